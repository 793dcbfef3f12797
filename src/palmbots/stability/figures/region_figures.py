# SPDX-License-Identifier: Apache-2.0
"""The paper's Figures 5 and 6 for any scene: operating region and permitted centres of mass.

Source: paper, section 3; docs/theory/stability.md.
"""

import math
from collections.abc import Iterator, Mapping
from itertools import product
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.stability.analysis import Analysis, Bands
from palmbots.stability.figures.canvas import (
    MM,
    Array,
    View,
    clipped,
    headline,
    panel,
    sheet,
)
from palmbots.stability.linear_conditions import failing
from palmbots.stability.problem import Pair, StabilityProblem
from palmbots.viz.style import BACKGROUND, HATCH, HUE, INK, LINE, PALE, QUIET, axis_label, styled

_STABLE: dict[str, Any] = {"fc": PALE["zero"], "ec": "none", "alpha": 0.7, "zorder": 0.5}
_FAILS: dict[str, Any] = {"fc": BACKGROUND, "ec": QUIET, "lw": 0, "hatch": "xxxx", "zorder": 0.6}


def _mm(value: float) -> str:
    """Metres as text in mm."""
    return f"{round(MM * value, 1) + 0.0:.1f}".replace("-", "−")


def _look(name: str) -> dict[str, Any]:
    """The style of an area that belongs to one palm or to both."""
    pale = PALE[name]
    return {"fc": pale, "ec": HUE[name], "lw": 0.6, "ls": LINE.get(name, "-"), "hatch": HATCH[name]}


def _mirrored(problem: StabilityProblem) -> bool:
    """Whether left and right are mirror images, so that one shallow palm represents both."""
    pairs = (problem.friction, problem.offset, problem.half_length, problem.reach)
    alike = all(math.isclose(one, two, rel_tol=1e-9, abs_tol=1e-12) for one, two in pairs)
    middle = math.isclose(problem.com[0], 0.5 * problem.width, rel_tol=1e-9)
    same = problem.angles[0] == problem.angles[1] and problem.contacts[0] == problem.contacts[1]
    return alike and middle and same and problem.slope == 0


# Figure 5


def _rectangle(x: Pair, y: Pair) -> Array:
    return MM * np.array([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])])


def figure5(analysis: Analysis) -> Figure:
    """Where the properties hold in the plane of contacts."""
    problem = analysis.problem
    sides = SIDES[:1] if _mirrored(problem) else SIDES
    with styled():
        size, head, foot = 2.75, 0.92, 0.45
        high = 0.4 + len(sides) * (head + size + foot)
        figure = sheet(7.0, high)
        text = "$z = p_R\\,\\sin\\theta_R - p_L\\,\\sin\\theta_L"
        text += (
            "$" if problem.offset == (0, 0) else " + o_R\\,\\cos\\theta_R - o_L\\,\\cos\\theta_L$"
        )
        text += ";  with the right palm shallow the mirror image" if len(sides) == 1 else ""
        figure.text(0.6 / 7, 1 - 0.06 / high, text, va="top", size=8)
        key = [
            Patch(**_STABLE, label="holds"),
            Patch(**_FAILS, label="fails"),
            Patch(fc=BACKGROUND, ec=INK, lw=1.0, label="on both palms"),
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
            _describe_plane(view, analysis, number, shallow, f"({'abcd'[k]})", corners)
        return figure


def _reach(analysis: Analysis, number: int, shallow: Side) -> float:
    """Half-width of the plane to show [mm]: up to the first failure, if that is close."""
    half = max(analysis.problem.reach)
    travel = analysis.properties[number, shallow].margins.travel_m
    far = half + travel if travel is not None else math.inf
    return MM * (1.12 * far if 1.3 * half < far < 3.6 * half else 1.5 * half)


def _draw_plane(view: View, analysis: Analysis, number: int, shallow: Side) -> Mapping[str, Array]:
    """Draw band, palms, region and travel margin; returns the corners E and F of the region."""
    problem, band = analysis.problem, analysis.bands[number, shallow]
    angles = problem.palms(shallow)
    gain = np.array([-math.sin(angles[0]), math.sin(angles[1])])  # z = base + gain · p
    base = MM * (problem.offset[1] * math.cos(angles[1]) - problem.offset[0] * math.cos(angles[0]))

    # The area where no condition fails is left; the edges of the band are drawn below.
    view.fill(view.corners, **_STABLE)
    for form in problem.forms(number, shallow, angles):
        bad = failing(form, problem.width)
        if bad is not None:
            part = clipped(view.corners, gain, MM * bad[1] - base)
            view.fill(clipped(part, -gain, base - MM * bad[0]), **_FAILS, gid="fails")
    low, high = view.corners[0], view.corners[2]
    view.line((low[0], 0), (high[0], 0), width=0.5, zorder=2)
    view.line((0, low[1]), (0, high[1]), width=0.5, zorder=2)

    half = problem.reach
    square = _rectangle((-half[0], half[0]), (-half[1], half[1]))
    region = _rectangle(*problem.region(number, shallow))
    view.fill(region, **_look(shallow), zorder=1.5, gid="region")
    view.line(*square, square[0], colour=INK, width=1.0)
    heights = region @ gain
    corners = {"E": region[int(heights.argmax())], "F": region[int(heights.argmin())]}
    for corner in corners.values():
        view.axes.plot(*corner, "o", ms=4, color=INK, zorder=6)
        view.occupy(corner)
    for name, k in _limits(band).items():
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
            # The arrow spans the margin along both axes.
            view.span(binding, end, f"travel margin {_mm(travel)}", (outward[1], -outward[0]))
    for name, corner in corners.items():
        view.label(name, corner, corner)
    return corners


def _limits(band: Bands) -> dict[str, float | None]:
    """The limits of z, as pictures name them."""
    return {"$k_\\mathrm{lower}$": band.k_lower, "$k_\\mathrm{upper}$": band.k_upper}


def _level(polygon: Array, gain: Array, value: float) -> list[Array]:
    """Where the line gain · p = value enters and leaves a convex polygon."""
    room = polygon @ gain - value
    pairs = ((k - 1, k) for k in range(len(polygon)) if (room[k - 1] < 0) != (room[k] < 0))
    ends = [
        polygon[i] + room[i] / (room[i] - room[k]) * (polygon[k] - polygon[i]) for i, k in pairs
    ]
    return sorted(ends, key=lambda end: float(end[0]))


def _describe_plane(
    view: View,
    analysis: Analysis,
    number: int,
    shallow: Side,
    letter: str,
    corners: Mapping[str, Array],
) -> None:
    """State whether the property holds, the limits of z, and what fails first."""
    report, band = analysis.properties[number, shallow], analysis.bands[number, shallow]
    known = [f"{name} = {_mm(k)} mm" for name, k in _limits(band).items() if k is not None]
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
    view.axes.set(xlabel=axis_label("$p_L$", "mm"), ylabel=axis_label("$p_R$", "mm"))


# Figure 6


def _com_limits(
    problem: StabilityProblem, number: int, shallow: Side
) -> Iterator[tuple[Array, float]]:
    """Half-planes n · COM ≤ most [m] whose intersection are the COMs for which a property holds."""
    pose = problem.pose(number, shallow)
    left, right = problem.friction
    friction = ((left, left), (right, right))
    for _, rise, weight in problem.spans(pose.rise):
        x, y, low, high, _, _ = _core.com_interval(
            number,
            SIDES.index(shallow),
            problem.width,
            problem.slope,
            friction,
            False,
            pose.angles,
            rise,
            (weight * problem.radius[0], weight * problem.radius[1]),
        )
        normal = np.array([x, y])
        yield normal, high
        yield -normal, -low


_Needs = tuple[tuple[int, Side], ...]
"""Properties, each with its shallow palm."""


def _permitted_coms(problem: StabilityProblem, cases: _Needs) -> Array:
    """The COMs in the outline for which all these properties hold [mm], from the left contact
    vertex; may be empty."""
    polygon = np.array(problem.spec.silhouette)
    for number, shallow in cases:
        for normal, most in _com_limits(problem, number, shallow):
            polygon = clipped(polygon, normal, most)
    return MM * (polygon + problem.com_shift)


def _chords(polygon: Array, height: float) -> list[Pair]:
    """The intervals of a horizontal line that lie inside a polygon."""
    crossings: list[float] = []
    for k in range(len(polygon)):
        (ax, ay), (bx, by) = polygon[k - 1], polygon[k]
        if (ay > height) != (by > height):
            crossings.append(float(ax + (height - ay) / (by - ay) * (bx - ax)))
    crossings.sort()
    return list(zip(crossings[::2], crossings[1::2], strict=True))


def figure6(analysis: Analysis) -> Figure:
    """The COMs for which the properties hold, drawn on the object."""
    problem = analysis.problem
    outline = MM * (np.array(problem.spec.silhouette) + problem.com_shift)
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
            _draw_ranges(view, problem, cases, low[1])
            com = MM * np.array(problem.vertex_com)
            view.axes.plot(*com, "o", ms=5, mfc=BACKGROUND, mec=INK, zorder=5)
            view.axes.plot(*com, "+", ms=5, color=INK, mew=0.8, zorder=6)
            headline(view.axes, f"({'abc'[k]}) {title}")
            view.axes.set_xlabel(axis_label("$c_x$", "mm"))
            view.axes.set_ylabel("" if k else axis_label("$c_y$", "mm"))
            view.axes.tick_params(axis="y", labelleft=k == 0)
            ticks = view.axes.get_yticks()
            view.axes.set_yticks([t for t in ticks if low[1] <= t <= high[1]])
        return figure


def _draw_ranges(
    view: View, problem: StabilityProblem, cases: Mapping[str, _Needs], bottom: float
) -> None:
    """Draw the permitted COMs, and their range at the height of the scene's COM as dimensions."""
    com = MM * np.array(problem.vertex_com)
    levels = {name: bottom - (20 + 20 * row) * view.point for row, name in enumerate(cases)}
    chords: dict[str, list[Pair]] = {}
    for name, needed in cases.items():
        shaded = _permitted_coms(problem, needed)
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
