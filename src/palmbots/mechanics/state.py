# SPDX-License-Identifier: Apache-2.0
"""One state of a scene: palm angles and contact coordinates, checked against the scene.

Users give degrees and metres; the default angle is the scene's steep one. The object's angle
follows from the positions of its two contact vertices.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES, Overrides
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import contact_radii, to_spec


@dataclass(frozen=True)
class PalmState:
    """Left is index 0, right index 1."""

    scene: Scene
    spec: _core.Spec
    p_m: tuple[float, float]
    theta_deg: tuple[float, float]
    object_rad: float

    @property
    def theta_rad(self) -> tuple[float, float]:
        """The palm angles in radians."""
        return math.radians(self.theta_deg[0]), math.radians(self.theta_deg[1])


def palm_state(
    scene: SceneLike,
    p_left_m: float,
    p_right_m: float,
    theta_left_deg: float | None,
    theta_right_deg: float | None,
    overrides: Overrides = None,
) -> PalmState:
    """The state with these contacts and angles; as for `palmbots.contact_modes`."""
    chosen = load_scene(scene, overrides)
    degrees = [
        float(chosen.palm_of(side).steep_deg if angle is None else angle)
        for side, angle in zip(SIDES, (theta_left_deg, theta_right_deg), strict=True)
    ]
    spec = to_spec(chosen)
    p_left, p_right = float(p_left_m), float(p_right_m)
    if spec.width == 0:
        p_right = _on_right_of_pipe(spec, p_left, p_right, degrees)
    return placed(chosen, spec, (p_left, p_right), (degrees[0], degrees[1]))


def _on_right_of_pipe(
    spec: _core.Spec, p_left: float, p_right: float, degrees: Sequence[float]
) -> float:
    """Where the right palm touches a pipe that touches the left one at `p_left` [m]; 0 as
    `p_right` leaves it open."""
    (sin, right_sin), (cos, right_cos) = (
        [of(math.radians(angle)) for angle in degrees] for of in (math.sin, math.cos)
    )
    levels = [
        palm.offset + radius for palm, radius in zip(spec.palms, contact_radii(spec), strict=True)
    ]
    if right_sin == 0:
        raise PalmbotsError(
            "theta_right_deg: value is 0, and a level palm may touch a pipe anywhere; allowed: "
            "-80 to 80 degrees, but not 0"
        )
    place = (p_left * sin + levels[0] * cos - levels[1] * right_cos) / right_sin
    if p_right not in (0, place) and abs(p_right - place) > 1e-9:
        raise PalmbotsError(
            f"p_right_m: value is {show(p_right)}, but the contacts of a pipe move together; "
            f"allowed: {place:.6g} beside this p_left_m"
        )
    return place


def placed(
    scene: Scene, spec: _core.Spec, p: tuple[float, float], degrees: tuple[float, float]
) -> PalmState:
    """The same, for a scene that is converted to a spec already."""
    for i, side in enumerate(SIDES):
        half = 0.5 * spec.palms[i].length
        if not -half <= p[i] <= half:
            raise PalmbotsError(
                f"p_{side}_m: value is {show(p[i])}; allowed: on the palm, {-half:g} to {half:g} m"
            )
        if not -80 <= degrees[i] <= 80:
            raise PalmbotsError(
                f"theta_{side}_deg: value is {show(degrees[i])}; allowed: -80 to 80 degrees"
            )
    if spec.width == 0:  # it may be turned in any way
        return PalmState(scene, spec, p, degrees, 0.0)
    angles = [math.radians(d) for d in degrees]
    height = [
        p[i] * math.sin(angles[i]) + (spec.palms[i].offset + radius) * math.cos(angles[i])
        for i, radius in enumerate(contact_radii(spec))
    ]
    rise = (height[1] - height[0]) / spec.width
    if not abs(rise) < 1:
        raise PalmbotsError(
            "p_left_m, p_right_m: the contacts differ in height by more than the object is wide "
            f"({abs(rise) * spec.width:.3g} m); allowed: less than {spec.width:g} m"
        )
    return PalmState(scene, spec, p, degrees, math.asin(rise))
