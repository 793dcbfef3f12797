"""Rare drops: splitting against plain Monte Carlo, and what `palmbots rare` answers.

That the estimates are unbiased whatever the levels is shown against closed forms in
tests/core/splitting_test.cpp.
"""

import json
import math

import numpy as np
import pytest
from scipy import stats

import palmbots as pb
from palmbots import _core, cli
from palmbots.batch import DROPPED, run_seeds
from palmbots.lowering import lower
from palmbots.rare import PLANNING, _estimates, _t95, rare
from palmbots.scene import load_scene
from shell import palmbots

NOISY = {
    "distributed": {"robot.noise_m_s": 0.022},
    "centralized": {"robot.noise_m_s": 0.022, "radio.jitter_s": 0.03, "tactile.false_rate": 0.01},
    "none": {"robot.noise_m_s": 0.008, "bumps.rate_per_m": 1.0, "bumps.max_shift_m": 0.02},
    "resilient": {"robot.noise_m_s": 0.023, "radio.loss": 0.1},
}


@pytest.mark.parametrize("controller", NOISY)
def test_agrees_with_plain_monte_carlo(controller: str) -> None:
    """Where plain carries can tell the rate too; seeds of one are no seeds of the other."""
    keys = NOISY[controller] | {"task.distance_m": 0.6}
    n = 10_000
    run = run_seeds(lower(load_scene("paper", keys)), controller, 10**6, n, threads=2)
    plain = float(np.mean(run["outcome"] == DROPPED))
    assert 1e-3 < plain < 0.3  # rare enough to need a level, and not too rare to be told
    found = rare("paper", controller, overrides=keys, seed=5, within=0.1, effort=200)
    error = (found.interval[1] - found.interval[0]) / (2 * 1.96)
    assert abs(found.drop_rate - plain) < 4 * math.hypot(error, math.sqrt(plain * (1 - plain) / n))
    assert error < 0.12 * plain
    assert len(found.levels) >= 1


def test_levels_change_the_scatter_only() -> None:
    """The mean over replicates is the same number, whatever the levels."""
    spec = lower(load_scene("paper", NOISY["distributed"] | {"task.distance_m": 0.6}))
    told = []
    for levels in ([], [0.5], [0.3, 0.45, 0.6, 0.75, 0.9]):
        rows, _ = _core.replicates(spec, "distributed", 1, 300, levels, 0, 40, 2)
        each = _estimates(np.array(rows, float), 300)
        told.append((each.mean(), each.std(ddof=1) / math.sqrt(40)))
    for mean, error in told[1:]:
        assert abs(mean - told[0][0]) < 4 * math.hypot(error, told[0][1])
    assert told[2][1] < 0.7 * told[0][1]


@pytest.mark.parametrize(("noise", "seed", "effort"), [(0.02, 3, 60), (0.0145, 0, 10)])
def test_the_answer_is_that_of_the_replicates_that_count(
    noise: float, seed: int, effort: int
) -> None:
    """Worked out here, product by product, from those after the planning ones: the rate, its
    interval by scipy's Student t, and the share of stages; no replicate is used twice."""
    keys = {"robot.noise_m_s": noise, "task.distance_m": 0.3}
    told = rare("paper", "distributed", overrides=keys, seed=seed, within=1.0, effort=effort)
    spec = lower(load_scene("paper", keys))
    assert list(told.levels) == _core.choose_levels(spec, "distributed", seed, 1000, 0.4)
    rows, ticks = _core.replicates(
        spec, "distributed", seed, effort, list(told.levels), told.planning, told.replicates, 1
    )
    rates = []
    for stages in rows:
        rate, before = 0.0, 1.0
        for reached, drops in stages:
            rate += before * drops / effort
            before *= reached / effort
        rates.append(rate)
    assert told.drop_rate == pytest.approx(np.mean(rates), rel=1e-12)
    n = told.replicates
    half = stats.t.ppf(0.975, n - 1) * np.std(rates, ddof=1) / math.sqrt(n)
    low, high = told.interval
    assert low >= 0 and (low == 0) == (noise < 0.02), "cut off where chance may explain all drops"
    assert 0.999 * half <= high - told.drop_rate <= 1.04 * half  # a table of quantiles
    assert low == pytest.approx(max(2 * told.drop_rate - high, 0))
    first = [stages[0][0] / effort for stages in rows]
    assert told.reached[0] == pytest.approx(np.mean(first))
    carry_s = 0.3 / load_scene("paper").robot_of("left").speed_m_s
    assert told.carries == pytest.approx(ticks * spec.period / carry_s)


def test_the_interval_is_as_narrow_as_was_asked_for() -> None:
    """About, since how many replicates that takes is an estimate; and no more work than that."""
    keys = {"robot.noise_m_s": 0.022, "task.distance_m": 0.3}
    widths = []
    for seed in range(4):
        found = rare(overrides=keys, seed=seed, within=0.15, effort=50)
        widths.append((found.interval[1] - found.drop_rate) / found.drop_rate / 0.15)
        assert found.replicates > 30, "or the least number decides"
        assert found.planning >= max(PLANNING, found.replicates / 4)
    assert 0.65 < np.mean(widths) < 1


def test_progress_goes_on_to_the_end() -> None:
    told: list[float] = []
    keys = {"robot.noise_m_s": 0.02, "task.distance_m": 0.3}
    rare(overrides=keys, within=1.0, effort=50, threads=2, progress=told.append)
    assert told == sorted(told) and 0 < told[0] < 0.2 and told[-1] == 1
    assert sum(part < 0.201 for part in told) == PLANNING / 4


@pytest.mark.parametrize("freedom", [15, 19, 20, 40, 119, 120, 5000, 9999])
def test_student_s_quantiles(freedom: int) -> None:
    """As scipy has them; between two of the table the wider interval."""
    exact = stats.t.ppf(0.975, freedom)
    assert 0.9995 * exact <= _t95(freedom) <= 1.025 * exact


def test_threads_change_nothing_and_seeds_do() -> None:
    keys = {"robot.noise_m_s": 0.018, "task.distance_m": 0.3}

    def tell(seed: int, threads: int) -> pb.DropRate:
        return rare(overrides=keys, seed=seed, within=1.0, effort=50, threads=threads)

    assert tell(0, 1) == tell(0, 2) == tell(0, 3)
    assert tell(0, 1).drop_rate != tell(1, 1).drop_rate


def test_a_rate_that_no_monte_carlo_sees() -> None:
    """With less noise ever fewer are dropped, down to where a billion carries would show none."""
    rates = []
    for noise in (0.018, 0.013, 0.01):
        keys = {"robot.noise_m_s": noise, "task.distance_m": 0.3}
        rates.append(rare(overrides=keys, within=1.0, effort=500))
    first, second, third = (told.drop_rate for told in rates)
    assert first > 100 * second > 100 * 10 * third > 0
    assert rates[2].interval[1] < 1e-9


def test_the_command() -> None:
    keys = ("--set", "robot.noise_m_s=0.02", "--set", "task.distance_m=0.3")
    keys += ("--effort", "300")
    done = palmbots("rare", *keys, "--within-percent", "50", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["interval"][0] < told["drop_rate"] < told["interval"][1]
    assert told["scene"]["robot"]["noise_m_s"] == 0.02
    assert len(told["levels"]) == len(told["reached"])
    assert told["levels"] == sorted(told["levels"])
    again = palmbots("rare", *keys, "--within-percent", "50")
    assert again.returncode == 0
    assert f"{told['drop_rate']:.2g} of all carries dropped" in again.stdout


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--within-percent", "0.5"), "within"),
        (("--effort", "3"), "effort"),
        (("--seed", "-1"), "seed"),
        (("-c", "nobody"), "controller"),
        (("--set", "robot.noise_m_s=0", "--effort", "50"), "none came to a drop"),
        (("-c", "resilient", "--set", "radio.latency_s=2"), "allowed"),
    ],
)
def test_bad_input_is_one_line(
    arguments: tuple[str, ...], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["rare", *arguments]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert told in said.err
    assert "allowed" in said.err
