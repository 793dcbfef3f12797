# SPDX-License-Identifier: Apache-2.0
"""Keys of a scene from recordings: the motion of a robot, and the radio."""

from palmbots._util.results import FIGURES

FIGURES.register("motion-fit", "palmbots.fitting.motion_figure:draw_motion_fit")
FIGURES.register("radio-fit", "palmbots.fitting.radio_figure:draw_radio_fit")
