# SPDX-License-Identifier: Apache-2.0
"""What a scene is, where it is read from, what is wrong with it, and its `Spec`."""

from typing import TYPE_CHECKING

from palmbots._util.lazy_names import lazy_names

if TYPE_CHECKING:
    from palmbots._types import Overrides as Overrides
    from palmbots.scene.object_library import object_names as object_names
    from palmbots.scene.scene import Scene as Scene
    from palmbots.scene.scene import SceneLike as SceneLike
    from palmbots.scene.scene import load_scene as load_scene
else:
    __getattr__, __dir__ = lazy_names(__name__)
