# SPDX-License-Identifier: Apache-2.0
"""Draw the labelled picture of the task, docs/images/task.png, for `draw_images.py`.

The palm angles are larger than in the paper, so that they can be seen; lengths are the paper's.
"""

import math
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Wedge

import palmbots as pb
from palmbots._types import SIDES
from palmbots.scene.placement import Placement, floor_level, place
from palmbots.scene.spec import to_spec
from palmbots.viz import solids
from palmbots.viz.style import BACKGROUND, HUE, INK, OBJECT, QUIET, ZERO, styled

PALMS_DEG = (8.0, 21.0)
CONTACTS_M = (0.030, -0.022)
SPEC = to_spec(pb.Scene())
FLOOR = floor_level(SPEC)


def placed() -> Placement:
    """Where palms and object are at these palm angles and contacts."""
    (left, right), (shallow, steep) = CONTACTS_M, np.radians(PALMS_DEG)
    turn = math.radians(
        pb.contact_modes(
            p_left_m=left,
            p_right_m=right,
            theta_left_deg=PALMS_DEG[0],
            theta_right_deg=PALMS_DEG[1],
        ).object_deg
    )
    wide = SPEC.width * math.cos(turn)
    return place(
        SPEC,
        separation=wide - left * math.cos(shallow) - right * math.cos(steep),
        midpoint=0.0,
        palm=[(shallow, steep)],
        contact=[CONTACTS_M],
        turn=turn,
    )


def draw_robot(axes: Axes, k: int, where: Placement) -> None:
    """A robot: body, wheels, arm, palm and pivot."""
    side, pivot = SIDES[k], where.pivot[0, k]
    base = np.array([pivot[0], 0.0])
    shoulder = base + solids.shoulder(side, FLOOR)
    for solid in solids.robot(side, FLOOR):
        shape = solid.shape
        if isinstance(shape, solids.Cylinder):
            hub = (base[0] + shape.centre[0], shape.centre[2])
            axes.add_patch(
                Circle(hub, shape.radius, facecolor=BACKGROUND, edgecolor=HUE[side], linewidth=1.4)
            )
        elif isinstance(shape, solids.Box) and not shape.turn:
            axes.add_patch(
                Polygon(
                    base + np.array(shape.corners()), facecolor=solid.colour, edgecolor=HUE[side]
                )
            )
            middle = (base[0] + shape.centre[0], shape.centre[2])
            axes.text(*middle, f"{side} robot", ha="center", va="center", color=HUE[side])
    axes.plot(*np.stack([shoulder, pivot]).T, color=QUIET, linewidth=3.5, solid_capstyle="round")
    axes.add_patch(Polygon(where.plate[0, k], color=HUE[side], linewidth=2, zorder=2))
    axes.add_patch(Circle(tuple(pivot), 0.006, facecolor=BACKGROUND, edgecolor=HUE[side], zorder=4))


def dimension(axes: Axes, start: np.ndarray, end: np.ndarray, text: str) -> None:
    """An arrow below the line from start to end, with its name at the inner end."""
    shift = np.array([0.0, -0.018])
    axes.annotate(
        "", xy=tuple(end + shift), xytext=tuple(start + shift),
        arrowprops={"arrowstyle": "->", "color": INK, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
        zorder=5,
    )  # fmt: skip
    inner = min(start, end, key=lambda point: abs(point[0]))
    where = "left" if inner[0] < 0 else "right"
    axes.text(*(inner + 2 * shift), f" {text}  ", ha=where, va="center", zorder=5)


def callout(axes: Axes, text: str, at: np.ndarray, label: tuple[float, float]) -> None:
    """A name, `label` away, with a thin line to the thing that it names."""
    axes.annotate(
        text, xy=tuple(at), xytext=tuple(at + label), ha="center", va="center",
        arrowprops={"arrowstyle": "-", "color": QUIET, "linewidth": 0.8, "shrinkB": 2}, zorder=6,
    )  # fmt: skip


def draw(path: Path) -> None:
    """Draw the picture and write it to a PNG file."""
    with styled():
        figure, axes = plt.subplots(figsize=(7.2, 3.9))
        where = placed()
        pivot, contact, com = where.pivot[0], where.contact[0], where.com[0]
        for k in range(2):
            draw_robot(axes, k, where)
        axes.add_patch(
            Polygon(where.outline[0], facecolor=OBJECT, edgecolor=INK, alpha=0.85, zorder=3)
        )
        axes.plot(*com, marker="o", color=INK, markersize=5, zorder=5)
        axes.text(com[0] + 0.012, com[1], "COM", va="center", zorder=5)
        axes.text(com[0], com[1] + 0.075, "object", ha="center", va="center", zorder=5)
        normal, half = 90.0 - PALMS_DEG[0], math.degrees(math.atan(SPEC.palms[0].friction))
        cone = (normal - half, normal + half)
        axes.add_patch(Wedge(tuple(contact[0]), 0.085, *cone, facecolor=ZERO, alpha=0.35, zorder=4))
        axes.plot(*contact.T, marker="o", linestyle="none", color=ZERO, markersize=6, zorder=6)
        for k, text in enumerate(("$p_L > 0$", "$p_R < 0$")):
            dimension(axes, pivot[k], contact[k], text)
        callout(axes, "friction cone", contact[0] + (-0.002, 0.065), (-0.11, 0.06))
        for k, text in enumerate(("palm, shallow (tilted up)", "palm, steep")):
            end = 0.85 * where.palm_outer[0, k] + 0.15 * where.palm_inner[0, k]
            callout(axes, text, end, ((-0.10, 0.055), (0.09, 0.03))[k])
        callout(axes, "pivot", pivot[1], (0.02, 0.1))
        reach = abs(pivot[1, 0]) + 0.29
        axes.plot([-reach, reach], [FLOOR, FLOOR], color=INK, linewidth=1.2)
        axes.annotate(
            "", xy=(0.09, FLOOR + 0.042), xytext=(-0.09, FLOOR + 0.042),
            arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.6},
        )  # fmt: skip
        axes.text(0.0, FLOOR + 0.06, "direction of travel", ha="center", va="center")
        axes.set(xlim=(-reach, reach), ylim=(FLOOR - 0.012, 0.2), aspect="equal")
        axes.axis("off")
        figure.savefig(
            path, dpi=200, bbox_inches="tight", pad_inches=0.04, metadata={"Software": None}
        )
