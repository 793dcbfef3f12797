# SPDX-License-Identifier: Apache-2.0
"""Figures 2 to 4 and 7, and the legibility of all: they show the analysis of any scene."""

import math
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.analysis_figures import draw_all
from palmbots.stability.figures.canvas import clipped
from palmbots.stability.figures.cone_figures import figure3, figure4
from palmbots.stability.figures.drawn_state import state_of
from palmbots.stability.figures.lifting_figure import lifting_forces
from palmbots.stability.figures.sensor_figure import figure7, readings
from palmbots.stability.problem import stability_problem
from palmbots.viz.style import styled
from sampled import amounts
from stability_figures import (
    ANGLES,
    ZONES,
    random_analyses,
    rows,
    shown_texts,
)


def check(figures: dict[str, Figure]) -> None:
    """Axes named with units; texts of at least 7 pt, on the page, apart from each other."""
    assert list(figures) == [f"figure{k}" for k in range(2, 8)]
    for name, figure in figures.items():
        with styled():
            figure.draw_without_rendering()
            texts = shown_texts(figure)
            boxes = [(text.get_text(), text.get_window_extent()) for text in texts]
        assert all("[" in axes.get_xlabel() for axes in figure.axes), name
        first = figure.axes[0]  # the others of a row share its label
        assert "[" in first.get_ylabel() or "switches" in rows(figure), name
        assert min(float(text.get_fontsize()) for text in texts) >= 7, name
        for text, box in boxes:
            assert box.x0 >= 0 and box.x1 <= figure.bbox.width, (name, text)
            assert box.y0 >= 0 and box.y1 <= figure.bbox.height, (name, text)
        for (one, box), (two, other) in combinations(boxes, 2):
            wide = min(box.x1, other.x1) - max(box.x0, other.x0)
            assert min(wide, min(box.y1, other.y1) - max(box.y0, other.y0)) <= 1, (name, one, two)


def test_every_figure_of_every_scene(figures: dict[str, Figure]) -> None:
    check(figures)
    for name in ("figure2", "figure3", "figure4", "figure5", "figure6"):  # drawn to scale
        unit = figures[name].axes[0].transData.transform([(0, 0), (1, 0), (0, 1)])
        assert unit[1, 0] - unit[0, 0] == pytest.approx(unit[2, 1] - unit[0, 1], rel=1e-6)


@pytest.mark.parametrize("scenes", amounts(1, 6))
def test_every_figure_of_random_scenes(scenes: int) -> None:
    for found in random_analyses(scenes, 0):
        check(draw_all(found))


def test_figure_2_names_every_symbol(analysis: Analysis, figures: dict[str, Figure]) -> None:
    texts = set(rows(figures["figure2"]))
    assert {"w", "d", "$c_x$", "$c_y$", "COM", "$C_L$", "$C_R$"} <= texts
    for letter, offset in zip("LR", analysis.problem.offset, strict=True):
        assert {f"$\\theta_{letter}$", f"$p_{letter}$"} <= texts
        assert (f"$o_{letter}$" in texts) == (offset != 0)
    assert {"ϑ", "ϑ = 0"} & texts


def test_the_state_closes_the_loop_and_agrees_with_modes(analysis: Analysis) -> None:
    rng = np.random.default_rng(2)
    compared = 0
    for _ in range(20):
        left, right = (float(rng.uniform(-half, half)) for half in analysis.problem.half_length)
        state = state_of(analysis.problem, (left, right))
        corner = state.point("outline")[analysis.problem.spec.contact_right]
        assert corner == pytest.approx(state.point("contact", 1), abs=1e-9)
        theta: dict[str, Any] = dict(zip(ANGLES, map(math.degrees, state.angles), strict=True))
        try:
            found = pb.contact_modes(analysis.scene, p_left_m=left, p_right_m=right, **theta)
        except PalmbotsError:  # the state would put a palm into the object
            continue
        compared += 1
        assert math.degrees(state.turn) == pytest.approx(found.object_deg)
        assert state.balances == set(found.feasible)
        assert state.closing == found.closing
    assert compared > 3


def test_figure_3_gravity_crosses_the_cones_where_st_st_balances() -> None:
    """The cones as they are drawn, cut from a large square, against the modes of the core."""
    rng = np.random.default_rng(3)
    verdicts: list[bool] = []
    for k in range(60):
        x, friction = rng.uniform((0.02, 0.03), (0.23, 0.25)).tolist()
        scene = pb.load_scene("paper", {"palm.friction": friction, "object.com_m": [x, 0.05]})
        state = state_of(stability_problem(scene), (-0.02, 0.02))
        common = 1e7 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        for side, slide in product((0, 1), (1, -1)):
            way = state.edge(side, slide)
            out = slide * (1, -1)[side] * np.array([way[1], -way[0]])
            common = clipped(common, out, float(out @ state.point("contact", side)))
        x = state.point("com")[0]
        crosses = bool(len(common)) and common[:, 0].min() <= x <= common[:, 0].max()
        assert crosses == (("ST", "ST") in state.balances)
        verdicts.append(crosses)
        if k < 6:
            titles = [axes.get_title(loc="left") for axes in figure3(state).axes]
            for mode, title in zip((("ST", "ST"), ("SL", "ST")), titles, strict=True):
                assert ("does not" in title) == (mode not in state.balances)
    assert 5 < sum(verdicts) < 55


def test_figure_4_heights_are_the_papers() -> None:
    """Equations (2) to (4), from the paper's own quantities, for φ < θ."""
    p, shallow, steep, phi = (-0.03, 0.04), math.radians(5), math.radians(15), math.atan(0.2)
    left, right = p[0] * math.sin(shallow), p[1] * math.sin(steep)
    turn = math.asin((right - left) / 0.25)
    q = s = math.hypot(0.125, 0.04)
    gamma = delta = math.atan2(0.04, 0.125)
    heights = {
        "L₁": q * math.cos(turn + gamma) / math.tan(shallow + phi) + left,
        "R₁": s * math.cos(delta - turn) / math.tan(steep + phi) + right,
        "R₂": s * math.cos(delta - turn) / math.tan(steep - phi) + right,
    }
    found = rows(
        figure4(state_of(stability_problem(pb.load_scene("paper", {"palm.friction": 0.2})), p))
    )
    for name, height in heights.items():
        row = next(row for row in found if row.startswith(f"{name}  "))
        assert row.endswith(f": {1e3 * height:.0f}")
    found = rows(
        figure4(state_of(stability_problem(pb.load_scene("paper", {"palm.friction": 0.5})), p))
    )
    assert next(row for row in found if row.startswith("R₂  ")).endswith("*")
    assert any("behind a contact" in row for row in found)


def test_figure_7_readings_follow_the_rule_of_the_sensor(paper: Analysis) -> None:
    default = [(-1, -math.inf, -5.0), (0, -5.0, 5.0), (1, 5.0, math.inf)]
    assert readings(default, 75) == [(-1, -75, -5), (0, -5, 5), (1, 5, 75)]
    zones = [(-1, -75.0, 2.0), (0, -4.0, 4.0), (1, 2.0, 50.0)]
    assert readings(zones, 75) == [(-1, -75, -4), (0, -4, 4), (1, 4, 50), (0, 50, 75)]
    assert readings([], 30) == [(0, -30, 30)]
    figure = figure7(paper.scene.tactile, paper.problem.spec)
    assert "layout assumed" in " ".join(rows(figure))
    assert figure.axes[0].get_xlim() == figure.axes[1].get_xlim()[::-1]  # outward on either side
    given = pb.analyze("paper", overrides={"tactile.zones": ZONES})
    assert "assumed" not in " ".join(rows(figure7(given.scene.tactile, given.problem.spec)))


@pytest.mark.parametrize("keys", [{}, {"palm.heel_m": 0.0, "palm.nose_m": 1e-4}])
def test_squeezes_of_the_lifting_figure_are_those_of_the_table(keys: dict[str, float]) -> None:
    analysis = pb.analyze("lift", overrides=keys)
    assert analysis.lifting is not None
    titles = [axes.get_title(loc="left") for axes in lifting_forces(analysis).axes]
    first, second = (title for title in titles if "gets under" in title)
    assert f"H = {analysis.lifting.palms.left.squeeze_n:.2f} N" in first
    assert f"H = {analysis.lifting.palms.right.second_n:.2f} N" in second
