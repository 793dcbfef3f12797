# SPDX-License-Identifier: Apache-2.0
"""Figures and Sobol indices of studies."""

import dataclasses
import itertools
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.container import BarContainer

from palmbots.cli import main as cli
from palmbots.errors import PalmbotsError
from palmbots.studies import study_figures as figures
from palmbots.studies.designs import DESIGNS
from palmbots.studies.points import design_points
from palmbots.studies.sobol import SobolIndex, sobol_indices
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import StudyResult, run_study

SALTELLI: Any = DESIGNS["sobol-indices"].sample

FEW: dict[str, Any] = {"set": {"task.distance_m": 0.2}, "seeds": {"count": 4}}
NOISE = {"from": 0.01, "to": 0.2}


def run(tmp_path: Path, **table: Any) -> StudyResult:
    return run_study(load_plan({**FEW, **table}), tmp_path / "study")


def texts(figure: Any) -> list[str]:
    return [t.get_text() for panel in figure.axes for t in panel.texts]


def test_one_key_is_curves_with_bands(tmp_path: Path) -> None:
    result = run(tmp_path, vary={"robot.noise_m_s": [0.01, 0.1, 0.2]})
    figure = figures.draw(result)
    drops, rms = figure.axes
    assert drops.get_xlabel() == "robot noise [m/s]"
    assert (drops.get_ylabel(), rms.get_ylabel()) == ("dropped [%]", "contact rms [mm]")
    for panel, metric, scale in ((drops, "drop_rate", 100), (rms, "rms_m", 1e3)):
        values, ends = result.values[metric]
        assert ends is not None
        for c, line in enumerate(panel.lines):
            assert line.get_label() == result.points.plan.controller_names[c]
            assert line.get_xdata() == pytest.approx([0.01, 0.1, 0.2])
            assert line.get_ydata() == pytest.approx(scale * values[:, c])
            band = np.asarray(panel.collections[c].get_paths()[0].vertices)
            for k, x in enumerate((0.01, 0.1, 0.2)):
                there = band[band[:, 0] == x, 1]
                assert (there.min(), there.max()) == pytest.approx(tuple(scale * ends[k, c]))


def test_two_keys_are_maps_on_one_scale(tmp_path: Path) -> None:
    vary = {"radio.latency_s": [0.0, 0.1], "robot.noise_m_s": [0.01, 0.1, 0.2]}
    result = run(tmp_path, vary=vary, controllers=["none", "distributed"])
    figure = figures.draw(result)
    images = [panel.images[0] for panel in figure.axes[:4]]
    limits = [image.get_clim() for image in images]
    assert limits[0] == limits[1] != limits[2] == limits[3]
    for c, image in enumerate(images):
        metric, scale = (("drop_rate", 100), ("rms_m", 1e3))[c // 2]
        shown = np.asarray(image.get_array()).T
        assert shown.reshape(-1) == pytest.approx(scale * result.values[metric][0][:, c % 2])
        for text in image.axes.texts:
            i, k = text.get_position()
            assert float(text.get_text()) == pytest.approx(shown[int(i), int(k)], rel=0.006)
    assert [panel.get_title() for panel in figure.axes[:2]] == ["none", "distributed"]
    for panel in figure.axes[2:4]:
        assert panel.get_xlabel() == "radio latency [s]"
        assert [t.get_text() for t in panel.get_xticklabels()] == ["0", "0.1"]
    for panel in (figure.axes[0], figure.axes[2]):
        assert panel.get_ylabel() == "robot noise [m/s]"
        assert [t.get_text() for t in panel.get_yticklabels()] == ["0.01", "0.1", "0.2"]
    assert [bar.get_ylabel() for bar in figure.axes[4:]] == ["dropped [%]", "contact rms [mm]"]


def test_map_names_refused_cells(tmp_path: Path) -> None:
    vary = {"radio.latency_s": [0.05, 0.5], "robot.noise_m_s": [0.01, 0.02]}
    result = run(tmp_path, vary=vary, controllers=["distributed", "resilient"])
    assert texts(figures.draw(result)).count("refused") == 4


def test_three_keys_are_a_map_for_each_pair(tmp_path: Path) -> None:
    vary = {
        "radio.latency_s": [0.0, 0.1],
        "robot.noise_m_s": [0.01, 0.2],
        "palm.friction": [0.2, 0.3],
    }
    result = run(tmp_path, vary=vary, controllers=["none"])
    figure = figures.draw(result)
    maps = [panel for panel in figure.axes if panel.images]
    assert len(maps) == 3
    rate = 100 * result.values["drop_rate"][0].reshape(2, 2, 2)
    labels = ("radio latency [s]", "robot noise [m/s]", "palm friction")
    for panel, (x, y, gone) in zip(maps, ((0, 1, 2), (0, 2, 1), (1, 2, 0)), strict=True):
        shown = np.asarray(panel.images[0].get_array()).T
        assert shown == pytest.approx(rate.mean(axis=gone))
        assert (panel.get_xlabel(), panel.get_ylabel()) == (labels[x], labels[y])


@pytest.mark.parametrize("kind", ["random", "sobol"])
def test_other_designs_are_drawn_over_each_key(tmp_path: Path, kind: str) -> None:
    vary = {"robot.noise_m_s": NOISE, "object": ["box", "box-strips"]}
    result = run(tmp_path, vary=vary, design={"kind": kind, "points": 32})
    assert {"robot.noise_m_s", "object"} <= set(result.dataset().coords)
    noise, thing = figures.draw(result).axes
    rates = result.values["drop_rate"][0]
    order = np.argsort(result.points.column("robot.noise_m_s"), kind="stable")
    shown = noise.lines[0].get_ydata()
    assert shown == pytest.approx(100 * rates[order, 0].reshape(8, 4).mean(axis=1))
    assert [t.get_text() for t in thing.get_xticklabels()] == ["box", "box-strips"]
    picked = [v == "box" for v in result.points.column("object")]
    at = [t.get_text() for t in thing.get_xticklabels()].index("box")
    assert np.asarray(thing.lines[0].get_ydata())[at] == pytest.approx(
        100 * rates[picked, 0].mean()
    )


def test_panels_show_all_of_their_curves(tmp_path: Path) -> None:
    """Panels share their scale: the first one, in which little happens, must not set it for all."""
    vary = {"palm.friction": {"from": 0.2, "to": 0.3}, "robot.noise_m_s": NOISE}
    result = run(tmp_path, vary=vary, design={"kind": "sobol", "points": 32}, controllers=["none"])
    noises = np.array(result.points.column("robot.noise_m_s"))
    values = result.values | {"drop_rate": (((noises / 0.2) ** 3)[:, None], None)}
    friction, noise = figures.draw(dataclasses.replace(result, values=values)).axes

    def top(panel: Any) -> float:
        bands = [path.vertices[:, 1].max() for c in panel.collections for path in c.get_paths()]
        return max(*bands, *(line.get_ydata().max() for line in panel.lines))

    assert 100 >= top(noise) > 1.2 * top(friction)
    low, high = noise.get_ylim()
    assert -0.05 * high < low < 0 and top(noise) <= high  # a marker at 0 is seen whole
    assert noise.get_ylim() == friction.get_ylim()


def test_axis_numbers_ascend_in_any_order_of_levels(tmp_path: Path) -> None:
    mixed, other = [0.2, 0.01, 0.1], [0.3, 0.2]
    one = run(tmp_path / "one", vary={"robot.noise_m_s": mixed})
    rates = one.values["drop_rate"][0][:, 0]
    line = figures.draw(one).axes[0].lines[0]
    assert line.get_xdata() == pytest.approx([0.01, 0.1, 0.2])
    assert line.get_ydata() == pytest.approx(100 * rates[[1, 2, 0]])
    vary = {"robot.noise_m_s": mixed, "palm.friction": other}
    two = run(tmp_path / "two", vary=vary, controllers=["none"])
    panel, below = figures.draw(two).axes[:2]
    assert [t.get_text() for t in below.get_xticklabels()] == ["0.01", "0.1", "0.2"]
    assert [t.get_text() for t in below.get_yticklabels()] == ["0.2", "0.3"]
    grid = 100 * two.values["drop_rate"][0].reshape(3, 2)
    assert pytest.approx(grid[[1, 2, 0]][:, [1, 0]]) == np.asarray(panel.images[0].get_array()).T
    points = run(
        tmp_path / "points", vary={"robot.noise_m_s": mixed, "palm.friction": NOISE},
        design={"kind": "random", "points": 24},
    )  # fmt: skip
    noise: Any = figures.draw(points).axes[0].lines[0]
    found = points.points.column("robot.noise_m_s")
    assert noise.get_xdata() == pytest.approx(sorted(set(found)))
    picked = [v == 0.01 for v in found]
    rate = points.values["drop_rate"][0][picked, 0].mean()
    assert noise.get_ydata()[0] == pytest.approx(100 * rate)


def test_logarithmic_range_has_a_logarithmic_axis(tmp_path: Path) -> None:
    log = {"from": 0.001, "to": 0.1, "scale": "log"}
    grid = run(tmp_path / "grid", vary={"robot.noise_m_s": {**log, "steps": 3}})
    assert {panel.get_xscale() for panel in figures.draw(grid).axes} == {"log"}
    vary = {"robot.noise_m_s": log, "palm.friction": {"from": 0.2, "to": 0.3}}
    points = run(tmp_path / "points", vary=vary, design={"kind": "random", "points": 16})
    assert [panel.get_xscale() for panel in figures.draw(points).axes] == ["log", "linear"]


def overlaps(labels: list[Any], renderer: Any) -> int:
    boxes = [t.get_window_extent(renderer) for t in labels if t.get_text()]
    return sum(a.overlaps(b) for a, b in itertools.pairwise(boxes))


@pytest.mark.slow
def test_no_words_overlap_or_are_cut_off(tmp_path: Path) -> None:
    log = {"from": 0.02, "to": 0.3, "steps": 4, "scale": "log"}
    fine = {"from": 0.005, "to": 0.03, "steps": 12}
    for k, vary in enumerate(
        (
            {"robot.noise_m_s": [0.01, 0.02, 0.03]},
            {"radio.latency_s": log},
            {"radio.latency_s": log, "robot.noise_m_s": fine},
            {"robot.noise_m_s": fine, "radio.latency_s": log},
            {
                "palm.friction": [0.2, 0.3],
                "robot.noise_m_s": [0.01, 0.02],
                "radio.latency_s": [0.0, 0.1],
            },
        )
    ):
        seeds = {"count": 1}
        result = run(tmp_path / str(k), vary=vary, seeds=seeds, controllers=["distributed"])
        figure: Any = figures.draw(result)
        canvas: Any = FigureCanvasAgg(figure)
        figure.draw_without_rendering()  # which places all words
        renderer = canvas.get_renderer()
        for panel in figure.axes:
            low, high = panel.get_xlim()
            shown = [t for t in panel.get_xticklabels() if low <= t.get_position()[0] <= high]
            assert overlaps(shown, renderer) == 0
            assert overlaps(panel.get_yticklabels(), renderer) == 0
            names = [t.get_text() for t in shown if t.get_text()]
            assert len(names) != 1
        titles = [legend.get_title() for legend in figure.legends]
        for text in [*titles, *([figure._suptitle] if figure._suptitle else [])]:
            box = text.get_window_extent(renderer)
            assert 0 <= box.x0 < box.x1 <= figure.bbox.width


def test_study_without_varied_keys_has_no_figure(tmp_path: Path) -> None:
    with pytest.raises(PalmbotsError, match="plot: nothing varies"):
        figures.draw(run(tmp_path))


def test_sobol_indices_of_ishigami_function() -> None:
    """Ishigami's function on our points; its indices are known in closed form."""
    a, b = 7.0, 0.1
    unit = SALTELLI(3, 2048, 0)
    assert unit.shape == (2048 * 5, 3)
    x = math.pi * (2 * unit - 1)
    y = np.sin(x[:, 0]) + a * np.sin(x[:, 1]) ** 2 + b * x[:, 2] ** 4 * np.sin(x[:, 0])
    keys = ["robot.noise_m_s", "radio.latency_s", "radio.jitter_s"]
    table = {
        "controllers": ["none"],
        "vary": {key: {"from": 0.0, "to": 0.1} for key in keys},
        "design": {"kind": "sobol-indices", "points": 8},
    }
    points = design_points(load_plan(table))
    assert points.shape == (40,)
    half = np.zeros((len(y), 1, 2))
    found = sobol_indices(
        points, {"drop_rate": (y[:, None], half), "rms_m": (y[:, None] * 0, half)}
    )
    v = a**2 / 8 + b * math.pi**4 / 5 + b**2 * math.pi**8 / 18 + 0.5
    first = [0.5 * (1 + b * math.pi**4 / 5) ** 2 / v, a**2 / 8 / v, 0.0]
    total = [first[0] + 8 * b**2 * math.pi**8 / 225 / v, first[1], 8 * b**2 * math.pi**8 / 225 / v]
    assert [i.key for i in found] == keys, "and none of a metric that never changes"
    assert [i.first for i in found] == pytest.approx(first, abs=0.04)
    assert [i.total for i in found] == pytest.approx(total, abs=0.04)
    assert all(0 < i.total_half < 0.1 for i in found)


def test_index_intervals_cover_the_scatter() -> None:
    """Other points scatter by no more than the bootstrap says, which does not know how even they
    are; and it says the same each time."""
    keys = ["robot.noise_m_s", "radio.latency_s", "radio.jitter_s"]
    table = {
        "controllers": ["none"],
        "vary": {key: {"from": 0.0, "to": 0.1} for key in keys},
        "design": {"kind": "sobol-indices", "points": 8},
    }
    points = design_points(load_plan(table))

    def values(seed: int) -> list[SobolIndex]:
        x = math.pi * (2 * SALTELLI(3, 256, seed) - 1)
        y = (np.sin(x[:, 0]) * (1 + 0.1 * x[:, 2] ** 4) + 7 * np.sin(x[:, 1]) ** 2)[:, None]
        return sobol_indices(points, {"drop_rate": (y, None), "rms_m": (0 * y, None)})

    several = [values(seed) for seed in range(12)]
    assert values(11) == several[11]
    for k in range(3):
        for name in ("first", "total"):
            scatter = np.std([getattr(one[k], name) for one in several], ddof=1)
            half = np.mean([getattr(one[k], f"{name}_half") for one in several])
            assert 0.8 * 1.96 * scatter < half < 0.3


def test_noise_decides_without_a_controller(tmp_path: Path) -> None:
    """Without a controller the radio can decide nothing, and noise everything."""
    result = run_study(
        load_plan(
            {
                "controllers": ["none"],
                "vary": {"radio.latency_s": {"from": 0.0, "to": 0.2}, "robot.noise_m_s": NOISE},
                "design": {"kind": "sobol-indices", "points": 32},
                "seeds": {"count": 10},
                "set": {"task.distance_m": 0.3},
            }
        ),
        tmp_path / "study",
    )
    by_key = {i.key: i for i in sobol_indices(result.points, result.values) if i.metric == "rms_m"}
    assert by_key["radio.latency_s"].total == 0
    assert by_key["robot.noise_m_s"].total > 0.7
    figure = figures.draw(result)
    names = [t.get_text() for t in figure.axes[0].get_yticklabels()]
    assert names == ["radio latency", "robot noise"]
    for panel, metric in zip(figure.axes, ("drop_rate", "rms_m"), strict=True):
        assert panel.get_title() == {"drop_rate": "drop rate", "rms_m": "contact rms"}[metric]
        one = {i.key: i for i in sobol_indices(result.points, result.values) if i.metric == metric}
        mine = [one["radio.latency_s"], one["robot.noise_m_s"]]
        bars = {
            kind.get_label(): [bar.get_width() for bar in kind]
            for kind in panel.containers
            if isinstance(kind, BarContainer)
        }
        assert bars["none, total"] == pytest.approx([i.total for i in mine])
        assert bars["none, alone"] == pytest.approx([max(i.first, 0) for i in mine])
        whiskers = [np.asarray(path.vertices)[:, 0] for path in panel.collections[0].get_paths()]
        for index, ends in zip(mine, whiskers, strict=True):
            assert np.ptp(ends) == pytest.approx(2 * index.total_half)


def test_constant_drop_rate_has_no_indices(tmp_path: Path) -> None:
    """The legend still has all entries, and entries of a list have names of their own."""
    vary = {
        "object.com_m[0]": {"from": 0.12, "to": 0.13},
        "object.com_m[1]": {"from": 0.02, "to": 0.03},
    }
    result = run(tmp_path, vary=vary, design={"kind": "sobol-indices", "points": 8})
    assert not result.values["drop_rate"][0].any()
    figure = figures.draw(result)
    assert texts(figure) == ["is the same at all points"]
    (legend,) = figure.legends
    assert len(legend.get_texts()) == 4
    names = {t.get_text() for t in figure.axes[0].get_yticklabels()}
    assert names == {"object com [0]", "object com [1]"}


def test_command_writes_the_figure_and_prints_the_table(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text("[vary]\nrobot.noise_m_s = [0.01, 0.02]\n[seeds]\ncount = 3\n")
    assert cli.run(["study", "s.toml", "--plot"]) == 0
    out = capsys.readouterr().out
    assert "wrote s.study/study.png" in out
    assert "12 carries" in out
    assert Path("s.study/study.png").read_bytes().startswith(b"\x89PNG")


def test_table_of_a_random_design_has_few_digits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Keys have four digits, and only a few of many refusals are listed."""
    monkeypatch.chdir(tmp_path)
    Path("s.toml").write_text(
        'controllers = ["resilient"]\n[vary]\nradio.latency_s = { from = 0.5, to = 0.6 }\n'
        '[design]\nkind = "random"\npoints = 5\n[seeds]\ncount = 3\n'
    )
    assert cli.run(["study", "s.toml"]) == 0
    out = capsys.readouterr().out
    first = design_points(load_plan("s.toml")).column("radio.latency_s")[0]
    assert f"radio.latency_s = {first:.4g}\n" in out
    assert repr(first) not in out
    assert "5 cells refused in total" in out
    assert out.count("resilient refuses radio.latency_s = ") <= 3
    Path("n.toml").write_text(
        'controllers = ["resilient"]\n[set]\nradio.latency_s = 0.5\n[seeds]\ncount = 3\n'
    )
    assert cli.run(["study", "n.toml"]) == 0
    assert "resilient refuses: radio.lease_s" in capsys.readouterr().out
