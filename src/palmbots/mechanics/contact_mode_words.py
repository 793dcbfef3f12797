# SPDX-License-Identifier: Apache-2.0
"""What a contact mode is, and which inequality decides it, in words.

`palmbots contact-modes` prints these sentences. The page (scripts/site_tables.py) fills in the same
templates. H is the squeeze, in units of the weight; I_L and I_R are the squeezes that the left and
the right contact can carry (paper, section 3.1).
"""

import math

from palmbots._types import SIDES, BySide

MOTION_MEANINGS = {"ST": "sticks", "SL": "slides left", "SR": "slides right"}
"""What the symbols of a contact mode mean."""

SENTENCES: dict[str, str] = {
    "mode": "The left contact {left}, the right one {right}.",
    "sticks": "sticks",
    "up": "slides up",
    "down": "slides down",
    "not_held": "No squeeze holds the object: it slides on both palms.",
    "jammed": "No squeeze makes a contact slide: the object is jammed.",
    "apart": "I_L = [{left_low}, {left_high}] and I_R = [{right_low}, {right_high}] have no "
    "squeeze in common.",
    "endless": "The squeeze rises without end, because neither I_L nor I_R has an upper end.",
    "closing_tie": "The squeeze rises until it reaches the upper edges of both cones at once: "
    "H = {first}.",
    "closing": "The squeeze rises until it reaches the upper edge of the {near} cone first: "
    "H = {first} there ≤ {second} at the upper edge of the {far} cone.",
    "opening_tie": "The squeeze falls until it reaches the lower edges of both cones at once: "
    "H = {first}.",
    "opening": "The squeeze falls until it reaches the lower edge of the {near} cone first: "
    "H = {first} there ≥ {second} at the lower edge of the {far} cone.",
    "margin": "Both friction cones may shrink by {angle} before the object slides.",
    "no_margin": "Both friction cones would have to grow by {angle} to hold the object.",
    "all_hold": "HELD  with all {count} contacts sticking",
    "all_slip": "NOT HELD  with all {count} contacts sticking",
    "no_mode": "no contact mode is possible and in balance",
    "mode_margin": "margin {angle} of friction angle",
    "endless_margin": "margin: no change of a friction angle ends this mode",
    "at_cone": "|friction| = μ × normal, {motion}",
    "carries_nothing": "normal = 0",
    "property_1": "Driving the palms together slides the contact on the shallow palm up.",
    "property_2": "Driving the palms apart slides the contact on the steep palm down.",
}
"""Every sentence, with names in braces for what is filled in. The properties are those of a pair
of palm angles (paper, section 2)."""

_TIE = 1e-9  # ends that are closer than this are the same one

_UP = {"left": "SL", "right": "SR"}


def _number(value: float, digits: int = 3) -> str:
    if not math.isfinite(value):
        return "∞" if value > 0 else "−∞"
    return f"{value:.{digits}f}".replace("-", "−")


def mode_sentence(mode: tuple[str, str] | None, *, held: bool) -> str:
    """The motion of both contacts; None: the object is not held, or else it is jammed."""
    if mode is None:
        return SENTENCES["jammed" if held else "not_held"]
    left, right = (
        SENTENCES["sticks" if motion == "ST" else "up" if motion == _UP[side] else "down"]
        for side, motion in zip(_UP, mode, strict=True)
    )
    return SENTENCES["mode"].format(left=left, right=right)


def decision_sentence(squeeze: BySide[tuple[float, float]], *, closing: bool, held: bool) -> str:
    """The comparison of squeezes that decides which contact slides.

    Args:
        squeeze: I_L and I_R by side: low and high, in units of the weight, infinite if unbounded.
        closing: whether the palms are driven together; else they are driven apart.
        held: whether the object is held.
    """
    (left_low, left_high), (right_low, right_high) = squeeze["left"], squeeze["right"]
    if not held:
        return SENTENCES["apart"].format(
            left_low=_number(left_low), left_high=_number(left_high),
            right_low=_number(right_low), right_high=_number(right_high),
        )  # fmt: skip
    ends = {side: ends[1 if closing else 0] for side, ends in squeeze.items()}
    near, far = sorted(SIDES, key=lambda side: ends[side], reverse=not closing)
    first, second = ends[near], ends[far]
    if not math.isfinite(first):
        return SENTENCES["endless"]
    name = "closing" if closing else "opening"
    if abs(first - second) < _TIE:
        return SENTENCES[f"{name}_tie"].format(first=_number(first))
    # As many digits as show which of the two is smaller.
    digits = next((n for n in range(3, 7) if _number(first, n) != _number(second, n)), 3)
    return SENTENCES[name].format(
        near=near, far=far, first=_number(first, digits), second=_number(second, digits)
    )


def margin_sentence(margin_rad: float) -> str:
    """By how much the friction cones may shrink, or would have to grow."""
    angle = f"{math.degrees(abs(margin_rad)):.2f}°"
    return SENTENCES["margin" if margin_rad >= 0 else "no_margin"].format(angle=angle)
