# SPDX-License-Identifier: Apache-2.0
"""The faults of `tests/fixtures/live_faults.toml`, for each harness those that it can express."""

import tomllib
from collections.abc import Collection
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palmbots.links.impairment import Impairment

TABLE = Path(__file__).parent.parent / "fixtures" / "live_faults.toml"


@dataclass(frozen=True)
class Fault:
    """One fault; the table explains the fields."""

    kind: str
    line: str
    whom: Any = None
    lasts_s: float = 0.0
    rate: float = 1.0
    radio: dict[str, float] = field(default_factory=dict)
    ends: tuple[str, ...] = ("delivered",)

    @property
    def impairment(self) -> Impairment:
        return Impairment(**({"delay_ms": 2.0} | self.radio))


FAULTS = {
    name: Fault(**row) for name, row in tomllib.loads(TABLE.read_text(encoding="utf-8")).items()
}


def faults_of(kinds: Collection[str]) -> list[str]:
    """The names of the faults of these kinds."""
    return [name for name, fault in FAULTS.items() if fault.kind in kinds]


SIMULATED = ("radio", "clock", "robot-off", "robot-held-up")
"""The kinds that a simulated carry can have."""
_RADIO = {
    "loss": ("loss", 1.0), "duplicate": ("duplicate", 1.0),
    "delay_ms": ("latency_s", 1e-3), "jitter_ms": ("jitter_s", 1e-3),
}  # fmt: skip
_EVENTS = {"robot-off": "reboot", "robot-held-up": "freeze"}


def scene_with(*names: str) -> dict[str, Any]:
    """The keys of a scene with all these faults; what happens at an instant, one after another."""
    keys: dict[str, Any] = {"radio.reorder": True}
    script: list[dict[str, Any]] = []
    at_s = 2.0
    for fault in map(FAULTS.__getitem__, names):
        for number, value in fault.radio.items():
            key, unit = _RADIO[number]
            keys[f"radio.{key}"] = unit * value
        if fault.kind == "clock":
            keys[f"robot.{fault.whom}.clock_ppm"] = round(1e6 * (fault.rate - 1))
        elif kind := _EVENTS.get(fault.kind):
            event = {"kind": kind, "robot": fault.whom, "at_s": at_s, "duration_s": fault.lasts_s}
            script.append(event)
            at_s += fault.lasts_s + 1.0
    return keys | ({"faults.script": script} if script else {})
