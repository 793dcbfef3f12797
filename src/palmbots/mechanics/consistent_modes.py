# SPDX-License-Identifier: Apache-2.0
"""The consistent contact modes of an object on any contacts: palms, their noses and heels, a floor,
walls.

`consistent_modes` takes the contacts as they are, whatever touches. The core has the mechanics
(`mechanics/wrench_cone.hpp`, `mechanics/twist_feasibility.hpp`, `mechanics/mode_forces.hpp`).
Source: docs/theory/contacts.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._util.arguments import show
from palmbots._util.results import Result
from palmbots.errors import PalmbotsError
from palmbots.mechanics.mode_forces import ConsistentMode, ContactForce, Support

MOTION_CODES = ("ST", "SL", "SR", "BR")
"""A contact sticks, slides to the left, slides to the right, or breaks."""

_ST, _SL, _SR, _BR = MOTION_CODES
CODE_OF = ({0: _ST, 1: _SL, -1: _SR, 2: _BR}, {0: _ST, 1: _SR, -1: _SL, 2: _BR})
"""The code of a motion by palm and by the number that the core gives it: 1 slides up the palm."""

MOST_CONTACTS = 8


@dataclass(frozen=True, slots=True)
class SurfaceContact:
    """One contact of the object with a surface. Frame: world, x forward, y up."""

    surface: str
    """Name of the surface; contacts of one surface have one friction."""
    point_m: tuple[float, float]
    """The point, from the COM."""
    normal: tuple[float, float]
    """Direction of the normal, from the surface into the object; its length does not matter."""
    friction: float
    """Friction coefficient."""
    velocity_m_s: tuple[float, float] = (0.0, 0.0)
    """Velocity of the surface at this point."""


@dataclass(frozen=True, repr=False)
class ConsistentModes(Result):
    """All consistent contact modes of an object under a given motion of the surfaces."""

    lines_of = "palmbots.mechanics.contact_mode_lines:consistent_mode_lines"

    contacts: tuple[SurfaceContact, ...]
    slope: float
    """The sideways specific force towards −x."""
    held: bool
    """Whether friction can hold the object with every contact sticking."""
    modes: tuple[ConsistentMode, ...]
    """There may be none (the object falls, or the surfaces crush it), or several: rigid contacts
    with Coulomb friction do not determine which one occurs."""


def consistent_modes(contacts: Iterable[SurfaceContact], *, slope: float = 0.0) -> ConsistentModes:
    """All contact modes that are possible under the motion of the surfaces and in balance.

    For each of them the result states the force at every contact, or its range, by how much the
    friction angles may change, and which contact decides that.

    SL and SR mean that the object slides to the left or right as seen by someone who stands on the
    surface: on a wall to the right of the object, SL is down.

    Args:
        contacts: at most 8, of any surfaces.
        slope: sideways specific force towards −x: acceleration / g, or the slope of the floor.

    Raises:
        PalmbotsError: there are too many contacts, a number is not finite, a normal has no length,
            the friction is negative, or contacts of one surface have different frictions.
    """
    chosen = tuple(contacts)
    _check(chosen, slope)
    supports = [_support(one) for one in chosen]
    velocities = [one.velocity_m_s for one in chosen]
    still = [0] * len(supports)
    return ConsistentModes(
        contacts=chosen,
        slope=float(slope),
        held=_core.balances(supports, still, slope),
        modes=modes_of(supports, velocities, slope, [one.surface for one in chosen]),
    )


def modes_of(
    supports: Sequence[Support],
    velocities: Sequence[tuple[float, float]],
    slope: float,
    surfaces: Sequence[str],
) -> tuple[ConsistentMode, ...]:
    """The same, of contacts as the core takes them."""

    def named(motions: Sequence[int]) -> tuple[str, ...]:
        return tuple(CODE_OF[s[0]][m] for s, m in zip(supports, motions, strict=True))

    names = sorted(set(surfaces))
    numbers = [names.index(name) for name in surfaces]

    def made(motions: Sequence[int]) -> ConsistentMode:
        forces, margin, at = _core.mode_forces(list(supports), motions, slope, numbers)
        return ConsistentMode(
            motions=named(motions),
            forces=tuple(ContactForce(normal, friction) for normal, friction in forces),
            margin_deg=math.degrees(margin),
            at_limit=None if at is None else named(at),
        )

    return tuple(made(m) for m in _core.outcomes(list(supports), list(velocities), slope))


def _support(contact: SurfaceContact) -> Support:
    (x, y), (nx, ny) = contact.point_m, contact.normal
    size = math.hypot(nx, ny)
    return (0, float(x), float(y), nx / size, ny / size, float(contact.friction))


def _check(contacts: Sequence[SurfaceContact], slope: float) -> None:
    if not len(contacts) <= MOST_CONTACTS:
        raise PalmbotsError(
            f"contacts: {len(contacts)} are given; allowed: at most {MOST_CONTACTS}"
        )
    if not math.isfinite(slope):
        raise PalmbotsError(f"slope: value is {show(slope)}; allowed: a finite number")
    frictions: dict[str, float] = {}
    for one in contacts:
        for name, pair in (
            ("point_m", one.point_m),
            ("normal", one.normal),
            ("velocity_m_s", one.velocity_m_s),
        ):
            if not all(map(math.isfinite, pair)) or (name == "normal" and not any(pair)):
                raise PalmbotsError(
                    f"{name}: value is {show(pair)}; allowed: two finite numbers"
                    + (", not both 0" if name == "normal" else "")
                )
        if not 0 <= one.friction < math.inf:
            raise PalmbotsError(
                f"friction: value is {show(one.friction)}; allowed: a finite number, at least 0"
            )
        if frictions.setdefault(one.surface, one.friction) != one.friction:
            raise PalmbotsError(
                f"friction: contacts of the surface {show(one.surface)} have different values; "
                "allowed: one value for each surface"
            )
