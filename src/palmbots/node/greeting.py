# SPDX-License-Identifier: Apache-2.0
"""The first frame of a robot's program to its world: which robot it is, and its boot."""

from typing import Any

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.node.frames import Connection

_WITHIN_S = 30.0


def greeted(program: Connection, ends: tuple[str, ...] = SIDES) -> tuple[str, int]:
    """Wait for the end and epoch of a program that has connected; closes what is none.

    Raises:
        PalmbotsError: it is not the program of a robot.
    """
    try:
        return greeting_in(program.receive(_WITHIN_S), ends)
    except PalmbotsError:
        program.close()
        raise


def greeting_in(frame: Any, ends: tuple[str, ...] = SIDES) -> tuple[str, int]:
    """End and epoch in the first frame of a program.

    Raises:
        PalmbotsError: it is no robot's program.
    """
    if isinstance(frame, list) and len(frame) == 2:
        end, epoch = frame
        if end in ends and isinstance(epoch, int):
            return end, epoch
    raise PalmbotsError("robots: a program that is not a robot has connected")
