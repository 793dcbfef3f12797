# SPDX-License-Identifier: Apache-2.0
"""Carries of real processes in real time, each with a fault at a random time."""

import contextlib
import os
import random
import re
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.links.impairment import Impairment
from palmbots.pair.launcher import LiveCarryProcesses

CONTROLLERS = shipped_names("robots")
HELD_S = 0.02
ENDS_WITHIN_S = 10.0
"""Of the robots' time, after the fault."""
LONGEST_S = 120.0
POLL_S = 0.01


@dataclass(frozen=True)
class Fault:
    """What happens in a carry."""

    radio: Impairment = field(default_factory=lambda: Impairment(delay_ms=2.0))
    signal: int = 0
    whom: str = ""
    lasts_s: float = 0.0
    cuts: tuple[str, str] | None = None


FAULTS: dict[str, Fault] = {
    "none": Fault(),
    "loss 20 %": Fault(Impairment(loss=0.2, delay_ms=2.0)),
    "delay 50 ± 30 ms": Fault(Impairment(delay_ms=50.0, jitter_ms=30.0)),
    "copies 20 %": Fault(Impairment(delay_ms=2.0, duplicate=0.2)),
    "one direction dead for 3 s": Fault(cuts=("left", "right"), lasts_s=3.0),
    "left killed": Fault(signal=signal.SIGKILL, whom="left"),
    "right killed": Fault(signal=signal.SIGKILL, whom="right"),
    "station killed": Fault(signal=signal.SIGKILL, whom="station"),
    "world killed": Fault(signal=signal.SIGKILL, whom="world"),
    "left suspended for 5 s": Fault(signal=signal.SIGSTOP, whom="left", lasts_s=5.0),
    "station suspended for 5 s": Fault(signal=signal.SIGSTOP, whom="station", lasts_s=5.0),
}


@dataclass
class LiveRun:
    """How one carry went."""

    fault: str
    controller: str
    seed: int
    rate: float
    outcome: str
    """``delivered``, ``dropped, avoidable``, ``stopped (REASONS)``, ``void``, ``hangs``."""
    says: list[str]
    """What the station said of faults."""
    held_s: float
    """The longest time for which the machine held up a process that only sleeps."""

    @property
    def was_held(self) -> bool:
        """The machine itself held up a process: the run says nothing about the programs."""
        return self.held_s > HELD_S

    def summary(self) -> dict[str, Any]:
        return asdict(self) | {"was_held": self.was_held}


class Heartbeat:
    """Measures for how long the machine holds up a thread that only sleeps."""

    def __init__(self) -> None:
        self.longest_s = 0.0
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._beat, daemon=True)

    def _beat(self) -> None:
        before = time.monotonic()
        while not self._ends.is_set():
            time.sleep(0.002)
            now = time.monotonic()
            self.longest_s = max(self.longest_s, now - before - 0.002)
            before = now

    def __enter__(self) -> "Heartbeat":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()


def run_live_carry(fault: str, controller: str, seed: int, rate: float) -> LiveRun:
    """One carry of world, robots and station as processes, with the fault at a random time."""
    given, chance = FAULTS[fault], random.Random(f"{fault} {controller} {seed}")
    scene = pb.load_scene("paper", {"task.distance_m": 0.6, "task.timeout_s": 60.0})
    with tempfile.TemporaryDirectory() as name, Heartbeat() as heartbeat:
        output, said = Path(name) / "world", Path(name) / "station"
        carry = LiveCarryProcesses(
            scene, controller, ["--seed", str(seed), "--json"],
            rate=rate, impairment=given.radio, output=output, station_output=said,
            on_line=lambda _: None, seed=seed,
        )  # fmt: skip
        outcome = ""
        with carry:
            try:
                outcome = _followed(carry, given, chance, rate, said)
                carry.finish()
            except pb.PalmbotsError as error:
                outcome = outcome or ("void" if "void" in str(error) else f"error: {error}")
        lines = re.sub(r"(?m)^ *[\d.]+ s  ", "", said.read_text() if said.exists() else "")
        found = _world_outcome(output.read_text() if output.exists() else "", lines)
        faults = [one for one in lines.splitlines() if re.search(_FAULT_LINES, one)]
        return LiveRun(fault, controller, seed, rate, outcome or found, faults, heartbeat.longest_s)


_FAULT_LINES = (
    r"not heard|heard again|started again|\(\w+\)$|hangs|claim|lost$|twice$|overtaken|answer take"
)


def _followed(
    carry: LiveCarryProcesses, fault: Fault, chance: random.Random, rate: float, said: Path
) -> str:
    """Wait for the carry, do the fault at a random time of it, and wait for its end."""
    give_up = time.monotonic() + LONGEST_S / rate + 30.0
    begun = False
    acts: list[tuple[float, Callable[[], None]]] = []
    while carry.poll():
        now = time.monotonic()
        if now > give_up:
            return "hangs"
        if not begun and re.search(r"carrying|holding", said.read_text()):
            begun = True
            acts = [*_acts(carry, fault, now + chance.uniform(0.5, 7.0) / rate, rate)]
        while acts and acts[0][0] <= now:
            acts.pop(0)[1]()
        time.sleep(POLL_S)
    return ""


def _acts(
    carry: LiveCarryProcesses, fault: Fault, at_s: float, rate: float
) -> Iterator[tuple[float, Callable[[], None]]]:
    if fault.cuts is not None:
        cuts = fault.cuts
        yield at_s, lambda: carry.proxy.packets.cut(cuts)
        yield at_s + fault.lasts_s / rate, lambda: carry.proxy.packets.cut()
    if fault.signal:
        yield at_s, lambda: _send(carry, fault.whom, fault.signal)
        if fault.lasts_s:
            yield at_s + fault.lasts_s / rate, lambda: _send(carry, fault.whom, signal.SIGCONT)


def _send(carry: LiveCarryProcesses, whom: str, number: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(carry.processes.number(whom), number)


def _world_outcome(printed: str, lines: str) -> str:
    found = re.search(r'"outcome": "(\w+)".*"avoidable": (\w+)', printed)
    if found is None:
        return "no result"
    outcome, avoidable = found.groups()
    if outcome == "dropped":
        return "dropped, avoidable" if avoidable == "true" else "dropped, unavoidable"
    if outcome == "stopped":
        reasons = sorted({*re.findall(r"(?:fault|done|disarmed) \((\w+)\)", lines)})
        return f"stopped ({', '.join(reasons) or 'no reason'})"
    return outcome
