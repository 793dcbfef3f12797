# SPDX-License-Identifier: Apache-2.0
"""Scenes for the figures of the stability analysis, and what a drawn figure shows."""

from collections.abc import Iterator
from typing import Any

import numpy as np
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


def planes(figure: Figure) -> Iterator[tuple[Axes, int, Side]]:
    for k, axes in enumerate(figure.axes):
        yield axes, 1 + k % 2, SIDES[k // 2]
