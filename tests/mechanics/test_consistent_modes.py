# SPDX-License-Identifier: Apache-2.0
"""Contact modes of any contacts, with forces and margins, against linear programs, closed forms and
exact rationals. The oracle enumerates all modes and shares no code with the core."""

import math
import re
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.mechanics.consistent_modes import ConsistentModes, SurfaceContact, consistent_modes
from sampled import amounts

UNCLEAR = 1e-6  # HiGHS meets a constraint to 1e-7


class Body:
    """Contacts as rows: the wrench of a normal force and of a friction force to the left."""

    def __init__(self, contacts: tuple[SurfaceContact, ...], slope: float = 0.0) -> None:
        self.contacts, self.load = contacts, [slope, 1.0, 0.0]
        self.normals, self.lefts, self.points = [], [], []
        for one in contacts:
            n = np.array(one.normal) / math.hypot(*one.normal)
            self.normals.append(n)
            self.lefts.append(np.array([-n[1], n[0]]))
            self.points.append(np.array(one.point_m))

    @staticmethod
    def wrench(point: np.ndarray, force: np.ndarray) -> list[float]:
        return [force[0], force[1], point[0] * force[1] - point[1] * force[0]]

    def forces(self, motions: tuple[str, ...]) -> tuple[Any, ...]:
        """Unknowns: normal and friction force of each contact. The constraints of a program."""
        columns, above, equal = [], [], []
        k = len(self.contacts)
        for i, (one, motion) in enumerate(zip(self.contacts, motions, strict=True)):
            columns += [self.wrench(self.points[i], f) for f in (self.normals[i], self.lefts[i])]
            row = np.zeros(2 * k)
            if motion == "BR":
                row[2 * i] = 1
                equal.append(row)
                row = np.zeros(2 * k)
                row[2 * i + 1] = 1
                equal.append(row)
            elif motion == "ST":
                for sign in (-1, 1):
                    row = np.zeros(2 * k)
                    row[2 * i], row[2 * i + 1] = -one.friction, sign
                    above.append(row)
            else:  # friction opposes the slip
                row[2 * i], row[2 * i + 1] = one.friction, 1 if motion == "SL" else -1
                equal.append(row)
        a_eq = np.vstack([np.array(columns).T, *equal])
        b_eq = np.concatenate([self.load, np.zeros(len(equal))])
        return above or None, [0.0] * len(above) or None, a_eq, b_eq

    def extent(self, motions: tuple[str, ...], which: int) -> tuple[float, float] | None:
        """The least and the greatest value of one unknown; None: nothing balances."""
        a_ub, b_ub, a_eq, b_eq = self.forces(motions)
        bounds = [(0, None), (None, None)] * len(self.contacts)
        ends = []
        for sign in (1.0, -1.0):
            cost = np.zeros(2 * len(self.contacts))
            cost[which] = sign
            found = linprog(cost, a_ub, b_ub, a_eq, b_eq, bounds=bounds)
            if found.status == 2:
                return None
            ends.append(sign * found.fun if found.status == 0 else -sign * math.inf)
        return ends[0], ends[1]

    def balances(self, motions: tuple[str, ...]) -> bool:
        return self.extent(motions, 0) is not None

    def clearance(self, motions: tuple[str, ...]) -> float:
        """The largest common excess of all strict inequalities, at most 1; −inf: the equations
        contradict each other."""
        equal, wanted, above, bounds = [], [], [], []
        fastest = max(math.hypot(*one.velocity_m_s) for one in self.contacts) or 1.0
        for i, (one, motion) in enumerate(zip(self.contacts, motions, strict=True)):
            at = self.points[i]
            for way, sign in (
                (self.normals[i], 1 if motion == "BR" else 0),
                (self.lefts[i], {"ST": 0, "SL": 1, "SR": -1, "BR": None}[motion]),
            ):
                if sign is None:
                    continue
                row = [way[0], way[1], way @ np.array([-at[1], at[0]])]
                value = float(way @ np.array(one.velocity_m_s)) / fastest
                if sign == 0:
                    equal.append([*row, 0.0])
                    wanted.append(value)
                else:
                    above.append([*(-sign * np.array(row)), 1.0])
                    bounds.append(-sign * value)
        found = linprog(
            [0, 0, 0, -1], above or None, bounds or None, equal or None, wanted or None,
            bounds=[(None, None)] * 3 + [(None, 1)],
        )  # fmt: skip
        return -found.fun if found.status == 0 else -math.inf


def drawn(rng: np.random.Generator) -> tuple[SurfaceContact, ...]:
    """Contacts of a box with palms, their noses, a floor and a wall, at random."""
    closing = rng.choice([-1.0, 1.0], 2) * rng.uniform(0.2, 1.0, 2)
    lean = rng.uniform(-0.3, 1.2, 2)
    friction = rng.uniform(0.05, 0.9, 4)
    x, y = rng.uniform(0.05, 0.15), -rng.uniform(0.02, 0.08)
    possible = [
        SurfaceContact("left", (-x, y + 0.01), (math.sin(lean[0]), math.cos(lean[0])),
                       float(friction[0]), (float(closing[0]), 0.0)),
        SurfaceContact("right", (x, y + 0.01), (-math.sin(lean[1]), math.cos(lean[1])),
                       float(friction[1]), (-float(closing[1]), 0.0)),
        SurfaceContact("floor", (-x + 0.004, y), (0.0, 2.0), float(friction[2])),
        SurfaceContact("floor", (x - 0.004, y), (0.0, 2.0), float(friction[2])),
        SurfaceContact("wall", (x, y + 0.05), (-1.0, 0.0), float(friction[3])),
    ]  # fmt: skip
    chosen = sorted(rng.choice(5, int(rng.integers(2, 5)), replace=False).tolist())
    return tuple(possible[k] for k in chosen)


@pytest.mark.parametrize("count", amounts(9, 400))
def test_modes_and_forces_agree_with_linear_programs_over_all_modes(count: int) -> None:
    rng = np.random.default_rng(2001)
    compared = several = 0
    for _ in range(count):
        contacts, slope = drawn(rng), float(rng.choice([0.0, 0.1]))
        found = consistent_modes(contacts, slope=slope)
        ours = {mode.motions: mode for mode in found.modes}
        body = Body(contacts, slope)
        assert found.held == body.balances(("ST",) * len(contacts))
        for motions in product(("ST", "SL", "SR", "BR"), repeat=len(contacts)):
            clear = body.clearance(motions)
            if clear == -math.inf or 0 < clear < UNCLEAR:
                assert motions not in ours or clear > 0
                continue
            possible = clear > 0 or set(motions) == {"ST"}
            if not possible or not body.balances(motions):
                assert motions not in ours, (contacts, motions)
                continue
            mode = ours[motions]
            for i, force in enumerate(mode.forces):
                for which, (low, high) in enumerate((force.normal, force.friction)):
                    expected = body.extent(motions, 2 * i + which)
                    assert expected is not None
                    assert (low, high) == pytest.approx(expected, abs=1e-6), (contacts, motions)
                    several += high - low > 1e-6
            compared += 1
    assert compared > count / 3 and several > 4


def with_friction(contacts: tuple[SurfaceContact, ...], by: dict[str, float]) -> Any:
    return tuple(
        replace(one, friction=math.tan(max(0.0, math.atan(one.friction) + by[one.surface])))
        for one in contacts
    )


@pytest.mark.parametrize("count", amounts(12, 200))
def test_a_mode_stays_consistent_up_to_its_margin_and_one_change_beyond_it_ends_it(
    count: int,
) -> None:
    rng = np.random.default_rng(2002)
    ended = 0
    for _ in range(count):
        contacts = drawn(rng)
        surfaces = sorted({one.surface for one in contacts})
        for mode in consistent_modes(contacts).modes:
            margin = math.radians(min(mode.margin_deg, 60.0))
            held, fails = margin - 1e-5, margin + 1e-5

            def all_signs(
                by: float, of: Any = contacts, names: Any = surfaces, m: Any = mode
            ) -> Any:
                return [
                    Body(
                        with_friction(of, dict(zip(names, by * np.array(s), strict=True)))
                    ).balances(m.motions)
                    for s in product((-1, 1), repeat=len(names))
                    if by < 0.5 * math.pi - max(math.atan(one.friction) for one in of) - 0.01
                ]

            if held > 0:
                assert all(all_signs(held)), (contacts, mode)
            if mode.margin_deg < 60.0 and (tried := all_signs(fails)):
                assert not all(tried), (contacts, mode)
                ended += 1
    assert ended > count / 2


def test_two_vertices_have_the_margin_of_the_squeeze_interval() -> None:
    """Level box, θ_L < θ_R: H = tan(θ_L + φ) / 2 while the left contact slides up. It must be at
    most the upper end on the right, tan(θ_R + φ) / 2, and at least the lower one,
    tan(θ_R − φ) / 2."""
    phi = math.degrees(math.atan(0.3))
    for steep, shallow, limit in ((15.0, 5.0, "SR"), (25.0, 3.0, "SL")):
        contacts = [
            SurfaceContact("left", (-0.125, 0.0), lean(shallow), 0.3, (0.5, 0.0)),
            SurfaceContact("right", (0.125, 0.0), lean(-steep), 0.3, (-0.5, 0.0)),
        ]
        (mode,) = consistent_modes(contacts).modes
        assert mode.motions == ("SL", "ST")
        upper, lower = (steep - shallow) / 2, (shallow + 2 * phi - steep) / 2
        assert mode.margin_deg == pytest.approx(min(upper, lower), abs=1e-6)
        assert mode.at_limit == ("SL", limit) and (limit == "SR") == (upper < lower)
        squeeze = math.tan(math.radians(shallow) + math.atan(0.3)) / 2
        n, f = (ends[0] for ends in (mode.forces[0].normal, mode.forces[0].friction))
        assert f == pytest.approx(-0.3 * n)
        assert n**2 * (1 + 0.3**2) == pytest.approx(squeeze**2 + 0.25)


def lean(degrees: float) -> tuple[float, float]:
    """A normal that leans to the right from the vertical."""
    return math.sin(math.radians(degrees)), math.cos(math.radians(degrees))


@pytest.mark.parametrize(
    ("thickness", "phi_deg"), [(0.3, 16.7), (0.6, 16.7), (0.2, 31.0), (0.65, 10.0)]
)
def test_a_nose_lifts_an_edge_until_its_force_is_horizontal(
    thickness: float, phi_deg: float
) -> None:
    """cos ψ = 1 − t / r (docs/theory/lifting.md). The nose can lift if ψ + φ < 90°, with
    H = V tan(ψ + φ) against a wall without friction. t is in radii."""
    psi = math.degrees(math.acos(1 - thickness))
    mu = math.tan(math.radians(phi_deg))
    contacts = [
        SurfaceContact("nose", (-0.1, -0.05), lean(psi), mu, (0.1, 0.0)),
        SurfaceContact("floor", (0.1, -0.05), (0.0, 1.0), 0.0),
        # The wall presses on the line of the nose's contact, so that both share the weight.
        SurfaceContact("wall", (0.12, -0.05), (-1.0, 0.0), 0.0),
    ]
    found = consistent_modes(contacts)
    lifting = [mode for mode in found.modes if mode.motions[0] == "SL"]
    assert bool(lifting) == (psi + phi_deg < 90)
    if lifting:
        (wall,) = {mode.forces[2].normal[0] for mode in lifting}
        # Half the weight rests on the nose: V = 1/2.
        assert wall == pytest.approx(0.5 * math.tan(math.radians(psi + phi_deg)), rel=1e-9)
        assert lifting[0].margin_deg <= 90 - psi - phi_deg + 1e-6


def test_a_degenerate_state_has_the_forces_of_exact_rationals() -> None:
    """A block on three legs in one line, friction 3/4, pushed by a quarter of its weight: the
    corners of the polygon of their forces, in rationals."""
    mu, push = Fraction(3, 4), Fraction(1, 4)
    legs = [Fraction(-1, 8), Fraction(0), Fraction(1, 8)]
    contacts = [SurfaceContact("floor", (float(x), -0.125), (0.0, 1.0), float(mu)) for x in legs]
    (mode,) = [
        m for m in consistent_modes(contacts, slope=float(push)).modes
        if m.motions == ("ST", "ST", "ST")
    ]  # fmt: skip
    # Σ N = 1, Σ F = −push to the left, and Σ x N = −push / 8 (the push acts at the COM, 1/8 above).
    arm = -push / 8
    corners = []
    for i in range(3):  # one leg carries nothing, or two carry all
        j, k = (n for n in range(3) if n != i)
        share = (arm - legs[k]) / (legs[j] - legs[k])
        if 0 <= share <= 1:
            load = [Fraction(0)] * 3
            load[j], load[k] = share, 1 - share
            corners.append(load)
    for i, force in enumerate(mode.forces):
        loads = [corner[i] for corner in corners]
        assert force.normal == pytest.approx((float(min(loads)), float(max(loads))), abs=1e-12)
    assert mode.margin_deg == pytest.approx(
        math.degrees(math.atan(float(mu)) - math.atan(float(push))), abs=1e-5
    )
    assert mode.at_limit is not None and set(mode.at_limit) <= {"SL", "BR"}


def test_a_tie_has_no_margin() -> None:
    contacts = [
        SurfaceContact("left", (-0.125, 0.0), lean(10), 0.3, (0.5, 0.0)),
        SurfaceContact("right", (0.125, 0.0), lean(-10), 0.3, (-0.5, 0.0)),
    ]
    both = [m for m in consistent_modes(contacts).modes if m.motions == ("SL", "SR")]
    assert len(both) == 1 and both[0].margin_deg == pytest.approx(0.0, abs=1e-6)


def test_contacts_between_walls_press_without_limit() -> None:
    found = consistent_modes([
        SurfaceContact("floor", (0.0, -0.1), (0.0, 1.0), 0.3),
        SurfaceContact("left wall", (-0.1, 0.0), (1.0, 0.0), 0.3),
        SurfaceContact("right wall", (0.1, 0.0), (-1.0, 0.0), 0.3),
    ])  # fmt: skip
    (still,) = [m for m in found.modes if set(m.motions) == {"ST"}]
    assert still.forces[1].normal == (0.0, math.inf)
    assert found.summary()["modes"][0]["forces"][1]["normal"][1] is None
    assert still.margin_deg == math.inf and still.at_limit is None
    assert "no change of a friction angle ends this mode" in str(found)


def test_nothing_is_consistent_where_walls_close() -> None:
    found = consistent_modes([
        SurfaceContact("left", (-0.1, 0.0), (1.0, 0.0), 0.3, (1.0, 0.0)),
        SurfaceContact("right", (0.1, 0.0), (-1.0, 0.0), 0.3, (-1.0, 0.0)),
    ])  # fmt: skip
    assert found.held and found.modes == () and "none" in str(found)


def test_the_command_reports_forces_and_margins_of_further_contacts() -> None:
    result = pb.contact_modes("paper", theta_left_deg=0)
    assert result.modes_closing is not None
    (mode,) = result.modes_closing
    assert mode.motions == ("SL", "SL", "ST") and mode.margin_deg == pytest.approx(7.4997, abs=1e-3)
    text = str(result)
    assert text.startswith("HELD  with all 3 contacts sticking") and "margin 7.50°" in text
    assert pb.contact_modes("paper", theta_left_deg=5).modes_closing is None


@pytest.mark.parametrize(
    ("contacts", "words"),
    [
        ([SurfaceContact("a", (0, 0), (0, 0), 0.3)], "normal: value is [0, 0]"),
        ([SurfaceContact("a", (0, math.nan), (0, 1), 0.3)], "point_m"),
        ([SurfaceContact("a", (0, 0), (0, 1), -0.3)], "friction: value is -0.3"),
        ([SurfaceContact("a", (0, 0), (0, 1), mu) for mu in (0.3, 0.4)], "different values"),
        ([SurfaceContact("a", (0, 0), (0, 1), 0.3)] * 9, "contacts: 9 are given"),
    ],
)  # fmt: skip
def test_impossible_contacts_are_refused(contacts: Any, words: str) -> None:
    with pytest.raises(PalmbotsError, match=re.escape(words)):
        consistent_modes(contacts)


def test_an_empty_set_holds_nothing() -> None:
    found: ConsistentModes = consistent_modes([])
    assert not found.held and found.modes == ()
