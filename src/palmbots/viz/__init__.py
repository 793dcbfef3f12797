# SPDX-License-Identifier: Apache-2.0
"""Figures and animations of results.

Every figure is a function that takes a result and returns a `matplotlib.figure.Figure`. `FIGURES`
holds them by name, and ``result.plot()`` draws the figure that its class names. A program adds a
figure with ``FIGURES.register("mine", function)``. Importing this room does not import matplotlib.
"""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES as FIGURES

if TYPE_CHECKING:
    from palmbots.viz.animation import save_animation as save_animation
    from palmbots.viz.carry_figure import draw_carry as draw_carry
    from palmbots.viz.lift_phases_figure import draw_lift_phases as draw_lift_phases
    from palmbots.viz.noise_limit_figure import draw_noise_limit as draw_noise_limit
    from palmbots.viz.save_figure import write_figure as write_figure
    from palmbots.viz.sequence_chart import draw_message_sequence as draw_message_sequence
    from palmbots.viz.side_view_figure import draw_side_view as draw_side_view
    from palmbots.viz.sweep_figure import draw_sweep as draw_sweep
    from palmbots.viz.timeline_figure import draw_timeline as draw_timeline
    from palmbots.viz.video_files import video_formats as video_formats
else:
    __getattr__, __dir__ = lazy_names(__name__)
    for _name in __dir__():
        if _name.startswith("draw_"):
            FIGURES.register(_name.removeprefix("draw_"), f"{__name__}:{_name}")
