# SPDX-License-Identifier: Apache-2.0
"""Tolerance and clearance of every pair of palm angles of a grid.

The core evaluates each pair exactly, so the best pair is the best of the whole grid. A pair is
admissible if its tolerance is positive, which means that properties 0, 1 and 2 hold with either
palm shallow, if the outline clears the palms, and if the two angles differ by a given minimum.
Source: docs/theory/stability.md; paper, section 5.1.
"""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from palmbots._types import Interval
from palmbots._util.arguments import ordered_pair, show
from palmbots.errors import PalmbotsError
from palmbots.stability.interval_sets import shifted
from palmbots.stability.problem import Pair, StabilityProblem
from palmbots.stability.reaction_region import Reaction

if TYPE_CHECKING:
    import xarray as xr

Quantity = Literal["com", "friction", "slope", "acceleration", "region", "angle"]
"""What `palmbots.design` can maximize the tolerance of."""

Lift = Literal["lift"]
Objective = Literal["noise"] | Lift | Quantity
"""What `palmbots.design` can maximize: the noise limit σ*, the tightest margin of a job on the
floor, or a tolerance."""

NOISE: Literal["noise"] = "noise"
LIFT: Lift = "lift"

QUANTITIES: dict[Quantity, tuple[int, float, str, float, str]] = {
    "com": (0, math.inf, "m", 1e3, "COM along the object"),
    "friction": (1, 2.0, "", 1.0, "friction"),
    "slope": (2, 1.0, "tangent", 1.0, "slope"),
    "acceleration": (2, 1.0, "g", 1.0, "acceleration"),
    "region": (3, math.inf, "m", 1e3, "contact coordinate"),
    "angle": (4, math.radians(30), "rad", 180 / math.pi, "palm angle"),
}
"""Every quantity: its number in the core, largest tolerance and unit, the factor to the
unit that is shown, and its name."""

_LARGEST_TOLERANCE = 10.0
_ROUNDING_DEG = 1e-9

Grid = NDArray[np.float64]


@dataclass(frozen=True)
class GridLimits:
    """The grid of angles and the conditions that a pair must meet.

    Raises:
        PalmbotsError: a value is out of range.
    """

    range_deg: Interval
    resolution_deg: float
    min_difference_deg: float
    min_clearance_deg: float
    also_deg: tuple[float, ...] = ()
    """Angles of the grid that need not be multiples of the resolution; only those in the range."""

    def __post_init__(self) -> None:
        low, high = ordered_pair("angle_range_deg", self.range_deg, -45, 75, differ=True)
        if not (math.isfinite(self.resolution_deg) and 0.01 <= self.resolution_deg <= 10):
            raise PalmbotsError(
                f"resolution_deg: value is {show(self.resolution_deg)}; allowed: 0.01 to 10 degrees"
            )
        if not 0 < self.min_difference_deg <= high - low:
            raise PalmbotsError(
                f"min_angle_difference_deg: value is {show(self.min_difference_deg)}; allowed: "
                f"more than 0, up to {high - low:g}"
            )
        if not 0 <= self.min_clearance_deg <= 90:
            raise PalmbotsError(
                f"min_clearance_deg: value is {show(self.min_clearance_deg)}; allowed: 0 to 90"
            )

    def angles_deg(self) -> Grid:
        """The angles of the grid: multiples of the resolution within the range."""
        low, high = self.range_deg
        step = self.resolution_deg
        steps = np.arange(math.ceil(low / step), math.floor(high / step) + 1)
        multiples = np.round(steps * step, 6).astype(np.float64)
        return np.union1d(multiples, [angle for angle in self.also_deg if low <= angle <= high])


@dataclass(frozen=True)
class Uncertainty:
    """Intervals over which the properties have to hold at every pair of angles."""

    friction: tuple[Interval, Interval]
    """Of the left and of the right palm."""
    common_friction: bool
    com_y: Interval | None
    slope: Interval | None
    """Specific force towards −x, as `StabilityProblem.slope`."""
    com_x: Interval | None = None
    """From the left contact; None: as in the problem."""

    def counted_from(self, origin: Pair) -> "Uncertainty":
        """The same with the COM measured from another point."""
        ends = zip((self.com_x, self.com_y), origin, strict=True)
        com_x, com_y = (None if one is None else shifted(one, -by) for one, by in ends)
        return replace(self, com_x=com_x, com_y=com_y)


@dataclass(frozen=True)
class AngleGrid:
    """Results over all pairs; axis 0 is the shallow angle, axis 1 the steep one."""

    degrees: Grid
    tolerance: Grid
    """In the unit of the quantity; negative: a property fails at the scene's own values."""
    clearance_deg: Grid
    admissible: NDArray[np.bool_]
    reach_m: Grid | None
    """Region half-width at each pair; None: the region does not depend on the angles."""

    @property
    def difference_deg(self) -> Grid:
        """Steep minus shallow angle."""
        return self.degrees[np.newaxis, :] - self.degrees[:, np.newaxis]

    def best(self) -> tuple[int, int]:
        """Row and column of the admissible pair with the largest tolerance.

        Ties go to the pair with the smallest difference, since its palms turn fastest.
        """
        tolerance = np.where(self.admissible, self.tolerance, -np.inf)
        ties = np.argwhere(tolerance >= tolerance.max() * (1 - 1e-9))
        difference = self.difference_deg
        row, column = min(ties, key=lambda rc: (difference[rc[0], rc[1]], self.degrees[rc[0]]))
        return int(row), int(column)

    def place_of(self, shallow_deg: float, steep_deg: float) -> tuple[int, int] | None:
        """Row and column of a pair; None: it is not on the grid."""
        places = [
            np.flatnonzero(np.abs(self.degrees - angle) < _ROUNDING_DEG)
            for angle in (shallow_deg, steep_deg)
        ]
        if any(len(place) == 0 for place in places):
            return None
        row, column = (int(place[0]) for place in places)
        return row, column

    def tolerance_at(self, shallow_deg: float, steep_deg: float) -> float | None:
        """The tolerance of one pair; None: not on the grid, or the pair fails or touches."""
        place = self.place_of(shallow_deg, steep_deg)
        if place is None:
            return None
        value = float(self.tolerance[place])
        return value if value >= 0 and self.clearance_deg[place] >= 0 else None

    def refusal(self, limits: GridLimits) -> str:
        """Why no pair is admissible."""
        holds = self.tolerance > 0
        if not holds.any():
            return (
                "the properties hold at no pair; allow less uncertainty, a smaller region or more "
                "friction"
            )
        apart = holds & (self.difference_deg >= limits.min_difference_deg - _ROUNDING_DEG)
        if not apart.any():
            most = float(self.difference_deg[holds].max())
            return (
                f"where the properties hold, the angles differ by at most {most:g}°; "
                "lower min_angle_difference_deg"
            )
        clear = float(np.nanmax(np.where(apart, self.clearance_deg, -np.inf)))
        return (
            f"where the properties hold, the clearance is at most {clear:.2f}°, less than "
            f"{limits.min_clearance_deg:g}°; lower min_clearance_deg, put feet under the object or "
            "choose a smaller region"
        )

    def dataset(
        self, quantity: Quantity, limits: GridLimits, sigma_m_s: Grid | None = None
    ) -> "xr.Dataset":
        """The grid as a labelled dataset, with about σ* of each pair if it is given."""
        import xarray as xr  # here: its import takes longer than a carry

        about = {"units": QUANTITIES[quantity][2], "long_name": f"tolerance of {quantity}"}
        axes = ("shallow", "steep")
        coordinates = {name: (name, self.degrees, {"units": "degrees"}) for name in axes}
        return xr.Dataset(
            {
                "tolerance": (axes, self.tolerance, about),
                "clearance": (axes, self.clearance_deg, {"units": "degrees"}),
                "allowed": (axes, self.admissible),
            }
            | ({} if sigma_m_s is None else {"sigma_star": (axes, sigma_m_s, {"units": "m/s"})}),
            coords=coordinates,
            attrs={
                "min_clearance_deg": limits.min_clearance_deg,
                "min_angle_difference_deg": limits.min_difference_deg,
            },
        )


def evaluate(
    problem: StabilityProblem,
    quantity: Quantity,
    limits: GridLimits,
    uncertainty: Uncertainty,
    implied: Reaction | None,
) -> AngleGrid:
    """Evaluate all pairs of the grid.

    Args:
        problem: the scene's problem; its own angles do not matter.
        quantity: whose error is tolerated.
        limits: the grid and the conditions.
        uncertainty: intervals over which the properties have to hold.
        implied: the region that the scene implies at every pair; None: the problem's region.

    Raises:
        PalmbotsError: no pair is admissible.
    """
    degrees = limits.angles_deg()
    reach = None if implied is None else np.minimum(implied.reach_m, min(problem.reach))
    tolerance, clearance_deg = _map(problem, quantity, degrees, degrees, uncertainty, reach)
    difference = degrees[np.newaxis, :] - degrees[:, np.newaxis]
    admissible = (
        (tolerance > 0)
        & (clearance_deg >= limits.min_clearance_deg)
        & (difference >= limits.min_difference_deg - _ROUNDING_DEG)
    )
    grid = AngleGrid(degrees, tolerance, clearance_deg, admissible, reach)
    if not admissible.any():
        raise PalmbotsError(f"no pair of angles qualifies: {grid.refusal(limits)}")
    return grid


def tolerance_at(
    problem: StabilityProblem,
    quantity: Quantity,
    angles_deg: Interval,
    uncertainty: Uncertainty,
    implied: Reaction | None,
) -> float | None:
    """The tolerance of one pair of angles (shallow, steep), which need not be on any grid.

    None: the pair fails or touches. Arguments as of `evaluate`, with `implied` at this pair.
    """
    if angles_deg[1] <= angles_deg[0]:
        return None
    reach = None
    if implied is not None:
        reach = np.minimum(implied.reach_m, min(problem.reach)).reshape(1, 1)
    shallow, steep = (np.array([angle], np.float64) for angle in angles_deg)
    tolerance, clearance_deg = _map(problem, quantity, shallow, steep, uncertainty, reach)
    value = float(tolerance[0, 0])
    return value if value >= 0 and clearance_deg[0, 0] >= 0 else None


def _map(
    problem: StabilityProblem,
    quantity: Quantity,
    shallow_deg: Grid,
    steep_deg: Grid,
    uncertainty: Uncertainty,
    reach: Grid | None,
) -> tuple[Grid, Grid]:
    """Tolerance, and clearance [°], of all pairs of these angles."""
    envelope = problem.envelope(
        com_y=uncertainty.com_y,
        friction=uncertainty.friction,
        common=uncertainty.common_friction,
        slope=uncertainty.slope,
    )
    number, most, *_ = QUANTITIES[quantity]
    if quantity == "region":
        most = min(problem.reach)
    tolerance, clearance = envelope.map(
        np.radians(shallow_deg),
        np.radians(steep_deg),
        uncertainty.com_x or (problem.com[0], problem.com[0]),
        number,
        min(most, _LARGEST_TOLERANCE),
        np.empty((0, 0)) if reach is None else np.ascontiguousarray(reach),
    )
    return tolerance, np.degrees(clearance)
