# SPDX-License-Identifier: Apache-2.0
"""What a robot does, in lines: for the journal of a service, and for a terminal."""

from collections.abc import Callable
from typing import Any

from palmbots._types import Side
from palmbots.pair.fault_words import FAULT_WORDS


class ModeLines:
    """Prints a line when the mode of a robot, or its fault, changes.

    Args:
        side: the robot.
        on_line: called with each line.
    """

    def __init__(self, side: Side, on_line: Callable[[str], None]) -> None:
        self._side, self._on_line = side, on_line
        self._last = ("", "none")

    def take(self, robot: Any) -> None:
        """The core's program after a step."""
        now = (robot.mode, robot.fault)
        if now == self._last:
            return
        self._last = now
        words = FAULT_WORDS.get(robot.fault)
        why = "" if words is None else f": {words.meaning}; {words.remedy}"
        self._on_line(f"{self._side}: {robot.mode}{why}")
