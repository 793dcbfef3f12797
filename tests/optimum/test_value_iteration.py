# SPDX-License-Identifier: Apache-2.0
"""The opening problem: against closed forms, an independent simulation, and finer grids."""

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from palmbots._core import OpeningProblem
from palmbots.optimum.opening import COARSE, FINE, Grid, best_price, opening_problem, solve
from palmbots.scene.spec import to_spec

pytestmark = pytest.mark.slow

Array = NDArray[np.float64]


def problem(each: float, **fields: float) -> OpeningProblem:
    """Two palms of 0.15 m that stay level, and the paper's robots, `each` with this noise [m/s]."""
    made = OpeningProblem()
    given = {
        "lowest": 0.1, "highest": 0.4, "start": 0.25, "slowest": -0.06, "fastest": 0.06,
        "change": 0.01, "noise": math.sqrt(2) * each, "memory": math.exp(-0.01 / 0.5),
        "period": 0.01, "duration": 25.06, "distance": 1.5,
    }  # fmt: skip
    for name, value in (given | fields).items():
        setattr(made, name, value)
    made.most = (0.09, 0.09)
    return made


def sigma_star(grid: Grid, start: float, **fields: float) -> float:
    """Where 1 % drop, in cm/s: two secant steps in ln σ, from 2 % below and above `start`."""
    xs = [math.log(start * factor / 100) for factor in (0.98, 1.02)]
    ys = [math.log(solve(problem(math.exp(x), **fields), grid).drop / 0.01) for x in xs]
    for _ in range(2):
        xs.append(xs[-1] - ys[-1] * (xs[-1] - xs[-2]) / (ys[-1] - ys[-2]))
        ys.append(math.log(solve(problem(math.exp(xs[-1]), **fields), grid).drop / 0.01))
    assert abs(ys[-1]) < 2e-3
    return 100 * math.exp(xs[-1])


UNLIMITED = {"change": 1.0}
STOPPING = {"slowest": -0.12, "fastest": 0.12}


@pytest.mark.parametrize(
    ("expected", "fields"),
    [
        (3.93, {}),
        (3.95, UNLIMITED),
        # 5.86 counts the time that stopping costs (test_drop_bound); a carry of given time reaches
        # more.
        (5.91, STOPPING),
        (6.04, STOPPING | UNLIMITED),
        (5.79, STOPPING | {"change": 0.005}),
    ],
)
def test_sigma_star_of_the_problem_in_one_dimension(
    expected: float, fields: dict[str, float]
) -> None:
    """Against a program of its own (dynamic programming with other grids), within 0.02 cm/s."""
    assert sigma_star(COARSE, expected, **fields) == pytest.approx(expected, abs=0.02)


def simulate(case: OpeningProblem, policy: bytes, carries: int, seed: int) -> tuple[float, Array]:
    """Fraction of carries that drop, with normal noise and the decisions of a table of costs.

    Written anew from the meaning of the table: NumPy, all carries side by side. Returns also the
    midpoint's mean speed of each.
    """
    axes = np.frombuffer(policy[:72], dtype=[("first", "f8"), ("cell", "f8"), ("count", "u8")])
    counts = [int(count) for count in axes["count"]]
    costs = np.frombuffer(policy[72:], np.float32).reshape(counts[::-1]).astype(float)

    def place(axis: int, value: Array) -> tuple[NDArray[np.int64], Array]:
        at = (value - axes["first"][axis]) / axes["cell"][axis]
        at = np.clip(at, 0, counts[axis] - 1)
        below = np.minimum(at.astype(np.int64), counts[axis] - 2)
        return below, at - below

    def cost(x: Array, n: Array, c: Array) -> Array:
        (i, u), (j, v), (k, w) = place(0, x), place(1, n), place(2, c)
        total = np.zeros_like(x)
        for a, p in ((0, 1 - u), (1, u)):
            for b, q in ((0, 1 - v), (1, v)):
                for d, r in ((0, 1 - w), (1, w)):
                    total += p * q * r * costs[k + d, j + b, i + a]
        return total

    rng = np.random.default_rng(seed)
    x = np.full(carries, case.start)
    n = case.noise * rng.standard_normal(carries)
    c = np.zeros(carries)
    held = np.ones(carries, bool)
    gone = np.zeros(carries)
    for _ in range(round(case.duration / case.period)):
        choices = [np.clip(c + d * case.change, case.slowest, case.fastest) for d in (-1, 0, 1)]
        best = np.argmin([cost(x, n, choice) for choice in choices], axis=0)
        c = np.choose(best, choices)
        fresh = rng.standard_normal(carries)
        n = case.memory * n + case.noise * math.sqrt(1 - case.memory**2) * fresh
        x = x + (c + case.bias + n) * case.period
        held &= (x >= case.lowest) & (x <= case.highest)
        gone += (0.09 - np.abs(c) / 2) * case.period
    return 1 - float(held.mean()), gone / case.duration


@pytest.mark.parametrize("fields", [{}, {"bias": 0.02}, STOPPING | {"noise": 0.11}])
def test_predicted_drop_rate_is_that_of_simulated_carries(fields: dict[str, float]) -> None:
    """6000 carries of 4 s: within 4 standard errors and the error of the grid."""
    case = problem(0.055, duration=4.0, **fields)
    solution = solve(case, FINE)
    dropped, _ = simulate(case, solution.policy, 6000, 7)
    error = math.sqrt(solution.drop * (1 - solution.drop) / 6000)
    assert 0.02 < solution.drop < 0.6
    assert dropped == pytest.approx(solution.drop, abs=4 * error + 0.02 * solution.drop)


def test_speed_of_the_midpoint_is_that_of_simulated_carries() -> None:
    case = problem(0.059, duration=6.0, **STOPPING)
    case.price = 0.01
    solution = solve(case, COARSE)
    _, speed = simulate(case, solution.policy, 2000, 8)
    assert solution.speed == pytest.approx(float(speed.mean()), rel=0.02)


def exit_rate(variance_rate: float, half: float) -> float:
    """The hazard of Brownian motion on an interval: π² D / (8 a²), variance D per second."""
    return math.pi**2 * variance_rate / (8 * half * half)


def test_white_noise_without_control_is_a_random_walk() -> None:
    """In discrete time the ends seem farther away by 0.5826 steps (Siegmund 1985)."""
    walk = problem(0.0, slowest=-1e-9, fastest=1e-9, noise=0.8, memory=0.0, duration=60.0)
    found = solve(walk, FINE).hazard
    step = 0.8 * 0.01
    expected = exit_rate(step**2 / 0.01, 0.15 + 0.5826 * step)
    assert found == pytest.approx(expected, rel=0.01)


def test_without_noise_the_bias_decides() -> None:
    """A bias beyond the greatest speed drops every object in time; a smaller one none."""
    assert solve(problem(0.0, bias=0.059), COARSE).drop == pytest.approx(0, abs=1e-9)
    assert solve(problem(0.0, bias=0.075), COARSE).drop == pytest.approx(1, abs=1e-9)
    late = problem(0.0, bias=0.075, duration=0.15 / 0.015 - 2)
    assert solve(late, COARSE).drop == pytest.approx(0, abs=1e-9)


LONG = pytest.mark.soak


@pytest.mark.parametrize(
    "name", ["positions", *(pytest.param(name, marks=LONG) for name in ("noises", "speeds"))]
)
@pytest.mark.parametrize("fields", [pytest.param({}, marks=LONG), STOPPING])
def test_finer_grids_change_little(name: str, fields: dict[str, float]) -> None:
    """Each grid refined by two: the drop rate by less than 3 %, so σ* by less than 0.3 %."""
    noise = 0.0393 if not fields else 0.0591
    finer = Grid(**{**vars(FINE), name: 2 * getattr(FINE, name)})
    two = solve(problem(noise, **fields), finer).drop
    assert two == pytest.approx(fine_drop(noise, bool(fields)), rel=0.03)


@cache
def fine_drop(noise: float, may_stop: bool) -> float:
    return solve(problem(noise, **(STOPPING if may_stop else {})), FINE).drop


def test_problem_of_the_default_scene() -> None:
    """The ends: both palms shallow, both contacts at the same ends; the object is level."""
    case = opening_problem(to_spec(pb.load_scene("paper")), "corrections")
    reach = 0.15 * math.cos(math.radians(5))
    assert case.lowest == pytest.approx(0.25 - reach, abs=1e-9)
    assert case.highest == pytest.approx(0.25 + reach, abs=1e-9)
    assert (case.slowest, case.fastest) == pytest.approx((-0.06, 0.06))
    assert case.change == pytest.approx(0.01)
    assert case.noise == pytest.approx(0.01 * math.sqrt(2))
    assert case.memory == pytest.approx(math.exp(-0.02))
    stopping = opening_problem(to_spec(pb.load_scene("paper")), "stopping")
    assert (stopping.slowest, stopping.fastest) == pytest.approx((-0.12, 0.12))


def test_price_is_the_rate_of_drops_per_metre() -> None:
    """No other price gives fewer drops per metre."""
    case = problem(0.06, **STOPPING)
    best = best_price(case, COARSE)
    fewest = best.hazard / best.speed
    assert case.price == pytest.approx(fewest, rel=0.02)
    for factor in (0.25, 4.0):
        other = problem(0.06, **STOPPING)
        other.price = factor * case.price
        solution = solve(other, COARSE)
        assert solution.hazard / solution.speed > fewest
