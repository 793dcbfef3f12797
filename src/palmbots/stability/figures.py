"""The paper's Figures 2 to 7 for any scene, from its analysis: `draw_all` and `save_all`.

This file draws Figures 5 and 6, what holds where; `geometry_figures` draws 2 to 4 and
`sensor_figure` draws 7.
Source: paper, section 3 and Figure 7; MECHANICS sections 3 to 5.
"""

import math
import os
from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from textwrap import wrap
from typing import Any, Literal, get_args

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from palmbots import _core
from palmbots.errors import PalmbotsError, show
from palmbots.files import folder as writable_folder
from palmbots.pictures import save_figure
from palmbots.sections import SIDES, Side
from palmbots.side_by_side import both
from palmbots.stability.analysis import Analysis
from palmbots.stability.drawing import (
    MM,
    Array,
    State,
    View,
    clipped,
    headline,
    panel,
    sheet,
    state_of,
)
from palmbots.stability.forms import failing
from palmbots.stability.geometry_figures import figure2, figure3, figure4
from palmbots.stability.sensor_figure import figure7
from palmbots.stability.situation import Pair, Situation
from palmbots.style import HATCH, HUE, INK, LINE, PALE, QUIET, styled

__all__ = ["Kind", "draw_all", "figure5", "figure6", "save_all"]

Kind = Literal["png", "svg", "pdf"]
_STABLE: dict[str, Any] = {"fc": PALE["zero"], "ec": "none", "alpha": 0.7, "zorder": 0.5}
_FAILS: dict[str, Any] = {"fc": "white", "ec": QUIET, "lw": 0, "hatch": "xxxx", "zorder": 0.6}


def draw_all(analysis: Analysis, p_m: Pair | None = None) -> dict[str, Figure]:
    """The figures by name, "figure2" to "figure7".

    Args:
        analysis: of the scene to draw.
        p_m: contact coordinates (left, right) of the state in Figures 2 to 4; None: a quarter of
            the region's negative end on the left and of its positive end on the right, in Figure 2
            six tenths.

    Raises:
        PalmbotsError: a contact is beyond its palm, or the object does not reach across.
    """
    return dict(_of_states(*_states(analysis, p_m))) | dict(_of_regions(analysis))


def _states(analysis: Analysis, p_m: Pair | None) -> tuple[State, State]:
    """The states of Figure 2, and of Figures 3 and 4."""
    at = analysis.situation
    ends = at.contacts[0][0], at.contacts[1][1]
    clear, state = (state_of(at, p_m or (f * ends[0], f * ends[1])) for f in (0.6, 0.25))
    return clear, state


_Figures = Iterator[tuple[str, Figure]]
"""One after the other, so that a figure is saved while its texts are still in the cache."""


def _of_states(clear: State, state: State) -> _Figures:
    yield "figure2", figure2(clear)
    yield "figure3", figure3(state)
    yield "figure4", figure4(state)


def _of_regions(analysis: Analysis) -> _Figures:
    yield "figure5", figure5(analysis)
    yield "figure6", figure6(analysis)
    yield "figure7", figure7(analysis.scene.tactile, analysis.situation.spec)


def save_all(
    analysis: Analysis, folder: str | os.PathLike[str], kind: Kind = "png", p_m: Pair | None = None
) -> list[Path]:
    """Write the figures to a folder, each file whole or not at all.

    The same analysis gives the same files. Where a fork is safe, two processes draw.

    Raises:
        PalmbotsError: the kind is none of png, svg and pdf, a file cannot be written, or as
            `draw_all`.
    """
    if kind not in get_args(Kind):
        raise PalmbotsError(f"kind: value is {show(kind)}; allowed: {', '.join(get_args(Kind))}")
    states = _states(analysis, p_m)  # may refuse, before anything is written
    place = writable_folder(folder)
    # Drawing takes most of the time, and each half about as long as the other.
    one, two = both(
        lambda: _saved(_of_states(*states), place, kind),
        lambda: _saved(_of_regions(analysis), place, kind),
    )
    return one + two


def _saved(figures: _Figures, folder: Path, kind: Kind) -> list[Path]:
    written: list[Path] = []
    for name, figure in figures:
        path = folder / f"{name}.{kind}"
        save_figure(path, figure)
        written.append(path)
    return written


def _mm(value: float) -> str:
    """Metres as a number of mm."""
    return f"{round(MM * value, 1) + 0.0:.1f}".replace("-", "−")


def _look(name: str) -> dict[str, Any]:
    """Of an area that belongs to a palm, or to both."""
    pale = PALE.get(name, "#EFD9E6")
    return {"fc": pale, "ec": HUE[name], "lw": 0.6, "ls": LINE.get(name, "-"), "hatch": HATCH[name]}


def _mirrored(at: Situation) -> bool:
    """Whether left and right are mirror images, so that one shallow palm stands for both."""
    pairs = (at.friction, at.offset, at.half_length)
    alike = all(math.isclose(one, two, rel_tol=1e-9, abs_tol=1e-12) for one, two in pairs)
    middle = math.isclose(at.com[0], 0.5 * at.width, rel_tol=1e-9)
    same = at.angles[0] == at.angles[1] and at.contacts[0] == at.contacts[1]
    return alike and middle and same and at.slope == 0


# Figure 5


def _rectangle(x: Pair, y: Pair) -> Array:
    return MM * np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])


def figure5(analysis: Analysis) -> Figure:
    """Where the properties hold in the plane of contacts."""
    at = analysis.situation
    sides = SIDES[:1] if _mirrored(at) else SIDES
    with styled():
        size, head, foot = 2.75, 0.92, 0.45
        high = 0.4 + len(sides) * (head + size + foot)
        figure = sheet(7.0, high)
        text = "$z = p_R\\,\\sin\\theta_R - p_L\\,\\sin\\theta_L"
        text += "$" if at.offset == (0, 0) else " + o_R\\,\\cos\\theta_R - o_L\\,\\cos\\theta_L$"
        text += ";  with the right palm shallow the mirror image" if len(sides) == 1 else ""
        figure.text(0.6 / 7, 1 - 0.06 / high, text, va="top", size=8)
        key = [
            Patch(**_STABLE, label="holds"),
            Patch(**_FAILS, label="fails"),
            Patch(fc="white", ec=INK, lw=1.0, label="on both palms"),
            *(Patch(**_look(side), label=f"needed, {side} shallow") for side in sides),
        ]
        place = {"loc": "upper left", "bbox_to_anchor": (0.6 / 7, 1 - 0.24 / high)}
        figure.legend(
            handles=key, ncols=5, borderaxespad=0, columnspacing=1.0, handlelength=1.7, **place
        )
        for k, (shallow, number) in enumerate(product(sides, (1, 2))):
            bottom = high - 0.4 - (k // 2 + 1) * (head + size + foot) + foot
            half = _reach(analysis, number, shallow)
            view = panel(figure, 0.6 + 3.4 * (k % 2), bottom, size, (-half, half), (-half, half))
            corners = _draw_plane(view, analysis, number, shallow)
            _tell_plane(view, analysis, number, shallow, f"({'abcd'[k]})", corners)
        return figure


def _reach(analysis: Analysis, number: int, shallow: Side) -> float:
    """Half the part of the plane to show [mm]: as far as the first failure, if that is near."""
    half = max(analysis.situation.half_length)
    travel = analysis.properties[number, shallow].margins.travel_m
    far = half + travel if travel is not None else math.inf
    return MM * (1.12 * far if 1.3 * half < far < 3.6 * half else 1.5 * half)


def _draw_plane(view: View, analysis: Analysis, number: int, shallow: Side) -> Mapping[str, Array]:
    """Band, palms, region and travel margin; returns the corners E and F of the region."""
    at, band = analysis.situation, analysis.bands[number, shallow]
    angles = at.palms(shallow)
    gain = np.array([-math.sin(angles[0]), math.sin(angles[1])])  # z = base + gain · p
    base = MM * (at.offset[1] * math.cos(angles[1]) - at.offset[0] * math.cos(angles[0]))

    # What holds is what does not fail; the band's edges are drawn below.
    view.fill(view.corners, **_STABLE)
    for form in at.forms(number, shallow, angles):
        bad = failing(form, at.width)
        if bad is not None:
            part = clipped(view.corners, gain, MM * bad[1] - base)
            view.fill(clipped(part, -gain, base - MM * bad[0]), **_FAILS, gid="fails")
    view.axes.axhline(0, color=QUIET, lw=0.5, zorder=2)
    view.axes.axvline(0, color=QUIET, lw=0.5, zorder=2)

    half = at.half_length
    square = _rectangle((-half[0], half[0]), (-half[1], half[1]))
    region = _rectangle(*at.region(number, shallow))
    view.fill(region, **_look(shallow), zorder=1.5, gid="region")
    view.line(*square, square[0], colour=INK, width=1.0)
    heights = region @ gain
    corners = {"E": region[int(heights.argmax())], "F": region[int(heights.argmin())]}
    for corner in corners.values():
        view.axes.plot(*corner, "o", ms=4, color=INK, zorder=6)
        view.occupy(corner)
    for name, k in (("k_lower", band.k_lower), ("k_upper", band.k_upper)):
        edge = [] if k is None else _level(view.corners, gain, MM * k - base)
        if len(edge) == 2:
            view.line(*edge, colour=INK, width=1.3, gid=name)
            view.label(name, 0.05 * edge[0] + 0.95 * edge[1], (1, -0.3))
    report = analysis.properties[number, shallow]
    travel, binding = report.margins.travel_m, MM * np.array(report.binding_p_m)
    if travel is not None and travel > 0:
        highest = 2 * float(binding @ gain) >= heights.max() + heights.min()
        outward = np.sign(gain) * (1 if highest else -1)
        end = binding + MM * travel * outward
        if (np.abs(end) < view.corners[2]).all():
            # It goes along both axes, by the margin along each.
            view.span(binding, end, f"travel margin {_mm(travel)}", (outward[1], -outward[0]))
    for name, corner in corners.items():
        view.label(name, corner, corner)
    return corners


def _level(polygon: Array, gain: Array, value: float) -> list[Array]:
    """Where the line gain · p = value enters and leaves a convex polygon."""
    room = polygon @ gain - value
    pairs = ((k - 1, k) for k in range(len(polygon)) if (room[k - 1] < 0) != (room[k] < 0))
    ends = [
        polygon[i] + room[i] / (room[i] - room[k]) * (polygon[k] - polygon[i]) for i, k in pairs
    ]
    return sorted(ends, key=lambda end: float(end[0]))


def _tell_plane(
    view: View,
    analysis: Analysis,
    number: int,
    shallow: Side,
    letter: str,
    corners: Mapping[str, Array],
) -> None:
    """In words, what holds, within which limits, and what fails first."""
    report, band = analysis.properties[number, shallow], analysis.bands[number, shallow]
    limits = {"k_lower": band.k_lower, "k_upper": band.k_upper}
    known = [f"{name} = {_mm(k)} mm" for name, k in limits.items() if k is not None]
    lines = [", ".join(known) or "no bound on z"]
    if report.margins.travel_m is not None:
        first = "fails first" if report.holds else "fails"
        binding = MM * np.array(report.binding_p_m)
        named = [f"{name} " for name, corner in corners.items() if np.allclose(corner, binding)]
        place = "".join(named[:1]) + f"({', '.join(_mm(p) for p in report.binding_p_m)})"
        lines += wrap(f"{first} at {place}: {report.binding}", 54)
        lines.append(f"travel margin {_mm(report.margins.travel_m)} mm")
    holds = "holds" if report.holds else "fails"
    title = f"{letter} property {number}, {shallow} palm shallow: {holds}"
    headline(view.axes, title, "\n".join(lines))
    view.axes.set(xlabel="$p_L$ [mm]", ylabel="$p_R$ [mm]")


# Figure 6


def _com_limits(at: Situation, number: int, shallow: Side) -> Iterator[tuple[Array, float]]:
    """Half planes n · COM ≤ most [m] that make up the COMs for which a property holds."""
    pose = at.pose(number, shallow)
    left, right = at.friction
    friction = ((left, left), (right, right))
    for rise in pose.rise:
        x, y, low, high, _, _ = _core.com_band(
            number, SIDES.index(shallow), at.width, at.slope, friction, False, pose.angles, rise
        )
        normal = np.array([x, y])
        yield normal, high
        yield -normal, -low


_Needs = tuple[tuple[int, Side], ...]
"""Properties, each with the palm that is shallow."""


def _permitted_coms(at: Situation, cases: _Needs) -> Array:
    """The COMs in the outline for which all these properties hold [mm]; may be empty."""
    polygon = np.array([(x, y) for x, _, y in at.spec.outline])
    for number, shallow in cases:
        for normal, most in _com_limits(at, number, shallow):
            polygon = clipped(polygon, normal, most)
    return MM * polygon


def _chords(polygon: Array, height: float) -> list[Pair]:
    """Where a horizontal line runs inside a polygon."""
    crossings: list[float] = []
    for k in range(len(polygon)):
        (ax, ay), (bx, by) = polygon[k - 1], polygon[k]
        if (ay > height) != (by > height):
            crossings.append(float(ax + (height - ay) / (by - ay) * (bx - ax)))
    crossings.sort()
    return list(zip(crossings[::2], crossings[1::2], strict=True))


def figure6(analysis: Analysis) -> Figure:
    """The COMs for which the properties hold, drawn on the object."""
    at = analysis.situation
    outline = MM * np.array([(x, y) for x, _, y in at.spec.outline])
    low, high = outline.min(axis=0), outline.max(axis=0)
    wide, tall = high - low
    size = 1.9
    across = max(1.16 * wide, 1.1 * tall * size / 3.2)
    point = across / (72 * size)
    x = (0.5 * (low[0] + high[0] - across), 0.5 * (low[0] + high[0] + across))
    y = (low[1] - 50 * point, high[1] + 6 * point)  # room for the dimensions
    with styled():
        height = size * (y[1] - y[0]) / across
        figure = sheet(7.0, height + 1.25)
        names = {
            "left": "left palm shallow",
            "right": "right palm shallow",
            "both": "both properties, either palm shallow",
        }
        key = [Patch(**_look(name), alpha=0.7, label=text) for name, text in names.items()]
        place = {"loc": "upper left", "bbox_to_anchor": (0.6 / 7, 1 - 0.05 / (height + 1.25))}
        title = "permitted centres of mass; ranges in mm at the height of the scene's COM (circle)"
        legend = figure.legend(handles=key, ncols=3, borderaxespad=0, title=title, **place)
        legend.set(alignment="left")
        every = tuple(product((1, 2), SIDES))
        for k, title in enumerate(("property 1", "property 2", "both properties")):
            view = panel(figure, 0.6 + 2.17 * k, 0.45, size, x, y)
            cases: dict[str, _Needs] = {"both": every}
            if k < 2:
                cases = {side: ((k + 1, side),) for side in SIDES}
            view.line(*outline, outline[0], colour=INK, width=1.0)
            _draw_ranges(view, at, cases, low[1])
            com = MM * np.array(at.com)
            view.axes.plot(*com, "o", ms=5, mfc="white", mec=INK, zorder=5)
            view.axes.plot(*com, "+", ms=5, color=INK, mew=0.8, zorder=6)
            headline(view.axes, f"({'abc'[k]}) {title}")
            view.axes.set(xlabel="$c_x$ [mm]", ylabel="" if k else "$c_y$ [mm]")
            view.axes.tick_params(axis="y", labelleft=k == 0)
            ticks = view.axes.get_yticks()
            view.axes.set_yticks([t for t in ticks if low[1] <= t <= high[1]])
        return figure


def _draw_ranges(view: View, at: Situation, cases: Mapping[str, _Needs], bottom: float) -> None:
    """The permitted COMs, with the dimensions of the range at the scene's COM below the object."""
    com = MM * np.array(at.com)
    levels = {name: bottom - (20 + 20 * row) * view.point for row, name in enumerate(cases)}
    chords: dict[str, list[Pair]] = {}
    for name, needed in cases.items():
        shaded = _permitted_coms(at, needed)
        view.fill(shaded, **_look(name), alpha=0.7, zorder=0.5, gid=name)
        chords[name] = _chords(shaded, com[1])
        for end in (end for chord in chords[name] for end in chord):
            foot = (end, levels[name] - 3 * view.point)
            view.line((end, com[1]), foot, colour=HUE[name], width=0.5)
    for name, level in levels.items():
        for low, high in chords[name]:
            view.span((low, level), (high, level), "", (0, 1), HUE[name])
            text = f"{low:.1f} – {high:.1f}".replace("-", "−")
            view.caption(text, 0.5 * (low + high), level)
    for name, level in levels.items():
        if not chords[name]:
            view.label("none at this height", (com[0], level), (0, 1), HUE[name], size=7.5)
