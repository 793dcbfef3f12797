# SPDX-License-Identifier: Apache-2.0
"""Objects from files of other programs: drawings (SVG, DXF) and meshes (STL, OBJ, glTF)."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names
from palmbots._util.results import FIGURES

if TYPE_CHECKING:
    from palmbots.shapes.imported_object import ImportedObject as ImportedObject
    from palmbots.shapes.importing import import_object as import_object
else:
    __getattr__, __dir__ = lazy_names(__name__)

FIGURES.register("imported-object", "palmbots.shapes.imported_figure:draw_imported_object")
