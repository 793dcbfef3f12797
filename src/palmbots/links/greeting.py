# SPDX-License-Identifier: Apache-2.0
"""The first frame of a program to its world: which end it is, its boot, and its scene."""

import json
import zlib
from collections.abc import Collection
from typing import Any, NamedTuple

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene

TAKEN, OTHER_SCENE = "taken", "scene"
"""The frames by which a world refuses a program (`check_admitted`)."""


class Greeting(NamedTuple):
    """The content of the frame."""

    end: str
    """``left``, ``right``, or ``station``."""
    epoch: int
    """Number of its boots."""
    scene: int
    """`scene_number` of its scene; 0: not compared."""


def scene_number(scene: Scene) -> int:
    """A number that is equal for two programs if their scenes are; never 0."""
    text = json.dumps(scene.model_dump(), sort_keys=True, default=str)
    return max(1, zlib.crc32(text.encode()))


def greeting_in(frame: Any, ends: Collection[str] = SIDES) -> Greeting:
    """The greeting in the first frame of a program.

    Raises:
        PalmbotsError: it is no robot's program.
    """
    if isinstance(frame, list) and len(frame) == 3:
        end, epoch, scene = frame
        if end in ends and isinstance(epoch, int) and isinstance(scene, int):
            return Greeting(end, epoch, scene)
    raise PalmbotsError("robots: a program that is not a robot has connected")


def is_other_scene(greeting: Greeting, number: int) -> bool:
    """Whether the program runs with another scene than the one with this number."""
    return 0 not in (greeting.scene, number) and greeting.scene != number


def check_admitted(frame: Any, end: str) -> None:
    """Raise `PalmbotsError` if the world refuses the program of this end by this frame."""
    name = end if end == "station" else f"{end} robot"
    if frame == TAKEN:
        raise PalmbotsError(f"world: another program is the {name}")
    if frame == OTHER_SCENE:
        raise PalmbotsError(
            f"world: runs another scene than the {name}; start it with the scene of the pair file"
        )
