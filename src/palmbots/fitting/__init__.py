# SPDX-License-Identifier: Apache-2.0
"""Keys of a scene from recordings: the motion of a robot."""

from palmbots._util.results import FIGURES

FIGURES.register("motion-fit", "palmbots.fitting.motion_figure:draw_motion_fit")
