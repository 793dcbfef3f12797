# SPDX-License-Identifier: Apache-2.0
"""Figures and animations of results.

Every figure is a function that takes a result and returns a `matplotlib.figure.Figure`. `FIGURES`
holds them by name, and ``result.plot()`` draws the figure that its class names. A program adds a
figure with ``FIGURES.register("mine", function)``. Importing this room does not import matplotlib.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES, WRITERS

if TYPE_CHECKING:
    from palmbots.viz.animation import save as save_animation
    from palmbots.viz.carry_figure import draw as draw_carry
    from palmbots.viz.noise_limit_figure import draw as draw_noise_limit
    from palmbots.viz.save_figure import save_figure as write_figure
    from palmbots.viz.sequence_chart import draw as draw_message_sequence
    from palmbots.viz.side_view_figure import draw as draw_side_view
    from palmbots.viz.sweep_figure import draw as draw_sweep
    from palmbots.viz.timeline_figure import draw as draw_timeline
    from palmbots.viz.video_files import video_formats

__all__ = [
    "FIGURES",
    "draw_carry",
    "draw_message_sequence",
    "draw_noise_limit",
    "draw_side_view",
    "draw_sweep",
    "draw_timeline",
    "save_animation",
    "video_formats",
    "write_figure",
]

_PLACES = {
    "draw_carry": ".carry_figure:draw",
    "draw_message_sequence": ".sequence_chart:draw",
    "draw_noise_limit": ".noise_limit_figure:draw",
    "draw_side_view": ".side_view_figure:draw",
    "draw_sweep": ".sweep_figure:draw",
    "draw_timeline": ".timeline_figure:draw",
    "save_animation": ".animation:save",
    "video_formats": ".video_files",
    "write_figure": ".save_figure:save_figure",
}

for _name, _place in _PLACES.items():
    if _name.startswith("draw_"):
        FIGURES.register(_name.removeprefix("draw_"), f"palmbots.viz{_place}")
WRITERS.register("figure", "palmbots.viz.save_figure:save_figure")

__getattr__, __dir__ = lazy_names(__name__, _PLACES)
