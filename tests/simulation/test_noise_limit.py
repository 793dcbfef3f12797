# SPDX-License-Identifier: Apache-2.0
"""The noise at which 1 % of carries drop: against closed forms, and against plain carries."""

import importlib
import math
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from scipy import stats

import palmbots as pb
from palmbots.control import StepOutput
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, run_seeds
from sampled import in_soak

MODULE = importlib.import_module("palmbots.simulation.noise_limit")
SHORT = {"task.distance_m": 0.3}


class Holding:
    """A controller that never corrects."""

    def step(self, seen: object) -> StepOutput:
        return StepOutput()


def uniform(seeds: np.ndarray) -> np.ndarray:
    """A number from 0 to 1 for each seed (the SplitMix64 generator)."""
    z = seeds.astype(np.uint64) + np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        z = (z ^ (z >> np.uint64(shift))) * np.uint64(factor)
    return (z ^ (z >> np.uint64(31))) / 2.0**64


class Simulated:
    """Stands in for the worlds: a carry drops if its number is below the rate of its noise."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, rate: Any) -> None:
        self.rate = rate
        self.calls: list[tuple[list[float], np.ndarray, np.ndarray]] = []
        monkeypatch.setattr(MODULE, "carry_many", self.carry_many)
        monkeypatch.setattr(MODULE._Carries, "_prepared", lambda _, noise: noise)

    def carry_many(self, noises: Any, index: Any, seeds: Any, *_: Any, **__: Any) -> dict[str, Any]:
        self.calls.append((noises, index, seeds))
        dropped = uniform(seeds) < self.rate(np.asarray(noises)[index])
        return {"outcome": np.where(dropped, DROPPED, DELIVERED)}


def curve(limit: float, slope: float, rate: float = 0.01) -> Any:
    """The quantile of the rate is linear in 1/noise, as where a drift must reach a palm's end."""
    return lambda noise: stats.norm.cdf(stats.norm.ppf(rate) + slope * (1 - limit / noise))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("limit", "slope", "rate", "runs"),
    [
        (0.0193, 4.0, 0.01, 40),  # about the curve of Table 2
        in_soak(0.0006, 9.0, 0.01, 30),
        (0.7, 2.0, 0.1, 30),
        in_soak(0.03, 3.5, 0.01, 2000),
    ],
)
def test_interval_covers_the_known_limit(
    limit: float, slope: float, rate: float, runs: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The whole procedure, pilot run included, covers in 95 % − 4 standard errors at least."""
    world = Simulated(monkeypatch, curve(limit, slope, rate))
    covered, widths = 0, []
    for run in range(runs):
        found = pb.noise_limit(
            drop_rate=rate, relative_half_width=0.03, seed=run * 10**6, overrides=SHORT
        )
        low, high = found.interval
        covered += low <= limit <= high
        widths.append((high - low) / 2 / found.sigma_star_m_s)
        assert found.pilot_carries + found.carries == sum(len(c[2]) for c in world.calls)
        world.calls.clear()
    assert covered / runs > 0.95 - 4 * math.sqrt(0.95 * 0.05 / runs)
    assert 0.02 < np.median(widths) < 0.036


@pytest.mark.slow
def test_limit_agrees_with_plain_carries() -> None:
    """Half as much noise drops fewer, and at the limit 1 % drop, with seeds that were not used."""
    found = pb.noise_limit("paper", "distributed", relative_half_width=0.03, overrides=SHORT)
    rates = []
    for noise in (found.interval[0], found.sigma_star_m_s, found.interval[1]):
        spec = to_spec(pb.load_scene("paper", SHORT | {"robot.noise_m_s": noise}))
        run = run_seeds(spec, "distributed", 10**6, 20_000, threads=2)
        rates.append(float(np.mean(run["outcome"] == DROPPED)))
    error = math.sqrt(0.01 * 0.99 / 20_000)
    half = (rates[2] - rates[0]) / 2 / 1.96  # what the interval of the noise means for the rate
    assert abs(rates[1] - 0.01) < 4 * math.hypot(error, half)
    assert rates[0] < 0.01 + 2 * error and rates[2] > 0.01 - 2 * error


@pytest.mark.soak
@pytest.mark.parametrize("controller", ["distributed", "resilient"])
def test_limit_of_the_paper_scene(controller: str) -> None:
    """1.93 cm/s by an independent harness, to half a hundredth."""
    found = pb.noise_limit("paper", controller, relative_half_width=0.003)
    assert 0.0190 < found.sigma_star_m_s < 0.0198


def test_seeds_are_common_in_the_pilot_run_and_new_where_carries_count(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    world = Simulated(monkeypatch, curve(0.0193, 4.0))
    found = pb.noise_limit(seed=7, overrides=SHORT)
    *pilot, (noises, index, seeds) = world.calls
    single = [call for call in pilot if len(call[0]) == 1]
    assert len(single) >= 3
    for _, _, used in single:
        assert used.tolist() == list(range(7, 7 + 400))
    assert len(set(seeds.tolist())) == len(seeds) == found.carries
    assert min(seeds) > max(max(used) for *_, used in pilot)
    counts = [point for point in found.points if point.counts]
    assert [point.noise_m_s for point in counts] == pytest.approx(noises)
    assert [point.carries for point in counts] == np.bincount(index).tolist()
    assert sum(point.carries for point in found.points) == found.carries + found.pilot_carries


def test_result_depends_on_the_seed_and_not_on_threads() -> None:
    given: dict[str, Any] = {"relative_half_width": 0.1, "overrides": SHORT}
    one, two, other = (
        pb.noise_limit(seed=s, threads=t, **given) for s, t in ((0, 1), (0, 2), (9999, 2))
    )
    assert one.summary() == two.summary()
    assert one.sigma_star_m_s != other.sigma_star_m_s


def test_result_is_drawn_and_stated(monkeypatch: pytest.MonkeyPatch) -> None:
    Simulated(monkeypatch, curve(0.0193, 4.0))
    fractions: list[float] = []
    found = pb.noise_limit(overrides=SHORT, on_progress=fractions.append)
    assert fractions == sorted(fractions) and fractions[-1] == 1
    assert repr(found).startswith("σ* = 1.9")
    figure = found.plot()
    (axes,) = figure.axes
    assert axes.get_xlabel() == "robot noise [cm/s]" and axes.get_ylabel() == "dropped [%]"
    FigureCanvasAgg(figure).draw()


def test_python_controller_runs_with_a_wide_interval(monkeypatch: pytest.MonkeyPatch) -> None:
    Simulated(monkeypatch, curve(0.0193, 4.0))
    found = pb.noise_limit("paper", Holding, relative_half_width=0.02)
    assert found.controller == "Holding"
    assert found.carries + found.pilot_carries < 1.5 * MODULE.MOST_CARRIES_IN_PYTHON


def test_one_noisy_robot_is_varied_and_the_other_keeps_its_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With an override, the limit of the varied robot alone is higher than that of both."""
    given: dict[str, Any] = {"relative_half_width": 0.1}
    both = pb.noise_limit(overrides=SHORT, **given)
    one = pb.noise_limit(overrides=SHORT | {"robot.left.noise_m_s": 0.0}, **given)
    ratio = one.sigma_star_m_s / both.sigma_star_m_s
    assert ratio == pytest.approx(math.sqrt(2), rel=0.15)  # the variances of both robots add up


def test_carries_in_another_world_run_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """Wide intervals are allowed there; the bracket is carried in MuJoCo, too."""
    seen: list[str] = []

    def carry_many(prepared: Any, index: Any, seeds: Any, **_: Any) -> dict[str, Any]:
        seen.extend(one.world.name for one in prepared)
        noises = np.array([one.scene.robot.noise_m_s for one in prepared])
        dropped = uniform(seeds) < curve(0.02, 4.0, 0.1)(noises[index])
        return {"outcome": np.where(dropped, DROPPED, DELIVERED)}

    monkeypatch.setattr(MODULE, "carry_many", carry_many)
    found = pb.noise_limit(world="mujoco", drop_rate=0.1, relative_half_width=0.1)
    assert set(seen) == {"mujoco"} == {found.world}
    assert found.interval[0] < 0.02 < found.interval[1]
    assert ", mujoco" in repr(found)
