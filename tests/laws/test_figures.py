# SPDX-License-Identifier: Apache-2.0
"""Figures have one style: units on their axes, colours for every kind of vision, the same file
whenever they are drawn, and no effect on the caller's matplotlib.

Of every figure in the registry.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import matplotlib
import numpy as np
import pytest
from matplotlib.cm import ScalarMappable
from matplotlib.collections import Collection
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Patch
from matplotlib.text import Text

import palmbots as pb
from palmbots import viz
from palmbots.assessment.page import _outcomes
from palmbots.control.registry import shipped_names
from palmbots.fitting.object_fit import fit_object, touch_of
from palmbots.mujoco.route_carry import carry_route
from palmbots.mujoco.validation.speed_limits import Limit, Pace, SpeedLimits
from palmbots.optimum.design_law import KEYS, DesignLaw, LawPoint
from palmbots.scene.scene import Scene
from palmbots.simulation.outcome_counts import count_outcomes
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import run_study
from palmbots.viz import style
from recordings import HIDDEN, gilbert, packets_csv, recorded
from sampled import amounts
from shape_files import svg, written
from short_route import short_plan
from short_validation import short_validation
from study_fixtures import SMALL

pytestmark = pytest.mark.slow

SHORT = {"task.distance_m": 0.2}
COARSE: dict[str, Any] = {"relative_half_width": 0.1, "overrides": SHORT}
ARC = {"task.path.kind": "arc", "task.path.radius_m": 0.5, **SHORT}

# What labels may state in square brackets, and labels that have no unit.
UNITS = {"%", "cm/s", "m", "m/s", "m/s²", "mm", "ms", "s", "weight", "°"}
WITHOUT_UNIT = {
    "correction\n(case)",
    "density of the residuals",
    "fitted lead of the left contact\n(difference of squeezes over the weight)",
    "friction μ",
    "messages per metre",
    "multiple of the scene's value",
    "number of bursts",
    "packets lost together, at least",
    "palm friction",
    "readings",
    "residual / its standard deviation",
    "sensor",
    "share of packets with more",
    "share of the variance (Sobol index)",
    "slides",
    "tolerance of friction, ±",
}


def speed_limits() -> SpeedLimits:
    """Two frictions and two speeds, as if they had been measured."""
    limits = [
        Limit(friction, closing, forward, "left" if closing else "right", 1.0, 1.1)
        for friction in (0.2, 0.3)
        for closing in (True, False)
        for forward in (True, False)
    ]
    paces = [Pace(speed, 4, (4, 3), (0.004, 0.005), (0.01, 0.012)) for speed in (0.06, 0.12)]
    return SpeedLimits(Scene(), tuple(limits), tuple(paces), 0.5)


def results(folder: Path) -> Iterator[tuple[str, Any]]:
    """A small result for every registered figure; studies have several."""
    carry = pb.carry("paper", overrides=SHORT)
    for name in ("carry", "timeline", "message_sequence", "side_view"):
        yield name, carry
    curved = pb.carry("paper", world="mujoco", overrides=ARC)
    yield "carry", curved  # one more panel
    yield "plan_view", curved
    yield "route", short_plan()
    yield "route", carry_route(plan=short_plan())
    yield "lift_phases", pb.carry("lift", "shared-sign")
    yield "lift_phases", pb.carry("lone", "shared-sign")
    yield "sweep", pb.compare("paper", values=[0.0, 0.2], carries=2, overrides=SHORT)
    analysis = pb.analyze("paper")
    for name in ("stability-geometry", "friction-cones", "meeting-points", "operating-region",
                 "permitted-com", "tactile-zones"):  # fmt: skip
        yield name, analysis
    yield "lifting-forces", pb.analyze("lift")
    for quantity in ("com", "friction"):  # with a unit and without
        angles: dict[str, Any] = {"angle_range_deg": (5, 15), "resolution_deg": 5}
        yield "palm-angles", pb.design("paper", maximize=quantity, overrides=SHORT, **angles)
    yield "noise_limit", pb.noise_limit("paper", drop_rate=0.2, **COARSE)
    yield "probe", pb.probe("paper", com_x_m=(0.12, 0.13), angle_range_deg=(5, 7))
    yield "bound", pb.bound("paper", "corrections", overrides=SHORT)
    law = [LawPoint(key, f, 0.04 * f, 0.041 * f) for key in KEYS for f in (1.0, 2.0)]
    yield "design-law", DesignLaw(tuple(law), Scene())
    drawing = written(folder / "box.svg", svg('<rect width="200" height="100"/>'))
    yield "imported-object", pb.import_object(drawing)
    files = recorded(folder, HIDDEN, seed=1, stretches=6)
    yield "motion-fit", pb.fit(files, motion=True)
    kept = np.flatnonzero(~gilbert(np.random.default_rng(1), 2000, 0.05, 0.05, 3.0)).astype(float)
    packets = packets_csv(folder, "packets.csv", "index,time_s", kept, 0.05 * kept)
    yield "radio-fit", pb.fit([packets], radio=True)
    touch = touch_of(pb.carry("paper", "shared-sign", overrides=SHORT), "carry.mcap")
    yield "object-fit", fit_object([touch], ())
    yield "validation", short_validation()
    yield "speed_limits", speed_limits()
    ranges = {
        "palm.friction": {"from": 0.2, "to": 0.3},
        "robot.noise_m_s": {"from": 0.0, "to": 0.1},
    }
    sobol = {"vary": ranges, "design": {"kind": "sobol-indices", "points": 4}}
    for k, table in enumerate(({}, {"vary": {"palm.friction": [0.2, 0.3]}}, sobol)):
        plan = load_plan({**SMALL, "set": SHORT, "seeds": {"count": 2}, **table})
        yield "study", run_study(plan, folder / str(k))


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, Any, Figure]]:
    """Name, result and figure; drawing leaves the caller's settings alone."""
    made = list(results(tmp_path_factory.mktemp("studies")))
    before = dict(matplotlib.rcParams)
    found = [(name, result, viz.FIGURES.get(name)(result)) for name, result in made]
    assert dict(matplotlib.rcParams) == before
    return found


def test_every_registered_figure_is_drawn(drawn: list[tuple[str, Any, Figure]]) -> None:
    assert {name for name, *_ in drawn} == set(viz.FIGURES.names())


def test_every_result_draws_its_figures(drawn: list[tuple[str, Any, Figure]]) -> None:
    """By their names, as `plot` is asked for them."""
    own = {type(result): {result.figure, *result.more_figures} for _, result, _ in drawn}
    shown: dict[type, set[str]] = {kind: set() for kind in own}
    for name, result, _ in drawn:
        shown[type(result)].add(name)
    assert all(own[kind] <= names for kind, names in shown.items())


def test_the_unit_stands_last_in_square_brackets(drawn: list[tuple[str, Any, Figure]]) -> None:
    seen: set[str] = set()
    for name, _, figure in drawn:
        for axes in figure.axes:
            for label in (axes.get_xlabel(), axes.get_ylabel()):
                units = re.findall(r"\[(.*?)\]$", label, re.MULTILINE)
                expected = 0 if label in WITHOUT_UNIT | {""} else 1
                assert label.count("[") == len(units) == expected, (name, label)
                assert set(units) <= UNITS, (name, label)
                seen |= set(units) or {label}
    assert seen >= UNITS  # no unit is listed for nothing


def half_hidden(figure: Figure) -> Iterator[str]:
    """The labels of axes on whose edge, within the width of the marker, a value of 0 is marked."""
    figure.draw_without_rendering()
    for axes in figure.axes:
        for line in axes.lines:
            if line.get_marker() in ("None", "", None) or line.get_transform() != axes.transData:
                continue
            least = 0.5 * line.get_markersize() * figure.dpi / 72
            box = axes.bbox
            for k, (label, edge) in enumerate(
                ((axes.get_xlabel(), box.x0), (axes.get_ylabel(), box.y0))
            ):
                points = np.array(line.get_xydata(), float)
                zero = points[points[:, k] == 0]
                if len(zero) and abs(axes.transData.transform(zero)[:, k] - edge).min() < least:
                    yield label or str(line.get_label())


def test_a_marker_at_zero_does_not_stand_on_the_axis(
    drawn: list[tuple[str, Any, Figure]],
) -> None:
    """A rate of 0 % is seen as well as others."""
    figures = [(name, viz.FIGURES.get(name)(result)) for name, result, _ in drawn]
    found = [(name, [*half_hidden(one)]) for name, one in figures]
    counts = [count_outcomes("paper", name, seeds=20, overrides=SHORT) for name in shipped_names()]
    found += [
        ("assess", [*half_hidden(one)])
        for one in _outcomes(cast("Any", SimpleNamespace(counts=counts)))
    ]
    assert [(name, labels) for name, labels in found if labels] == []


def test_no_name_of_a_program_stands_in_a_picture(
    drawn: list[tuple[str, Any, Figure]],
) -> None:
    """Symbols are set as formulas, and names in words."""
    for name, _, figure in drawn:
        for text in (artist.get_text() for artist in figure.findobj(Text)):
            assert "_" not in re.sub(r"\$.*?\$", "", text), (name, text)


def palette(value: Any = None) -> Iterator[str]:
    """The colours of `palmbots.viz.style`."""
    if value is None:
        for name, found in vars(style).items():
            if name.lstrip("_").isupper():
                yield from palette(found)
    elif isinstance(value, str) and re.fullmatch("#[0-9A-Fa-f]{6}", value):
        yield value.upper()
    elif isinstance(value, dict | tuple):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from palette(inner)


def colours(figure: Figure) -> Iterator[Any]:
    """The colours of everything that is drawn, those of maps excepted."""
    for artist in figure.findobj():
        if isinstance(artist, Line2D):
            if artist.get_linestyle() != "None":
                yield artist.get_color()
            if artist.get_marker() not in ("None", "", None):
                yield artist.get_markeredgecolor()
                if MarkerStyle(artist.get_marker()).is_filled():
                    yield artist.get_markerfacecolor()
        elif isinstance(artist, Text):
            yield artist.get_color()
        elif isinstance(artist, Patch):
            yield from (artist.get_facecolor(), artist.get_edgecolor())
        elif isinstance(artist, Collection) and artist.get_array() is None:
            yield from (*artist.get_facecolor(), *artist.get_edgecolor())


def test_colours_are_those_of_the_style(drawn: list[tuple[str, Any, Figure]]) -> None:
    """Greys excepted; maps have the one colour map."""
    allowed = set(palette())
    assert len(allowed) > 20
    for name, _, figure in drawn:
        for colour in colours(figure):
            shown = to_hex(colour).upper()
            grey = shown[1:3] == shown[3:5] == shown[5:7]
            assert grey or shown in allowed, (name, shown)
        for artist in figure.findobj():
            if not isinstance(artist, ScalarMappable):
                continue
            values = artist.get_array()
            if values is not None and values.ndim < 3:  # else it is a picture
                used = artist.get_cmap()
                own = {to_hex(used(k)).upper() for k in range(used.N)}
                assert used.name == style.COLOUR_MAP or own <= allowed, name


@pytest.mark.parametrize("every", amounts(5, 1))
def test_the_same_file_whatever_settings_the_user_has(
    drawn: list[tuple[str, Any, Figure]], every: int, tmp_path: Path
) -> None:
    for k, (name, result, figure) in enumerate(drawn[::every]):
        viz.write_figure(tmp_path / f"{k}.svg", figure)
        with matplotlib.rc_context({"font.size": 30, "axes.grid": True, "lines.linewidth": 9}):
            viz.write_figure(tmp_path / "again.svg", viz.FIGURES.get(name)(result))
        one, two = ((tmp_path / f"{file}.svg").read_bytes() for file in (k, "again"))
        assert one == two, name


def test_no_figure_stays_open(drawn: list[tuple[str, Any, Figure]]) -> None:
    """None is known to pyplot, which keeps its figures until they are closed."""
    pyplot = sys.modules.get("matplotlib.pyplot")
    assert pyplot is None or pyplot.get_fignums() == []
