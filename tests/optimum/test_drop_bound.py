# SPDX-License-Identifier: Apache-2.0
"""`palmbots.bound`: its numbers, its cache and its refusals."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.optimum import Bound, FrontPoint, drop_bound
from palmbots.optimum.opening import COARSE, Grid, best_price, opening_problem
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, run_seeds

SHORT = {"task.distance_m": 0.2}


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache of this file: what several tests need is solved once."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture(autouse=True)
def cache(shared: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The shared cache, and coarse grids: the numbers shift by less than 0.5 %."""
    monkeypatch.setenv("PALMBOTS_CACHE", str(shared))
    monkeypatch.setattr(drop_bound, "FINE", COARSE)
    return shared


def bound(change: Mapping[str, object] | None = None, drop_rate: float = 0.01) -> Bound:
    """Of short carries with corrections only."""
    keys = SHORT | dict(change or {})
    return pb.bound("paper", "corrections", drop_rate=drop_rate, overrides=keys)


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder for a cache of its own."""
    monkeypatch.setenv("PALMBOTS_CACHE", str(tmp_path))
    return tmp_path / "bound"


NUMBERS = {
    "sigma_star_m_s": 0.05, "grid_error": 0.001, "drop_rate": 0.0, "rate": 0.01,
    "speeds": "corrections", "time_s": 3.0, "law_m_s": 0.05, "opening_speed_m_s": 0.06,
    "usable_m": 0.15, "front": [],
}  # fmt: skip


@pytest.mark.slow
def test_bound_of_the_default_scene() -> None:
    """3.93 cm/s with level palms, and 0.2 % less because the palms are not level."""
    fractions: list[float] = []
    found = pb.bound("paper", "corrections", on_progress=fractions.append)
    alone = found.sigma_star_m_s / (1 + found.grid_error)
    assert 100 * alone == pytest.approx(3.93, abs=0.02)
    assert found.drop_rate < 1e-9
    assert found.noise_m_s == 0.01
    assert 0 < found.grid_error < 0.01
    assert found.time_s == pytest.approx(25.06)
    assert found.opening_speed_m_s == pytest.approx(0.06)
    assert found.front == ()
    assert fractions == sorted(fractions) and fractions[-1] == 1
    assert repr(found).startswith("σ* at most 3.9")


def test_stopping_counts_the_time() -> None:
    """1 % drop at 5.86 ± 0.03 cm/s, where the rate grows 13 times as fast as the noise."""
    spec = to_spec(pb.load_scene("paper", {"robot.noise_m_s": 0.0586}))
    found = best_price(opening_problem(spec, "stopping"), COARSE)
    assert found.drop == pytest.approx(0.01, rel=13 * 0.03 / 5.86)
    assert found.duration > 26.0


@pytest.mark.soak
def test_bound_with_stopping_counts_the_time() -> None:
    """5.86 cm/s: less than 5.91, because the carry takes longer while a robot stops."""
    found = pb.bound("paper", "stopping")
    alone = found.sigma_star_m_s / (1 + found.grid_error)
    assert 100 * alone == pytest.approx(5.86, abs=0.03)
    times = [point.time_s for point in found.front]
    rates = [point.drop_rate for point in found.front]
    assert times == sorted(times, reverse=True) and rates == sorted(rates)
    assert rates[0] == pytest.approx(0.01, rel=0.03)
    assert 1.5 / 0.09 < times[-1] < times[0]


def test_drop_rate_at_the_limit_is_the_rate() -> None:
    limit = bound(drop_rate=0.05)
    alone = limit.sigma_star_m_s / (1 + limit.grid_error)
    there = bound({"robot.noise_m_s": limit.sigma_star_m_s}, 0.05)
    assert there.drop_rate == pytest.approx(0.05, rel=0.01)
    assert there.sigma_star_m_s / (1 + there.grid_error) == pytest.approx(alone, rel=1e-3)


@pytest.mark.parametrize(
    "change",
    [
        {"task.direction": "backward"},
        {"palm.left.length_m": 0.14, "palm.right.length_m": 0.16},
        {"tactile.zero_half_width_m": 0.01, "radio.loss": 0.5, "radio.latency_s": 0.3},
    ],
)
def test_what_does_not_matter(change: dict[str, object]) -> None:
    """The direction, how length is shared, and what a controller knows: the problem is the same."""
    one, other = (problem_fields(SHORT | keys) for keys in ({}, change))
    assert other == pytest.approx(one, abs=1e-5)


def problem_fields(keys: dict[str, object]) -> list[float]:
    """What the drop rate depends on, of a robot pair that may stop."""
    found = opening_problem(to_spec(pb.load_scene("paper", keys)), "stopping")
    names = (
        "lowest", "highest", "start", "slowest", "fastest", "change", "bias", "noise", "memory",
        "period", "duration", "distance",
    )  # fmt: skip
    return [*(getattr(found, name) for name in names), *found.most]


def test_bias_of_both_robots_moves_the_pair() -> None:
    """It shortens the carry: the midpoint is faster by the mean of both biases."""
    *_, duration, distance, behind, ahead = problem_fields({"robot.bias_m_s": 0.03})
    assert (behind, ahead) == pytest.approx((0.12, 0.12))
    assert duration == pytest.approx(distance / 0.09 + 0.06)


@pytest.mark.slow
def test_longer_palms_and_faster_corrections_tolerate_more() -> None:
    base = bound().sigma_star_m_s
    for change in ({"palm.length_m": 0.18}, {"robot.correction_m_s": 0.04}):
        assert bound(change).sigma_star_m_s > 1.05 * base


def test_result_is_kept(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drop_bound._Search, "numbers", lambda search: dict(NUMBERS))
    first = bound()
    (file,) = own.iterdir()
    monkeypatch.setattr(drop_bound, "_Search", None)  # nothing is solved again
    assert bound().summary() == first.summary()
    assert json.loads(file.read_text())["sigma_star_m_s"] == first.sigma_star_m_s


def test_damaged_cache_is_not_used(own: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(drop_bound._Search, "numbers", lambda search: dict(NUMBERS))
    first = bound()
    (file,) = own.iterdir()
    with monkeypatch.context() as patched:
        patched.setattr(drop_bound, "_Search", None)
        for content in ("", "{", "[1]", "{}", '{"sigma_star_m_s": 1}'):
            file.write_text(content)
            with pytest.raises(TypeError):  # it is solved again
                bound()
    assert bound().summary() == first.summary()


def test_cache_that_cannot_be_written_is_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("PALMBOTS_CACHE", str(blocked))
    monkeypatch.setattr(drop_bound._Search, "numbers", lambda search: dict(NUMBERS))
    assert bound().sigma_star_m_s > 0


def test_figure_shows_the_front() -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    front = tuple(FrontPoint(27.0 - i, 0.01 * (1 + i)) for i in range(3))
    figure = replace(bound(), speeds="stopping", front=front).plot()
    (axes,) = figure.axes
    assert axes.lines[0].get_xdata().tolist() == [27.0, 26.0, 25.0]
    assert axes.get_xlabel() == "mean duration of a carry [s]"
    FigureCanvasAgg(figure).draw()


def test_little_noise_gives_a_possible_speed() -> None:
    """Progress is interpolated, too, and must not leave what the speeds allow."""
    spec = to_spec(pb.load_scene("paper", {"palm.length_m": 0.08, "robot.noise_m_s": 0.01}))
    problem = opening_problem(spec, "stopping")
    problem.duration = 6.0
    found = best_price(problem, Grid(40, 20, 0.5))
    assert found.speed == pytest.approx(0.09, rel=0.01)


@pytest.mark.slow
def test_controllers_that_stand_beat_the_bound() -> None:
    """At a noise beyond the bound `standing` drops fewer, and `creeping` nothing: why the bound is
    for robots that keep driving."""
    keys = {"robot.noise_m_s": 0.07, "task.timeout_s": 400.0}
    spec = to_spec(pb.load_scene("paper", keys))
    least = best_price(opening_problem(spec, "stopping"), COARSE.coarser("noises")).drop
    assert least > 0.05
    standing = run_seeds(spec, "standing", 0, 1000)["outcome"]
    assert float((standing == DROPPED).mean()) < 0.02
    assert (run_seeds(spec, "creeping", 0, 200)["outcome"] == DELIVERED).all()
