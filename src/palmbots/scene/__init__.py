# SPDX-License-Identifier: Apache-2.0
"""What a scene is, where it is read from, what is wrong with it, and its `Spec`."""

from palmbots._types import Overrides
from palmbots.scene.object_library import object_names
from palmbots.scene.scene import Scene, SceneLike, load_scene

__all__ = ["Overrides", "Scene", "SceneLike", "load_scene", "object_names"]


def __dir__() -> list[str]:
    return sorted(__all__)
