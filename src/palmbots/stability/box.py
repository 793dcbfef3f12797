"""The box of uncertainty that a certificate speaks of, as exact decimal numbers.

Everything is kept as `Fraction`, taken from the decimal text of what was given: a certificate
states 0.3, not the binary number next to it. Angles are in degrees here, as in the scene, since a
whole number of degrees has no exact value in radians.
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from palmbots.errors import PalmbotsError, show
from palmbots.frame import object_frame
from palmbots.scene import Scene
from palmbots.sections import SIDES

__all__ = ["Box", "Ends", "box_of", "exact", "text"]

Ends = tuple[Fraction, Fraction]


def exact(value: Any) -> Fraction:
    """The decimal number that a float prints as."""
    return value if isinstance(value, Fraction) else Fraction(repr(float(value)))


def text(value: Fraction) -> str:
    """A fraction as decimal text where that is exact and short, as a quotient otherwise."""
    denominator = value.denominator
    for prime in (2, 5):
        while denominator % prime == 0:
            denominator //= prime
    if denominator != 1:
        return str(value)
    digits = 0
    while value.denominator != 1 and digits <= 30:
        digits += 1
        if (value * 10**digits).denominator == 1:
            break
    whole = abs(int(value * 10**digits))
    sign = "-" if value < 0 else ""
    if not digits:
        return f"{sign}{whole}"
    padded = str(whole).rjust(digits + 1, "0")
    return f"{sign}{padded[:-digits]}.{padded[-digits:]}"


@dataclass(frozen=True)
class Box:
    """What may vary, each within its ends; pairs and lists per side are (left, right)."""

    com: tuple[tuple[Fraction, Fraction], ...]
    """Corners of the polygon in which the COM lies [m], in the object frame."""
    width: Ends
    friction: tuple[Ends, Ends]
    common: bool
    """Both palms have the same coefficient, whichever it is."""
    shallow_deg: tuple[Ends, Ends]
    steep_deg: tuple[Ends, Ends]
    contacts: tuple[Ends, Ends]
    beyond: Fraction
    half_length: tuple[Ends, Ends]
    offset: tuple[Ends, Ends]
    slope: Ends
    """s, towards -x on the object."""
    outline: tuple[tuple[Fraction, Fraction, Fraction], ...]
    """All vertices (from left, from right, height), counter-clockwise, the left contact first. Each
    palm sees them from its own contact, however wide the object is; the other contact is at w."""
    right_contact: int
    """Which of them is the right contact."""

    def seen(self, side: int, w: Fraction) -> list[tuple[Fraction, Fraction]]:
        """The outline from one contact, the origin: (along the line of contacts, height)."""
        found = [(vertex[side], vertex[2]) for vertex in self.outline]
        found[self.right_contact if side == 0 else 0] = (w, Fraction(0))
        return found

    def as_dict(self) -> dict[str, Any]:
        """The box as it stands in a certificate."""

        def ends(pair: Ends) -> list[str]:
            return [text(end) for end in pair]

        def sides(pair: tuple[Ends, Ends]) -> dict[str, list[str]]:
            return {side: ends(one) for side, one in zip(SIDES, pair, strict=True)}

        return {
            "com_m": [[text(x), text(y)] for x, y in self.com],
            "width_m": ends(self.width),
            "friction": sides(self.friction) | {"common": self.common},
            "shallow_deg": sides(self.shallow_deg),
            "steep_deg": sides(self.steep_deg),
            "contacts_m": sides(self.contacts),
            "beyond_m": text(self.beyond),
            "half_length_m": sides(self.half_length),
            "offset_m": sides(self.offset),
            "slope": ends(self.slope),
            "outline_m": [[text(v) for v in vertex] for vertex in self.outline],
            "right_contact": self.right_contact,
        }


def _ends(name: str, given: Any, usual: Any, least: float, most: float) -> Ends:
    if given is None:
        return exact(usual), exact(usual)
    try:
        low, high = given
        fits = least <= low <= high <= most
    except (TypeError, ValueError):  # one number, three, or none at all
        raise PalmbotsError(
            f"{name}: value is {show(given)}; allowed: two numbers, the lower one first, from "
            f"{least:g} to {most:g}"
        ) from None
    if not fits:
        raise PalmbotsError(
            f"{name}: value is {show([low, high])}; allowed: two numbers, the lower one first, "
            f"from {least:g} to {most:g}"
        )
    return exact(low), exact(high)


def box_of(
    scene: Scene,
    *,
    com_x_m: Any = None,
    com_y_m: Any = None,
    com_polygon_m: Any = None,
    friction: Any = None,
    friction_right: Any = None,
    common: bool = False,
    shallow_deg: Any = None,
    steep_deg: Any = None,
    width_m: Any = None,
    length_m: Any = None,
    offset_m: Any = None,
    slope: Any = None,
    region_m: Any = None,
    beyond_m: float = 0.0,
) -> Box:
    """A scene with the uncertainty given; what is not given is as in the scene, exactly.

    Raises:
        PalmbotsError: an interval is upside down or beyond what a scene allows.
    """
    thing = scene.object
    frame = object_frame(thing.vertices_m, thing.contacts, thing.com_m)
    palms = tuple(scene.palm_of(side) for side in SIDES)
    w = frame.width
    if com_polygon_m is not None:
        if com_x_m is not None or com_y_m is not None or len(com_polygon_m) < 1:
            raise PalmbotsError(
                "com_polygon_m: allowed: one point [x, y] or more, and then neither com_x_m nor "
                "com_y_m"
            )
        com = tuple((exact(x), exact(y)) for x, y in com_polygon_m)
    else:
        xs = _ends("com_x_m", com_x_m, frame.com.from_left, -10, 10)
        ys = _ends("com_y_m", com_y_m, frame.com.height, -10, 10)
        com = tuple(dict.fromkeys((x, y) for x in xs for y in ys))
    right_given = friction if friction_right is None else friction_right
    frictions = (
        _ends("friction", friction, palms[0].friction, 0, 100),
        _ends("friction_right", right_given, palms[1].friction, 0, 100),
    )
    if common and frictions[0] != frictions[1]:
        raise PalmbotsError(
            "friction: with a common coefficient both palms have the same interval; allowed: one "
            "interval for both, or no common coefficient"
        )

    def angle(name: str, given: Any) -> tuple[Ends, Ends]:
        left, right = (_ends(name, given, getattr(palm, name), -79, 79) for palm in palms)
        return left, right

    shallow, steep = angle("shallow_deg", shallow_deg), angle("steep_deg", steep_deg)
    for low, high in zip(shallow, steep, strict=True):
        if not low[1] < high[0]:
            raise PalmbotsError(
                f"shallow_deg: value is {show([float(low[0]), float(low[1])])}; allowed: all of it "
                f"below steep_deg, {float(high[0]):g}"
            )
    spans: list[Ends] = []
    halves: list[Ends] = []
    for palm in palms:
        shortest, longest = _ends("length_m", length_m, palm.length_m, 0.001, 10)
        halves.append((shortest / 2, longest / 2))
        low, high = -longest / 2, longest / 2
        if region_m is not None:
            low, high = _ends("region_m", region_m, None, float(low), float(high))
            if not low <= 0 <= high:
                raise PalmbotsError(
                    f"region_m: value is {show(list(region_m))}; allowed: an interval around 0"
                )
        spans.append((low, high))
    at_slope = 0.0
    if scene.task.slope_deg:
        from palmbots.lowering import lower

        at_slope = lower(scene).slope
    offset = tuple(_ends("offset_m", offset_m, palm.pivot_offset_m, -1, 1) for palm in palms)
    return Box(
        com=com,
        width=_ends("width_m", width_m, w, 0.001, 10),
        friction=frictions,
        common=common,
        shallow_deg=shallow,
        steep_deg=steep,
        contacts=(spans[0], spans[1]),
        beyond=exact(beyond_m),
        half_length=(halves[0], halves[1]),
        offset=(offset[0], offset[1]),
        slope=_ends("slope", slope, at_slope, -1, 1),
        outline=tuple(
            (exact(c.from_left), exact(c.from_right), exact(c.height)) for c in frame.outline
        ),
        right_contact=frame.contact_right,
    )
