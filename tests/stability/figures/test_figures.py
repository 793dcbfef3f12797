# SPDX-License-Identifier: Apache-2.0
"""Figures 2 to 7: they show what the analysis found, for any scene, legibly and reproducibly."""

import math
from collections.abc import Iterator
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.path import Path as Outline
from matplotlib.text import Text
from numpy.typing import NDArray

import palmbots as pb
from palmbots._types import SIDES, Side
from palmbots.errors import PalmbotsError
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.analysis_figures import draw_all
from palmbots.stability.figures.canvas import clipped
from palmbots.stability.figures.cone_figures import figure3, figure4
from palmbots.stability.figures.drawn_state import state_of
from palmbots.stability.figures.region_figures import figure5, figure6
from palmbots.stability.figures.sensor_figure import figure7, readings
from palmbots.stability.linear_conditions import failing
from palmbots.stability.problem import permitted, stability_problem
from palmbots.viz.style import styled

CORNERS = [[0.0, 0.0], [0.2, 0.0], [0.26, 0.12], [-0.02, 0.14]]
TRAPEZOID: dict[str, Any] = {
    "object": {"vertices_m": CORNERS, "com_m": [0.105, 0.05]},
    "palm": {
        "friction": 0.35,
        "left": {"length_m": 0.12, "steep_deg": 18.0},
        "right": {"length_m": 0.18, "friction": 0.25, "shallow_deg": 8.0, "pivot_offset_m": 0.02},
    },
    "task": {"slope_deg": 3.0},
}
SIDED = [f"{name}_{side}" for name in ("theta", "friction", "offset") for side in SIDES]
ANGLES = ("theta_left_deg", "theta_right_deg")
ZONES = [
    {"sign": "-", "from_m": -0.075, "to_m": 0.002},
    {"sign": "0", "from_m": -0.004, "to_m": 0.004},
    {"sign": "+", "from_m": 0.002, "to_m": 0.05},
]
SCENES: dict[str, tuple[Any, dict[str, Any]]] = {
    "paper": ("paper", {}),
    "phi below theta": ("paper", {"palm.friction": 0.2}),
    "phi above theta": ("paper", {"palm.friction": 0.5}),
    "offset": ("paper-offset", {}),
    "trapezoid": (TRAPEZOID, {}),
    "zones": ("paper", {"tactile.zones": ZONES}),
    "flat": ("paper", {"palm.shallow_deg": 0.0, "palm.steep_deg": 10.0}),
    "wedged": ("paper", {"palm.friction": 3.0}),
}


def random_table(rng: np.random.Generator) -> dict[str, Any]:
    """A scene with any palms and outlines on feet, on a keel and not convex among others."""
    w, h, a, b = (float(x) for x in rng.uniform((0.08, 0.05, -0.1, -0.1), (0.5, 0.45, 0.1, 0.1)))
    foot, sole = 0.2 * w, 0.2 * min(w, h)
    inner = [[foot, 0.0], [foot, sole], [w - foot, sole], [w - foot, 0.0]]
    outlines = [
        [[0.0, 0.0], [w, 0.0], [w + a * w, h], [-b * w, h]],
        [[0.0, 0.0], *inner, [w, 0.0], [w, h], [0.0, h]],
        [[0.0, 0.0], [w / 2, -sole], [w, 0.0], [w + a * w, h], [-b * w, h]],
        [[0.0, 0.0], [w, 0.0], [w, sole], [foot, sole], [foot, h], [0.0, h]],
    ]
    kind = rng.integers(len(outlines))
    height = float(rng.uniform(0.3, 0.9)) * sole if kind == 3 else 0.4 * h

    def palm() -> dict[str, float]:
        names = ("length_m", "friction", "shallow_deg", "steep_deg", "pivot_offset_m")
        least, most = (0.05, 0.05, -4.0, 0.5, -0.01), (0.2, 0.9, 14.0, 14.0, 0.02)
        found = dict(zip(names, rng.uniform(least, most).tolist(), strict=True))
        return found | {"steep_deg": found["shallow_deg"] + found["steep_deg"]}

    return {
        "object": {
            "vertices_m": outlines[kind],
            "contacts": [0, outlines[kind].index([w, 0.0])],
            "com_m": [w * float(rng.uniform(0.25, 0.75)), height],
        },
        "palm": palm() | ({"right": palm()} if rng.random() < 0.5 else {}),
        "task": {"slope_deg": float(rng.choice([0.0, rng.uniform(-5, 5)]))},
        "tactile": {"zones": ZONES} if rng.random() < 0.5 else {},
    }


def random_analyses(count: int, seed: int) -> Iterator[Analysis]:
    rng = np.random.default_rng(seed)
    while count:
        try:
            found = pb.analyze(random_table(rng))
        except PalmbotsError:  # the object does not reach across these palms
            continue
        count -= 1
        yield found


SHORT = ("phi below theta", "phi above theta")  # the others take long


@pytest.fixture(
    scope="module",
    params=[*SHORT, *(pytest.param(s, marks=pytest.mark.soak) for s in SCENES if s not in SHORT)],
)
def analysis(request: pytest.FixtureRequest) -> Analysis:
    source, overrides = SCENES[request.param]
    return pb.analyze(source, overrides=overrides)


@pytest.fixture(scope="module")
def figures(analysis: Analysis) -> dict[str, Figure]:
    return draw_all(analysis)


@pytest.fixture(scope="module")
def paper() -> Analysis:
    return pb.analyze("paper")


def polygons(axes: Axes, gid: str) -> list[NDArray[np.float64]]:
    found = [patch for patch in axes.patches if patch.get_gid() == gid]
    return [np.asarray(patch.get_xy(), float) for patch in found if isinstance(patch, Polygon)]


def shades(axes: Axes, gid: str, x: float, y: float) -> bool:
    return any(Outline(polygon).contains_point((x, y)) for polygon in polygons(axes, gid))


def shown_texts(figure: Figure) -> list[Text]:
    """All texts that are drawn; tick labels only if they are in view."""
    found: list[Text] = []
    labels: set[int] = set()
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            for tick in axis.get_major_ticks():
                labels |= {id(tick.label1), id(tick.label2)}
                if low <= tick.get_loc() <= high and tick.label1.get_visible():
                    found.append(tick.label1)
    others = [text for text in figure.findobj(Text) if isinstance(text, Text)]
    found += [text for text in others if text.get_visible() and id(text) not in labels]
    return [text for text in found if text.get_text()]


def rows(figure: Figure) -> list[str]:
    return [row for text in shown_texts(figure) for row in text.get_text().split("\n")]


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


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.soak)])
def test_every_figure_of_random_scenes(seed: int) -> None:
    for found in random_analyses(3, seed):
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
        theta = dict(zip(ANGLES, map(math.degrees, state.angles), strict=True))
        try:
            found = pb.modes(analysis.scene, p_left_m=left, p_right_m=right, **theta)
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


def planes(figure: Figure) -> Iterator[tuple[Axes, int, Side]]:
    for k, axes in enumerate(figure.axes):
        yield axes, 1 + k % 2, SIDES[k // 2]


def test_figure_5_draws_the_band(analysis: Analysis, figures: dict[str, Figure]) -> None:
    at = analysis.problem
    for axes, number, shallow in planes(figures["figure5"]):
        band, angles = analysis.bands[number, shallow], at.palms(shallow)
        base = at.offset[1] * math.cos(angles[1]) - at.offset[0] * math.cos(angles[0])
        gain = 1e-3 * np.array([-math.sin(angles[0]), math.sin(angles[1])])
        reach = np.array(list(product(axes.get_xlim(), axes.get_ylim()))) @ gain + base
        for gid, k in (("k_lower", band.k_lower), ("k_upper", band.k_upper)):
            lines = [line for line in axes.lines if line.get_gid() == gid]
            assert len(lines) == (k is not None and reach.min() < k < reach.max())
            for line in lines:
                assert np.asarray(line.get_xydata()) @ gain + base == pytest.approx(k, abs=1e-12)


@pytest.mark.parametrize("scenes", [1, pytest.param(5, marks=pytest.mark.soak)])
def test_figure_5_shades_what_fails(scenes: int) -> None:
    """Random contacts, outside the palms too, against the mode that happens there."""
    rng = np.random.default_rng(8)
    counted = {True: 0, False: 0}
    order = ("SL", "ST"), ("ST", "SR"), ("ST", "SL"), ("SR", "ST")
    wanted = [pb.mechanics.CONTACT_MODES.index(mode) for mode in order]
    for found in [pb.analyze(TRAPEZOID), *random_analyses(scenes, 21)]:
        at = found.problem
        for axes, number, shallow in planes(figure5(found)):
            angles, mode = at.palms(shallow), wanted[2 * number - 2 + SIDES.index(shallow)]
            x, y = rng.uniform(*axes.get_xlim(), 60), rng.uniform(*axes.get_ylim(), 60)
            z = 1e-3 * (y * math.sin(angles[1]) - x * math.sin(angles[0]))
            z += at.offset[1] * math.cos(angles[1]) - at.offset[0] * math.cos(angles[0])
            bad = [failing(form, at.width) for form in at.forms(number, shallow, angles)]
            ends = [end for interval in bad if interval for end in interval]
            values = (at.width, *at.com, *angles, *at.friction, *at.offset, at.slope)
            given = dict(zip(("width", "com_x", "com_y", *SIDED, "slope"), values, strict=True))
            happens = pb.modes_batch(p_left=1e-3 * x, p_right=1e-3 * y, **given)
            modes = happens.closing if number == 1 else happens.opening
            for k in range(60):
                if abs(z[k]) > 0.99 * at.width or any(abs(z[k] - end) < 1e-6 for end in ends):
                    continue
                shaded = shades(axes, "fails", x[k], y[k])
                assert shaded == (modes[k] != mode)
                counted[shaded] += 1
    assert min(counted.values()) > 100


def test_figure_5_of_the_paper_and_its_panels(paper: Analysis) -> None:
    figure = figure5(paper)
    first, second = figure.axes
    (region,) = polygons(first, "region")
    assert {tuple(p) for p in region} == {(-75, -75), (0, -75), (0, 75), (-75, 75)}
    (region,) = polygons(second, "region")
    assert {tuple(p) for p in region} == {(-75, 0), (75, 0), (75, 75), (-75, 75)}
    texts = " ".join(rows(figure))
    assert "k_lower = −244.1 mm, k_upper = 64.9 mm" in texts
    assert "fails first at E (−75.0, 75.0): driven together" in texts
    assert "travel margin 112.7 mm" in texts
    shifted = pb.analyze("paper", overrides={"object.com_m": [0.124, 0.04]})
    assert len(figure5(shifted).axes) == 4  # no longer its own mirror image


def test_figure_5_labels_the_arrow_once(analysis: Analysis) -> None:
    """The arrow is the travel margin; k_upper and k_lower stand by the lines they are of."""
    figure = figure5(analysis)
    with styled():
        figure.draw_without_rendering()
    for axes, number, shallow in planes(figure):
        inside = [t for t in axes.texts if axes.bbox.contains(*t.get_window_extent().p0)]
        texts = {text.get_text(): text for text in inside if text.get_text()}
        arrows = [text for text in axes.texts if getattr(text, "arrow_patch", None)]
        margins = analysis.properties[number, shallow].margins
        labels = [] if not arrows else [f"travel margin {1e3 * (margins.travel_m or 0.0):.1f}"]
        lines = {str(line.get_gid()): line for line in axes.lines if line.get_gid()}
        assert set(texts) == {"E", "F", *labels, *lines}
        for name, line in lines.items():
            at = texts[name].get_window_extent().get_points().mean(axis=0)
            ends = axes.transData.transform(np.asarray(line.get_xydata()))
            assert away(at, ends) < 0.5 * figure.dpi  # half an inch
            for other in labels:
                box = texts[other].get_window_extent().get_points()
                assert away(at, ends) < away(box.mean(axis=0), ends)


def away(point: NDArray[np.float64], segment: NDArray[np.float64]) -> float:
    """The distance of a point from a segment."""
    along = segment[1] - segment[0]
    share = np.clip((point - segment[0]) @ along / (along @ along), 0.0, 1.0)
    return float(np.hypot(*(segment[0] + share * along - point)))


@pytest.mark.parametrize("scenes", [2, pytest.param(10, marks=pytest.mark.soak)])
def test_figure_6_shades_the_permitted_coms(scenes: int) -> None:
    """Random COMs in the outline are shaded exactly where the core permits them."""
    rng = np.random.default_rng(1)
    counted = {True: 0, False: 0}
    for found in [pb.analyze("paper"), pb.analyze(TRAPEZOID), *random_analyses(scenes, 30)]:
        at = found.problem
        corners = np.array([(x, y) for x, _, y in at.spec.outline])
        points = rng.uniform(corners.min(axis=0), corners.max(axis=0), (60, 2))
        panels = figure6(found).axes
        for x, y in points[Outline([*corners, corners[0]]).contains_points(points)]:
            envelope = at.envelope(com_y=(y, y))
            allowed: list[bool] = []
            for number, side in product((1, 2), SIDES):
                low, high = permitted(envelope, number, side, at.angles)
                allowed.append(low <= x <= high)
                if min(abs(x - low), abs(x - high)) > 1e-7:
                    shaded = shades(panels[number - 1], side, 1e3 * x, 1e3 * y)
                    assert shaded == allowed[-1], (number, side, x, y)
                    counted[shaded] += 1
            assert shades(panels[2], "both", 1e3 * x, 1e3 * y) == all(allowed)
    assert min(counted.values()) > 200


def test_figure_6_dimensions_are_the_ranges(paper: Analysis) -> None:
    texts = [{t.get_text() for t in axes.texts} for axes in figure6(paper).axes]
    assert {"108.5 – 246.9", "3.1 – 141.5"} <= texts[0]
    assert {"4.2 – 217.8", "32.2 – 245.8"} <= texts[1]
    assert "108.5 – 141.5" in texts[2]
    narrow = pb.analyze("paper", overrides={"object.com_m": [0.125, 0.15], "palm.friction": 0.5})
    assert "none at this height" in rows(figure6(narrow))


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
