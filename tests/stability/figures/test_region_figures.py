# SPDX-License-Identifier: Apache-2.0
"""Figures 5 and 6: the regions that they shade are those in which the properties hold."""

import math
from itertools import product

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.path import Path as Outline
from numpy.typing import NDArray

import palmbots as pb
from palmbots._types import SIDES
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.region_figures import figure5, figure6
from palmbots.stability.linear_conditions import failing
from palmbots.stability.problem import permitted
from palmbots.viz.style import styled
from stability_figures import (
    SIDED,
    TRAPEZOID,
    planes,
    polygons,
    random_analyses,
    rows,
    shades,
)


def test_figure_5_draws_the_band(analysis: Analysis, figures: dict[str, Figure]) -> None:
    at = analysis.problem
    for axes, number, shallow in planes(figures["figure5"]):
        band, angles = analysis.bands[number, shallow], at.palms(shallow)
        base = at.offset[1] * math.cos(angles[1]) - at.offset[0] * math.cos(angles[0])
        gain = 1e-3 * np.array([-math.sin(angles[0]), math.sin(angles[1])])
        reach = np.array(list(product(axes.get_xlim(), axes.get_ylim()))) @ gain + base
        for name, k in (("lower", band.k_lower), ("upper", band.k_upper)):
            lines = [line for line in axes.lines if name in str(line.get_gid())]
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
            happens = pb.contact_modes_batch(p_left=1e-3 * x, p_right=1e-3 * y, **given)
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
    assert "$k_\\mathrm{lower}$ = −244.1 mm, $k_\\mathrm{upper}$ = 64.9 mm" in texts
    assert "fails first at E (−75.0, 75.0): on closing" in texts
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
        corners = np.array([(x, y) for x, _, y, _ in at.spec.outline])
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
