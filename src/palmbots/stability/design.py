"""Which palm angles to use: the pair that tolerates most.

Every pair of a grid is looked at (exactly, in the core), so the answer is the best of the grid and
not a local one. A pair counts if both properties hold with either palm as the shallow one, the
object is held while a palm turns (property 0), the outline clears the palms, and the angles differ
enough. The contacts it has to hold for are those that the scene's own zones, speeds, latencies and
tilt times imply at those angles (`region.py`), or given ones. Source: MECHANICS sections 3 and 5;
paper, section 5.1 ("shallow enough that our system would have enough time to react").
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from palmbots.errors import PalmbotsError, show, two_numbers
from palmbots.scene import Scene, load_scene
from palmbots.stability.box import box_of
from palmbots.stability.certificate import Certificate, prove
from palmbots.stability.limits import friction_ranges
from palmbots.stability.ranges import around
from palmbots.stability.region import reaction
from palmbots.stability.situation import Pair, Situation, situation_of

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["PAPER_DEG", "QUANTITIES", "Design", "Quantity", "design", "with_angles"]

Quantity = Literal["com", "friction", "slope", "acceleration", "region", "angle"]

QUANTITIES: dict[Quantity, tuple[int, float, str, float, str]] = {
    # number in the core, most, unit, scale and name for people
    "com": (0, math.inf, "m", 1e3, "COM along the object [± mm]"),
    "friction": (1, 2.0, "", 1.0, "friction [±]"),
    "slope": (2, 1.0, "tangent", 1.0, "slope [± tangent]"),
    "acceleration": (2, 1.0, "g", 1.0, "acceleration [± g]"),
    "region": (3, math.inf, "m", 1e3, "contact coordinate [± mm]"),
    "angle": (4, math.radians(30), "rad", 180 / math.pi, "palm angle [± °]"),
}

PAPER_DEG = (5.0, 15.0)


@dataclass(frozen=True)
class Design:
    """The best pair of angles and what it is worth."""

    scene: Scene
    """As given; its own angles play no part."""
    quantity: Quantity
    shallow_deg: float
    steep_deg: float
    tolerance: float
    """Of the quantity, to either side, in its unit (`QUANTITIES`)."""
    clearance_deg: float
    """How far object or palm may still turn until an edge lies on a palm."""
    friction: Pair | None
    """Coefficients, alike on both palms, for which the properties hold at these angles."""
    friction_floor: float | None
    reaction_s: dict[str, float]
    """From leaving the zero zone to moving: own (d) and asked (a)."""
    region_m: Pair
    """The contacts for which everything holds."""
    paper_tolerance: float | None
    """The tolerance of 5° and 15° under the same conditions; None: they do not qualify."""
    certificate: Certificate
    map: "xr.Dataset"
    """Tolerance and clearance over all pairs of angles."""

    def summary(self) -> dict[str, Any]:
        """What ``palmbots design --json`` prints."""
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


def design(
    scene: Any = "paper",
    *,
    overrides: Any = None,
    maximize: str = "com",
    friction: Pair | None = None,
    common: bool = True,
    com_y_m: Pair | None = None,
    slope: Pair | None = None,
    region_m: Pair | Literal["implied", "palm"] = "implied",
    least_difference_deg: float = 5.0,
    least_clearance_deg: float = 0.25,
    angles_deg: Pair = (-5.0, 50.0),
    resolution_deg: float | None = None,
) -> Design:
    """The palm angles, alike for both palms, that tolerate most.

    Args:
        scene: as in `palmbots.carry`.
        overrides: scene keys to set.
        maximize: whose error to tolerate, of `QUANTITIES`.
        friction: interval of the coefficient; None: the scene's.
        common: both palms have the same coefficient, whichever it is; False: each its own.
        com_y_m: interval of the COM's height; None: the scene's.
        slope: interval of the floor's tangent; None: the scene's.
        region_m: contacts for which all has to hold: what the scene implies at each pair of angles,
            the whole palm, or (low, high).
        least_difference_deg: of the two angles.
        least_clearance_deg: of the outline from the palms.
        angles_deg: limits of both angles.
        resolution_deg: of the grid; None: 0.1 for the COM, 0.5 for what needs more work.

    Raises:
        SceneError: the scene cannot be read or makes no sense.
        PalmbotsError: an argument is not allowed, or no pair of angles qualifies.
    """
    chosen = load_scene(scene, overrides)
    if maximize not in QUANTITIES:
        raise PalmbotsError(
            f"maximize: {show(maximize)} is not known; allowed: {', '.join(QUANTITIES)}"
        )
    quantity: Quantity = maximize
    step = resolution_deg if resolution_deg is not None else (0.1 if quantity == "com" else 0.5)
    low, high = two_numbers("angles_deg", angles_deg)
    if not (math.isfinite(step) and 0.01 <= step <= 10):
        raise PalmbotsError(f"resolution_deg: value is {show(step)}; allowed: 0.01 to 10 degrees")
    if not -45 <= low < high <= 75:
        raise PalmbotsError(
            f"angles_deg: value is {show([low, high])}; allowed: two numbers, the lower one first, "
            "from -45 to 75"
        )
    if not 0 < least_difference_deg <= high - low:
        raise PalmbotsError(
            f"least_difference_deg: value is {show(least_difference_deg)}; allowed: more than 0, "
            f"up to {high - low:g}"
        )
    if not 0 <= least_clearance_deg <= 90:
        raise PalmbotsError(
            f"least_clearance_deg: value is {show(least_clearance_deg)}; allowed: 0 to 90"
        )
    for name, ends in (("friction", friction), ("com_y_m", com_y_m), ("slope", slope)):
        if ends is not None:
            least, most = two_numbers(name, ends)
            if not -10 <= least <= most <= 100:
                raise PalmbotsError(
                    f"{name}: value is {show([least, most])}; allowed: two numbers, the lower one "
                    "first"
                )
    at = _at(chosen, region_m)
    if friction is not None and friction[0] < 0:
        raise PalmbotsError(f"friction: value is {show(list(friction))}; allowed: 0 or more")
    frictions = (friction, friction) if friction else tuple((mu, mu) for mu in at.friction)
    if common and frictions[0] != frictions[1]:
        raise PalmbotsError(
            "friction: the scene's palms differ; allowed: an interval for both (friction), or each "
            "its own (common=False; --each)"
        )

    steps = np.arange(math.ceil(low / step), math.floor(high / step) + 1)
    degrees = np.round(steps * step, 6).astype(np.float64)
    radians = np.radians(degrees)
    implied = region_m == "implied"
    grids = np.meshgrid(radians, radians, indexing="ij")
    seen = reaction(chosen, *grids)
    reach = np.minimum(seen.reach_m, min(at.half_length)) if implied else np.empty((0, 0))
    if implied:
        at = at.with_(beyond=seen.beyond_m)
    envelope = at.envelope(
        com_y=com_y_m, friction=(frictions[0], frictions[1]), common=common, slope=slope
    )
    number, most, *_ = QUANTITIES[quantity]
    if quantity == "region":
        most = min(at.half_length)
    tolerance, clearance = envelope.map(
        radians,
        radians,
        (at.com[0], at.com[0]),
        number,
        min(most, 10.0),
        np.ascontiguousarray(reach),
    )
    clearance = np.degrees(clearance)
    difference = degrees[np.newaxis, :] - degrees[:, np.newaxis]
    allowed = (
        (tolerance > 0)
        & (clearance >= least_clearance_deg)
        & (difference >= least_difference_deg - 1e-9)
    )
    if not allowed.any():
        raise PalmbotsError(
            "no pair of angles qualifies: "
            + _why_none(tolerance, clearance, difference, least_clearance_deg, least_difference_deg)
        )
    # Of equals the one that turns least: it reacts soonest.
    best = np.where(allowed, tolerance, -np.inf)
    ties = np.argwhere(best >= best.max() * (1 - 1e-9))
    row, column = min(ties, key=lambda rc: (difference[rc[0], rc[1]], degrees[rc[0]]))
    shallow, steep = float(degrees[row]), float(degrees[column])

    region = (-float(reach[row, column]), float(reach[row, column])) if implied else at.contacts[0]
    pair = (math.radians(shallow), math.radians(steep))
    answer = at.with_(
        angles=(pair, pair), contacts=at.contacts if not implied else (region, region)
    )
    floor = _friction_interval(answer, frictions)
    value = float(tolerance[row, column])
    certificate = _certificate(
        chosen, answer, quantity, value, (shallow, steep), frictions, common, com_y_m, slope
    )
    times = reaction(chosen, *pair)
    return Design(
        scene=chosen,
        quantity=quantity,
        shallow_deg=shallow,
        steep_deg=steep,
        tolerance=value,
        clearance_deg=float(clearance[row, column]),
        friction=floor,
        friction_floor=floor[0] if floor else None,
        reaction_s={"own": float(times.own_s), "asked": float(times.asked_s)},
        region_m=answer.contacts[0],
        paper_tolerance=_at_paper(degrees, tolerance, clearance),
        certificate=certificate,
        map=_dataset(degrees, tolerance, clearance, allowed, quantity),
    )


def _at(scene: Scene, region_m: Any) -> Situation:
    if region_m in ("implied", "palm"):
        return situation_of(scene)
    if not isinstance(region_m, tuple | list) or len(region_m) != 2:
        raise PalmbotsError(
            f"region_m: value is {show(region_m)}; allowed: implied, palm, or two numbers in m"
        )
    return situation_of(scene, (float(region_m[0]), float(region_m[1])))


def _why_none(
    tolerance: NDArray[np.float64],
    clearance: NDArray[np.float64],
    difference: NDArray[np.float64],
    least_clearance: float,
    least_difference: float,
) -> str:
    holds = tolerance > 0
    if not holds.any():
        return "the properties hold at none (less uncertainty, a smaller region, more friction)"
    apart = holds & (difference >= least_difference - 1e-9)
    if not apart.any():
        most = float(difference[holds].max())
        return f"where they hold the angles differ by at most {most:g}° (least_difference_deg)"
    clear = float(np.nanmax(np.where(apart, clearance, -np.inf)))
    return (
        f"where they hold the clearance is at most {clear:.2f}°, not {least_clearance:g}° "
        "(least_clearance_deg, feet under the object, a smaller region)"
    )


def _friction_interval(at: Situation, frictions: tuple[Pair, ...]) -> Pair | None:
    middle = sum(end for pair in frictions for end in pair) / 4
    return around(friction_ranges(at.with_(friction=(middle, middle))), middle)


def _at_paper(
    degrees: NDArray[np.float64],
    tolerance: NDArray[np.float64],
    clearance: NDArray[np.float64],
) -> float | None:
    places = [np.flatnonzero(np.abs(degrees - angle) < 1e-9) for angle in PAPER_DEG]
    if any(len(p) == 0 for p in places):
        return None
    row, column = (int(p[0]) for p in places)
    value = float(tolerance[row, column])
    return value if value >= 0 and clearance[row, column] >= 0 else None


def _certificate(
    scene: Scene,
    at: Situation,
    quantity: Quantity,
    tolerance: float,
    angles_deg: Pair,
    frictions: tuple[Pair, ...],
    common: bool,
    com_y_m: Pair | None,
    slope: Pair | None,
) -> Certificate:
    """A proof for the tolerance found, less a millionth of it for the bisection."""
    by = math.floor(tolerance * (1 - 1e-6) * 1e9) / 1e9
    given: dict[str, Any] = {
        "com_y_m": com_y_m,
        "friction": frictions[0],
        "friction_right": frictions[1],
        "common": common,
        "shallow_deg": (angles_deg[0],) * 2,
        "steep_deg": (angles_deg[1],) * 2,
        "slope": slope,
        "region_m": None,
    }
    region = at.contacts[0]
    whole = region == (-at.half_length[0], at.half_length[0])
    if not whole:
        # Outward to the nanometre, but not beyond the palm: decimal text stands in a certificate.
        most = min(at.half_length)
        given["region_m"] = tuple(
            math.copysign(min(math.ceil(abs(end) * 1e9) / 1e9, most), end) for end in region
        )
    if quantity == "com":
        x = at.com[0]
        given["com_x_m"] = (round(x - by, 9), round(x + by, 9))
    elif quantity == "friction":
        pairs = [(max(round(a - by, 9), 0.0), round(b + by, 9)) for a, b in frictions]
        given["friction"], given["friction_right"] = pairs
    elif quantity in ("slope", "acceleration"):
        base = slope or (at.slope, at.slope)
        given["slope"] = (round(base[0] - by, 9), round(base[1] + by, 9))
    elif quantity == "region":
        given["region_m"] = (-by, by)
    else:
        error = math.floor(math.degrees(by) * 1e6) / 1e6
        for key, angle in zip(("shallow_deg", "steep_deg"), angles_deg, strict=True):
            given[key] = (round(angle - error, 6), round(angle + error, 6))
    return prove(box_of(_turned(scene, angles_deg), beyond_m=at.beyond, **given))


def _turned(scene: Scene, angles_deg: Pair) -> Scene:
    table = scene.model_dump()
    for palm in (table["palm"], table["palm"].get("left", {}), table["palm"].get("right", {})):
        palm.pop("shallow_deg", None)
        palm.pop("steep_deg", None)
    table["palm"] |= {"shallow_deg": angles_deg[0], "steep_deg": angles_deg[1]}
    return Scene.model_validate(table)


def _dataset(
    degrees: NDArray[np.float64],
    tolerance: NDArray[np.float64],
    clearance: NDArray[np.float64],
    allowed: NDArray[np.bool_],
    quantity: Quantity,
) -> "xr.Dataset":
    about = {"units": QUANTITIES[quantity][2], "long_name": f"tolerance of {quantity}"}
    dims = ("shallow", "steep")
    import xarray as xr  # here: it takes longer to import than a carry to run

    return xr.Dataset(
        {
            "tolerance": (dims, tolerance, about),
            "clearance": (dims, clearance, {"units": "degrees"}),
            "allowed": (dims, allowed),
        },
        coords={
            "shallow": ("shallow", degrees, {"units": "degrees"}),
            "steep": ("steep", degrees, {"units": "degrees"}),
        },
    )


def with_angles(scene: Scene, found: Design) -> Scene:
    """The scene with the designed angles on both palms."""
    return _turned(scene, (found.shallow_deg, found.steep_deg))
