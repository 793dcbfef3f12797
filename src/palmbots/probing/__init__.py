# SPDX-License-Identifier: Apache-2.0
"""What an object is, known by touch: probes, and the set of objects that explains them."""

from palmbots._util.results import FIGURES

FIGURES.register("probe", "palmbots.probing.probe_figure:draw_probe")
