# SPDX-License-Identifier: Apache-2.0
"""The lines of a drawing, SVG or DXF, as arrays of points; curves as many short lines.

Texts, pictures and hatches are left out. SVG's y points down; here it points upwards.
"""

from __future__ import annotations

import io
import itertools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from palmbots._util.optional_imports import require
from palmbots.shapes.point_arrays import Points

_STEPS = 64
"""Short lines in place of a curve: within 0.03 % of the radius of a quarter of a circle."""

# Metres per drawing unit by DXF's number of the unit.
_DXF_UNITS = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 10: 0.9144, 14: 0.1}
_PIXEL_M = 0.0254 / 96  # by the standard of CSS
_CSS_UNITS = {"mm": 1e-3, "cm": 1e-2, "in": 0.0254, "pt": 0.0254 / 72, "pc": 0.0254 / 6, "q": 25e-5}
_LENGTH = re.compile(r"\s*([\d.eE+-]+)\s*(mm|cm|in|pt|pc|q)\s*", re.IGNORECASE)


@dataclass(frozen=True)
class Drawing:
    """What a drawing contains."""

    pieces: list[Points]
    """Lines in the unit of the file, y upwards; those that are closed end where they start."""
    metres: float | None
    """Of the unit of the file; None: the file has no physical unit."""


def read_svg(data: bytes) -> Drawing:
    """The shapes of an SVG drawing. An area without a line that closes it is closed."""
    svgelements = require("svgelements", "import")
    found = svgelements.SVG.parse(io.BytesIO(data), reify=True, ppi=96)
    # The numbers in the file, in place of the pixels of a screen.
    to_file = svgelements.Matrix(found.viewbox_transform or "")
    to_file.inverse()
    pieces = []
    for shape in found.elements(lambda one: isinstance(one, svgelements.Shape)):
        path = abs(svgelements.Path(shape) * to_file)
        filled = shape.fill is not None and shape.fill.value is not None
        for part in path.as_subpaths():
            points = [point for segment in part for point in _svg_points(svgelements, segment)]
            if len(points) > 2 and filled:
                points.append(points[0])
            if len(points) > 1:
                pieces.append(_distinct(np.array(points) * (1.0, -1.0)))
    return Drawing(pieces, _svg_unit(found.values.get("attributes") or {}))


def _svg_unit(root: Mapping[str, str]) -> float | None:
    """Metres of a user unit: the smaller one, where width and height state different ones."""
    found = []
    box = [float(part) for part in re.split(r"[\s,]+", root.get("viewBox", "").strip()) if part]
    for name, k in (("width", 2), ("height", 3)):
        if given := _LENGTH.fullmatch(str(root.get(name, ""))):
            metres = float(given[1]) * _CSS_UNITS[given[2].lower()]
            found.append(metres / box[k] if len(box) == 4 else _PIXEL_M)
    return min(found, default=None)


def _svg_points(svgelements: Any, segment: Any) -> Iterator[tuple[float, float]]:
    if isinstance(segment, svgelements.Move) or segment.end is None:
        ends = [] if segment.end is None else [segment.end]
    elif isinstance(segment, svgelements.Line | svgelements.Close):
        ends = [segment.end]
    else:
        ends = [segment.point(share) for share in np.linspace(0, 1, _STEPS + 1)[1:]]
    yield from ((end.x, end.y) for end in ends)


def read_dxf(data: bytes) -> Drawing:
    """The lines and curves of the model space of a DXF drawing, those of its blocks included."""
    require("ezdxf", "import")
    disassemble, paths = require("ezdxf.disassemble", "import"), require("ezdxf.path", "import")
    document, _ = require("ezdxf.recover", "import").read(io.BytesIO(data))
    unit = _DXF_UNITS.get(int(document.header.get("$INSUNITS", 0)))
    pieces = []
    for entity in disassemble.recursive_decompose(document.modelspace()):
        if entity.dxftype() in ("HATCH", "TEXT", "MTEXT", "DIMENSION"):
            continue
        try:
            path = paths.make_path(entity)
        except TypeError:  # no line
            continue
        for part in path.sub_paths():
            points = itertools.chain([part.start], *map(_dxf_points, _dxf_curves(part)))
            pieces.append(_distinct(np.array([(p.x, p.y) for p in points])))
    return Drawing([piece for piece in pieces if len(piece) > 1], unit)


def _dxf_curves(path: Any) -> Iterator[tuple[Any, ...]]:
    """The control points of each line or Bézier curve of a path."""
    start = path.start
    for command in path.commands():
        inner = [getattr(command, name, None) for name in ("ctrl", "ctrl1", "ctrl2")]
        yield (start, *(point for point in inner if point is not None), command.end)
        start = command.end


def _dxf_points(control: tuple[Any, ...]) -> Iterator[Any]:
    """Points of a Bézier curve after its first one, by de Casteljau's rule."""
    for share in np.linspace(0, 1, _STEPS + 1)[1:] if len(control) > 2 else (1.0,):
        points = list(control)
        while len(points) > 1:
            points = [a.lerp(b, share) for a, b in itertools.pairwise(points)]
        yield points[0]


def _distinct(points: Points) -> Points:
    """Without points that repeat the one before."""
    return points[np.r_[True, (np.diff(points, axis=0) != 0).any(axis=1)]]
