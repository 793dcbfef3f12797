# SPDX-License-Identifier: Apache-2.0
"""The check's forms for clearance, one by one, on boxes where only one of them decides."""

from fractions import Fraction
from typing import Any

import pytest

from palmbots.stability.certificates.checker.clearance_conditions import (
    ObjectOutline,
    prove_clear,
    prove_touching,
)
from palmbots.stability.certificates.checker.property_conditions import (
    LEFT,
    CheckFailed,
    ObjectParams,
    ParameterBox,
)


def just(*values: str) -> Any:
    return tuple((Fraction(value), Fraction(value)) for value in values)


def between(low: str, high: str) -> tuple[Fraction, Fraction]:
    return Fraction(low), Fraction(high)


LEVEL = ObjectParams((), just("0")[0], just("0", "0"))
BOX = ("0 0", "0.25 0", "0.25 0.1", "0 0.1")
WALLED = ("0 0", "0.02 0.3", "0.23 0.3", "0.25 0", "0.25 0.4", "-0.1 0.4", "-0.1 -0.2")


def thing(points: tuple[str, ...], right: int, half: str = "0.075") -> ObjectOutline:
    found = [tuple(map(Fraction, point.split())) for point in points]
    outline = tuple((x, Fraction("0.25") - x, y) for x, y in found)
    return ObjectOutline(outline, right, just(half, half))


def part(angles: Any, contacts: Any) -> ParameterBox:
    return ParameterBox(angles, just("0", "0"), just("0.25")[0], contacts, False)


def walled(at: str) -> ObjectOutline:
    """A wall beside the left contact, outward."""
    return thing((*WALLED, f"{at} -0.2", f"{at} 0.35", "0 0.35"), 3)


def test_edge_at_the_contact_must_be_above_the_palm_at_all_corners() -> None:
    angles = just("5", "15")
    prove_clear(LEFT, part(angles, just("-0.05", "0.05")), LEVEL, thing(BOX, 1))
    with pytest.raises(CheckFailed, match="lie flat"):
        prove_clear(LEFT, part(angles, just("0.07", "-0.07")), LEVEL, thing(BOX, 1))
    # Turned from one to the other it is above the palm at some corners only.
    both = (between("-0.05", "0.07"), between("-0.07", "0.05"))
    with pytest.raises(CheckFailed, match="lie flat"):
        prove_clear(LEFT, part(angles, both), LEVEL, thing(BOX, 1))


def test_palm_reach_is_largest_level_with_the_object() -> None:
    """Turned to either side its back end is above or below, and not so far out."""
    swinging = part(just("0", "40"), (just("0")[0], between("-0.15", "0.15")))
    for at, touches_there in (("-0.074", True), ("-0.0751", False)):
        if touches_there:
            with pytest.raises(CheckFailed, match="may touch"):
                prove_clear(LEFT, swinging, LEVEL, walled(at))
        else:
            prove_clear(LEFT, swinging, LEVEL, walled(at))


def test_back_end_reach_is_largest_with_the_contact_farthest_inward() -> None:
    sliding = part(just("0", "5"), (between("-0.01", "0"), just("0")[0]))
    prove_clear(LEFT, sliding, LEVEL, walled("-0.0851"))
    with pytest.raises(CheckFailed, match="may touch"):
        prove_clear(LEFT, sliding, LEVEL, walled("-0.0849"))


def test_palm_is_not_touched_beyond_its_end() -> None:
    """With the contact at the palm's tip nothing of the palm is under the object."""
    low = part(just("-5", "5"), just("-0.07", "0"))
    prove_touching(LEFT, 0, low, LEVEL, thing(BOX, 1))
    for p in ("-0.075", "0.075"):
        end = part(just("-5", "5"), just(p, "0"))
        with pytest.raises(CheckFailed, match="not inside its palm"):
            prove_touching(LEFT, 0, end, LEVEL, thing(BOX, 1))


def test_angle_interval_around_level_has_the_reach_of_a_level_palm() -> None:
    """Neither end of its angles is level, but one between them is."""
    angles = (between("-30", "30"), just("0")[0])
    contacts = just("0", "0")
    with pytest.raises(CheckFailed, match="may touch"):
        prove_clear(LEFT, part(angles, contacts), LEVEL, walled("-0.074"))
    prove_clear(LEFT, part(angles, contacts), LEVEL, walled("-0.0751"))


@pytest.mark.parametrize("angles", [between("10", "40"), between("-40", "-10")])
def test_reach_is_that_of_the_flattest_angle(
    angles: tuple[Fraction, Fraction],
) -> None:
    """0.075 m · cos 10° = 0.0739 m."""
    turning = part((angles, just("0")[0]), just("0", "0"))
    with pytest.raises(CheckFailed, match="may touch"):
        prove_clear(LEFT, turning, LEVEL, walled("-0.0735"))
    prove_clear(LEFT, turning, LEVEL, walled("-0.0742"))
