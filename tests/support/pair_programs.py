# SPDX-License-Identifier: Apache-2.0
"""A station in the test, and what happens to the programs of a pair."""

import contextlib
import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from palmbots.pair.live_ends import open_pair_link
from palmbots.pair.pair_file import load_pair
from palmbots.station.station import PERIOD_S, Station


def ended(process: "subprocess.Popen[str]") -> tuple[dict[str, Any], str]:
    """End a robot's program as systemd does; what it prints, and its lines on stderr."""
    process.terminate()
    printed, errors = process.communicate(timeout=60)
    assert process.returncode == 0, errors
    return json.loads(printed), errors


class Operator:
    """A station that the test steps."""

    def __init__(self, file: Path) -> None:
        self.pair = load_pair(file)
        self.link = open_pair_link(self.pair, "station")
        self.lines: list[str] = []
        self.station = Station(self.pair, self.link, self.lines.append)

    def until(self, predicate: Callable[[], object], within_s: float = 60.0) -> None:
        """Step the station until the predicate holds."""
        give_up = time.monotonic() + within_s
        while not predicate():
            assert time.monotonic() < give_up, self.lines
            self.station.step()
            time.sleep(PERIOD_S)

    def mode(self, side: Any) -> str:
        return self.station.modes().get(side, "")

    def wish(self, operation: Any, side: Any, *modes: str) -> None:
        """Wish until this robot is in one of the modes."""
        self.station.wish(operation)
        self.until(lambda: self.mode(side) in modes)

    def start(self, side: Any, has_started: Callable[[], object] | None = None) -> None:
        """Arm and start this robot; again, if a busy machine makes it too slow meanwhile."""
        wishes = dict.fromkeys(("off", "disarmed", "fault", "done"), "arm") | {"armed": "start"}
        wished: list[Any] = [None]

        def carries() -> bool:
            mode = self.mode(side)
            wish: Any = wishes.get(mode)
            if wish is not None and [mode, wish] != wished:
                wished[:] = [mode, wish]
                self.station.wish(wish)
            return bool(has_started()) if has_started else mode in ("carrying", "holding")

        self.until(carries)

    def close(self) -> None:
        self.link.close()


@contextlib.contextmanager
def operator(file: Path) -> Iterator[Operator]:
    made = Operator(file)
    try:
        yield made
    finally:
        made.close()


def hold(process: "subprocess.Popen[str]", by: signal.Signals) -> float:
    """Stop or kill a process; the time of the machine."""
    now_s = time.monotonic()
    os.kill(process.pid, by)
    return now_s
