# SPDX-License-Identifier: Apache-2.0
"""The box of a certificate: read, and refused where its values contradict each other."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from palmbots.stability.certificates.checker.certificate_file import interval, number, per_side
from palmbots.stability.certificates.checker.clearance_conditions import ObjectOutline
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.outline_validity import require_valid_outline
from palmbots.stability.certificates.checker.property_conditions import CheckFailed, ObjectParams

__all__ = ["ClaimedBox", "read_box"]

_STEEPEST_DEG = 80


@dataclass(frozen=True)
class ClaimedBox:
    """Every uncertain quantity with its ends; pairs are (left, right)."""

    params: ObjectParams
    """COM, slope and pivot offsets."""
    outline: ObjectOutline
    """Outline and palm half-lengths."""
    friction: tuple[Ends, Ends]
    common_friction: bool
    width: Ends
    shallow_deg: tuple[Ends, Ends]
    steep_deg: tuple[Ends, Ends]
    contacts: tuple[Ends, Ends]
    beyond: Fraction


def read_box(table: dict[str, Any]) -> ClaimedBox:
    """The box of a certificate.

    Raises:
        CheckFailed: a value is out of range or contradicts another one.
    """
    com = tuple((number(x), number(y)) for x, y in table["com_m"])
    if not com:
        raise CheckFailed("there is no COM")
    width = interval(table["width_m"])
    friction, common = per_side(table, "friction"), table["friction"]["common"]
    if common is not True and common is not False:
        raise CheckFailed("friction.common is neither true nor false")
    if common and friction[0] != friction[1]:
        raise CheckFailed("a common friction has two intervals")
    if friction[0][0] < 0 or friction[1][0] < 0 or width[0] <= 0:
        raise CheckFailed("friction or width is negative")
    box = ClaimedBox(
        params=ObjectParams(com, interval(table["slope"]), per_side(table, "offset_m")),
        outline=_outline(table),
        friction=friction,
        common_friction=common,
        width=width,
        shallow_deg=per_side(table, "shallow_deg"),
        steep_deg=per_side(table, "steep_deg"),
        contacts=per_side(table, "contacts_m"),
        beyond=number(table["beyond_m"]),
    )
    _require_palms(box)
    require_valid_outline(box.outline, width)
    return box


def _outline(table: dict[str, Any]) -> ObjectOutline:
    vertices = tuple(
        (number(left), number(right), number(height)) for left, right, height in table["outline_m"]
    )
    contact = table["right_contact"]
    if type(contact) is not int or not 0 < contact < len(vertices):
        raise CheckFailed("the outline has no right contact vertex")
    return ObjectOutline(vertices, contact, per_side(table, "half_length_m"))


def _require_palms(box: ClaimedBox) -> None:
    """Angles, lengths and contacts of the palms must be consistent."""
    if any(abs(end) >= _STEEPEST_DEG for a in (*box.shallow_deg, *box.steep_deg) for end in a):
        raise CheckFailed(f"a palm angle is not between −{_STEEPEST_DEG}° and {_STEEPEST_DEG}°")
    for shallow, steep in zip(box.shallow_deg, box.steep_deg, strict=True):
        if not shallow[1] < steep[0]:
            raise CheckFailed("a shallow angle is not below the steep one")
    if box.beyond < 0:
        raise CheckFailed("beyond_m is negative: a correction would end before p = 0")
    for (low, high), (shortest, longest) in zip(box.contacts, box.outline.half_length, strict=True):
        if shortest <= 0:
            raise CheckFailed("a palm has no length")
        if not low <= 0 <= high:
            raise CheckFailed("the region of contacts does not contain p = 0")
        if max(-low, high) > longest:
            raise CheckFailed(
                f"contacts_m reaches {float(max(-low, high)):g} m from the middle of a palm, "
                f"beyond its half_length_m, {float(longest):g} m"
            )
