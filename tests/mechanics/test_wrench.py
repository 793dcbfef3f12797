# SPDX-License-Identifier: Apache-2.0
"""Several contacts at once: balance and kinematics against linear programs and contact modes.

The program for balance finds the smallest missing wrench, so that the number is compared as well as
the answer. The program for kinematics finds the largest margin of all inequalities.
"""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise, product

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from batched_lp import Program, least_costs
from palmbots.mechanics.contact_modes import CONTACT_MODES as NAMES
from sampled import amounts
from statics_oracle import DOWN, OFF_BY, STICK, UP, State, random_state

Support = tuple[int, float, float, float, float, float]
Velocity = tuple[float, float]
STAY, OUT, IN, LEAVE = 0, 1, -1, 2
ALL = (STAY, OUT, IN, LEAVE)
TOLERANCE = _core.wrench_tolerance
UNCLEAR = 1e-6  # HiGHS meets a constraint to 1e-7


def tangent(s: Support) -> np.ndarray:
    """The direction in which the body slides up: outward, to the left on the left palm."""
    return np.array([-s[4], s[3]] if s[0] == 0 else [s[4], -s[3]])


def reach(supports: Sequence[Support]) -> float:
    return max(math.hypot(s[1], s[2]) for s in supports) or 1.0


def rays(supports: Sequence[Support], motions: Sequence[int]) -> np.ndarray:
    """Columns: the extreme wrenches of all contacts."""
    columns = []
    for s, motion in zip(supports, motions, strict=True):
        signs = {STAY: (1, -1), OUT: (-1,), IN: (1,), LEAVE: ()}[motion]
        for sign in signs:
            f = np.array([s[3], s[4]]) + sign * s[5] * tangent(s)
            columns.append([*f, (s[1] * f[1] - s[2] * f[0]) / reach(supports)])
    return np.array(columns, dtype=float).reshape(-1, 3).T


def least_missing(supports: Sequence[Support], motions: Sequence[int], slope: float) -> Program:
    """The smallest sum of absolute parts of a wrench that completes the balance."""
    generators = rays(supports, motions)
    n = generators.shape[1]
    matrix = np.hstack([generators, np.eye(3), -np.eye(3)])
    cost = np.r_[np.zeros(n), np.ones(6)]
    return Program(cost, matrix, np.array([slope, 1.0, 0.0]), [(0, None)] * (n + 6))


def clearest(
    supports: Sequence[Support], motions: Sequence[int], velocities: Sequence[Velocity]
) -> Program | None:
    """Minus the largest common margin of all inequalities, at most 1.

    None: the equations have no solution.
    """
    equations, wanted, above, bounds = [], [], [], []
    scale = max(math.hypot(*v) for v in velocities) or 1.0
    for s, motion, v in zip(supports, motions, velocities, strict=True):
        for direction, sign in (
            (np.array([s[3], s[4]]), 1 if motion == LEAVE else 0),
            (tangent(s), {STAY: 0, OUT: 1, IN: -1, LEAVE: None}[motion]),
        ):
            if sign is None:
                continue
            row = np.array(
                [*direction, (s[1] * direction[1] - s[2] * direction[0]) / reach(supports)]
            )
            value = float(direction @ np.array(v)) / scale
            size = float(np.linalg.norm(row))
            if sign == 0:
                equations.append([*row / size, 0.0])
                wanted.append(value / size)
            else:
                above.append([*(-sign * row / size), 1.0])
                bounds.append(-sign * value / size)
    a, b = np.array(equations).reshape(-1, 4), np.array(wanted)
    if len(b) and np.abs(a @ np.linalg.lstsq(a, b)[0] - b).max() > OFF_BY:
        return None
    return Program(
        np.array([0.0, 0.0, 0.0, -1.0]),
        a,
        b,
        [(None, None)] * 3 + [(None, 1)],
        np.array(above),
        np.array(bounds),
    )


def margins(cases: Iterable[tuple]) -> list[float | None]:
    """The largest common margin of all inequalities, for each case."""
    programs = [clearest(*case) for case in cases]
    least = least_costs([p for p in programs if p is not None])
    return [None if p is None else -next(least) for p in programs]


def random_supports(rng: np.random.Generator, n: int) -> list[Support]:
    """Contacts anywhere, the first two on different palms, normals mostly upwards."""
    values = []
    for i in range(n):
        side = i if i < 2 else int(rng.integers(2))
        lean = rng.normal(0, 0.6 if i < 2 else 1.2)
        x = (1 if side else -1) * rng.uniform(0.02, 0.2)
        y = rng.uniform(-0.1, 0.02)
        friction = rng.uniform(0.05, 1.0)
        values.append((side, x, y, math.sin(lean), math.cos(lean), friction))
    return values


def degenerate_supports(rng: np.random.Generator, n: int) -> list[Support]:
    """Coincident and collinear contacts, parallel and opposed normals, equal frictions."""
    values = []
    frictions = rng.choice([0.25, 0.5, 1.0], 2)
    for i in range(n):
        side = i if i < 2 else int(rng.integers(2))
        x = (1 if side else -1) * float(rng.choice([0.0, 0.125, 0.25]))
        y = float(rng.choice([-0.125, 0.0]))
        nx, ny = [(0.0, 1.0), (0.6, 0.8), (-0.6, 0.8), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0)][
            int(rng.choice(6, p=[0.4, 0.2, 0.2, 0.08, 0.08, 0.04]))
        ]
        values.append((side, x, y, nx, ny, float(frictions[side])))
    return values


def palm_velocities(rng: np.random.Generator, supports: Sequence[Support]) -> list[Velocity]:
    """Velocities of palms that close, open or turn about their own pivots."""
    palms = [
        {"closing": (0.5, 0.0, 0.0), "opening": (-0.5, 0.0, 0.0), "turning": (0.0, 0.0, 1.0)}[
            str(rng.choice(["closing", "opening", "turning"]))
        ]
        for _ in range(2)
    ]
    values = []
    for s in supports:
        vx, vy, spin = palms[s[0]]
        vx = -vx if s[0] else vx
        px, py = (0.1 if s[0] else -0.1), -0.125
        values.append((vx - spin * (s[2] - py), vy + spin * (s[1] - px)))
    return values


@pytest.mark.parametrize("draw", [random_supports, degenerate_supports])
@pytest.mark.parametrize("count", amounts(1000, 2500))
def test_balance_agrees_with_linear_programming(draw, count: int) -> None:
    rng = np.random.default_rng(19)
    held = 0
    unclear = 0
    cases = []
    for _ in range(count):
        supports = draw(rng, int(rng.integers(2, 7)))
        motions = [int(m) for m in rng.choice(ALL, len(supports), p=[0.55, 0.15, 0.15, 0.15])]
        cases.append((supports, motions, float(rng.choice([0.0, 0.0, 0.2, -0.1]))))
    least = least_costs([least_missing(*case) for case in cases])
    for case, theirs in zip(cases, least, strict=True):
        ours = _core.balances(*case)
        if TOLERANCE < theirs < UNCLEAR:
            unclear += 1
            continue
        assert ours == (theirs <= UNCLEAR), case
        held += ours
    assert unclear < count / 250
    assert 0.15 < held / count < 0.9


@pytest.mark.parametrize("draw", [random_supports, degenerate_supports])
@pytest.mark.parametrize("count", amounts(200, 500))
def test_possible_motions_agree_with_linear_programming(draw, count: int) -> None:
    rng = np.random.default_rng(23)
    counted = {True: 0, False: 0}
    cases = []
    for _ in range(count):
        supports = draw(rng, int(rng.integers(2, 7)))
        velocities = palm_velocities(rng, supports)
        possible = {tuple(m) for m in _core.possible_motions(supports, velocities)}
        listed = sorted(possible)
        # Palms that close on opposed normals leave nothing possible: the body is crushed.
        tried = [listed[int(i)] for i in rng.integers(len(listed), size=3)] if listed else []
        tried += [tuple(int(m) for m in rng.choice(ALL, len(supports))) for _ in range(3)]
        cases += [((supports, motions, velocities), possible) for motions in tried]
    for (case, possible), margin in zip(cases, margins(c for c, _ in cases), strict=True):
        motions = case[1]
        if margin is not None and TOLERANCE < abs(margin) < UNCLEAR:
            continue
        strict = any(m != STAY for m in motions)
        theirs = margin is not None and (margin > UNCLEAR or not strict)
        assert (motions in possible) == theirs, case
        counted[theirs] += 1
    assert min(counted.values()) > count


def test_motions_of_three_contacts_agree_with_linear_programming() -> None:
    """All 64 motions."""
    rng = np.random.default_rng(29)
    for draw in (random_supports, degenerate_supports):
        for _ in range(12):
            supports = draw(rng, 3)
            velocities = palm_velocities(rng, supports)
            possible = {tuple(m) for m in _core.possible_motions(supports, velocities)}
            happening = {tuple(m) for m in _core.outcomes(supports, velocities, 0.0)}
            everything = list(product(ALL, repeat=3))
            clear = margins((supports, motions, velocities) for motions in everything)
            least = least_costs([least_missing(supports, m, 0.0) for m in everything])
            for motions, margin, missing in zip(everything, clear, least, strict=True):
                still = motions == (STAY,) * 3
                theirs = margin is not None and (margin > UNCLEAR or still)
                assert (motions in possible) == theirs, (supports, motions, velocities)
                assert (motions in happening) == (theirs and missing < UNCLEAR)


def mirrored(supports: Sequence[Support]) -> list[Support]:
    return [(1 - side, -x, y, -nx, ny, mu) for side, x, y, nx, ny, mu in supports]


@pytest.mark.parametrize("draw", [random_supports, degenerate_supports])
def test_mirrored_state_gives_the_mirrored_result(draw) -> None:
    rng = np.random.default_rng(31)
    for _ in range(300):
        supports = draw(rng, int(rng.integers(2, 6)))
        slope = float(rng.choice([0.0, 0.1]))
        velocities = palm_velocities(rng, supports)
        turned = [(-x, y) for x, y in velocities]
        image = mirrored(supports)
        assert _core.outcomes(supports, velocities, slope) == _core.outcomes(image, turned, -slope)
        motions = [int(m) for m in rng.choice(ALL, len(supports))]
        there, back = (
            _core.balances(supports, motions, slope),
            _core.balances(image, motions, -slope),
        )
        assert there == back


def test_result_does_not_depend_on_scale() -> None:
    """Neither lengths nor rates have a scale."""
    rng = np.random.default_rng(37)
    for _ in range(200):
        supports = random_supports(rng, 4)
        large = [(s, 8 * x, 8 * y, nx, ny, mu) for s, x, y, nx, ny, mu in supports]
        velocities = palm_velocities(rng, supports)
        slow = [(x / 64, y / 64) for x, y in velocities]
        assert _core.outcomes(supports, velocities) == _core.outcomes(large, slow)


def supports_of(state: State) -> list[Support]:
    left, right, com = state.points()
    values = []
    for side, at in ((0, left), (1, right)):
        lean = state.theta[side] * (1 if side == 0 else -1)
        x, y = at - com
        values.append((side, x, y, math.sin(lean), math.cos(lean), state.friction[side]))
    return values


def test_two_contacts_give_the_nine_modes() -> None:
    rng = np.random.default_rng(41)
    states = [random_state(rng) for _ in range(3000)]
    columns = {key: np.array([s.arguments()[key] for s in states]) for key in states[0].arguments()}
    result = pb.contact_modes_batch(**columns)
    left = {"ST": STAY, "SL": OUT, "SR": IN}
    right = {"ST": STAY, "SR": OUT, "SL": IN}
    left_out = 0
    for i, state in enumerate(states):
        finite = sorted(end for end in result.squeeze[i].ravel() if math.isfinite(end))
        if any(b - a < 1e-6 * (1 + abs(b)) for a, b in pairwise(finite)):
            left_out += 1
            continue
        supports = supports_of(state)
        for k, mode in enumerate(NAMES):
            motions = [left[mode[0]], right[mode[1]]]
            ours = _core.balances(supports, motions, state.slope)
            assert ours == result.feasible[i, k], (state, mode)
    assert left_out < 100


@pytest.mark.parametrize("theta_deg", [(15, 15), (5, 15), (15, 5), (5, 5)])
def test_two_contacts_of_the_papers_box_close_and_open_as_in_modes(theta_deg) -> None:
    """Ties too: a symmetric object's boundary modes balance in both."""
    state = State(0.25, (0.125, 0.04), tuple(np.radians(theta_deg)), (0.0, 0.0), (0.3, 0.3))
    supports = supports_of(state)
    known = pb.contact_modes("paper", theta_left_deg=theta_deg[0], theta_right_deg=theta_deg[1])
    names = ({STAY: "ST", OUT: "SL", IN: "SR"}, {STAY: "ST", OUT: "SR", IN: "SL"})
    for sign, consistent in ((1, known.consistent_closing), (-1, known.consistent_opening)):
        velocities = [(0.5 * sign, 0.0), (-0.5 * sign, 0.0)]
        staying = [m for m in _core.possible_motions(supports, velocities) if LEAVE not in m]
        assert {(names[0][a], names[1][b]) for a, b in staying} == set(consistent)
        happening = {
            (names[0][a], names[1][b]) for a, b in _core.outcomes(supports, velocities, 0.0)
        }
        assert happening == set(known.feasible) & set(consistent)
    for mode in product((STICK, UP, DOWN), repeat=2):
        numbers = [{STICK: STAY, UP: OUT, DOWN: IN}[m] for m in mode]
        name = (names[0][numbers[0]], names[1][numbers[1]])
        ours = _core.balances(supports, numbers, 0.0)
        assert ours == (name in known.feasible)


def test_table_on_three_legs_and_a_wedge() -> None:
    """Known answers: legs hold on any slope up to μ; two smooth walls at 45° hold a ball."""
    legs = [
        (0, -0.1, -0.1, 0.0, 1.0, 0.5),
        (0, 0.0, -0.1, 0.0, 1.0, 0.5),
        (1, 0.1, -0.1, 0.0, 1.0, 0.5),
    ]
    for slope in (0.0, 0.3, 0.5 - 1e-8, -0.5 + 1e-8):
        assert _core.balances(legs, [0, 0, 0], slope)
    assert not _core.balances(legs, [0, 0, 0], 0.5 + 1e-6)
    # All slide to −x: up on the left palm, down on the right one; pushed by exactly μ.
    assert _core.balances(legs, [1, 1, -1], 0.5)
    half = math.sqrt(0.5)
    wedge = [(0, -half, -half, half, half, 1e-3), (1, half, -half, -half, half, 1e-3)]
    assert _core.balances(wedge, [0, 0], 0.0)
    assert not _core.balances([(0, 0.0, 0.0, 0.0, -1.0, 0.5)], [0], 0.0)
    assert not _core.balances([], [], 0.0)
