# SPDX-License-Identifier: Apache-2.0
"""Pairs on free ports, their programs as processes, and a station in the test."""

import contextlib
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from palmbots.pair.launcher import free_addresses
from palmbots.pair.live_ends import open_pair_link
from palmbots.pair.pair_file import ENDS, init_pair, load_pair
from palmbots.station.station import PERIOD_S, Station


def new_pair(
    folder: Path,
    values: Mapping[str, object] | None = None,
    scene: str = "paper",
    **named: object,
) -> Path:
    """`pair.toml` in this folder, on ports that no program uses, with further values.

    They are a table (``{"link.kind": "serial"}``), or named (``link__kind="serial"``).
    """
    with free_addresses(len(ENDS)) as addresses:
        chosen: dict[str, object] = {
            f"link.{end}": address for end, address in zip(ENDS, addresses, strict=True)
        }
    chosen |= {**(values or {}), **{name.replace("__", "."): v for name, v in named.items()}}
    address = f"unix:{folder / 'world'}"
    file = folder / "pair.toml"
    return init_pair(file, scene=scene, controller="resilient", address=address, values=chosen)[0]


def started(
    command: Sequence[str],
    folder: Path | None = None,
    environment: Mapping[str, str] | None = None,
    **streams: Any,
) -> "subprocess.Popen[str]":
    """`palmbots COMMAND` in this folder, with further variables; its streams are pipes."""
    pipes: dict[str, Any] = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    return subprocess.Popen(
        [sys.executable, "-m", "palmbots", *command],
        cwd=folder, text=True, env=os.environ | dict(environment or {}), **(pipes | streams),
    )  # fmt: skip


@contextlib.contextmanager
def running(
    *commands: Sequence[str], folder: Path, environment: Mapping[str, str] | None = None
) -> Iterator[list["subprocess.Popen[str]"]]:
    """The commands run as long as the block, also if it has suspended them."""
    processes = [started(command, folder, environment) for command in commands]
    try:
        yield processes
    finally:
        for process in processes:
            with contextlib.suppress(OSError):
                process.send_signal(signal.SIGCONT)
            process.terminate()
            process.communicate(timeout=60)


def children(parent: "subprocess.Popen[str]") -> dict[str, int]:
    """The command lines of the processes that this one has started, with their numbers."""
    found = {}
    for folder in Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            command = (folder / "cmdline").read_text().replace("\0", " ")
            if f"PPid:\t{parent.pid}\n" in (folder / "status").read_text():
                found[command] = int(folder.name)
    return found


NAMES = {"world": " world ", "left": "--side left", "right": "--side right", "station": " station "}


def programs_of(up: "subprocess.Popen[str]") -> dict[str, int]:
    """The processes of `palmbots up` by name, as far as they run."""
    lines = children(up).items()
    return {name: number for name, text in NAMES.items() for line, number in lines if text in line}


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
