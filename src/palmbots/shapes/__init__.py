# SPDX-License-Identifier: Apache-2.0
"""Objects from files of other programs: drawings (SVG, DXF) and meshes (STL, OBJ, glTF)."""

from palmbots._util.results import FIGURES

FIGURES.register("imported-object", "palmbots.shapes.imported_figure:draw_imported_object")
