"""The check's forms for clearance, one by one, on boxes where only one of them decides."""

from fractions import Fraction
from typing import Any

import pytest

from palmbots.exact_clearance import Thing, prove_clear, prove_touching
from palmbots.exact_forms import LEFT, Box, Given, Wrong


def just(*values: str) -> Any:
    return tuple((Fraction(value), Fraction(value)) for value in values)


def between(low: str, high: str) -> tuple[Fraction, Fraction]:
    return Fraction(low), Fraction(high)


LEVEL = Given((), just("0")[0], just("0", "0"))
BOX = ("0 0", "0.25 0", "0.25 0.1", "0 0.1")
WALLED = ("0 0", "0.02 0.3", "0.23 0.3", "0.25 0", "0.25 0.4", "-0.1 0.4", "-0.1 -0.2")


def thing(points: tuple[str, ...], right: int, half: str = "0.075") -> Thing:
    found = [tuple(map(Fraction, point.split())) for point in points]
    outline = tuple((x, Fraction("0.25") - x, y) for x, y in found)
    return Thing(outline, right, just(half, half))


def part(angles: Any, contacts: Any) -> Box:
    return Box(angles, just("0", "0"), just("0.25")[0], contacts, False)


def walled(at: str) -> Thing:
    """A wall beside the left contact, outward."""
    return thing((*WALLED, f"{at} -0.2", f"{at} 0.35", "0 0.35"), 3)


def test_an_edge_at_the_contact_has_to_be_above_the_palm_everywhere() -> None:
    angles = just("5", "15")
    prove_clear(LEFT, part(angles, just("-0.05", "0.05")), LEVEL, thing(BOX, 1))
    with pytest.raises(Wrong, match="lie flat"):
        prove_clear(LEFT, part(angles, just("0.07", "-0.07")), LEVEL, thing(BOX, 1))
    # Turned from one to the other it is above the palm at some corners only.
    both = (between("-0.05", "0.07"), between("-0.07", "0.05"))
    with pytest.raises(Wrong, match="lie flat"):
        prove_clear(LEFT, part(angles, both), LEVEL, thing(BOX, 1))


def test_a_palm_reaches_farthest_where_it_is_level_with_the_object() -> None:
    """Turned to either side its back end is above or below, and not so far out."""
    swinging = part(just("0", "40"), (just("0")[0], between("-0.15", "0.15")))
    for at, touches_there in (("-0.074", True), ("-0.0751", False)):
        if touches_there:
            with pytest.raises(Wrong, match="may touch"):
                prove_clear(LEFT, swinging, LEVEL, walled(at))
        else:
            prove_clear(LEFT, swinging, LEVEL, walled(at))


def test_a_palm_reaches_farthest_out_with_the_contact_farthest_in() -> None:
    sliding = part(just("0", "5"), (between("-0.01", "0"), just("0")[0]))
    prove_clear(LEFT, sliding, LEVEL, walled("-0.0851"))
    with pytest.raises(Wrong, match="may touch"):
        prove_clear(LEFT, sliding, LEVEL, walled("-0.0849"))


def test_no_palm_is_touched_beyond_its_end() -> None:
    """With the contact at the palm's tip nothing of the palm is under the object."""
    low = part(just("-5", "5"), just("-0.07", "0"))
    prove_touching(LEFT, 0, low, LEVEL, thing(BOX, 1))
    for p in ("-0.075", "0.075"):
        end = part(just("-5", "5"), just(p, "0"))
        with pytest.raises(Wrong, match="not inside its palm"):
            prove_touching(LEFT, 0, end, LEVEL, thing(BOX, 1))


def test_a_palm_that_may_be_level_reaches_out_as_far_as_a_level_one() -> None:
    """Neither end of its angles is level, but one between them is."""
    angles = (between("-30", "30"), just("0")[0])
    contacts = just("0", "0")
    with pytest.raises(Wrong, match="may touch"):
        prove_clear(LEFT, part(angles, contacts), LEVEL, walled("-0.074"))
    prove_clear(LEFT, part(angles, contacts), LEVEL, walled("-0.0751"))


@pytest.mark.parametrize("angles", [between("10", "40"), between("-40", "-10")])
def test_the_flattest_of_its_angles_reaches_out_farthest(
    angles: tuple[Fraction, Fraction],
) -> None:
    """0.075 m · cos 10° = 0.0739 m."""
    turning = part((angles, just("0")[0]), just("0", "0"))
    with pytest.raises(Wrong, match="may touch"):
        prove_clear(LEFT, turning, LEVEL, walled("-0.0735"))
    prove_clear(LEFT, turning, LEVEL, walled("-0.0742"))
