# SPDX-License-Identifier: Apache-2.0
"""The obligations of a certificate's claims, listed independently of the prover."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from palmbots.stability.certificates.checker.claimed_box import ClaimedBox
from palmbots.stability.certificates.checker.enclosures import Ends
from palmbots.stability.certificates.checker.property_conditions import LEFT, RIGHT

CLAIMS = {
    "property 0",
    "property 1",
    "property 2",
    "clearance",
    "property 0 turning",
    "clearance turning",
    "no jam",
}
"""All that a certificate may claim."""
_NAMES = ("left", "right")


@dataclass(frozen=True)
class Obligation:
    """A condition that has to hold everywhere in a part of the box."""

    claim: str
    number: int
    """Of the property; 0 for clearance; 1 for a jam on closing, 2 on opening."""
    side: int
    """The shallow palm; for clearance the palm that must not be touched; otherwise the left one."""
    angles: tuple[Ends, Ends]
    contacts: tuple[Ends, Ends]

    @property
    def is_clearance(self) -> bool:
        """Whether it is about the outline and not about forces."""
        return self.claim.startswith("clearance")


def required_obligations(box: ClaimedBox, claims: Sequence[str]) -> dict[str, Obligation]:
    """All obligations of the claims, by name."""
    shallow, steep = box.shallow_deg, box.steep_deg
    obligations: dict[str, Obligation] = {}
    for number in (1, 2):
        claim = f"property {number}"
        for side in (LEFT, RIGHT) if claim in claims else ():
            angles = (shallow[0], steep[1]) if side == LEFT else (steep[0], shallow[1])
            region = _clip(box.contacts, number, side, box.beyond)
            obligations[f"{number} {_NAMES[side]}"] = Obligation(
                claim, number, side, angles, region
            )

    poses = [("steep", LEFT, steep, box.contacts), ("shallow", LEFT, shallow, box.contacts)]
    for side in (LEFT, RIGHT):
        turning = (shallow[side][0], steep[side][1])  # all angles from shallow to steep
        angles = (turning, steep[1]) if side == LEFT else (steep[0], turning)
        for number in (1, 2):
            region = _clip(box.contacts, number, side, box.beyond)
            poses.append((f"{_NAMES[side]} {number}", side, angles, region))
    for pose, turning_side, angles, region in poses:
        if "property 0" in claims:
            obligations[f"0 {pose}"] = Obligation("property 0", 0, turning_side, angles, region)
        for side in (LEFT, RIGHT) if "clearance" in claims else ():
            name = f"clear {_NAMES[side]} {pose}"
            obligations[name] = Obligation("clearance", 0, side, angles, region)
    return obligations | _while_both_turn(box, claims)


def _while_both_turn(box: ClaimedBox, claims: Sequence[str]) -> dict[str, Obligation]:
    """The obligations for palms that have any angle from shallow to steep, each its own."""
    angles = (
        (box.shallow_deg[LEFT][0], box.steep_deg[LEFT][1]),
        (box.shallow_deg[RIGHT][0], box.steep_deg[RIGHT][1]),
    )
    found: dict[str, Obligation] = {}
    if "property 0 turning" in claims:
        found["0 turning"] = Obligation("property 0 turning", 0, LEFT, angles, box.contacts)
    if "clearance turning" in claims:
        (left_in, left_out), (right_in, right_out) = box.contacts
        regions = {
            "outward": (
                (max(left_in, -box.beyond), left_out),
                (max(right_in, -box.beyond), right_out),
            ),
            "inward": (
                (left_in, min(left_out, box.beyond)),
                (right_in, min(right_out, box.beyond)),
            ),
        }
        for direction, region in regions.items():
            for side in (LEFT, RIGHT):
                name = f"clear {_NAMES[side]} turning {direction}"
                found[name] = Obligation("clearance turning", 0, side, angles, region)
    if "no jam" in claims:
        found["jam closing"] = Obligation("no jam", 1, LEFT, angles, box.contacts)
        found["jam opening"] = Obligation("no jam", 2, LEFT, angles, box.contacts)
    return found


def _clip(
    contacts: tuple[Ends, Ends], number: int, shallow: int, beyond: Fraction
) -> tuple[Ends, Ends]:
    """The contacts for which property 1 or 2 is needed."""
    ends = [list(pair) for pair in contacts]
    if number == 1:
        ends[shallow][1] = min(ends[shallow][1], beyond)
    if number == 2:
        ends[1 - shallow][0] = max(ends[1 - shallow][0], -beyond)
    return (ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])
