# SPDX-License-Identifier: Apache-2.0
"""A person at the workbench of simulated robots: reads a tape to 1 mm and a protractor to 0.5°."""

import math
import random
from collections.abc import Callable
from typing import Any

import palmbots as pb
from palmbots._types import Side
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.drivers.hardware import HardwareParameters
from palmbots.pair.calibration_bench import Machine, Task
from palmbots.simulation.bench_stage import BenchStage, Pose
from palmbots.simulation.imperfections import Imperfections

TASK = Task(length_m=1.5, speed_m_s=0.06, palm_deg=(5.0, 15.0), palm_half_m=0.075)


class Bench:
    """A workbench in the same process, as a driver of one of its robots."""

    def __init__(self, table: dict[str, Any], side: Side, seed: int, scene: Any = None) -> None:
        self.side: Side = side
        scene = pb.load_scene("paper") if scene is None else scene
        self.stage = BenchStage(scene, seed, Imperfections.model_validate(table))
        self.command = RawCommand((0.0, 0.0))

    def read_raw(self) -> RawReading | None:
        return self.stage.reading(self.side)

    def write_raw(self, command: RawCommand) -> None:
        self.command = command

    def wait(self) -> int:
        self.stage.move(self.side, self.command)
        return 1

    def machine(self, hardware: HardwareParameters | None = None) -> Machine:
        return Machine(self, hardware or HardwareParameters(), self.wait, 0.01)


class SimulatedPerson:
    """Follows the instructions. Puts a robot down with an error of a degree."""

    def __init__(self, bench: Bench, seed: int = 0) -> None:
        self.bench = bench
        self.side: Side = bench.side
        self.chance = random.Random(seed)
        self.lines: list[str] = []
        self.lie: dict[str, float] = {}

    @property
    def pose(self) -> Pose:
        return self.bench.stage.poses[self.side]

    def ready(self, text: str) -> None:
        self.lines.append(text)
        if "tape" in text:
            aim = math.radians(self.chance.uniform(-1, 1))
            left = self.chance.uniform(-0.5e-3, 0.5e-3)
            self.bench.stage.put_down(self.side, Pose(0.0, left, aim))
        if "rod" in text:
            self.bench.stage.rods[self.side] = -TASK.palm_half_m + 0.001

    def number(self, text: str, unit: str, least: float, most: float) -> float:
        self.lines.append(text)
        value = self._reads(text)
        for word, error in self.lie.items():
            value += error if word in text else 0.0
        assert least <= value <= most, (text, value)
        return value

    def _reads(self, text: str) -> float:
        if "left of the edge" in text:
            return float(round(1000 * self.pose.left_m))
        if "along the tape" in text:
            return float(round(1000 * self.pose.ahead_m))
        if "rod" in text:
            rod = self.bench.stage.rods[self.side]
            assert rod is not None
            return float(round(1000 * rod))
        if "high is the pivot" in text:
            return float(round(1000 * self.bench.stage.robots[self.side].pivot_m))
        assert "angle of the palm" in text
        palm = math.degrees(self.bench.stage.robots[self.side].palm_rad)
        return round(2 * palm) / 2

    def watch(self, text: str, changed: Callable[[], bool]) -> bool:
        self.lines.append(text)
        while True:
            rod = self.bench.stage.rods[self.side]
            assert rod is not None
            if rod > TASK.palm_half_m - 0.001:
                return False
            # The hand moves on while the eye sees the change.
            self.bench.stage.rods[self.side] = rod + self.chance.uniform(0.1e-3, 0.9e-3)
            if changed():
                return True
