# SPDX-License-Identifier: Apache-2.0
"""The box of a certificate: read, and refused where its values contradict each other."""

from dataclasses import dataclass
from fractions import Fraction

from palmbots.stability.certificates.checker.certificate_file import Entry
from palmbots.stability.certificates.checker.clearance_conditions import ObjectOutline
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.outline_validity import require_valid_outline
from palmbots.stability.certificates.checker.property_conditions import CheckFailed, ObjectParams
from palmbots.stability.certificates.checker.touching_points import ContactArcs

_STEEPEST_DEG = 80
_MOST_COMS = 100


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
    arcs: ContactArcs | None = None
    """The arcs that round the contact vertices in the certificate's scene; None: both are sharp."""


def read_box(entry: Entry) -> ClaimedBox:
    """The box of a certificate.

    Raises:
        CheckFailed: a value is missing, out of range or contradicts another one.
    """
    points = [point.items(2) for point in entry["com_m"].items()]
    if not 1 <= len(points) <= _MOST_COMS:
        raise CheckFailed(f"box.com_m: {len(points)} points are given; allowed: 1 to {_MOST_COMS}")
    com = tuple((x.number(), y.number()) for x, y in points)
    width = entry["width_m"].interval()
    friction, common = entry["friction"].sides(), entry["friction"]["common"]
    if not isinstance(common.value, bool):
        raise common.fault("true, false")
    if common.value and friction[0] != friction[1]:
        raise CheckFailed("a common friction has two intervals")
    if friction[0][0] < 0 or friction[1][0] < 0 or width[0] <= 0:
        raise CheckFailed("friction or width is negative")
    box = ClaimedBox(
        params=ObjectParams(com, entry["slope"].interval(), entry["offset_m"].sides()),
        outline=_outline(entry),
        friction=friction,
        common_friction=common.value,
        width=width,
        shallow_deg=entry["shallow_deg"].sides(),
        steep_deg=entry["steep_deg"].sides(),
        contacts=entry["contacts_m"].sides(),
        beyond=entry["beyond_m"].number(),
    )
    _require_palms(box)
    require_valid_outline(box.outline, width)
    return box


def _outline(entry: Entry) -> ObjectOutline:
    rows = [row.items(3) for row in entry["outline_m"].items()]
    vertices = tuple(
        (left.number(), right.number(), height.number()) for left, right, height in rows
    )
    contact = entry["right_contact"].index(1, max(len(vertices), 3))
    return ObjectOutline(vertices, contact, entry["half_length_m"].sides())


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
