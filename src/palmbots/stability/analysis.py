"""The paper's analysis of any scene: do the properties hold, by how much, and what breaks them?

Properties 1 and 2 (paper, section 2) let the algorithms steer the contacts; property 0, that the
object is held at all while a palm turns, is taken for granted there. Each is asked for with
either palm as the shallow one and for all contacts of a region, the whole palms by default.
Source: paper, sections 3.2 to 3.4; MECHANICS sections 2 to 5.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

from palmbots.scene import Scene, load_scene
from palmbots.sections import SIDES, Side
from palmbots.stability.clearance import Clearance, clearance
from palmbots.stability.forms import failing, text_of
from palmbots.stability.limits import (
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
from palmbots.stability.ranges import Interval
from palmbots.stability.sideways import Sideways, sideways_of
from palmbots.stability.situation import Pair, Situation, permitted, situation_of
from palmbots.stability.touch import FirstTouch, first_touch

__all__ = ["Analysis", "Bands", "G", "Margins", "PropertyReport", "Wedging", "analyze"]

G = 9.80665
"""Standard gravity [m/s²]."""


@dataclass(frozen=True)
class Margins:
    """How far a property is from failing; None: nothing binds, or it fails already."""

    travel_m: float | None
    """How much farther out every contact may be, on both palms; negative: must be less far."""
    angle_rad: float | None
    """By how much both palm angles may be wrong, each its own way."""
    friction: float | None
    """By how much both coefficients may be wrong, each its own way."""
    com_m: float | None
    """How far the COM may lie to either side; negative: by how much it is beyond."""


@dataclass(frozen=True)
class PropertyReport:
    """One property with one palm as the shallow one (property 0: as the one that turns)."""

    number: int
    shallow: Side
    holds: bool
    margins: Margins
    binding: str
    """In words, what happens first where the property fails; empty: nothing binds."""
    binding_p_m: Pair
    """The contacts (left, right) at which that is nearest: E or F of the paper's Figure 5."""
    com_x_m: Pair | None
    """The COMs along the object for which the property holds; None: none."""


@dataclass(frozen=True)
class Bands:
    """The stable band in the plane of contacts: k_lower ≤ z ≤ k_upper; None: does not bind."""

    k_lower: float | None
    k_upper: float | None
    lower_by: str
    upper_by: str


@dataclass(frozen=True)
class Analysis:
    """What `analyze` found. Ranges hold each quantity against the others at the scene's values."""

    scene: Scene
    situation: Situation
    properties: dict[tuple[int, Side], PropertyReport]
    bands: dict[tuple[int, Side], Bands]
    com_x_m: Interval | None
    """From the left contact vertex along the line of contacts; both properties, both palms."""
    com_y_m: tuple[Interval, ...]
    friction: tuple[Interval, ...]
    """Alike on both palms."""
    half_length_m: Interval | None
    """Of both palms, measured from p = 0."""
    slope: Interval | None
    """Tangents of the floor's slope, uphill in travel positive."""
    angle_error_rad: float | None
    clearance: Clearance
    """How far the outline stays from both palms, and where that is least."""
    touch: FirstTouch | None
    """What happens where a palm, turned on from there (or back), just touches the outline."""
    wedging: Wedging
    sideways: Sideways

    @property
    def holds(self) -> bool:
        """Whether all properties hold with either palm as the shallow one."""
        return all(report.holds for report in self.properties.values())

    @property
    def max_slope_deg(self) -> float | None:
        """The steepest floor, up or down, on which both properties hold."""
        return None if self.slope is None else math.degrees(math.atan(_smaller(self.slope, 0.0)))

    @property
    def max_acceleration_m_s2(self) -> float | None:
        """The largest acceleration, either way, at which both properties hold."""
        if self.slope is None:
            return None
        here = self.situation.slope * self.situation.spec.direction
        return G * _smaller(self.slope, here)

    def summary(self) -> dict[str, Any]:
        """What ``palmbots analyze --json`` prints."""
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
            "clearance_deg": math.degrees(self.clearance.turn.margin),
            "clearance": asdict(self.clearance) | {"touches": self.clearance.touches},
            "touch": None if self.touch is None else self.touch.summary(),
            "wedging": asdict(self.wedging),
            "sideways": asdict(self.sideways),
            "region_m": {
                side: list(ends) for side, ends in zip(SIDES, self.situation.contacts, strict=True)
            },
            "scene": self.scene.model_dump(),
        }


def _smaller(interval: Interval, here: float) -> float:
    return min(here - interval[0], interval[1] - here)


def analyze(
    scene: Any = "paper", *, overrides: Any = None, region_m: Pair | None = None
) -> Analysis:
    """Whether, where and by how much the properties hold for a scene.

    Args:
        scene: as in `palmbots.carry`.
        overrides: scene keys to set.
        region_m: contact coordinates (low, high) for which the properties have to hold, on either
            palm; None: the whole palm, as in the paper.

    Raises:
        SceneError: the scene cannot be read or makes no sense.
        PalmbotsError: the region is not on the palms, or the object cannot reach across it.
    """
    chosen = load_scene(scene, overrides)
    at = situation_of(chosen, region_m)
    clear = clearance(at)
    properties: dict[tuple[int, Side], PropertyReport] = {
        (number, shallow): _report(at, number, shallow) for number in (1, 2, 0) for shallow in SIDES
    }
    return Analysis(
        scene=chosen,
        situation=at,
        properties=properties,
        bands={
            (number, shallow): _bands(at, number, shallow) for number in (1, 2) for shallow in SIDES
        },
        com_x_m=com_x_range(at),
        com_y_m=com_y_ranges(at),
        friction=friction_ranges(at),
        half_length_m=half_length_range(at),
        slope=slope_range(at),
        angle_error_rad=angle_error(at),
        clearance=clear,
        touch=first_touch(chosen, clear.turn),
        wedging=wedging(at),
        sideways=sideways_of(chosen),
    )


def _report(at: Situation, number: int, shallow: Side) -> PropertyReport:
    low, high = permitted(at.envelope(), number, shallow, at.angles)
    x = at.com[0]
    holds = low <= x <= high
    travel, nearest = _travel(at, number, shallow)
    return PropertyReport(
        number=number,
        shallow=shallow,
        holds=holds,
        margins=Margins(
            travel_m=travel,
            angle_rad=angle_margin(at, number, shallow) if holds else None,
            friction=friction_margin(at, number, shallow) if holds else None,
            com_m=min(x - low, high - x) if low <= high else None,
        ),
        binding=text_of(number, nearest[0]) if nearest else "",
        binding_p_m=nearest[1] if nearest else (0.0, 0.0),
        com_x_m=(low, high) if low <= high else None,
    )


def _travel(
    at: Situation, number: int, shallow: Side
) -> tuple[float | None, tuple[str, Pair] | None]:
    """How much larger the region may be, and the condition that then binds first, with where."""
    least, nearest = math.inf, None
    for pose in at.poses(number, shallow):
        spread = sum(abs(math.sin(a)) for a in pose.angles)
        for form in at.forms(number, shallow, pose.angles):
            bad = failing(form, at.width)
            if bad is None:
                continue
            # Distance from the region to where it fails, above or below it.
            below, above = pose.rise[0] - bad[1], bad[0] - pose.rise[1]
            room = max(below, above) / max(spread, 1e-12)
            if room < least:
                least = room
                nearest = (form.name, _corner(at, number, shallow, pose.angles, above >= below))
    return (None, None) if nearest is None else (least, nearest)


def _corner(at: Situation, number: int, shallow: Side, angles: Pair, highest: bool) -> Pair:
    """The contacts of the region at which z is extreme: E (highest) or F (lowest)."""
    ends = at.region(number, shallow)
    rising = [math.sin(a) >= 0 for a in angles]
    left = ends[0][0] if rising[0] == highest else ends[0][1]
    right = ends[1][1] if rising[1] == highest else ends[1][0]
    return left, right


def _bands(at: Situation, number: int, shallow: Side) -> Bands:
    angles = at.palms(shallow)
    lower: tuple[float, str] | None = None
    upper: tuple[float, str] | None = None
    middle = 0.5 * sum(at.rise(number, shallow, angles))
    for form in at.forms(number, shallow, angles):
        bad = failing(form, at.width)
        if bad is None or form.name.startswith("lift"):
            continue
        from_below = bad[0] <= -at.width or (bad[1] < at.width and bad[1] <= middle)
        if from_below and (lower is None or bad[1] > lower[0]):
            lower = (bad[1], form.name)
        if not from_below and (upper is None or bad[0] < upper[0]):
            upper = (bad[0], form.name)
    return Bands(
        k_lower=lower[0] if lower else None,
        k_upper=upper[0] if upper else None,
        lower_by=text_of(number, lower[1]) if lower else "",
        upper_by=text_of(number, upper[1]) if upper else "",
    )
