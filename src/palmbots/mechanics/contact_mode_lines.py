# SPDX-License-Identifier: Apache-2.0
"""What people read of the contact modes of a state."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from palmbots._types import SIDES
from palmbots._util.report import Item, Line, Table, bad, bold, good, quiet, verdict
from palmbots._util.text import millimetres
from palmbots.mechanics.contact_mode_words import (
    MOTION_MEANINGS,
    decision_sentence,
    margin_sentence,
    mode_sentence,
)
from palmbots.mechanics.contact_points import MOTION_CODES

if TYPE_CHECKING:
    from palmbots.mechanics.contact_modes import ContactMode, ContactModes
    from palmbots.mechanics.contact_points import Contact, Motions


def contact_mode_lines(found: "ContactModes") -> Iterator[Item]:
    """The state, the nine contact modes as a 3 × 3 table, and those that occur."""
    symbols = ", ".join(f"{symbol}: {meaning}" for symbol, meaning in MOTION_MEANINGS.items())
    yield (
        f"palms {found.theta_left_deg:g}°, {found.theta_right_deg:g}°   "
        f"contacts {millimetres(found.p_left_m)}, {millimetres(found.p_right_m)}   "
        f"object {found.object_deg:.2f}°"
    )
    if found.motions_closing is not None and found.motions_opening is not None:
        yield from _contacts(found.contacts, bool(found.held))
        yield from _outcomes("closing", found.contacts, found.motions_closing)
        yield from _outcomes("opening", found.contacts, found.motions_opening)
        yield quiet(f"{symbols}, BR: breaks contact")
        yield ""
        yield "If only the two contact vertices touched the palms:"
    slides = MOTION_CODES[:3]
    rows = [
        (bold(left), *(_verdict_mark(found, (left, right)) for right in slides)) for left in slides
    ]
    yield Table(rows, ("left ↓  right →", *slides))
    yield quiet(symbols)
    held = ("ST", "ST") in found.feasible
    for what, mode in (("closing", found.closing), ("opening", found.opening)):
        if mode is None:
            yield Line(f"{what}: ", bad("none"))
        else:
            yield Line(f"{what}: left ", bold(mode[0]), ", right ", bold(mode[1]))
        yield mode_sentence(mode, held=held)
        yield quiet(decision_sentence(found.squeeze, closing=what == "closing", held=held))
    for side in SIDES:
        low, high = found.squeeze[side]
        wedged = "   wedged: no squeeze force frees it" if found.wedged[side] else ""
        yield f"squeeze force {side:5}  {_end(low)} … {_end(high)} of the weight{wedged}"
    yield margin_sentence(found.margin_rad)


def _contacts(contacts: "Sequence[Contact]", held: bool) -> Iterator[Item]:
    """More than two contacts: their places, and whether they hold the object."""
    rows = [
        (one.side, one.kind, *map(millimetres, (one.place_m, *one.point_m))) for one in contacts
    ]
    places = ("on the palm", "object x", "object y")
    yield Table(rows, ("contact", "kind", *places), right=places)
    yield Line(f"held with all {len(contacts)} sticking: ", verdict(held, "yes", "no"))


def _outcomes(
    what: str, contacts: "Sequence[Contact]", motions: "Sequence[Motions]"
) -> Iterator[Item]:
    """The possible motions of several contacts, one combination per line, by palm."""
    if not motions:
        yield Line(f"{what}: ", bad("none"), " (no motion is possible and in balance)")
    for k, motion in enumerate(motions):
        pairs = list(zip(contacts, motion, strict=True))
        parts = [f"{what if k == 0 else '     or'}: "]
        for side in SIDES:
            names = " ".join(name for contact, name in pairs if contact.side == side)
            parts += [side, " ", bold(names), ", "]
        yield Line(*parts[:-1])


def _verdict_mark(found: "ContactModes", mode: "ContactMode") -> str:
    if mode not in found.feasible:
        return quiet("–")
    ways = (("closing", found.closing), ("opening", found.opening))
    happens = [word for word, one in ways if one == mode]
    text = ", ".join(["balanced", *happens])
    return good(text) if happens else text


def _end(value: float) -> str:
    return f"{value:+.3f}" if math.isfinite(value) else ("unbounded" if value > 0 else "-unbounded")
