# SPDX-License-Identifier: Apache-2.0
"""Draw the labelled picture of the task, docs/images/task.png, for `draw_images.py`.

The palm angles are larger than in the paper, so that they can be seen; lengths are the paper's.
"""

import math
from pathlib import Path

import matplotlib
import numpy as np
from scipy.optimize import brentq

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyBboxPatch, Polygon, Wedge

from palmbots.viz.style import BACKGROUND, HUE, INK, OBJECT, PALE, QUIET, ZERO, styled

SHALLOW, STEEP = math.radians(8), math.radians(21)
HALF_PALM = 0.075
WIDTH, HEIGHT, COM_HEIGHT = 0.25, 0.16, 0.04
CONTACT = {"left": 0.030, "right": -0.022}
FRICTION_ANGLE = math.atan(0.3)
FLOOR = -0.17


def along(side: str, angle: float) -> np.ndarray:
    """The unit vector outward along a palm."""
    return np.array([(-1.0 if side == "left" else 1.0) * math.cos(angle), math.sin(angle)])


def contact_points() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Pivots and contacts, with the pivots so far apart that the object fits between them."""
    left, right = along("left", SHALLOW), along("right", STEEP)

    def misfit(d: float) -> float:
        at = np.array([d, 0.0]) + CONTACT["right"] * right - CONTACT["left"] * left
        return float(np.hypot(*at)) - WIDTH

    pivot = np.array([brentq(misfit, 0.1, 0.4), 0.0])
    return np.zeros(2), pivot, CONTACT["left"] * left, pivot + CONTACT["right"] * right


def draw_robot(axes: Axes, side: str, pivot: np.ndarray, angle: float) -> None:
    """A robot: body, wheels, arm, palm and pivot."""
    out = -1.0 if side == "left" else 1.0
    centre = pivot[0] + out * 0.13
    body = (centre - 0.08, FLOOR + 0.025)
    axes.add_patch(
        FancyBboxPatch(
            body, 0.16, 0.095, boxstyle="round,pad=0,rounding_size=0.012",
            facecolor=PALE[side], edgecolor=HUE[side], linewidth=1.2, zorder=1,
        )
    )  # fmt: skip
    for offset in (-0.045, 0.045):
        wheel = (centre + offset, FLOOR + 0.02)
        axes.add_patch(
            Circle(wheel, 0.02, facecolor=BACKGROUND, edgecolor=HUE[side], linewidth=1.4)
        )
    arm = np.array([[centre, FLOOR + 0.12], [pivot[0], FLOOR + 0.12], pivot])
    axes.plot(*arm.T, color=HUE[side], linewidth=3.5, solid_joinstyle="round", zorder=1)
    u = along(side, angle)
    ends = np.array([pivot - HALF_PALM * u, pivot + HALF_PALM * u])
    axes.plot(*ends.T, color=HUE[side], linewidth=5, solid_capstyle="round", zorder=2)
    axes.add_patch(Circle(tuple(pivot), 0.006, facecolor=BACKGROUND, edgecolor=HUE[side], zorder=4))
    axes.text(centre, FLOOR + 0.07, f"{side} robot", ha="center", va="center", color=HUE[side])


def dimension(axes: Axes, start: np.ndarray, end: np.ndarray, text: str, shift: np.ndarray) -> None:
    """An arrow from start to end, moved by `shift`, with its name."""
    axes.annotate(
        "", xy=tuple(end + shift), xytext=tuple(start + shift),
        arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
        zorder=5,
    )  # fmt: skip
    axes.text(*(end + 1.7 * shift), f"{text} ", ha="right", va="center", zorder=5)


def callout(axes: Axes, text: str, at: tuple[float, float], label: tuple[float, float]) -> None:
    """A name with a thin line to the thing that it names."""
    axes.annotate(
        text, xy=at, xytext=label, ha="center", va="center",
        arrowprops={"arrowstyle": "-", "color": QUIET, "linewidth": 0.8, "shrinkB": 2},
    )  # fmt: skip


def draw(path: Path) -> None:
    """Draw the picture and write it to a PNG file."""
    with styled():
        figure, axes = plt.subplots(figsize=(7.2, 3.7))
        pivot_left, pivot_right, left, right = contact_points()
        draw_robot(axes, "left", pivot_left, SHALLOW)
        draw_robot(axes, "right", pivot_right, STEEP)
        x = (right - left) / WIDTH
        y = np.array([-x[1], x[0]])
        box = [left, right, right + HEIGHT * y, left + HEIGHT * y]
        axes.add_patch(
            Polygon(box, facecolor=OBJECT, edgecolor=INK, linewidth=1.0, alpha=0.85, zorder=3)
        )
        com = left + WIDTH / 2 * x + COM_HEIGHT * y
        axes.plot(*com, marker="o", color=INK, markersize=5, zorder=5)
        axes.text(com[0] + 0.012, com[1], "COM", va="center", zorder=5)
        axes.text(*(com + 0.075 * y), "object", ha="center", va="center", zorder=5)
        normal = math.degrees(math.pi / 2 - SHALLOW)
        half = math.degrees(FRICTION_ANGLE)
        axes.add_patch(
            Wedge(
                tuple(left),
                0.085,
                normal - half,
                normal + half,
                facecolor=ZERO,
                alpha=0.35,
                zorder=4,
            )
        )
        for contact in (left, right):
            axes.plot(*contact, marker="o", color=ZERO, markersize=6, zorder=6)
        below = np.array([0.0, -0.018])
        dimension(axes, pivot_left, left, "$p_L > 0$", below)
        dimension(axes, pivot_right, right, "$p_R < 0$", below)
        callout(axes, "friction cone", (left[0] - 0.002, left[1] + 0.065), (left[0] - 0.11, 0.125))
        outer = pivot_left + 0.062 * along("left", SHALLOW)
        callout(axes, "palm, shallow (tilted up)", tuple(outer), (-0.20, 0.06))
        outer = pivot_right + 0.066 * along("right", STEEP)
        callout(axes, "palm, steep", tuple(outer), (pivot_right[0] + 0.19, 0.075))
        callout(axes, "pivot", tuple(pivot_left), (0.085, -0.07))
        axes.plot([-0.32, pivot_right[0] + 0.32], [FLOOR, FLOOR], color=INK, linewidth=1.2)
        middle = pivot_right[0] / 2
        axes.annotate(
            "", xy=(middle + 0.09, FLOOR + 0.032), xytext=(middle - 0.09, FLOOR + 0.032),
            arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.6},
        )  # fmt: skip
        axes.text(middle, FLOOR + 0.05, "direction of travel", ha="center", va="center")
        axes.set(xlim=(-0.32, pivot_right[0] + 0.32), ylim=(FLOOR - 0.012, 0.2), aspect="equal")
        axes.axis("off")
        figure.savefig(
            path, dpi=200, bbox_inches="tight", pad_inches=0.04, metadata={"Software": None}
        )
