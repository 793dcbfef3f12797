# SPDX-License-Identifier: Apache-2.0
"""Design of the palm angles: the pair that tolerates the largest error of one quantity.

The contacts for which the properties have to hold are those that the scene's zones, speeds,
latencies and tilt times imply at each pair of angles (`reaction_region`), or given ones. The result
contains a certificate for the tolerance. Source: docs/theory/stability.md; paper, section 5.1
("shallow enough that our system would have enough time to react").
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast

import numpy as np

from palmbots._types import Interval, Overrides
from palmbots._util.arguments import one_of, show, two_numbers
from palmbots._util.renamed_names import renamed_arguments
from palmbots._util.results import Result
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.stability.angle_grid import (
    QUANTITIES,
    GridLimits,
    Quantity,
    Uncertainty,
    evaluate,
)
from palmbots.stability.certificates.box_from_scene import (
    RENAMED_ARGUMENTS,
    box_of,
    slope_interval,
)
from palmbots.stability.certificates.prover import Certificate, prove
from palmbots.stability.interval_sets import around
from palmbots.stability.margins import friction_ranges
from palmbots.stability.problem import StabilityProblem, stability_problem
from palmbots.stability.reaction_region import reaction

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PAPER_DEG", "Design", "design", "with_angles"]

PAPER_DEG = (5.0, 15.0)
"""The paper's palm angles (shallow, steep), for comparison."""

Range: TypeAlias = Interval | None
Region: TypeAlias = Interval | Literal["implied", "palm"]

# The tolerance is found by bisection; the certificate claims this much less of it.
_BISECTION_ERROR = 1e-6


@dataclass(frozen=True, repr=False)
class Design(Result):
    """The best pair of angles with its tolerance and a certificate."""

    scene: Scene
    """As given; its own angles do not matter."""
    quantity: Quantity
    shallow_deg: float
    steep_deg: float
    tolerance: float
    """Of the quantity, to either side, in its unit (`QUANTITIES`)."""
    clearance_deg: float
    """How far the object or a palm may turn until an edge lies on a palm."""
    friction: Interval | None
    """Coefficients, the same on both palms, for which the properties hold at these angles."""
    friction_floor: float | None
    reaction_s: dict[str, float]
    """Time from leaving the zero zone to moving: own contact (d), and asked by the partner (a)."""
    region_m: Interval
    """The contacts for which everything holds."""
    paper_tolerance: float | None
    """The tolerance of 5° and 15° under the same conditions; None: that pair does not qualify."""
    certificate: Certificate
    map: xr.Dataset
    """Tolerance and clearance over all pairs of angles."""

    figure = "palm-angles"

    def headline(self) -> str:
        """The angles and what they maximise."""
        name = QUANTITIES[self.quantity][4]
        return f"palm angles {self.shallow_deg:g}° and {self.steep_deg:g}° tolerate most: {name}"

    @property
    def shown_unit(self) -> str:
        """The unit in which people read the quantity; empty: it has none."""
        unit = QUANTITIES[self.quantity][2]
        return {"m": "mm", "rad": "°"}.get(unit, unit)

    def tolerance_text(self, tolerance: float) -> str:
        """A tolerance of the quantity with its unit."""
        scale, unit = QUANTITIES[self.quantity][3], self.shown_unit
        gap = "" if unit in ("", "°") else " "
        return f"±{scale * tolerance:.3g}{gap}{unit}"

    def facts(self) -> dict[str, str]:
        """Tolerance, clearance, region, friction and certificate."""
        low, high = self.region_m
        facts = {
            "tolerance": self.tolerance_text(self.tolerance),
            "tolerance of 5°, 15°": "none: the pair fails or is not on the grid"
            if self.paper_tolerance is None
            else self.tolerance_text(self.paper_tolerance),
            "clearance": f"{self.clearance_deg:.2f}°",
            "contacts": f"{1e3 * low:.1f} to {1e3 * high:.1f} mm",
        }
        if self.friction is not None:
            facts["friction"] = f"{self.friction[0]:.3f} to {self.friction[1]:.3f}"
        return facts | {"certificate": self.certificate.verdict}

    def summary(self) -> dict[str, Any]:
        """The object that ``palmbots design --json`` prints."""
        return {
            "shallow_deg": self.shallow_deg,
            "steep_deg": self.steep_deg,
            "maximize": self.quantity,
            "tolerance": self.tolerance,
            "unit": QUANTITIES[self.quantity][2],
            "paper_tolerance": self.paper_tolerance,
            "clearance_deg": self.clearance_deg,
            "friction": self.friction,
            "friction_floor": self.friction_floor,
            "reaction_s": self.reaction_s,
            "region_m": self.region_m,
            "certificate": self.certificate.data,
            "scene": self.scene.model_dump(),
        }


@renamed_arguments(
    angles_deg="angle_range_deg",
    least_clearance_deg="min_clearance_deg",
    least_difference_deg="min_angle_difference_deg",
    **RENAMED_ARGUMENTS,
)
def design(
    scene: SceneLike = "paper",
    *,
    maximize: str = "com",
    friction: Range = None,
    common_friction: bool = False,
    com_y_m: Range = None,
    slope_deg: Range = None,
    region_m: Region = "implied",
    min_angle_difference_deg: float = 5.0,
    min_clearance_deg: float = 0.25,
    angle_range_deg: Interval = (-5, 50),
    resolution_deg: float | None = None,
    overrides: Overrides = None,
) -> Design:
    """Find the palm angles, the same for both palms, that tolerate the largest error.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        maximize: the quantity whose error is tolerated, one of `QUANTITIES`.
        friction: interval of the coefficients; None: the scene's.
        common_friction: True: both palms have the same coefficient, which may be any of the
            interval; False: each palm has its own.
        com_y_m: interval of the COM's height; None: the scene's.
        slope_deg: interval of the floor's slope, uphill in the direction of travel > 0, from -45
            to 45; None: the scene's.
        region_m: the contacts for which the properties have to hold: those that the scene implies
            at each pair of angles, the whole palm, or (low, high).
        min_angle_difference_deg: smallest difference of the two angles.
        min_clearance_deg: smallest clearance of the outline from the palms.
        angle_range_deg: range of both angles.
        resolution_deg: resolution of the grid; None: 0.1 for ``com``, 0.5 for all others.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: an argument is out of range, or no pair of angles qualifies.
    """
    chosen = load_scene(scene, overrides)
    one_of("maximize", maximize, tuple(QUANTITIES))
    quantity = cast("Quantity", maximize)
    resolution = 0.1 if quantity == "com" else 0.5
    limits = GridLimits(
        angle_range_deg,
        resolution if resolution_deg is None else resolution_deg,
        min_angle_difference_deg,
        min_clearance_deg,
    )
    problem = _problem(chosen, region_m)
    uncertainty = Uncertainty(
        _frictions(problem, friction, common_friction),
        common_friction,
        None if com_y_m is None else _ends("com_y_m", com_y_m, -10, 10),
        None if slope_deg is None else _floats(slope_interval(chosen, slope_deg)),
    )
    implied = None
    if region_m == "implied":
        radians = np.radians(limits.angles_deg())
        implied = reaction(chosen, *np.meshgrid(radians, radians, indexing="ij"))
        problem = problem.with_(beyond=implied.beyond_m)
    grid = evaluate(problem, quantity, limits, uncertainty, implied)

    row, column = grid.best()
    shallow, steep = float(grid.degrees[row]), float(grid.degrees[column])
    pair = (math.radians(shallow), math.radians(steep))
    answer = problem.with_(angles=(pair, pair))
    if grid.reach_m is not None:
        reach = float(grid.reach_m[row, column])
        answer = answer.with_(contacts=((-reach, reach), (-reach, reach)))
    tolerance = float(grid.tolerance[row, column])
    interval = _friction_interval(answer, uncertainty.friction)
    times = reaction(chosen, *pair)
    return Design(
        scene=chosen,
        quantity=quantity,
        shallow_deg=shallow,
        steep_deg=steep,
        tolerance=tolerance,
        clearance_deg=float(grid.clearance_deg[row, column]),
        friction=interval,
        friction_floor=interval[0] if interval else None,
        reaction_s={"own": float(times.own_s), "asked": float(times.asked_s)},
        region_m=answer.contacts[0],
        paper_tolerance=grid.tolerance_at(*PAPER_DEG),
        certificate=_certificate(
            chosen, answer, quantity, tolerance, (shallow, steep), uncertainty
        ),
        map=grid.dataset(quantity, limits),
    )


def _problem(scene: Scene, region_m: Any) -> StabilityProblem:
    if region_m in ("implied", "palm"):
        return stability_problem(scene)
    if not isinstance(region_m, tuple | list) or len(region_m) != 2:
        raise PalmbotsError(
            f"region_m: value is {show(region_m)}; allowed: implied, palm, or two numbers in m"
        )
    return stability_problem(scene, (float(region_m[0]), float(region_m[1])))


def _ends(name: str, value: Any, least: float, most: float) -> Interval:
    low, high = two_numbers(name, value)
    if not least <= low <= high <= most:
        raise PalmbotsError(
            f"{name}: value is {show([low, high])}; allowed: two numbers, the lower one first, "
            f"from {least:g} to {most:g}"
        )
    return low, high


def _floats(ends: tuple[Any, Any]) -> Interval:
    return float(ends[0]), float(ends[1])


def _frictions(
    problem: StabilityProblem, friction: Interval | None, common: bool
) -> tuple[Interval, Interval]:
    """The intervals of both palms."""
    if friction is not None:
        interval = _ends("friction", friction, 0, 100)
        return interval, interval
    left, right = problem.friction
    if common and left != right:
        raise PalmbotsError(
            "common_friction: the scene's palms have different coefficients, "
            f"{left:g} and {right:g}; give the interval of a common one as friction, or choose "
            "independent friction"
        )
    return (left, left), (right, right)


def _friction_interval(
    problem: StabilityProblem, frictions: tuple[Interval, Interval]
) -> Interval | None:
    middle = sum(end for pair in frictions for end in pair) / 4
    return around(friction_ranges(problem.with_(friction=(middle, middle))), middle)


def _certificate(
    scene: Scene,
    problem: StabilityProblem,
    quantity: Quantity,
    tolerance: float,
    angles_deg: Interval,
    uncertainty: Uncertainty,
) -> Certificate:
    """The proof for a tolerance, reduced by the error of its bisection."""
    error = math.floor(tolerance * (1 - _BISECTION_ERROR) * 1e9) / 1e9
    intervals: dict[str, Any] = {
        "com_y_m": uncertainty.com_y,
        "friction": uncertainty.friction[0],
        "friction_right": uncertainty.friction[1],
        "common_friction": uncertainty.common_friction,
        "shallow_deg": (angles_deg[0],) * 2,
        "steep_deg": (angles_deg[1],) * 2,
        "slope": uncertainty.slope,
    }
    region = problem.contacts[0]
    if region != (-problem.half_length[0], problem.half_length[0]):
        # Rounded outward to 1 nm, since a certificate contains decimal text, but not off the palm.
        most = min(problem.half_length)
        intervals["region_m"] = tuple(
            math.copysign(min(math.ceil(abs(end) * 1e9) / 1e9, most), end) for end in region
        )
    if quantity == "com":
        x = problem.com[0]
        intervals["com_x_m"] = (round(x - error, 9), round(x + error, 9))
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
    turned = _with_palm_angles(scene, angles_deg)
    return prove(box_of(turned, beyond_m=problem.beyond, **intervals), scene=turned)


def _with_palm_angles(scene: Scene, angles_deg: Interval) -> Scene:
    table = scene.model_dump()
    for palm in (table["palm"], table["palm"].get("left", {}), table["palm"].get("right", {})):
        palm.pop("shallow_deg", None)
        palm.pop("steep_deg", None)
    table["palm"] |= {"shallow_deg": angles_deg[0], "steep_deg": angles_deg[1]}
    return Scene.model_validate(table)


def with_angles(scene: Scene, result: Design) -> Scene:
    """The scene with the designed angles on both palms."""
    return _with_palm_angles(scene, (result.shallow_deg, result.steep_deg))
