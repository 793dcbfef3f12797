# SPDX-License-Identifier: Apache-2.0
"""Rare drops: splitting against plain Monte Carlo, and the output of `palmbots drop-rate`.

That the estimates are unbiased for any levels is shown against closed forms in
tests/cpp/sim/multilevel_splitting_test.cpp.
"""

import json
import math
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats

import palmbots as pb
import palmbots._core as _core
from commands import runner
from palmbots._util.confidence_intervals import clopper_pearson, student_t95
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import rare_events
from palmbots.simulation.batch import DROPPED, run_seeds
from palmbots.simulation.prepare import prepare
from palmbots.simulation.rare_events import (
    PILOT,
    _estimates,
    _Splitting,
    default_budget,
    estimate_drop_rate,
)

NOISY = {
    "distributed": {"robot.noise_m_s": 0.022},
    "centralized": {"robot.noise_m_s": 0.022, "radio.jitter_s": 0.03, "tactile.false_rate": 0.01},
    "none": {"robot.noise_m_s": 0.008, "bumps.rate_per_m": 1.0, "bumps.max_shift_m": 0.02},
    "resilient": {"robot.noise_m_s": 0.023, "radio.loss": 0.1},
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "controller",
    [
        "distributed",
        *(pytest.param(c, marks=pytest.mark.soak) for c in ("centralized", "none", "resilient")),
    ],
)
def test_agrees_with_plain_monte_carlo(controller: str) -> None:
    """Where plain carries estimate the rate too; the two share no seeds.

    Equal rates differ by more than 6 standard errors with a probability below 5e-7 (Student's t, 40
    degrees of freedom; the normal distribution has 2e-9).
    """
    keys = NOISY[controller] | {"task.distance_m": 0.3}
    n = 10_000
    run = run_seeds(to_spec(load_scene("paper", keys)), controller, 10**6, n, threads=2)
    plain = float(np.mean(run["outcome"] == DROPPED))
    assert 1e-3 < plain < 0.3  # rare enough to need a level, frequent enough for plain Monte Carlo
    result = estimate_drop_rate(
        "paper", controller, overrides=keys, seed=5, relative_half_width=0.1, effort=200
    )
    error = (result.interval[1] - result.interval[0]) / (2 * 1.96)
    assert abs(result.drop_rate - plain) < 6 * math.hypot(error, math.sqrt(plain * (1 - plain) / n))
    assert error < 0.12 * plain
    assert len(result.levels) >= 1


@pytest.mark.parametrize("effort", [75, pytest.param(300, marks=pytest.mark.soak)])
def test_levels_change_only_the_scatter(effort: int) -> None:
    """The mean over replicates is the same number, whatever the levels.

    Equal means differ by more than 6 standard errors with a probability below 1e-7 (Student's t, 78
    degrees of freedom).
    """
    spec = to_spec(load_scene("paper", NOISY["distributed"] | {"task.distance_m": 0.3}))
    values = []
    for levels in ([], [0.5], [0.3, 0.45, 0.6, 0.75, 0.9]):
        rows, _ = _core.replicates(spec, "distributed", 1, effort, levels, 0, 40, 2)
        each = _estimates(np.array(rows, float), effort)
        values.append((each.mean(), each.std(ddof=1) / math.sqrt(40)))
    for mean, error in values[1:]:
        assert abs(mean - values[0][0]) < 6 * math.hypot(error, values[0][1])
    assert values[2][1] < 0.7 * values[0][1]


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "seed", "effort"), [(0.02, 3, 60), (0.0145, 0, 10)])
def test_estimate_uses_only_the_counted_replicates(noise: float, seed: int, effort: int) -> None:
    """Recomputed here from the replicates after the pilot run: the rate, its interval by scipy's
    Student t, and the fractions of the stages. No replicate is used twice."""
    keys = {"robot.noise_m_s": noise, "task.distance_m": 0.3}
    result = estimate_drop_rate(
        "paper", "distributed", overrides=keys, seed=seed, relative_half_width=1.0, effort=effort
    )
    spec = to_spec(load_scene("paper", keys))
    levels, ticks = _core.choose_levels(spec, "distributed", seed, 1000, 0.4)
    assert list(result.levels) == levels
    for first, count in (
        (0, result.pilot_replicates),
        (result.pilot_replicates, result.replicates),
    ):
        rows, more = _core.replicates(spec, "distributed", seed, effort, levels, first, count, 1)
        ticks += more
    rates = []
    for stages in rows:
        rate, before = 0.0, 1.0
        for reached, drops in stages:
            rate += before * drops / effort
            before *= reached / effort
        rates.append(rate)
    assert result.drop_rate == pytest.approx(np.mean(rates), rel=1e-12)
    n = result.replicates
    half = stats.t.ppf(0.975, n - 1) * np.std(rates, ddof=1) / math.sqrt(n)
    low, high = result.interval
    assert low >= 0 and (low == 0) == (noise < 0.02), "cut off where chance may explain all drops"
    assert 0.999 * half <= high - result.drop_rate <= 1.04 * half  # a table of quantiles
    assert low == pytest.approx(max(2 * result.drop_rate - high, 0))
    first = [stages[0][0] / effort for stages in rows]
    assert result.conditional_probabilities[0] == pytest.approx(np.mean(first))
    carry_s = 0.3 / load_scene("paper").robot_of("left").speed_m_s
    assert result.equivalent_carries == pytest.approx(ticks * spec.period / carry_s)


@pytest.mark.slow
def test_interval_has_the_requested_width() -> None:
    """Approximately, because the number of replicates is an estimate; and with no more work than
    needed."""
    keys = {"robot.noise_m_s": 0.026, "task.distance_m": 0.15}
    widths = []
    for seed in range(4):
        result = estimate_drop_rate(overrides=keys, seed=seed, relative_half_width=0.25, effort=50)
        widths.append((result.interval[1] - result.drop_rate) / result.drop_rate / 0.25)
        assert result.replicates > 30, "or the least number decides"
        assert result.pilot_replicates >= max(PILOT, result.replicates / 4)
    assert 0.65 < np.mean(widths) < 1


def test_progress_grows_to_one() -> None:
    values: list[float] = []
    keys = {"robot.noise_m_s": 0.02, "task.distance_m": 0.3}
    estimate_drop_rate(
        overrides=keys, relative_half_width=1.0, effort=50, threads=2, on_progress=values.append
    )
    assert values == sorted(values) and 0 < values[0] < 0.2 and values[-1] == 1


@pytest.mark.parametrize(("events", "n"), [(1, 10), (3, 1000), (997, 1000), (40, 117_472)])
def test_exact_interval_is_that_of_scipy(events: int, n: int) -> None:
    low, high = clopper_pearson(events, n)
    assert low == pytest.approx(stats.beta.ppf(0.025, events, n - events + 1), rel=1e-9)
    assert high == pytest.approx(stats.beta.ppf(0.975, events + 1, n - events), rel=1e-9)


@pytest.mark.parametrize("rate", [0.001, 0.02, 0.3])
def test_exact_interval_covers_at_least_95_percent(rate: float) -> None:
    """Summed over all outcomes of 200 trials, from the closed form of their chances; 0 of 200 has
    a one-sided bound."""
    covered = sum(
        stats.binom.pmf(k, 200, rate)
        for k in range(201)
        if clopper_pearson(k, 200)[0] <= rate <= clopper_pearson(k, 200)[1]
    )
    assert covered >= 0.95


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_scene_that_does_not_drop_has_a_bound(noise: float) -> None:
    keys = {"robot.noise_m_s": noise, "task.distance_m": 0.1}
    found = estimate_drop_rate(overrides=keys, effort=20, budget=1000, threads=1)
    assert (found.drop_rate, found.dropped, found.is_narrow) == (0.0, 0, False)
    assert found.carries <= 1000
    assert found.interval == (0.0, pytest.approx(1 - 0.05 ** (1 / found.carries)))
    assert f"drop rate < {found.interval[1]:.2g}" in repr(found)
    assert found == estimate_drop_rate(overrides=keys, effort=20, budget=1000, threads=3)


def test_budget_ends_the_work_and_its_interval_is_as_wide_as_it_has_to_be() -> None:
    keys = {"robot.noise_m_s": 0.022, "task.distance_m": 0.3}
    values: list[float] = []
    wanted: dict[str, Any] = {"overrides": keys, "relative_half_width": 0.02, "effort": 50}
    found = estimate_drop_rate(**wanted, budget=20_000, on_progress=values.append)
    assert not found.is_narrow
    assert "the budget of 20,000 carries allows no narrower interval" in repr(found)
    assert found.replicates >= 16
    assert 5_000 < found.equivalent_carries < 20_000
    assert values == sorted(values) and values[-1] == 1


@pytest.mark.parametrize(
    ("noise", "controller", "budget"),
    [(0.02, "distributed", 10_000), (0.01, "shared-sign", 10_000), (0.02, "distributed", 5000)],
)
def test_estimated_rest_of_the_work_does_not_grow(
    noise: float, controller: str, budget: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At every report, the work so far over its fraction; none costs more than the budget."""
    rests: list[float] = []
    report, plain = _Splitting.report, _Splitting.plain
    counted = [0.0]

    def watch(run: _Splitting, fraction: float) -> None:
        report(run, fraction)
        if counted[0]:  # plain carries: their share of what is left
            return
        assert 0 < fraction <= 1
        rests.append(run.spent * (1 - fraction) / fraction)

    def count(run: _Splitting, carries: int) -> int:
        counted[0] = run.spent + carries
        assert rests == [] or carries <= rests[-1] + 1
        return plain(run, carries)

    monkeypatch.setattr(_Splitting, "report", watch)
    monkeypatch.setattr(_Splitting, "plain", count)
    keys = {"robot.noise_m_s": noise, "task.distance_m": 0.3}
    found = estimate_drop_rate(overrides=keys, controller=controller, budget=budget)
    assert all(after <= before * 1.02 for before, after in pairwise(rests))
    assert counted[0] <= budget and (found.replicates == 0) == (counted[0] > 0)
    assert f"budget: {budget:,}" in repr(found)


def test_levels_that_cost_half_of_the_budget_are_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """There are the more of them, the rarer a drop is; all of them would cost twice the budget."""
    costs: list[tuple[float, int]] = []
    plain = _Splitting.plain

    def count(run: _Splitting, carries: int) -> int:
        costs.append((run.spent, carries))
        return plain(run, carries)

    monkeypatch.setattr(_Splitting, "plain", count)
    keys: dict[str, Any] = {"robot.noise_m_s": 0.02, "palm.length_m": 0.3, "task.distance_m": 0.3}
    keys |= {"object.box_m": [0.35, 0.16], "object.com_m": [0.175, 0.04]}
    found = estimate_drop_rate(overrides=keys, controller="shared-sign", budget=20_000)
    ((spent, carries),) = costs
    assert 10_000 < spent < 12_000
    assert found.carries == carries > 8000
    assert spent + carries <= 20_001
    assert 19_000 < found.equivalent_carries <= 20_001
    assert found.interval[1] < 4e-4


@pytest.mark.parametrize(
    ("keys", "budget"),
    [
        ({}, 200_000),
        ({"task.distance_m": 0.3}, 200_000),
        ({"task.distance_m": 3.0}, 100_000),  # twice as long
        ({"robot.left.motor_force_n": 30.0}, 40_000),  # a robot may stall
        ({"task.distance_m": 1000.0}, 1000),
    ],
)
def test_default_budget_follows_from_the_scene(keys: dict[str, float], budget: int) -> None:
    found = default_budget(prepare(load_scene("paper", keys), "silent"))
    assert found == pytest.approx(budget, rel=0.03)


@pytest.mark.parametrize(
    ("budget", "threads", "said"),
    [
        (1000, 4, "2.5 s: 1,000 carries (--budget)"),
        (20_000, 1, "3.3 min: 20,000 carries (--budget)"),
        # Up to half of the work chooses levels, on one processor.
        (24_000, 4, "2.5 min: 24,000 carries (--budget)"),
        (1000, 8, None),  # a moment
    ],
)
def test_time_is_stated_before_the_work(
    budget: int, threads: int, said: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 0.0

    def run_singly(specs: Any, index: Any, *_: Any) -> None:
        nonlocal now
        now += 0.01 * len(index)

    def stop(*_: Any) -> None:
        raise InterruptedError  # the work begins

    monkeypatch.setattr(rare_events, "time", SimpleNamespace(monotonic=lambda: now))
    monkeypatch.setattr(rare_events, "run_singly", run_singly)
    monkeypatch.setattr(rare_events, "_Splitting", stop)
    lines: list[str] = []
    with pytest.raises(InterruptedError):
        estimate_drop_rate(budget=budget, threads=threads, on_line=lines.append)
    assert lines == ([] if said is None else [f"the drop rate takes up to about {said}"])


@pytest.mark.parametrize("freedom", [15, 19, 20, 40, 119, 120, 5000, 9999])
def test_student_quantiles_are_those_of_scipy(freedom: int) -> None:
    """Between two entries of the table the wider interval is used."""
    exact = stats.t.ppf(0.975, freedom)
    assert 0.9995 * exact <= student_t95(freedom) <= 1.025 * exact


def test_estimate_depends_on_the_seed_and_not_on_threads() -> None:
    keys = {"robot.noise_m_s": 0.022, "task.distance_m": 0.2}

    def estimate(seed: int, threads: int) -> pb.simulation.DropRate:
        return estimate_drop_rate(
            overrides=keys, seed=seed, relative_half_width=1.0, effort=20, threads=threads
        )

    one = estimate(0, 1)
    assert one == estimate(0, 3)
    assert one.drop_rate != estimate(1, 1).drop_rate


def test_drop_rate_falls_with_the_noise() -> None:
    rates = []
    for noise in (0.022, 0.016):
        keys = {"robot.noise_m_s": noise, "task.distance_m": 0.2}
        result = estimate_drop_rate(overrides=keys, relative_half_width=1.0, effort=20)
        rates.append(result.drop_rate)
    assert rates[0] > 10 * rates[1] > 0


@pytest.mark.soak
def test_drop_rate_below_the_reach_of_monte_carlo() -> None:
    """With less noise fewer carries drop, down to rates at which a billion carries would drop
    none."""
    rates = []
    for noise in (0.018, 0.013, 0.01):
        keys = {"robot.noise_m_s": noise, "task.distance_m": 0.3}
        rates.append(estimate_drop_rate(overrides=keys, relative_half_width=1.0, effort=500))
    first, second, third = (result.drop_rate for result in rates)
    assert first > 100 * second > 100 * 10 * third > 0
    assert rates[2].interval[1] < 1e-9


def test_command_prints_rate_and_levels(capsys: pytest.CaptureFixture[str]) -> None:
    keys = ("--set", "robot.noise_m_s=0.022", "--set", "task.distance_m=0.2")
    keys += ("--effort", "20", "--relative-error-percent", "100")
    run = runner(capsys)
    done = run("drop-rate", *keys, "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert summary["interval"][0] < summary["drop_rate"] < summary["interval"][1]
    assert summary["scene"]["robot"]["noise_m_s"] == 0.022
    assert len(summary["levels"]) == len(summary["conditional_probabilities"])
    assert summary["levels"] == sorted(summary["levels"])
    again = run("drop-rate", *keys)
    assert again.returncode == 0
    assert f"drop rate {summary['drop_rate']:.2g}, " in again.stdout
