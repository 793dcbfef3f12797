# SPDX-License-Identifier: Apache-2.0
"""A fitted radio over its data: bursts of losses, delays, and what the model leaves of them."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from palmbots._util.text import plural
from palmbots.fitting.fit_panels import panels, say
from palmbots.fitting.radio_fit import RadioFit
from palmbots.viz import style

_LONG = 5.0  # times the model's longest delay: residuals get a logarithmic axis


def draw_radio_fit(result: RadioFit) -> Figure:
    """Draw the model over the data, and what the model leaves."""
    return panels(result, _draw_bursts, _draw_delays, _draw_rest)


def _draw_bursts(axes: Axes, result: RadioFit) -> None:
    data = result.data
    axes.set_xlabel("packets lost together, at least")
    axes.set_ylabel("number of bursts")
    if not data.bursts.size:
        has_index = any(one.key == "packets_lost" for one in result.estimates)
        say(axes, "no packet was lost" if has_index else "the packets have no index")
        return
    axes.set_title(f"{plural(result.lost, 'packet')} lost")
    one, other = style.SERIES[1], style.SERIES[0]
    axes.plot(
        data.burst_packets, data.bursts, color=style.INK, linestyle="none", marker="o",
        markersize=3, label="data",
    )  # fmt: skip
    axes.plot(data.burst_packets, data.fitted, color=one.colour, linestyle=one.line, label="fit")
    axes.plot(
        data.burst_packets, data.independent, color=other.colour, linestyle=other.line,
        label="independent losses",
    )  # fmt: skip
    axes.set_yscale("log")
    if data.burst_packets.max() > 20:
        axes.set_xscale("log")
    else:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylim(0.3, 2 * max(data.bursts.max(), 2))
    axes.legend()


def _draw_delays(axes: Axes, result: RadioFit) -> None:
    data = result.data
    called = result.delay_kind
    axes.set_xlabel(style.axis_label(called, "ms"))
    axes.set_ylabel("share of packets with more")
    if not data.delays_s.size:
        say(axes, "no delays")
        return
    look = style.SERIES[1]
    axes.plot(1e3 * data.delays_s, 1 - data.shares, color=style.INK, label="data")
    axes.plot(
        1e3 * data.model_s, 1 - data.shares, color=look.colour, linestyle=look.line, label="fit"
    )
    axes.set_yscale("log")
    if data.delays_s.max() > 20 * max(data.delays_s[len(data.delays_s) // 4], 1e-6):
        axes.set_xscale("log" if result.delay_kind != "delay behind the fastest" else "symlog")
    axes.set_title("delays")
    axes.legend()


def _draw_rest(axes: Axes, result: RadioFit) -> None:
    data = result.data
    axes.set_xlabel("share of packets with more")
    axes.set_ylabel(style.axis_label("delay, data less fit", "ms"))
    if not data.delays_s.size:
        say(axes, "no delays")
        return
    axes.plot(1 - data.shares, 1e3 * (data.delays_s - data.model_s), color=style.INK)
    axes.axhline(0, color=style.QUIET, linestyle=":")
    axes.set_xscale("log")
    if data.delays_s.max() > _LONG * data.model_s.max():
        thresh = 1e3 * float(data.model_s.max())
        axes.set_yscale("symlog", linthresh=thresh)
        axes.set_ylim(bottom=-thresh)  # a delay is never much shorter than the model's
    axes.set_title("residuals")
