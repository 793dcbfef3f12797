# SPDX-License-Identifier: Apache-2.0
"""The first frame of a robot's program to its world: which robot it is, and its boot."""

from palmbots._types import SIDES
from palmbots.errors import PalmbotsError
from palmbots.node.frames import Connection

_WITHIN_S = 30.0


def greeted(program: Connection) -> tuple[str, int]:
    """Side and epoch of a program that has connected.

    Raises:
        PalmbotsError: it is no robot's program.
    """
    try:
        side, epoch = program.receive(_WITHIN_S)
    except (TypeError, ValueError):
        side, epoch = "", 0
    if side not in SIDES or not isinstance(epoch, int):
        program.close()
        raise PalmbotsError("robots: a program connected that is no robot")
    return side, epoch
