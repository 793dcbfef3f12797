# SPDX-License-Identifier: Apache-2.0
"""A fitted object: the set of objects, the slides against it, and the switches."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from palmbots._types import SIDES
from palmbots.fitting.fit_panels import panels, say
from palmbots.fitting.object_fit import ObjectFit
from palmbots.viz import style


def draw_object_fit(result: ObjectFit) -> Figure:
    """Draw which objects remain, which contact slid where, and where the switches changed."""
    return panels(result, _draw_objects, _draw_slides, _draw_switches)


def _draw_objects(axes: Axes, result: ObjectFit) -> None:
    boxes = result.data.boxes
    axes.set_xlabel(style.axis_label("COM from the left contact", "mm"))
    axes.set_ylabel("palm friction")
    axes.set_title("objects that explain all slides")
    if not len(boxes):
        say(axes, "not identified")
        return
    for number, side in enumerate(SIDES, 1):
        x, y = 1e3 * boxes[:, 0], np.tan(boxes[:, number])
        order = np.argsort(x[:, 0], kind="stable")
        columns = np.unique(x[order, 0])
        ends = np.array(
            [(y[x[:, 0] == one, 0].min(), y[x[:, 0] == one, 1].max()) for one in columns]
        )
        axes.fill_between(
            columns, ends[:, 0], ends[:, 1], facecolor=style.PALE[side], hatch=style.HATCH[side],
            edgecolor=style.HUE[side], linewidth=1, alpha=0.7, label=f"{side} palm",
        )  # fmt: skip
    axes.set_ylim(bottom=0)
    axes.legend()


def _draw_slides(axes: Axes, result: ObjectFit) -> None:
    data = result.data
    axes.set_xlabel("fitted lead of the left contact\n(difference of squeezes over the weight)")
    axes.set_ylabel("slides")
    if not len(data.leads):
        say(axes, "not identified")
        return
    most = max(float(np.quantile(np.abs(data.leads), 0.99)), 1e-6)
    bins = np.linspace(-most, most, 41).tolist()
    against = 0
    for number, side in enumerate(SIDES):
        leads = data.leads[data.sides == number]
        against += int(((leads < 0) if side == "left" else (leads > 0)).sum())
        axes.hist(
            np.clip(leads, -most, most), bins=bins, facecolor=style.PALE[side],
            edgecolor=style.HUE[side], hatch=style.HATCH[side], alpha=0.7,
            label=f"{side} contact slid",
        )  # fmt: skip
    axes.axvline(0, color=style.INK, linestyle=":")
    which = "slides" if len(data.leads) == result.slides else "sampled slides"
    axes.set_title(f"{against} of {len(data.leads):,} {which} against the fit")
    axes.legend()


def _draw_switches(axes: Axes, result: ObjectFit) -> None:
    data = result.data
    axes.set_xlabel(style.axis_label("contact coordinate", "mm"))
    axes.set_ylabel("readings")
    if not len(data.contacts_m):
        say(axes, "the logs do not show contacts")
        return
    places = 1e3 * data.contacts_m
    most = float(np.abs(places).max())
    bins = np.linspace(-most, most, 61).tolist()
    looks = ((-1, "left", "reads −"), (0, "both", "reads 0"), (1, "right", "reads +"))
    for sign, side, label in looks:
        axes.hist(
            places[data.signs == sign], bins=bins, facecolor=style.PALE[side],
            edgecolor=style.HUE[side], hatch=style.HATCH[side], alpha=0.7, label=label,
        )  # fmt: skip
    axes.set_yscale("log")
    if data.half_width_m is not None:
        for end in (-1e3 * data.half_width_m, 1e3 * data.half_width_m):
            axes.axvline(end, color=style.INK, linestyle=":")
    axes.set_title("switches")
    axes.legend(loc="lower center", frameon=True)
