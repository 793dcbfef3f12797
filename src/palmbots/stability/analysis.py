# SPDX-License-Identifier: Apache-2.0
"""The paper's analysis of any scene: do the properties hold, by how much, and what breaks them?

With properties 1 and 2 (paper, section 2) the algorithms can steer the contacts. The paper assumes
property 0, that the object is held while a palm turns. Each property is evaluated with either palm
as the shallow one and for all contacts of a region, by default the whole palms.
Source: paper, sections 3.2 to 3.4; docs/theory/stability.md.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from palmbots._types import SIDES, Interval, Overrides, Side
from palmbots._util.results import Result
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.stability.clearance import Clearance, outline_clearance
from palmbots.stability.first_contact import FirstTouch, first_touch
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

    number: int
    shallow: Side
    holds: bool
    margins: Margins
    binding: str
    """What happens first where the property fails, in words; empty: no constraint binds."""
    binding_p_m: Pair
    """The contacts (left, right) closest to that: E or F of the paper's Figure 5."""
    com_x_m: Pair | None
    """The COMs along the object for which the property holds; None: there is none."""


@dataclass(frozen=True)
class Bands:
    """The stable band in the plane of contacts: k_lower ≤ z ≤ k_upper; None: does not bind."""

    k_lower: float | None
    k_upper: float | None
    lower_binding: str
    upper_binding: str


@dataclass(frozen=True, repr=False)
class Analysis(Result):
    """The result of `analyze`. Each range varies one quantity; all others are as in the scene."""

    scene: Scene
    problem: StabilityProblem
    properties: dict[tuple[int, Side], PropertyReport]
    bands: dict[tuple[int, Side], Bands]
    com_x_m: Interval | None
    """From the left contact vertex along the line of contacts, for both properties."""
    com_y_m: tuple[Interval, ...]
    friction: tuple[Interval, ...]
    """The same on both palms."""
    half_length_m: Interval | None
    """Of both palms, measured from p = 0."""
    slope: Interval | None
    """Tangents of the floor's slope, uphill in the direction of travel > 0."""
    angle_error_rad: float | None
    clearance: Clearance
    """How far the outline stays from both palms, and where the distance is smallest."""
    touch: FirstTouch | None
    """The contacts and motions where a palm, turned from there, just touches the outline."""
    wedging: Wedging
    sideways: Sideways
    warnings: tuple[str, ...]
    """Numbers of the scene that exceed what properties 1 and 2 allow."""

    figure = "operating-region"
    more_figures = (
        "stability-geometry", "friction-cones", "meeting-points", "permitted-com", "tactile-zones",
    )  # fmt: skip

    @property
    def holds(self) -> bool:
        """Whether all properties hold with either palm as the shallow one."""
        return all(report.holds for report in self.properties.values())

    @property
    def max_slope_deg(self) -> float | None:
        """The steepest floor, uphill or downhill, on which both properties hold."""
        if self.slope is None:
            return None
        return math.degrees(math.atan(min(-self.slope[0], self.slope[1])))

    @property
    def max_acceleration_m_s2(self) -> float | None:
        """The largest acceleration, in either direction, at which both properties hold."""
        return None if self.slope is None else largest_acceleration(self.problem, self.slope)

    def headline(self) -> str:
        """Whether the properties hold and the outline clears the palms."""
        if not self.holds:
            return "FAILS: a property fails, with one of the palms shallow"
        if self.clearance.touches:
            return "TOUCHES: the properties hold, but the outline touches a palm"
        return "HOLDS: all properties, with either palm shallow"

    def facts(self) -> dict[str, str]:
        """The ranges in which both properties hold, and the warnings."""
        region = self.problem.contacts[0]
        slope = [math.degrees(math.atan(end)) for end in self.slope or ()]
        limit = self.max_acceleration_m_s2
        pieces = [f"{low:.3f} to {high:.3f}" for low, high in self.friction]
        facts = {
            "contacts": f"{1e3 * region[0]:.1f} to {1e3 * region[1]:.1f} mm",
            "COM along the object": "none"
            if self.com_x_m is None
            else f"{1e3 * self.com_x_m[0]:.1f} to {1e3 * self.com_x_m[1]:.1f} mm",
            "friction, both palms": ", ".join(pieces) or "none",
            "angle error": "none"
            if self.angle_error_rad is None
            else f"±{math.degrees(self.angle_error_rad):.1f}°",
            "slope, uphill > 0": f"{slope[0]:.2f} to {slope[1]:.2f}°" if slope else "none",
            "acceleration": "none" if limit is None else f"up to {limit:.2f} m/s²",
            "clearance": f"{math.degrees(self.clearance.rotation_margin.margin):.2f}°",
        }
        return facts | ({"warnings": "; ".join(self.warnings)} if self.warnings else {})

    def plot(self, figure: str | None = None, **options: Any) -> Any:
        """Draw one figure of the analysis.

        Args:
            figure: its name; None: the operating region (the paper's Figure 5). The others are
                ``stability-geometry``, ``friction-cones``, ``meeting-points``, ``permitted-com``
                and ``tactile-zones`` (Figures 2, 3, 4, 6 and 7).
            options: ``p_m``, the contacts of the state that Figures 2 to 4 draw.

        Returns:
            The `matplotlib.figure.Figure`.

        Raises:
            PalmbotsError: the analysis has no figure of that name.
        """
        return super().plot(figure, **options)

    def summary(self) -> dict[str, Any]:
        """The object that ``palmbots analyze --json`` prints."""
        properties: dict[str, Any] = {}
        for (number, shallow), report in self.properties.items():
            entry = {k: v for k, v in asdict(report).items() if k not in ("number", "shallow")}
            properties.setdefault(str(number), {})[shallow] = entry
        bands: dict[str, Any] = {}
        for (number, shallow), band in self.bands.items():
            bands.setdefault(str(number), {})[shallow] = asdict(band)
        return {
            "holds": self.holds,
            "properties": properties,
            "bands": bands,
            "com_x_m": self.com_x_m,
            "com_y_m": self.com_y_m,
            "friction": self.friction,
            "half_length_m": self.half_length_m,
            "max_slope_deg": self.max_slope_deg,
            "max_acceleration_m_s2": self.max_acceleration_m_s2,
            "slope_deg": None
            if self.slope is None
            else [math.degrees(math.atan(s)) for s in self.slope],
            "angle_error_deg": None
            if self.angle_error_rad is None
            else math.degrees(self.angle_error_rad),
            "clearance_deg": math.degrees(self.clearance.rotation_margin.margin),
            "clearance": asdict(self.clearance) | {"touches": self.clearance.touches},
            "touch": None if self.touch is None else self.touch.summary(),
            "wedging": asdict(self.wedging),
            "sideways": asdict(self.sideways),
            "warnings": list(self.warnings),
            "region_m": {
                side: list(ends) for side, ends in zip(SIDES, self.problem.contacts, strict=True)
            },
            "scene": self.scene.model_dump(),
        }


def analyze(
    scene: SceneLike = "paper", *, region_m: Interval | None = None, overrides: Overrides = None
) -> Analysis:
    """Evaluate whether, where and by how much the properties hold for a scene.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        region_m: contact coordinates (low, high) for which the properties have to hold, on either
            palm; None: the whole palm, as in the paper.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: the region is not on the palms, or the object cannot span it.
    """
    chosen = load_scene(scene, overrides)
    problem = stability_problem(chosen, region_m)
    clearance = outline_clearance(problem)
    slope, angle = slope_range(problem), angle_error(problem)
    properties: dict[tuple[int, Side], PropertyReport] = {
        (number, shallow): _report(problem, number, shallow)
        for number in (1, 2, 0)
        for shallow in SIDES
    }
    return Analysis(
        scene=chosen,
        problem=problem,
        properties=properties,
        bands={
            (number, shallow): _bands(problem, number, shallow)
            for number in (1, 2)
            for shallow in SIDES
        },
        com_x_m=com_x_range(problem),
        com_y_m=com_y_ranges(problem),
        friction=friction_ranges(problem),
        half_length_m=half_length_range(problem),
        slope=slope,
        angle_error_rad=angle,
        clearance=clearance,
        touch=first_touch(chosen, clearance.rotation_margin),
        wedging=wedging(problem),
        sideways=sideways_of(chosen),
        warnings=limit_warnings(chosen, problem, slope, angle),
    )


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
        com_x_m=(low, high) if low <= high else None,
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
