# SPDX-License-Identifier: Apache-2.0
"""The first frame of a robot's program to its world: which robot it is, and its boot."""

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.node.frames import Connection

_WITHIN_S = 30.0


def greeted(program: Connection, ends: tuple[str, ...] = SIDES) -> tuple[str, int]:
    """End and epoch of a program that has connected.

    Raises:
        PalmbotsError: it is not the program of a robot.
    """
    try:
        end, epoch = program.receive(_WITHIN_S)
    except (TypeError, ValueError):
        end, epoch = "", 0
    if end not in ends or not isinstance(epoch, int):
        program.close()
        raise PalmbotsError("robots: a program that is not a robot has connected")
    return end, epoch
