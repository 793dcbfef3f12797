# SPDX-License-Identifier: Apache-2.0
"""`LivePair` with robots that have imperfections: motors, encoders and switches are theirs."""

import math
from pathlib import Path
from typing import Any

import palmbots._core as _core
from live_pair import ENDS, Air, LivePair
from palmbots._types import SIDES
from palmbots.drivers.driver import RawCommand
from palmbots.drivers.hardware import HardwareParameters
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.pair.drive_table import drive_table
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.world_stage import ImperfectStage
from palmbots.station.station import PERIOD_S

UP: dict[str, object] = {"limits.after_reboot": "rejoin", "limits.partner_lost": "controller"}


class ImperfectPair(LivePair):
    """Two robots that take their hardware for what `hardware` says, in a world of imperfections."""

    def __init__(
        self,
        folder: Path,
        imperfections: Imperfections,
        hardware: dict[Any, HardwareParameters],
        *,
        world: str = "quasistatic",
        controller: str = "resilient",
        seed: int = 0,
        overrides: dict[str, Any] | None = None,
    ) -> None:
        super().__init__(folder, controller, Air(), UP, overrides)
        self.stage = ImperfectStage(self.scene, world, seed, imperfections)
        self.io = {side: HardwareIo(hardware[side], leads=side == "right") for side in SIDES}
        self.drives = {side: drive_table(self.scene, side) for side in SIDES}
        self.motors: dict[str, RawCommand] = {side: RawCommand((0.0, 0.0)) for side in SIDES}
        self.start_m = dict.fromkeys(SIDES, 0.0)
        self.distance_m = dict.fromkeys(SIDES, math.nan)

    def tick(self) -> None:
        self.air.now += 1
        now_s = 0.01 * self.air.now
        for side, raw in zip(SIDES, self.stage.readings(), strict=True):
            robot, io = self.robots[side], self.io[side]
            seen = io.reading(raw, now_s)
            if not robot.wheels:
                self.start_m[side] = seen.distance_m
            self.distance_m[side] = seen.distance_m - self.start_m[side]
            reading = _core.runtime.Reading(
                seen.sign,
                seen.palm_at_target,
                contact=seen.has_contact,
                covered=self.distance_m[side] >= self.scene.task.distance_m,
            )
            palm, move, stop, packets, *_ = robot.step(1, reading, self.air.receive(side))
            drive = self.drives[side][palm, move, stop, robot.wheels]
            self.motors[side] = io.command(drive, now_s)
            for receiver, data, _ in packets:
                self.air.send(side, ENDS[receiver], data)
        if self.air.now % round(PERIOD_S / 0.01) == 0:
            self.station.step()
        self.stage.step(self.motors["left"], self.motors["right"])

    def carry_until_the_end(self) -> str:
        """Arm, start and carry; ``delivered``, ``dropped``, or why the robots stopped."""
        self.start()
        for _ in range(20_000):
            if self.stage.outcome != "running":
                return "dropped"
            if self.modes() == ("done", "done"):
                return "delivered"
            if "fault" in self.modes():
                return "/".join(robot.fault for robot in self.robots.values())
            self.tick()
        return "timeout"
