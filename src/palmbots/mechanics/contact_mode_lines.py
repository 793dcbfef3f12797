# SPDX-License-Identifier: Apache-2.0
"""What people read of the contact modes of a state."""

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from palmbots._types import SIDES
from palmbots._util.report import Item, Line, Table, bad, bold, good, quiet, verdict
from palmbots._util.text import millimetres, plural
from palmbots.mechanics.consistent_modes import MOTION_CODES
from palmbots.mechanics.contact_mode_words import (
    MOTION_MEANINGS,
    SENTENCES,
    decision_sentence,
    margin_sentence,
    mode_sentence,
)

if TYPE_CHECKING:
    from palmbots.mechanics.consistent_modes import ConsistentModes
    from palmbots.mechanics.contact_modes import ContactMode, ContactModes
    from palmbots.mechanics.contact_points import Contact
    from palmbots.mechanics.mode_forces import ConsistentMode, Range

_SYMBOLS = ", ".join(f"{symbol}: {meaning}" for symbol, meaning in MOTION_MEANINGS.items())
_ALL_SYMBOLS = (
    f"{_SYMBOLS}, BR: breaks contact; forces in units of the weight, friction to the left"
)


def contact_mode_lines(found: "ContactModes") -> Iterator[Item]:
    """The state, the nine contact modes as a 3 × 3 table, and those that occur."""
    if found.modes_closing is not None and found.modes_opening is not None:
        yield _held(bool(found.held), len(found.contacts))
    yield (
        f"palms {found.theta_left_deg:g}°, {found.theta_right_deg:g}°   "
        f"contacts {millimetres(found.p_left_m)}, {millimetres(found.p_right_m)}   "
        f"object {found.object_deg:.2f}°"
    )
    if found.modes_closing is not None and found.modes_opening is not None:
        names = _numbered([contact.side for contact in found.contacts])
        yield _contacts(found.contacts, names)
        yield from _modes("closing", names, found.modes_closing)
        yield from _modes("opening", names, found.modes_opening)
        yield quiet(_ALL_SYMBOLS)
        yield ""
        yield "If only the two contact vertices touched the palms:"
    slides = MOTION_CODES[:3]
    rows = [
        (bold(left), *(_verdict_mark(found, (left, right)) for right in slides)) for left in slides
    ]
    yield Table(rows, ("left ↓  right →", *slides))
    yield quiet(_SYMBOLS)
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
        yield f"squeeze force {side:5}  {_force(low)} … {_force(high)} of the weight{wedged}"
    yield margin_sentence(found.margin_rad)


def consistent_mode_lines(found: "ConsistentModes") -> Iterator[Item]:
    """The contacts, and each consistent contact mode with its forces."""
    yield _held(found.held, len(found.contacts))
    names = _numbered([contact.surface for contact in found.contacts])
    rows = [
        (name, *map(millimetres, one.point_m), f"{_lean_deg(one.normal):g}°", f"{one.friction:g}")
        for name, one in zip(names, found.contacts, strict=True)
    ]
    heads = ("x from the COM", "y", "normal leans right by", "friction")
    yield Table(rows, ("contact", *heads), right=heads)
    yield from _modes("the surfaces move", names, found.modes)
    yield quiet(_ALL_SYMBOLS)


def _lean_deg(normal: tuple[float, float]) -> float:
    return round(math.degrees(math.atan2(*normal)), 2) + 0.0


def _numbered(surfaces: "Sequence[str]") -> list[str]:
    """The contacts by surface, with a number where there are several."""
    names = []
    for k, name in enumerate(surfaces):
        several = surfaces.count(name) > 1
        names.append(f"{name} {surfaces[: k + 1].count(name)}" if several else name)
    return names


def _held(held: bool, count: int) -> Line:
    return Line(
        verdict(held, "HELD", "NOT HELD"), f"  with all {plural(count, 'contact')} sticking"
    )


def _contacts(contacts: "Sequence[Contact]", names: "Sequence[str]") -> Table:
    """More than two contacts: what touches, and where."""
    rows = [
        (name, one.kind, *map(millimetres, (one.place_m, *one.point_m)))
        for name, one in zip(names, contacts, strict=True)
    ]
    places = ("on the palm", "object x", "object y")
    return Table(rows, ("contact", "kind", *places), right=places)


def _modes(what: str, names: "Sequence[str]", modes: "Sequence[ConsistentMode]") -> Iterator[Item]:
    """All consistent contact modes under one motion of the surfaces."""
    if not modes:
        yield Line(f"{what}: ", bad("none"), f" ({SENTENCES['no_mode']})")
    elif len(modes) > 1:
        yield Line(f"{what}: ", bold(f"one of {len(modes)} contact modes"))
    for k, mode in enumerate(modes, start=1):
        heads = ("normal force", "friction force")
        limits = mode.at_limit or mode.motions
        rows = [
            (name, bold(motion), _range(force.normal), _range(force.friction), _end(motion, limit))
            for name, motion, force, limit in zip(
                names, mode.motions, mode.forces, limits, strict=True
            )
        ]
        title = what if len(modes) == 1 else f"  mode {k}"
        yield Table(rows, (title, "motion", *heads, "margin ends where"), right=heads)
        margin = SENTENCES["mode_margin" if mode.at_limit else "endless_margin"]
        yield "  " + margin.format(angle=f"{mode.margin_deg:.2f}°")


def _range(ends: "Range") -> str:
    low, high = (_force(end) for end in ends)
    return low if low == high else f"{low} … {high}"


def _end(motion: str, limit: str) -> str:
    """The inequality of a contact that becomes an equation where the margin of a mode ends."""
    if motion == limit:
        return ""
    return SENTENCES["carries_nothing" if limit == "BR" else "at_cone"].format(motion=limit)


def _verdict_mark(found: "ContactModes", mode: "ContactMode") -> str:
    if mode not in found.feasible:
        return quiet("–")
    ways = (("closing", found.closing), ("opening", found.opening))
    happens = [word for word, one in ways if one == mode]
    text = ", ".join(["balanced", *happens])
    return good(text) if happens else text


def _force(value: float) -> str:
    return f"{value:+.3f}" if math.isfinite(value) else ("unbounded" if value > 0 else "-unbounded")
