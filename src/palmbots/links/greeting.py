# SPDX-License-Identifier: Apache-2.0
"""The first frame of a program to its world: which end it is, its boot, and its scene."""

import json
import zlib
from typing import Any, NamedTuple

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import Connection
from palmbots.scene.scene import Scene

_WITHIN_S = 30.0


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


def greeted(program: Connection, ends: tuple[str, ...] = SIDES) -> Greeting:
    """Wait for the greeting of a program that has connected; closes what is none.

    Raises:
        PalmbotsError: it is not the program of a robot.
    """
    try:
        return greeting_in(program.receive(_WITHIN_S), ends)
    except PalmbotsError:
        program.close()
        raise


def greeting_in(frame: Any, ends: tuple[str, ...] = SIDES) -> Greeting:
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
