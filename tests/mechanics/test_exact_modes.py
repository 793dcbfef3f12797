# SPDX-License-Identifier: Apache-2.0
"""Contact modes, forces and margins of degenerate states, against exact rationals.

States on boundaries are drawn at random: a friction force through another contact, the COM exactly
over a contact, parallel normals, three forces through one point, a slip that is exactly zero, equal
ends of squeeze intervals. Points, velocities, sines and cosines are small fractions.
"""

import math
from fractions import Fraction
from functools import partial
from itertools import product
from typing import Any, TypeVar

import numpy as np
import pytest

from exact_modes import (
    ZERO,
    ExactContact,
    Vector,
    is_balanced,
    is_possible,
    is_reached,
    modes_of,
    whole,
)
from palmbots.mechanics.consistent_modes import (
    ConsistentMode,
    ConsistentModes,
    SurfaceContact,
    consistent_modes,
)
from palmbots.mechanics.contact_modes import CONTACT_MODES, contact_modes_batch
from sampled import amounts

ANGLES = [
    (Fraction(s * a, c), Fraction(b, c))
    for s, (a, b, c) in product(
        (1, -1), ((0, 1, 1), (3, 4, 5), (5, 12, 13), (7, 24, 25), (8, 15, 17), (20, 99, 101))
    )
]
"""Sines and cosines that are rational."""
NORMALS = [*ANGLES, (Fraction(1), ZERO), (Fraction(-1), ZERO), (ZERO, Fraction(-1))]
FRICTIONS = [ZERO, *(Fraction(a, b) for a, b in ((1, 3), (5, 12), (1, 2), (3, 4), (1, 1), (4, 3)))]
BESIDE = Fraction(1, 10**6)  # a larger change than the tolerance of the core, 1e-9, explains
SLIGHTLY = Fraction(1, 10**9)
# The distance from a wrench cone may grow with the square of a friction angle [rad]: 1e-9 at 3e-5.
NO_MARGIN = 5e-5
ROUNDED = Fraction(1, 10**12)  # the squeeze intervals have no tolerance

Drawn = TypeVar("Drawn")


def one_of(rng: np.random.Generator, options: Any) -> Any:
    return options[int(rng.integers(len(options)))]


def number(rng: np.random.Generator, low: int, high: int, share: int) -> Fraction:
    return Fraction(int(rng.integers(low, high + 1)), share)


def from_point(start: Vector, way: Any, by: Fraction) -> Vector:
    return start[0] + by * way[0], start[1] + by * way[1]


def drawn(rng: np.random.Generator) -> tuple[list[ExactContact], Fraction]:
    """Two to four contacts that are degenerate in some of the ways above, and a slope."""
    friction = {name: one_of(rng, FRICTIONS) for name in "abcd"}
    slope = one_of(rng, [ZERO, ZERO, Fraction(1, 4)])
    contacts = []
    for _ in range(int(rng.integers(2, 5))):
        name = one_of(rng, "abcd")
        point = number(rng, -4, 4, 32), number(rng, -4, 2, 32)
        velocity = number(rng, -1, 1, 4), number(rng, -1, 1, 4)
        contacts.append(ExactContact(name, point, one_of(rng, NORMALS), friction[name], velocity))
    first, second, *_ = contacts
    edge = first.edge(one_of(rng, (1, -1)))
    if rng.random() < 0.3:  # parallel normals
        contacts[1] = second._replace(normal=first.normal)
    if (how := rng.random()) < 0.3:  # a force through another contact
        beyond = from_point(first.point, edge, number(rng, -3, 3, 16))
        contacts[1] = contacts[1]._replace(point=beyond)
    elif how < 0.5:  # up to three forces through one point of the weight's line
        y = number(rng, -2, 2, 16)
        for k, one in enumerate(contacts[:3]):
            edge = one.edge(one_of(rng, (1, -1)))
            point = from_point((slope * y, y), edge, -number(rng, 1, 3, 16))
            contacts[k] = one._replace(point=point)
    if rng.random() < 0.3:  # the COM over a contact
        y = contacts[-1].point[1]
        contacts[-1] = contacts[-1]._replace(point=(slope * y, y))
    if rng.random() < 0.5:  # surfaces move with a twist of the body, or slip past it
        twist = number(rng, -1, 1, 4), number(rng, -1, 1, 4), number(rng, -2, 2, 1)
        for k, one in enumerate(contacts):
            (x, y), slip = one.point, number(rng, -1, 1, 4)
            leaves = number(rng, 0, 1, 2) * number(rng, 0, 1, 2)
            there = twist[0] - twist[2] * y, twist[1] + twist[2] * x
            velocity = from_point(from_point(there, one.to_left, slip), one.normal, -leaves)
            contacts[k] = one._replace(velocity=velocity)
    return contacts, slope


def beside(
    rng: np.random.Generator, contacts: list[ExactContact], slope: Fraction, by: Fraction
) -> tuple[list[ExactContact], Fraction]:
    """The same with a small change of one point, velocity or normal, or of the slope."""
    k, by = int(rng.integers(len(contacts))), one_of(rng, (by, -by))
    one, way = (
        contacts[k],
        (ZERO, Fraction(1)) if rng.random() < 0.5 else (Fraction(1), Fraction(1)),
    )
    changed = list(contacts)
    match int(rng.integers(4)):
        case 0:
            changed[k] = one._replace(point=from_point(one.point, way, by))
        case 1:
            changed[k] = one._replace(velocity=from_point(one.velocity, way, by))
        case 2:
            changed[k] = one._replace(normal=from_point(one.normal, one.to_left, by))
        case _:
            slope += by
    return changed, slope


def in_core(contacts: list[ExactContact], slope: Fraction) -> ConsistentModes:
    def floats(pair: Vector) -> tuple[float, float]:
        return float(pair[0]), float(pair[1])

    return consistent_modes(
        [
            SurfaceContact(
                one.surface, floats(one.point), floats(one.normal), float(one.friction),
                floats(one.velocity),
            )
            for one in contacts
        ],
        slope=float(slope),
    )  # fmt: skip


def motions_in(found: ConsistentModes) -> set[tuple[str, ...]]:
    return {mode.motions for mode in found.modes}


@pytest.mark.parametrize("count", amounts(60, 5000))
def test_degenerate_states_have_the_modes_of_exact_rationals(count: int) -> None:
    rng = np.random.default_rng(2101)
    decided = held = kinds = 0
    for _ in range(count):
        contacts, slope = drawn(rng)
        found = in_core(contacts, slope)
        exact = modes_of(contacts, slope)
        assert motions_in(found) == exact, (contacts, slope)
        assert found.held == is_balanced(contacts, ("ST",) * len(contacts), slope)
        held += found.held
        near = beside(rng, contacts, slope, BESIDE)
        others = modes_of(*near)
        assert motions_in(in_core(*near)) == others, near
        decided += others != exact
        kinds += len(exact | others) > 1
        # A change that is as small as the tolerance of the core loses no mode that survives it.
        near = beside(rng, contacts, slope, SLIGHTLY)
        assert exact & modes_of(*near) <= motions_in(in_core(*near)), near
    assert 0.3 < held / count < 0.9
    assert decided > 0.15 * count and kinds > 0.2 * count


def with_friction(contacts: list[ExactContact], by: dict[str, Fraction]) -> list[ExactContact]:
    """The same with these changes of the friction angles [rad], to first order."""
    return [
        one._replace(
            friction=max(ZERO, one.friction + by.get(one.surface, ZERO) * (1 + one.friction**2))
        )
        for one in contacts
    ]


def ends_at_once(contacts: list[ExactContact], slope: Fraction, mode: ConsistentMode) -> bool:
    """Whether friction angles that differ by BESIDE [rad] end the mode."""
    pairs = zip(contacts, mode.motions, strict=True)
    names = sorted({one.surface for one, motion in pairs if motion != "BR"})
    return not all(
        is_balanced(with_friction(contacts, dict(zip(names, by, strict=True))), mode.motions, slope)
        for by in product((BESIDE, -BESIDE), repeat=len(names))
    )


@pytest.mark.parametrize("count", amounts(150, 10000))
def test_degenerate_states_have_the_forces_and_margins_of_exact_rationals(count: int) -> None:
    rng = np.random.default_rng(2102)
    modes = without_margin = wide = endless = 0
    for _ in range(count):
        contacts, slope = drawn(rng)
        for mode in in_core(contacts, slope).modes:
            modes += 1
            margin = math.radians(mode.margin_deg)
            is_boundary = ends_at_once(contacts, slope, mode)
            assert margin < NO_MARGIN if is_boundary else margin > 0.9 * BESIDE, (contacts, mode)
            without_margin += is_boundary
            for k, force in enumerate(mode.forces):
                reaches = partial(is_reached, contacts, mode.motions, slope, k)
                low, high = force.normal
                assert reaches((1, Fraction(low + 1e-7))), (contacts, mode)
                assert not reaches((1, Fraction(low - 1e-7))), (contacts, mode)
                most = 1e9 if high == math.inf else high
                assert reaches((-1, Fraction(most - 1e-7))), (contacts, mode)
                assert high == math.inf or not reaches((-1, Fraction(high + 1e-7))), mode
                endless += high == math.inf
                wide += high > low + 1e-6
    assert modes > 0.7 * count and without_margin > 0.2 * modes
    assert wide > 0.2 * modes and endless > 0.05 * modes


class Held:
    """An object on two contacts, at the left end of a palm each; everything in rational numbers."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.palms = [one_of(rng, ANGLES), one_of(rng, ANGLES)]
        self.friction = [one_of(rng, FRICTIONS), one_of(rng, FRICTIONS)]
        sine, cosine = one_of(rng, ANGLES)
        self.width = Fraction(1, 4)
        self.rise, self.across = self.width * sine, self.width * cosine
        self.com = self.across * number(rng, -1, 9, 8), number(rng, -2, 5, 64)
        self.slope = one_of(rng, [ZERO, ZERO, ZERO, Fraction(1, 10), Fraction(-1, 5)])
        self._degenerate(rng)
        self.p = [number(rng, -2, 2, 40), number(rng, -2, 2, 40)]
        (left, _), (right, _) = self.palms
        if right != 0:
            self.p[1] = (self.rise + self.p[0] * left) / right
        elif left != 0:
            self.p[0] = -self.rise / left
        else:
            (x, y), (w, d, z) = self.com, (self.width, self.across, self.rise)
            # Both palms are level, so is the object: turned about the left contact.
            self.com = (x * d + y * z) / w, (y * d - x * z) / w
            self.rise, self.across = ZERO, w

    def _degenerate(self, rng: np.random.Generator) -> None:
        """Chooses a friction that puts an edge of a friction cone where it decides."""
        side, up = int(rng.integers(2)), one_of(rng, (1, -1))
        lean = [s / c for s, c in self.palms]
        z = (1, -1)[side] * self.rise
        kind = int(rng.integers(4))
        if kind == 0:  # vertical
            self.friction[side] = abs(lean[side])
        elif kind == 1 and z != 0:  # through the other contact
            self._lean(side, self.across / z, up)
        elif kind == 2:  # where both contacts slide at the same squeeze
            (x, y), other = self.com, 1 - side
            edge = self.contacts[0].edge(-up)
            # Moments about the right contact, then what the right contact has to carry.
            (fx, fy), (rx, ry) = edge[:2], (self.across - x, self.rise - y)
            moment = edge[2] - (rx * fy - ry * fx)
            if moment != 0:
                share = -(rx - ry * self.slope) / moment
                vx, vy = self.slope - share * fx, 1 - share * fy
                if share > 0 and vy > 0:
                    self._lean(1, -vx / vy, 1 if other else -1)

    def _lean(self, side: int, tangent: Fraction, up: int) -> None:
        """The friction with which the upper (lower) edge leans inward by this."""
        own = self.palms[side][0] / self.palms[side][1]
        if tangent * own != -1 and up * (friction := (tangent - own) / (1 + tangent * own)) >= 0:
            self.friction[side] = up * friction

    @property
    def contacts(self) -> list[ExactContact]:
        (x, y), (left, right) = self.com, self.palms
        return [
            ExactContact("left", (-x, -y), left, self.friction[0]),
            ExactContact(
                "right", (self.across - x, self.rise - y), (-right[0], right[1]), self.friction[1]
            ),
        ]

    @property
    def modes(self) -> set[tuple[str, str]]:
        return {mode for mode in CONTACT_MODES if is_balanced(self.contacts, mode, self.slope)}

    def beside(self, friction: tuple[Fraction, Fraction], com: Fraction) -> "Held":
        """The same with these changes of the friction and of the COM's place."""
        other = object.__new__(Held)
        other.__dict__.update(self.__dict__)
        ways = zip(self.friction, friction, strict=True)
        other.friction = [max(ZERO, mu + by) for mu, by in ways]
        other.com = self.com[0] + com, self.com[1]
        return other

    def nearly(self) -> tuple[set[tuple[str, str]], set[tuple[str, str]]]:
        """The modes that every state within rounding has, and those that some of them have."""
        found = [self.modes]
        for left, right, com in product((-1, 0, 1), (-1, 0, 1), (-1, 1)):
            found.append(self.beside((left * ROUNDED, right * ROUNDED), com * ROUNDED).modes)
        return set.intersection(*found), set.union(*found)

    def in_core(self) -> Any:
        cosine, sine = self.across / self.width, self.rise / self.width
        (x, y), angles = self.com, [math.atan2(float(s), float(c)) for s, c in self.palms]
        return contact_modes_batch(
            width=float(self.width), com_x=float(x * cosine + y * sine),
            com_y=float(y * cosine - x * sine), slope=float(self.slope),
            theta_left=angles[0], theta_right=angles[1],
            p_left=float(self.p[0]), p_right=float(self.p[1]),
            friction_left=float(self.friction[0]), friction_right=float(self.friction[1]),
        )  # fmt: skip


CLOSING, OPENING = ("SL", "SR"), ("SR", "SL")


@pytest.mark.parametrize("count", amounts(60, 5000))
def test_squeeze_intervals_decide_degenerate_states_as_exact_rationals(count: int) -> None:
    """At a boundary rounding decides: each mode in balance in all states within 1e-12 is among the
    answers, and none that is so in no state. A billionth beside it the answer is exact."""
    rng = np.random.default_rng(2103)
    degenerate = decided = ties = 0
    for _ in range(count):
        state = Held(rng)
        steps = [SLIGHTLY * int(rng.integers(-1, 2)) for _ in range(3)]
        for one in (state, state.beside((steps[0], steps[1]), steps[2])):
            certain, possible = one.nearly()
            degenerate += certain != possible
            found = one.in_core()
            modes = {mode for mode, has in zip(CONTACT_MODES, found.feasible, strict=True) if has}
            assert certain <= modes <= possible, (vars(one), found)
            ties += "ST" not in {motion for mode in modes for motion in mode[:1]}
            for chosen, slide in ((int(found.closing), CLOSING), (int(found.opening), OPENING)):
                sliding = {m for m in certain if m[0] == slide[0] or m[1] == slide[1]}
                if chosen >= 0:
                    mode = CONTACT_MODES[chosen]
                    assert mode in possible and (mode[0] == slide[0] or mode[1] == slide[1])
                elif chosen == -1:  # not held
                    assert ("ST", "ST") not in certain, vars(one)
                else:  # jammed
                    assert not sliding and ("ST", "ST") in possible, vars(one)
        decided += one.modes != state.modes
    assert degenerate > 0.1 * count and decided > 0.1 * count


def test_without_friction_no_contact_pulls() -> None:
    """The COM is beyond the right contact of an object on a level palm without friction."""
    found = contact_modes_batch(
        width=0.25, com_x=0.27, com_y=0.04, theta_left=0.0, theta_right=0.2, p_left=0.0,
        p_right=0.0, friction_left=0.0, friction_right=0.5,
    )  # fmt: skip
    assert not found.feasible.any() and found.closing == found.opening == -1


def test_the_oracle_decides_by_hand_what_it_decides() -> None:
    """One leg under the COM stands, however it moves; beside it nothing balances."""
    leg = ExactContact("floor", (ZERO, Fraction(-1)), (ZERO, Fraction(1)), Fraction(1, 2))
    assert is_balanced([leg], ["ST"]) and not is_balanced([leg], ["SL"])
    # The weight's line leans with the slope, up to the friction.
    slope = Fraction(1, 2)
    moved = leg._replace(point=(-slope, Fraction(-1)))
    assert is_balanced([moved], ["ST"], slope) and not is_balanced([leg], ["ST"], slope)
    assert not is_balanced([moved._replace(friction=slope - SLIGHTLY)], ["ST"], slope)
    aside = leg._replace(point=(SLIGHTLY, Fraction(-1)))
    assert not is_balanced([aside], ["ST"])
    assert is_possible([leg], ["BR"]) and is_possible([leg, aside], ["SL", "SL"])
    # Both feet of one rigid body on the floor cannot slide apart.
    assert not is_possible([leg, leg._replace(point=(Fraction(1), Fraction(-1)))], ["SL", "SR"])
    assert whole([Fraction(1, 2), Fraction(-1, 3)]) == (3, -2)


def test_equations_that_nearly_depend_on_each_other_lose_no_mode() -> None:
    """Two contacts a billionth apart, of which one sticks: rounding, magnified by their distance,
    must not contradict what a third contact that sticks asks for."""
    eighth, drift = Fraction(1, 8), (Fraction(-1, 4), Fraction(-1, 4))
    low, steep, slip = Fraction(-1, 16), Fraction(4, 3), (Fraction(-9, 20), Fraction(-1, 10))
    leaning = Fraction(3, 5), Fraction(4, 5)
    contacts = [
        ExactContact("a", (-eighth, low - SLIGHTLY), (ZERO, Fraction(1)), steep, drift),
        ExactContact("b", (-eighth, low), leaning, Fraction(5, 12), slip),
        ExactContact("a", (eighth, Fraction(-3, 32)), (Fraction(1), ZERO), steep, drift),
    ]
    exact = modes_of(contacts, ZERO)
    assert exact == {("ST", "SR", "ST")} and exact <= motions_in(in_core(contacts, ZERO))


def test_three_rays_that_are_equal_but_for_rounding_span_nothing() -> None:
    """A frictionless contact, which has one ray twice, on an edge of another friction cone."""
    first = SurfaceContact("a", (-1 / 8, -1 / 32), (3 / 5, 4 / 5), 0.0)
    second = SurfaceContact("b", (-1 / 20, 11 / 160), (0.0, 1.0), 3 / 4)
    assert not consistent_modes([first, second]).held
