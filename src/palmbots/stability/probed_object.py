# SPDX-License-Identifier: Apache-2.0
"""What a probe has found out about an object, as a file: `certify` and `design` read it."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, fields, replace
from typing import Any

from palmbots._types import SIDES, Interval
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.files import read_table
from palmbots.scene.object_frame import object_frame
from palmbots.scene.scene import Scene, load_scene
from palmbots.stability.angle_grid import Uncertainty

PROBED_FILE = FileKind(
    "a probed object",
    "palmbots certify --from and palmbots design --from",
    "palmbots probe --out DIR writes one, probe.toml",
    keys=("probed",),
)

_LIMITS = {"com_x_m": (-10.0, 10.0), "com_y_m": (-10.0, 10.0)}
_FRICTION = (0.0, 100.0)
_ROUNDING_M = 1e-6
"""The file has six digits."""


@dataclass(frozen=True)
class ProbedObject:
    """The intervals that contain the object."""

    com_x_m: Interval
    """COM from the left contact, along the line of contacts."""
    com_y_m: Interval
    """COM above that line."""
    friction_left: Interval
    friction_right: Interval

    @property
    def middle_m(self) -> float:
        """Of the COMs along the object."""
        return 0.5 * sum(self.com_x_m)

    def frictions(self, common: bool) -> tuple[Interval, Interval]:
        """The intervals of both palms; those of one coefficient that both have, if it is common.

        Raises:
            PalmbotsError: no coefficient is in both.
        """
        left, right = self.friction_left, self.friction_right
        if not common:
            return left, right
        both = max(left[0], right[0]), min(left[1], right[1])
        if both[0] > both[1]:
            raise PalmbotsError(
                "common_friction: the probed palms have no coefficient in common; allowed: "
                "independent friction"
            )
        return both, both


def read_probed(path: str | os.PathLike[str], scene: Scene) -> ProbedObject:
    """Read the file of a probe.

    Args:
        path: of the file.
        scene: with the object that was probed.

    Raises:
        SceneError: the file cannot be read.
        PalmbotsError: its content is not allowed, or is of another object.
    """
    name = os.fspath(path)
    table = read_table(name, PROBED_FILE).get("probed")
    names = [field.name for field in fields(ProbedObject)]
    if not isinstance(table, dict) or set(table) != set(names):
        given = sorted(table) if isinstance(table, dict) else table
        raise PalmbotsError(
            f"{name}: probed: has {show(given)}; allowed: a table with {', '.join(names)}"
        )
    found = ProbedObject(
        **{
            key: _interval(f"{name}: probed.{key}", table[key], *_LIMITS.get(key, _FRICTION))
            for key in names
        }
    )
    body = scene.object
    width = object_frame(body.vertices_m, body.contacts, body.com_m).width
    if not 0 <= found.com_x_m[0] <= found.com_x_m[1] <= width + _ROUNDING_M:
        raise PalmbotsError(
            f"{name}: probed.com_x_m: value is {show(list(found.com_x_m))}, and the contacts of "
            f"the object in the scene are {width:g} m apart; allowed: the probe of this object"
        )
    return found


def _interval(name: str, value: Any, least: float, most: float) -> Interval:
    ends = value if isinstance(value, list) else []
    if len(ends) == 2 and all(
        isinstance(end, int | float) and not isinstance(end, bool) and math.isfinite(end)
        for end in ends
    ):
        low, high = map(float, ends)
        if least <= low <= high <= most:
            return low, high
    raise PalmbotsError(
        f"{name}: value is {show(value)}; allowed: two numbers, the lower one first, "
        f"from {least:g} to {most:g}"
    )


def with_probed(
    scene: Scene, path: str | os.PathLike[str] | None, common: bool
) -> tuple[Scene, ProbedObject | None]:
    """The scene with an object and palms in the middle of the intervals of a file, and these.

    Args:
        scene: the scene.
        path: of the file; None: the scene stays as it is.
        common: both palms have the same coefficient.

    Raises:
        SceneError: such an object is not possible, or the file cannot be read.
        PalmbotsError: the content of the file is not allowed.
    """
    if path is None:
        return scene, None
    found = read_probed(path, scene)
    body = scene.object
    frame = object_frame(body.vertices_m, body.contacts, body.com_m)
    (left_x, left_y), (right_x, right_y) = (body.vertices_m[k] for k in body.contacts)
    along = (right_x - left_x) / frame.width, (right_y - left_y) / frame.width
    shift = found.middle_m - frame.com.from_left
    com = [c + shift * a for c, a in zip(body.com_m, along, strict=True)]
    frictions = {
        f"palm.{side}.friction": 0.5 * sum(ends)
        for side, ends in zip(SIDES, found.frictions(common), strict=True)
    }
    return load_scene(scene, {"object.com_m": com, **frictions}), found


def uncertainty_of(
    found: ProbedObject | None, given: Uncertainty, keeps_friction: bool
) -> Uncertainty:
    """The intervals over which a design has to hold, with those of a probed object.

    Args:
        found: the object; None: there is none.
        given: the intervals without it; a height of the COM in it has precedence.
        keeps_friction: the friction in it has precedence, too.
    """
    if found is None:
        return given
    return replace(
        given,
        friction=given.friction if keeps_friction else found.frictions(given.common_friction),
        com_y=given.com_y or found.com_y_m,
        com_x=found.com_x_m,
    )
