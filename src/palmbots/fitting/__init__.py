# SPDX-License-Identifier: Apache-2.0
"""Keys of a scene from recordings: the motion of a robot, the radio, and the object."""

from palmbots._util.results import FIGURES

FIGURES.register("motion-fit", "palmbots.fitting.motion_figure:draw_motion_fit")
FIGURES.register("object-fit", "palmbots.fitting.object_figure:draw_object_fit")
FIGURES.register("radio-fit", "palmbots.fitting.radio_figure:draw_radio_fit")
