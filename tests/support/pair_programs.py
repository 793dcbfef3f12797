# SPDX-License-Identifier: Apache-2.0
"""The programs of a pair as processes, and a station in the test."""

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from palmbots.runtime.live_ends import open_pair_link
from palmbots.runtime.pair_file import init_pair, load_pair
from palmbots.runtime.station import PERIOD_S, Station

ENDS = ("left", "right", "station")


def new_pair(folder: Path, **values: Any) -> Path:
    """A ``pair.toml`` with free ports, or other values: ``link__kind="serial"``."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket(type=socket.SOCK_DGRAM)) for _ in ENDS]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        ports = [one.getsockname()[1] for one in sockets]
    chosen: dict[str, object] = {
        f"link.{end}": f"127.0.0.1:{port}" for end, port in zip(ENDS, ports, strict=True)
    }
    chosen |= {name.replace("__", "."): value for name, value in values.items()}
    address = f"unix:{folder / 'world'}"
    return init_pair(folder / "pair.toml", address=address, values=chosen)[0]


def started(
    command: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [sys.executable, "-m", "palmbots", *command], cwd=folder, env=environment,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip


@contextlib.contextmanager
def running(*commands: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
            ) -> Iterator[list["subprocess.Popen[str]"]]:  # fmt: skip
    """Processes that are ended at the end."""
    processes = [started(command, folder, environment) for command in commands]
    try:
        yield processes
    finally:
        for process in processes:
            with contextlib.suppress(OSError):
                process.send_signal(signal.SIGCONT)
            process.terminate()
            process.communicate(timeout=60)


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

    def start(self, side: Any) -> None:
        self.until(lambda: self.mode(side) != "")
        self.wish("arm", side, "armed")
        self.wish("start", side, "carrying", "holding")

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
