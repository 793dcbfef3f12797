# SPDX-License-Identifier: Apache-2.0
"""The reference motor board as a process, and what it does with its wheels."""

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from waiting import wait_until


class Command(NamedTuple):
    """What the board does from a moment on."""

    time_s: float
    """By the monotonic clock of the machine."""
    left: float
    right: float
    by_watchdog: bool
    palm_rad: float


class Board:
    """A running board."""

    def __init__(self, device: Path) -> None:
        self.device = device
        self.commands: list[Command] = []
        self.start()

    def start(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-m", "palmbots.drivers.reference_board", "--link", str(self.device)],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip
        assert self.process.stdout is not None
        assert self.process.stdout.readline().strip() == str(self.device)
        threading.Thread(target=self._read, args=(self.process,), daemon=True).start()

    def _read(self, process: "subprocess.Popen[str]") -> None:
        assert process.stdout is not None
        with contextlib.suppress(ValueError):  # closed
            for line in process.stdout:
                words = line.replace(",", "").split()
                by_watchdog = "watchdog" in words
                numbers = float(words[2]), float(words[3])
                self.commands.append(
                    Command(float(words[0]), *numbers, by_watchdog, float(words[-2]))
                )

    def order(self, line: str) -> None:
        """Type a line, such as ``press 3``."""
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def turns(self) -> bool:
        return bool(self.commands) and (self.commands[-1].left, self.commands[-1].right) != (0, 0)

    def wait_turning(self) -> None:
        wait_until(self.turns)

    def wait_resting(self) -> Command:
        wait_until(lambda: not self.turns())
        return self.commands[-1]

    def end(self) -> None:
        """Pull the plug."""
        self.process.kill()
        self.process.communicate()


@contextlib.contextmanager
def board(device: Path) -> Iterator[Board]:
    made = Board(device)
    try:
        yield made
    finally:
        made.end()
        with contextlib.suppress(OSError):
            os.unlink(device)
