# SPDX-License-Identifier: Apache-2.0
"""`palmbots.bound`: its numbers, its cache and its refusals."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import palmbots as pb
from palmbots.optimum import FrontPoint, drop_bound
from palmbots.optimum.opening import COARSE, best_price, opening_problem
from palmbots.scene.spec import to_spec

SHORT = {"task.distance_m": 0.2}


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of its own, and coarse grids: the numbers shift by less than 0.5 %."""
    monkeypatch.setenv("PALMBOTS_CACHE", str(tmp_path))
    monkeypatch.setattr(drop_bound, "FINE", COARSE)
    return tmp_path / "bound"


def test_bound_of_the_default_scene() -> None:
    """3.93 cm/s with level palms, and 0.2 % less because the palms are not level."""
    fractions: list[float] = []
    found = pb.bound(on_progress=fractions.append)
    assert 100 * found.sigma_star_m_s == pytest.approx(3.93, abs=0.02)
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
    assert 100 * found.sigma_star_m_s == pytest.approx(5.86, abs=0.03)
    times = [point.time_s for point in found.front]
    rates = [point.drop_rate for point in found.front]
    assert times == sorted(times, reverse=True) and rates == sorted(rates)
    assert rates[0] == pytest.approx(0.01, rel=0.03)
    assert 1.5 / 0.09 < times[-1] < times[0]


def test_drop_rate_at_the_limit_is_the_rate() -> None:
    limit = pb.bound(drop_rate=0.05, overrides=SHORT).sigma_star_m_s
    there = pb.bound(drop_rate=0.05, overrides=SHORT | {"robot.noise_m_s": limit})
    assert there.drop_rate == pytest.approx(0.05, rel=0.01)
    assert there.sigma_star_m_s == pytest.approx(limit, rel=1e-3)


@pytest.mark.parametrize(
    "change",
    [
        {"task.direction": "backward"},
        {"palm.left.length_m": 0.14, "palm.right.length_m": 0.16},
        {"tactile.zero_half_width_m": 0.01, "radio.loss": 0.5, "radio.latency_s": 0.3},
    ],
)
def test_what_does_not_matter(change: dict[str, object]) -> None:
    """The direction, how length is shared, and what a controller knows."""
    one = pb.bound(overrides=SHORT).sigma_star_m_s
    other = pb.bound(overrides=SHORT | change).sigma_star_m_s
    assert other == pytest.approx(one, rel=2e-3)


def test_longer_palms_and_faster_corrections_tolerate_more() -> None:
    base = pb.bound(overrides=SHORT).sigma_star_m_s
    for change in ({"palm.length_m": 0.18}, {"robot.correction_m_s": 0.04}):
        assert pb.bound(overrides=SHORT | change).sigma_star_m_s > 1.05 * base


def test_result_is_kept(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = pb.bound(overrides=SHORT)
    (file,) = cache.iterdir()
    monkeypatch.setattr(drop_bound, "_Search", None)  # nothing is solved again
    assert pb.bound(overrides=SHORT).summary() == first.summary()
    assert json.loads(file.read_text())["sigma_star_m_s"] == first.sigma_star_m_s
    monkeypatch.undo()


def test_damaged_cache_is_not_used(cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = pb.bound(overrides=SHORT)
    (file,) = cache.iterdir()
    with monkeypatch.context() as patched:
        patched.setattr(drop_bound, "_Search", None)
        for content in ("", "{", "[1]", "{}", '{"sigma_star_m_s": 1}'):
            file.write_text(content)
            with pytest.raises(TypeError):  # it is solved again
                pb.bound(overrides=SHORT)
    assert pb.bound(overrides=SHORT).summary() == first.summary()


def test_cache_that_cannot_be_written_is_no_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("PALMBOTS_CACHE", str(blocked))
    assert pb.bound(overrides=SHORT).sigma_star_m_s > 0


def test_figure_shows_the_front() -> None:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    found = pb.bound("paper", overrides=SHORT)
    front = tuple(FrontPoint(27.0 - i, 0.01 * (1 + i)) for i in range(3))
    figure = replace(found, speeds="stopping", front=front).plot()
    (axes,) = figure.axes
    assert axes.lines[0].get_xdata().tolist() == [27.0, 26.0, 25.0]  # type: ignore[union-attr]
    assert axes.get_xlabel() == "mean duration of a carry [s]"
    FigureCanvasAgg(figure).draw()
