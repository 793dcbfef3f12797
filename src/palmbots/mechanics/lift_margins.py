# SPDX-License-Identifier: Apache-2.0
"""The margins with which a pair picks an object up and puts it down, and their report.

`palmbots.mechanics.lifting` evaluates them for a scene.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from palmbots._types import BySide, MaybeNaN
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, verdict, warning
from palmbots._util.text import millimetres, rounded_down, rounded_up
from palmbots.mechanics.lifting_bodies import Plate, Standing

PROPERTIES = (0, 1, 2)


@dataclass(frozen=True)
class PalmLift:
    """What one palm does at the floor. Squeezes are horizontal forces, each palm's on the
    object."""

    nose_height_m: float
    """Of the upper edge of its nose above the floor, palm steep."""
    thickest_m: float
    """The height from which on it does not get under the object's edge: r (1 − sin φ)."""
    lean_deg: float
    """Lean of the contact between nose and edge from the vertical: ψ."""
    squeeze_n: MaybeNaN
    """With which it gets under its edge while the other corner stands on the floor."""
    second_n: MaybeNaN
    """The same when the other palm is under the object already."""
    held_n: MaybeNaN
    """The most that the other palm then holds against it, before its corner climbs on."""
    heel_held_n: MaybeNaN
    """The most that it holds when that corner has climbed to its heel; infinite: any."""
    gets_under: bool
    """Whether it certainly gets under its edge, whichever palm is first."""
    may_get_under: bool
    """Whether statics permit it for some sequence of slip and roll."""
    needs_heel: bool
    """Whether it needs the other palm's heel for that, if it is second."""
    least_heel_m: MaybeNaN
    """The height of the other palm's heel with which it certainly gets under; 0: it needs none."""
    least_partner_deg: float
    """The least angle of the other palm at which it gets under without a heel."""
    push_n: MaybeNaN
    """The most that its robot can push with, while the palm carries its load."""
    heaviest_kg: MaybeNaN
    """The heaviest object under which this nose gets with that push of both robots."""
    floor_friction: BySide[MaybeNaN]
    """Friction of the floor with which the object is not dragged while this palm leaves last; left:
    shallow, right: steep."""
    pivot_m: BySide[float]
    """Height of its pivot with the nose on the floor; left: shallow, right: steep."""
    least_angle_deg: float
    """The least palm angle at which the wrist is not too low."""
    carry_height_m: float
    """Height of its pivot while the pair carries."""
    below_from_m: float | None
    """Height of its pivot below the object on the stand on which the job begins, where the palm
    touches it nowhere; None: there is none."""
    below_to_m: float | None
    """The same where the job ends."""
    clear_m: float
    """Height of its pivot from which on the object touches no stand; 0: there is none."""


@dataclass(frozen=True)
class Lifting:
    """Picking up and putting down: margins and what limits."""

    picks_up: bool
    """From the floor."""
    puts_down: bool
    """On the floor."""
    from_stand_m: float | None
    """Height of the stand on which the job begins; None: there is none."""
    to_stand_m: float | None
    """The same where the job ends."""
    palms: BySide[PalmLift]
    edge_radius_m: float
    floor_friction: float
    nose_gap_m: float
    """Between the noses when one contact is at its heel and the other one at its pivot; negative:
    they meet first."""
    held_gap_m: float
    """The same while the object is docked and centred: with both contacts at their pivots, or with
    one at the heel that its partner needs and the other one at its nose."""
    on_floor: tuple[int, ...]
    """The properties that hold while both noses are on the floor, for contacts anywhere on the
    palms."""
    in_air: tuple[int, ...]
    """The same with level pivots."""
    level_only: bool
    """Whether the pair corrects its contacts at level pivots only, because the properties do not
    hold otherwise: it raises the object before it centres them, and its wheels stand while its arms
    move."""
    permitted_rise_m: float
    """The height difference of the pivots up to which all properties hold for contacts on the inner
    half of the usable palms, where they are once they have been centred."""
    kept_rise_m: float
    """The same for property 0 and contacts anywhere on the palms: enough while the wheels stand."""
    clear_rise_m: float
    """That of all properties if the object also has to touch the palms nowhere else."""
    arms_differ_m: float
    """The largest height difference of two arms that move together: that of the pivots on the
    floor or at a stand + rate × (lease + delay + tick) + the errors of both."""
    most_rate_m_per_s: float
    """The greatest rate of the arms with which their difference is permitted."""
    clear_of_noses_m: float
    """The height difference of the pivots up to which an object that has just been docked touches
    steep palms at its contact vertices only. Beyond it, it may lie on a nose and lift off its
    contact."""
    clear_rate_m_per_s: float
    """The greatest rate of the arms with which their difference is at most that."""
    raised_differ_m: float
    """The largest height difference of the pivots while the pair carries."""
    refusals: tuple[str, ...]
    """Why the job cannot begin."""
    warnings: tuple[str, ...]
    """What may end it."""
    plates: tuple[tuple[Plate, Plate], tuple[Plate, Plate]] = field(metadata=NOT_IN_JSON)
    """(left, right), shallow and steep."""
    body: Standing = field(metadata=NOT_IN_JSON)

    @property
    def is_on_floor(self) -> bool:
        """Whether the job begins or ends on the floor."""
        return self.picks_up or self.puts_down

    @property
    def where_centred(self) -> tuple[int, ...]:
        """The properties that hold where both contacts are centred first: on the floor, or in the
        air."""
        return self.on_floor if self.picks_up and not self.level_only else self.in_air

    @derived
    def works(self) -> bool:
        """Whether the job can begin."""
        return not self.refusals

    @derived
    def squeeze_n(self) -> MaybeNaN:
        """The least with which the robots have to push; infinite: no push suffices."""
        return max(
            max(palm.squeeze_n, palm.second_n) if palm.may_get_under else math.inf
            for palm in self.palms.values()
        )

    def verdict_lines(self) -> Iterator[Item]:
        """Whether the job can begin, and why not."""
        ends = (self.picks_up, self.from_stand_m), (self.puts_down, self.to_stand_m)
        places = [
            "the floor" if on_floor else None if top is None else f"a stand of {millimetres(top)}"
            for on_floor, top in ends
        ]
        what = " and ".join(
            f"{does} {place}"
            for does, place in zip(("picks up from", "puts down on"), places, strict=True)
            if place is not None
        )
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(f"  the pair {what}"))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    def lines(self) -> Iterator[Item]:
        """The margins of both palms, and what limits."""
        yield bold("Picking up and putting down")
        heads = ("left", "right")
        yield Table(list(self._rows()), ("", *heads), right=heads)
        on_floor = f"with the noses on the floor: {numbers_of(self.on_floor)}; "
        yield (
            f"properties {on_floor if self.is_on_floor else 'with '}pivots level: "
            f"{numbers_of(self.in_air)}"
        )
        yield (
            f"while both arms move, they differ by up to {millimetres(self.arms_differ_m)}; with "
            "contacts on the inner half of the palms, all properties hold up to "
            f"{millimetres(self.permitted_rise_m)}, and from {millimetres(self.clear_rise_m)} on "
            "the object may touch a palm elsewhere; with contacts anywhere, property 0 holds up to "
            f"{millimetres(self.kept_rise_m)}"
        )
        if self.level_only:
            yield (
                "contacts are corrected at level pivots only: the pair raises the object before it "
                "centres them, and its wheels stand while its arms move"
            )
        yield from map(warning, self.warnings)

    def _rows(self) -> Iterator[tuple[str, ...]]:
        def row(name: str, text: Callable[[PalmLift], str]) -> tuple[str, ...]:
            return (f"  {name}", *(text(palm) for palm in self.palms.values()))

        if self.picks_up:
            yield row("nose above the floor", lambda one: _mm(one.nose_height_m))
            yield row("  gets under below", lambda one: _mm(one.thickest_m))
            yield row("  lean of the contact", lambda one: f"{one.lean_deg:.1f}°")
            yield row("squeeze to get under", lambda one: newtons(one.squeeze_n, "none suffices"))
            yield row("  second", lambda one: newtons(one.second_n, "none suffices"))
            yield row("  partner's palm holds", lambda one: newtons(one.held_n))
            yield row("  partner's heel holds", lambda one: newtons(one.heel_held_n))
            yield row("  partner needs a heel of", lambda one: _mm(one.least_heel_m))
            yield row("  or an angle of", lambda one: f"{one.least_partner_deg:.1f}°")
            yield row("robot pushes at most", lambda one: newtons(one.push_n))
            yield row("  heaviest object", lambda one: _kilograms(one.heaviest_kg))
        if self.puts_down:
            yield row("floor friction, leaves steep", lambda one: _number(one.floor_friction.right))
            yield row("  leaves shallow", lambda one: _number(one.floor_friction.left))
        if self.is_on_floor:
            yield row("pivot on the floor, shallow", lambda one: _mm(one.pivot_m.left))
            yield row("  steep", lambda one: _mm(one.pivot_m.right))
        if self.from_stand_m is not None:
            yield row("pivot below the object, at first", lambda one: _mm(one.below_from_m or 0.0))
        if self.to_stand_m is not None:
            yield row("pivot below the object, at last", lambda one: _mm(one.below_to_m or 0.0))
        if (self.from_stand_m, self.to_stand_m) != (None, None):
            yield row("  least on the floor", lambda one: _mm(one.pivot_m.right))
            yield row("pivot when clear of stands", lambda one: _mm(one.clear_m))
            yield row("  while the pair carries", lambda one: _mm(one.carry_height_m))


def numbers_of(numbers: tuple[int, ...] | list[int]) -> str:
    """Numbers of properties as text."""
    return ", ".join(map(str, numbers)) or "none"


def newtons(value: float, infinite: str = "any") -> str:
    """A force as text: 1.90 N; `infinite` where there is no limit."""
    return infinite if math.isinf(value) else f"{value:.2f} N"


def _mm(value: float) -> str:
    return "none helps" if math.isinf(value) else f"{1e3 * value:.2f} mm"


def _kilograms(value: float) -> str:
    return "any" if math.isinf(value) else f"{rounded_down(value, 3):g} kg"


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{rounded_up(value, 3):g}"
