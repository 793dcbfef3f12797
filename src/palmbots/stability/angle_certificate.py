# SPDX-License-Identifier: Apache-2.0
"""The certificate of designed palm angles, and the scene with these angles.

Near the largest tolerance a condition becomes an equality, and a prover that bisects boxes cannot
decide it. The certificate therefore claims a little less than the tolerance: first by the error of
its bisection, then by more, until the prover can decide. The angles are designed for robots of
which only one turns its palm at a time. Those claims for palms that turn at the same time that also
hold are added.
"""

from __future__ import annotations

import math
from typing import Any

from palmbots._types import Interval
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.stability.angle_grid import Quantity, Uncertainty
from palmbots.stability.certificates.box_from_scene import box_of
from palmbots.stability.certificates.obligations import BOTH_TURN, FORCE_CLAIMS, ONE_TURNS
from palmbots.stability.certificates.parameter_box import ParameterBox
from palmbots.stability.certificates.prover import Certificate, prove
from palmbots.stability.problem import StabilityProblem

_REDUCTIONS = (1e-6, 1e-4, 1e-3, 1e-2, 1e-1)
"""By how much less than the tolerance a certificate claims, in the order of the attempts. The first
is the error of the bisection that finds the tolerance."""
_FEW_BOXES, _MANY_BOXES = 3000, 20_000
"""An attempt that takes more boxes counts as undecided; the last one may take many."""


def angle_keys(scene: Scene, angles_deg: Interval) -> dict[str, float]:
    """The scene keys that give both palms these angles (shallow, steep)."""
    names = "palm.shallow_deg", "palm.steep_deg"
    return on_every_side(scene, dict(zip(names, angles_deg, strict=True)))


def scene_at(scene: Scene, angles_deg: Interval) -> Scene:
    """The scene with these angles on both palms.

    Raises:
        SceneError: it is no valid scene.
    """
    return load_scene(scene, angle_keys(scene, angles_deg))


def certify_tolerance(
    scene: Scene,
    problem: StabilityProblem,
    quantity: Quantity,
    tolerance: float,
    angles_deg: Interval,
    uncertainty: Uncertainty,
) -> tuple[Certificate, float]:
    """The certificate for as much of a tolerance as the prover can decide, and how much that is."""
    turned = scene_at(scene, angles_deg)

    def attempt(reduction: float, max_boxes: int) -> tuple[Certificate, float]:
        claimed = math.floor(tolerance * (1 - reduction) * 1e9) / 1e9
        intervals = _intervals(problem, quantity, claimed, angles_deg, uncertainty)
        box = box_of(turned, beyond_m=problem.beyond, **intervals)
        is_whole = reduction == _REDUCTIONS[0]
        claims = _provable(box, ONE_TURNS)
        certificate = prove(box, claims, scene=turned, max_boxes=max_boxes)
        if certificate.verdict == "holds":
            certificate = _with_further_claims(box, turned, max_boxes)
        return certificate, tolerance if is_whole else claimed

    for reduction in _REDUCTIONS[:-1]:
        certificate, proved = attempt(reduction, _FEW_BOXES)
        if certificate.verdict != "undecided":
            return certificate, proved
    return attempt(_REDUCTIONS[-1], _MANY_BOXES)


def _provable(box: ParameterBox, claims: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(claim for claim in claims if claim in FORCE_CLAIMS or not box.rounded)


def _with_further_claims(box: ParameterBox, scene: Scene, max_boxes: int) -> Certificate:
    """The certificate of a box in which the first claims hold, with the others that hold in it."""

    def holds(claim: str) -> bool:
        return prove(box, (claim,), scene=scene, max_boxes=max_boxes).verdict == "holds"

    claims = (*_provable(box, ONE_TURNS), *filter(holds, _provable(box, BOTH_TURN)))
    return prove(box, claims, scene=scene, max_boxes=len(claims) * max_boxes)


def _intervals(
    problem: StabilityProblem,
    quantity: Quantity,
    error: float,
    angles_deg: Interval,
    uncertainty: Uncertainty,
) -> dict[str, Any]:
    """The box of a claim: the uncertainty, and the error of one quantity to either side."""
    left, up = problem.com_shift
    uncertainty = uncertainty.counted_from((-left, -up))  # boxes count from the contact vertices
    intervals: dict[str, Any] = {
        "com_x_m": uncertainty.com_x,
        "com_y_m": uncertainty.com_y,
        "friction": uncertainty.friction[0],
        "friction_right": uncertainty.friction[1],
        "common_friction": uncertainty.common_friction,
        "shallow_deg": (angles_deg[0],) * 2,
        "steep_deg": (angles_deg[1],) * 2,
        "slope": uncertainty.slope,
    }
    region = problem.contacts[0]
    if region != (-problem.reach[0], problem.reach[0]):
        # Rounded outward to 1 nm, since a certificate contains decimal text, but not off the palm.
        most = min(problem.reach)
        intervals["region_m"] = tuple(
            math.copysign(min(math.ceil(abs(end) * 1e9) / 1e9, most), end) for end in region
        )
    if quantity == "com":
        low, high = uncertainty.com_x or (problem.vertex_com[0],) * 2
        intervals["com_x_m"] = (round(low - error, 9), round(high + error, 9))
    elif quantity == "friction":
        pairs = [
            (max(round(low - error, 9), 0.0), round(high + error, 9))
            for low, high in uncertainty.friction
        ]
        intervals["friction"], intervals["friction_right"] = pairs
    elif quantity in ("slope", "acceleration"):
        low, high = uncertainty.slope or (problem.slope, problem.slope)
        intervals["slope"] = (round(low - error, 9), round(high + error, 9))
    elif quantity == "region":
        intervals["region_m"] = (-error, error)
    else:
        error = math.floor(math.degrees(error) * 1e6) / 1e6
        for key, angle in zip(("shallow_deg", "steep_deg"), angles_deg, strict=True):
            intervals[key] = (round(angle - error, 6), round(angle + error, 6))
    return intervals
