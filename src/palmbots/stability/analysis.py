# SPDX-License-Identifier: Apache-2.0
"""The paper's analysis of any scene: do the properties hold, by how much, and what breaks them?

With properties 1 and 2 (paper, section 2) the algorithms can steer the contacts. The paper assumes
property 0, that the object is held while a palm turns. Each property is evaluated with either palm
as the shallow one and for all contacts of a region, by default the whole palms.
Source: paper, sections 3.2 to 3.4; docs/theory/stability.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Generic, Literal, TypeVar

from palmbots._types import SIDES, BySide, Interval, Overrides, Side
from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import Result
from palmbots.errors import PalmbotsError
from palmbots.mechanics.hand_over import HandOver, hand_over
from palmbots.mechanics.lift_margins import Lifting
from palmbots.mechanics.lifting import lifting
from palmbots.mechanics.load_limits import LoadLimit, LoadLimits, load_limits
from palmbots.mechanics.lone import LoneLift, on_one_palm
from palmbots.mechanics.lone_refusals import lone_lift
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.stability.clearance import Clearance, outline_clearance
from palmbots.stability.first_contact import FirstTouch, first_touch
from palmbots.stability.interval_sets import shifted
from palmbots.stability.lateral_tipping import Sideways, sideways_of
from palmbots.stability.linear_conditions import failing, text_of
from palmbots.stability.margins import (
    Wedging,
    angle_error,
    angle_margin,
    com_x_range,
    com_y_ranges,
    friction_margin,
    friction_ranges,
    half_length_range,
    slope_range,
    wedging,
)
from palmbots.stability.problem import Pair, StabilityProblem, permitted, stability_problem
from palmbots.stability.scene_limits import largest_acceleration, limit_warnings
from palmbots.stability.tightest_margins import RankedMargin, ranked_margins

_CENTRED_M = 1e-3

T = TypeVar("T")


@dataclass(frozen=True)
class Margins:
    """How far a property is from failing; None: no constraint binds, or the property fails."""

    travel_m: float | None
    """How much farther outward every contact may be, on both palms; negative: how much less far
    it must be."""
    angle_rad: float | None
    """Largest error of the palm angles, independent on both palms."""
    friction: float | None
    """Largest error of the coefficients, independent on both palms."""
    com_m: float | None
    """Distance of the COM from the nearer end of its range; negative: it lies outside."""


@dataclass(frozen=True)
class PropertyReport:
    """One property with one palm as the shallow one (property 0: as the one that turns)."""

    number: int = field(metadata=NOT_IN_JSON)
    shallow: Side = field(metadata=NOT_IN_JSON)
    holds: bool
    margins: Margins
    binding: str
    """What happens first where the property fails, in words; empty: no constraint binds."""
    binding_p_m: Pair
    """The contacts (left, right) closest to that: E or F of the paper's Figure 5."""
    com_x_m: Pair | None
    """The COMs along the object for which the property holds, measured as in `Analysis.com_x_m`.
    None: there is none."""


@dataclass(frozen=True)
class Bands:
    """The stable band in the plane of contacts: k_lower ≤ z ≤ k_upper; None: does not bind."""

    k_lower: float | None
    k_upper: float | None
    lower_binding: str
    upper_binding: str


@dataclass(frozen=True)
class ByMotion(Generic[T]):
    """A value for properties 1 and 2, each with either palm as the shallow one."""

    closing: BySide[T]
    """Property 1: the palms are driven together."""
    opening: BySide[T]
    """Property 2: they are driven apart."""

    def __getitem__(self, place: tuple[int, Side]) -> T:
        """The value of a property and a side."""
        number, side = place
        own: dict[int, BySide[T]] = dict(zip((1, 2, 0), vars(self).values(), strict=False))
        return own[number][side]

    def values(self) -> Iterator[T]:
        """All values."""
        for pair in vars(self).values():
            yield from pair.values()


@dataclass(frozen=True)
class ByProperty(ByMotion[T], Generic[T]):
    """A value for every property, with either palm as the shallow one."""

    turning: BySide[T]
    """Property 0: one palm turns."""


@dataclass(frozen=True, repr=False)
class Analysis(Result):
    """The result of `analyze`. Each range varies one quantity; all others are as in the scene."""

    lines_of = "palmbots.stability.analysis_lines:analysis_lines"

    scene: Scene
    problem: StabilityProblem = field(metadata=NOT_IN_JSON)
    properties: ByProperty[PropertyReport]
    bands: ByMotion[Bands]
    com_x_m: Interval | None
    """From the left contact vertex along the line of contacts, for both properties. If it is
    rounded, the vertex is where the straight edges would meet, as in `object.vertices_m`."""
    com_y_m: tuple[Interval, ...]
    """Above that vertex."""
    friction: tuple[Interval, ...]
    """The same on both palms."""
    half_length_m: Interval | None
    """Of both palms, measured from p = 0."""
    slope: Interval | None = field(metadata=NOT_IN_JSON)
    """Tangents of the floor's slope, uphill in the direction of travel > 0."""
    angle_error_rad: float | None = field(metadata=NOT_IN_JSON)
    clearance: Clearance
    """How far the outline stays from both palms, and where the distance is smallest."""
    touch: FirstTouch | None
    """The contacts and motions where a palm, turned from there, just touches the outline."""
    wedging: Wedging
    sideways: Sideways
    load: LoadLimits = field(metadata=NOT_IN_JSON)
    """What the robots can hold."""
    lifting: Lifting | None
    """Whether the object can be picked up and put down; None: the job does neither, or one robot
    does it alone."""
    lone: LoneLift | None
    """Whether one robot can do the job alone; None: two do it."""
    hand_over: HandOver | None
    """Whether one robot can hand the object to the other one; None: they do not."""
    warnings: tuple[str, ...]
    """Numbers of the scene that exceed what properties 1 and 2 allow."""

    figure = "operating-region"
    more_figures = (
        "stability-geometry", "friction-cones", "meeting-points", "permitted-com", "tactile-zones",
        "lifting-forces",
    )  # fmt: skip

    @derived
    def holds(self) -> bool:
        """Whether all properties hold with either palm as the shallow one."""
        return all(report.holds for report in self.properties.values())

    @derived
    def ranking(self) -> tuple[RankedMargin, ...]:
        """The margins, the tightest first: by the margin over what the scene uses up of it."""
        return ranked_margins(self)

    @derived
    def heaviest_kg(self) -> float | None:
        """The heaviest object that the robots hold with contacts anywhere on the palms; None:
        any."""
        return self.load.heaviest_kg

    @derived
    def load_limits(self) -> tuple[LoadLimit, ...]:
        """What limits the mass, the tightest first."""
        return self.load.limits

    @derived
    def slope_deg(self) -> Interval | None:
        """Slopes of the floor, uphill in the direction of travel > 0."""
        if self.slope is None:
            return None
        low, high = (math.degrees(math.atan(end)) for end in self.slope)
        return low, high

    @derived
    def angle_error_deg(self) -> float | None:
        """The admissible error of all palm angles."""
        return None if self.angle_error_rad is None else math.degrees(self.angle_error_rad)

    @derived
    def clearance_deg(self) -> float:
        """How far a palm may turn until the outline touches it."""
        return math.degrees(self.clearance.rotation_margin.margin)

    @derived
    def region_m(self) -> BySide[Interval]:
        """The contacts for which the properties have to hold."""
        return BySide.of(self.problem.contacts)

    @derived
    def max_slope_deg(self) -> float | None:
        """The steepest floor, uphill or downhill, on which both properties hold."""
        if self.slope is None:
            return None
        return math.degrees(math.atan(min(-self.slope[0], self.slope[1])))

    @derived
    def max_acceleration_m_s2(self) -> float | None:
        """The largest acceleration, in either direction, at which both properties hold."""
        return None if self.slope is None else largest_acceleration(self.problem, self.slope)

    def plot(self, figure: str | None = None, **options: Any) -> Any:
        """Draw one figure of the analysis.

        Args:
            figure: its name; None: the operating region (the paper's Figure 5). The others are
                ``stability-geometry``, ``friction-cones``, ``meeting-points``, ``permitted-com``
                and ``tactile-zones`` (Figures 2, 3, 4, 6 and 7), and ``lifting-forces`` for a job
                that begins or ends on the floor.
            options: ``p_m``, the contacts of the state that Figures 2 to 4 draw.

        Returns:
            The `matplotlib.figure.Figure`.

        Raises:
            PalmbotsError: the analysis has no figure of that name.
        """
        return super().plot(figure, **options)


@command(
    order=30,
    example="palmbots analyze --set palm.friction=0.4 --out out",
    region_m=Option("--region", metavar="implied|palm|LOW,HIGH"),
)
def analyze(
    scene: SceneLike = "paper",
    *,
    region_m: Interval | Literal["implied", "palm"] = "palm",
    overrides: Overrides = None,
) -> Analysis:
    """Report whether the properties hold, and their margins.

    The report also states what limits them and the ranges of COM, friction, slope and acceleration
    in which they hold. For a job that begins or ends on the floor it states whether the object can
    be picked up and put down.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        region_m: contact coordinates: what the scene implies, the whole palm, or an interval [m].
            The properties have to hold for them on either palm.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: the region is not on the palms, or the object cannot span it.
    """
    chosen = load_scene(scene, overrides)
    problem = _problem(chosen, region_m)
    clearance = outline_clearance(problem)
    slope, angle = slope_range(problem), angle_error(problem)
    closing, opening, turning = (
        BySide.of(_report(problem, number, shallow) for shallow in SIDES) for number in (1, 2, 0)
    )
    load, lone, handed = load_limits(chosen), lone_lift(chosen), hand_over(chosen)
    return Analysis(
        scene=chosen,
        problem=problem,
        properties=ByProperty(closing, opening, turning),
        bands=ByMotion(
            *(BySide.of(_bands(problem, number, shallow) for shallow in SIDES) for number in (1, 2))
        ),
        com_x_m=com_x_range(problem),
        com_y_m=com_y_ranges(problem),
        friction=friction_ranges(problem),
        half_length_m=half_length_range(problem),
        slope=slope,
        angle_error_rad=angle,
        clearance=clearance,
        # Of two palms; an object for one may reach farther than between them.
        touch=None if lone or handed else first_touch(chosen, clearance.rotation_margin),
        wedging=wedging(problem),
        sideways=sideways_of(chosen),
        load=load,
        lifting=lifting(chosen),
        lone=lone,
        hand_over=handed,
        warnings=limit_warnings(chosen, problem.contacts),
    )


def _problem(scene: Scene, region_m: Interval | Literal["implied", "palm"]) -> StabilityProblem:
    """The question for two palms. One palm alone can hold objects that do not reach the ends of
    two; then it is asked for centred contacts only."""
    try:
        return stability_problem(scene, region_m)
    except PalmbotsError:
        if region_m != "palm" or not on_one_palm(scene):
            raise
        return stability_problem(scene, (-_CENTRED_M, _CENTRED_M))


def _report(problem: StabilityProblem, number: int, shallow: Side) -> PropertyReport:
    low, high = permitted(problem.envelope(), number, shallow, problem.angles)
    x = problem.com[0]
    holds = low <= x <= high
    travel, nearest = _travel(problem, number, shallow)
    return PropertyReport(
        number=number,
        shallow=shallow,
        holds=holds,
        margins=Margins(
            travel_m=travel,
            angle_rad=angle_margin(problem, number, shallow) if holds else None,
            friction=friction_margin(problem, number, shallow) if holds else None,
            com_m=min(x - low, high - x) if low <= high else None,
        ),
        binding=text_of(number, nearest[0]) if nearest else "",
        binding_p_m=nearest[1] if nearest else (0.0, 0.0),
        com_x_m=shifted((low, high), problem.com_shift[0]) if low <= high else None,
    )


def _travel(
    problem: StabilityProblem, number: int, shallow: Side
) -> tuple[float | None, tuple[str, Pair] | None]:
    """How much larger the region may be, and the condition that then binds first, with where."""
    least, nearest = math.inf, None
    for pose in problem.poses(number, shallow):
        spread = sum(abs(math.sin(a)) for a in pose.angles)
        for form in problem.forms(number, shallow, pose.angles):
            bad = failing(form, problem.width)
            if bad is None:
                continue
            # Distance from the region to where it fails, above or below it.
            below, above = pose.rise[0] - bad[1], bad[0] - pose.rise[1]
            room = max(below, above) / max(spread, 1e-12)
            if room < least:
                least = room
                nearest = (
                    form.name,
                    _corner(problem, number, shallow, pose.angles, above >= below),
                )
    return (None, None) if nearest is None else (least, nearest)


def _corner(
    problem: StabilityProblem, number: int, shallow: Side, angles: Pair, highest: bool
) -> Pair:
    """The contacts of the region at which z is extreme: E (highest) or F (lowest)."""
    ends = problem.region(number, shallow)
    rising = [math.sin(a) >= 0 for a in angles]
    left = ends[0][0] if rising[0] == highest else ends[0][1]
    right = ends[1][1] if rising[1] == highest else ends[1][0]
    return left, right


def _bands(problem: StabilityProblem, number: int, shallow: Side) -> Bands:
    angles = problem.palms(shallow)
    lower: tuple[float, str] | None = None
    upper: tuple[float, str] | None = None
    middle = 0.5 * sum(problem.rise(number, shallow, angles))
    for form in problem.forms(number, shallow, angles):
        bad = failing(form, problem.width)
        if bad is None or form.name.startswith("lift"):
            continue
        from_below = bad[0] <= -problem.width or (bad[1] < problem.width and bad[1] <= middle)
        if from_below and (lower is None or bad[1] > lower[0]):
            lower = (bad[1], form.name)
        if not from_below and (upper is None or bad[0] < upper[0]):
            upper = (bad[0], form.name)
    return Bands(
        k_lower=lower[0] if lower else None,
        k_upper=upper[0] if upper else None,
        lower_binding=text_of(number, lower[1]) if lower else "",
        upper_binding=text_of(number, upper[1]) if upper else "",
    )
