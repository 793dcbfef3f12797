# SPDX-License-Identifier: Apache-2.0
"""Faults of a running pair, one in each carry, and how each kind of them is caused.

A new fault is a row of `FAULTS`. A new kind is a class, too: what it does to the parts of a pair
and, if a simulated carry can have it, the event there. All faults that they can cause are run by

- `tests/processes/test_faults_of_processes.py`: processes whose time the test grants,
- `tests/processes/test_lockstep_processes.py` and `tests/robot/test_remote_programs.py`: processes
  in lockstep and programs in one process, which carry like one program,
- `tests/soak/test_live_faults.py`: processes in real time, at a random time,
- `benchmarks/bench_live_faults.py`: programs on a clock of their own.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

from palmbots._types import SIDES, Side
from palmbots.links.impairment import Impairment


class Parts(Protocol):
    """What can be done to a running pair; `whom`: a robot's side, ``station`` or ``world``."""

    def cut(self, *directions: tuple[str, str]) -> None:
        """Nothing from the first to the second of these passes from now on; all else does."""

    def kill(self, whom: str, /) -> None:
        """End a program."""

    def restart(self, whom: str, /) -> None:
        """Start it again."""

    def suspend(self, whom: str, /) -> None:
        """Hold a program up."""

    def resume(self, whom: str, /) -> None:
        """Let it go on."""


@dataclass(frozen=True, kw_only=True)
class Fault:
    """A fault from the start on: a bad radio or clock, or none. Other kinds are subclasses."""

    line: str
    """What the station then prints, as a regular expression."""
    ends: tuple[str, ...] = ("delivered",)
    """How the carry ends with a controller that tolerates the fault."""
    radio: Mapping[str, float] = field(default_factory=dict)
    """What all packets pass (`palmbots.links.impairment.Impairment`)."""
    clock_rate: Mapping[Side, float] = field(default_factory=dict)
    """How fast the clocks of robots run."""
    whom: str = ""
    """Whose program the fault is in."""
    lasts_s: float = 0.0
    """From `begin` to `end`."""
    event: ClassVar[str] = ""
    """The same fault of a robot in `faults.script`."""

    def begin(self, parts: Parts) -> None:
        """Cause the fault."""

    def end(self, parts: Parts) -> None:
        """Remove it."""

    @property
    def impairment(self) -> Impairment:
        return Impairment(**{"delay_ms": 2.0, **self.radio})


@dataclass(frozen=True, kw_only=True)
class Cut(Fault):
    """Nothing from the first to the second end passes."""

    direction: tuple[str, str]

    def begin(self, parts: Parts) -> None:
        parts.cut(self.direction)

    def end(self, parts: Parts) -> None:
        parts.cut()


class Off(Fault):
    """A program is killed, and starts again."""

    event = "reboot"

    def begin(self, parts: Parts) -> None:
        parts.kill(self.whom)

    def end(self, parts: Parts) -> None:
        parts.restart(self.whom)


class HeldUp(Fault):
    """A program is suspended for a while."""

    event = "freeze"

    def begin(self, parts: Parts) -> None:
        parts.suspend(self.whom)

    def end(self, parts: Parts) -> None:
        parts.resume(self.whom)


FAULTS: dict[str, Fault] = {
    "none": Fault(line=r"left: done"),
    "loss 20 %": Fault(radio={"loss": 0.2}, line=r"left: \d\d % of its packets are lost"),
    "delay 50 ± 30 ms": Fault(
        radio={"delay_ms": 50.0, "jitter_ms": 30.0},
        line=r"(left|right): a packet and its answer take 0\.\d\d s",
    ),
    "copies 20 %": Fault(
        radio={"duplicate": 0.2}, line=r"(left|right): \d\d % of its packets arrive twice"
    ),
    "one clock 2 % fast": Fault(clock_rate={"left": 1.02}, line=r"left: its clock runs 2 % fast"),
    "one direction dead for 3 s": Cut(
        direction=("left", "right"), lasts_s=3.0, line=r"right: (holding|carrying) \(partner_lost\)"
    ),
    "left robot off for 0.5 s": Off(
        whom="left", lasts_s=0.5, line=r"left: has started again \(boot 2\)"
    ),
    "right robot off for 0.5 s": Off(
        whom="right", lasts_s=0.5, line=r"right: has started again \(boot 2\)"
    ),
    "left program held up for 5 s": HeldUp(
        whom="left", lasts_s=5.0, line=r"left: not heard for 1 s"
    ),
    "right program held up for 5 s": HeldUp(
        whom="right", lasts_s=5.0, line=r"right: not heard for 1 s"
    ),
    "station off for 3 s": Off(
        whom="station", lasts_s=3.0, line=r"left: fault \(station_lost\)", ends=("stopped",)
    ),
    "station held up for 5 s": HeldUp(
        whom="station", lasts_s=5.0, line=r"left: fault \(station_lost\)", ends=("stopped",)
    ),
    "world held up for 5 s": HeldUp(
        whom="world", lasts_s=5.0, line=r"(left|right): fault \(driver\)", ends=("stopped",)
    ),
    "world off": Off(whom="world", line=r"(left|right): fault \(driver\)", ends=("void",)),
}

SIMULATED = [
    name
    for name, fault in FAULTS.items()
    if type(fault) is Fault or (fault.event and fault.whom in SIDES)
]
"""The faults that a simulated carry can have."""
_RADIO = {
    "loss": ("loss", 1.0), "duplicate": ("duplicate", 1.0),
    "delay_ms": ("latency_s", 1e-3), "jitter_ms": ("jitter_s", 1e-3),
}  # fmt: skip


def scene_with(*names: str) -> dict[str, Any]:
    """The keys of a scene with all these faults; what happens at an instant, one after another."""
    keys: dict[str, Any] = {"radio.reorder": True}
    script: list[dict[str, Any]] = []
    at_s = 2.0
    for fault in map(FAULTS.__getitem__, names):
        for number, value in fault.radio.items():
            key, unit = _RADIO[number]
            keys[f"radio.{key}"] = unit * value
        for side, rate in fault.clock_rate.items():
            keys[f"robot.{side}.clock_ppm"] = round(1e6 * (rate - 1))
        if fault.event:
            event = {"kind": fault.event, "robot": fault.whom, "at_s": at_s}
            script.append(event | {"duration_s": fault.lasts_s})
            at_s += fault.lasts_s + 1.0
    return keys | ({"faults.script": script} if script else {})


# The box of scene `lift`, carried 0.3 m from floor to floor.
JOB: dict[str, Any] = {
    "task.from": "floor", "task.to": "floor", "object.edge_radius_m": 0.003,
    "palm.thickness_m": 0.0015, "palm.nose_m": 0.0003, "palm.bevel_m": 0.008,
    "palm.heel_m": 0.012, "task.distance_m": 0.3,
}  # fmt: skip

# Other jobs, over a short distance.
SHORT_WAY: dict[str, dict[str, Any]] = {
    "stand": {
        "task.distance_m": 0.5,
        "floor.stands": [
            {"from_m": x - 0.2, "to_m": x + 0.2, "height_m": 0.1, "gap_m": 0.26} for x in (0.0, 0.5)
        ],
    },
    "lone": {"task.distance_m": 0.5},
    "handover": {"task.distance_m": 0.5},
}
