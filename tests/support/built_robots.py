# SPDX-License-Identifier: Apache-2.0
"""Two robots of motors, servos and switches at an object on the floor or on a stand.

As with real hardware, a driver that a user would write stands between a robot's program and the
world: it derives from `HardwareDriver` and reads ``[hardware]``. The world knows pivots and palms
only (`FloorWorld`): neither what a phase is nor when an arm is to stop.
"""

import json
import math
from collections import deque
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar, cast

import pytest

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.drivers import guard, hardware_driver
from palmbots.drivers.driver import Drive, Driver, DriverSettings, RawCommand, RawReading, targets
from palmbots.drivers.driver_registry import DRIVERS
from palmbots.drivers.hardware import HardwareParameters, palm_angle
from palmbots.drivers.hardware_driver import HardwareDriver
from palmbots.links.local_connection import ConnectionLost
from palmbots.pair.launcher import UP
from palmbots.pair.live_ends import open_pair_driver
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_world import FloorWorld
from palmbots.station.simulated_pair import Air, SimulatedPair

ARM = {"hardware.arm_floor_deg": 150, "hardware.arm_top_deg": 30}
_ROUNDING_M = 1e-9
_GAP_M = 0.03  # between nose and object where a job begins


class BuiltWorld:
    """An object and the hardware of both robots, tick by tick; a `Stage` without motor boards."""

    is_put_down = True
    contacts = (0.0, 0.0)
    carried_m = 0.0

    def __init__(self, scene: Scene, hardware: HardwareParameters) -> None:
        self.scene, self.hardware, self._spec = scene, hardware, to_spec(scene)
        steep = [scene.palm_of(side).steep_deg for side in SIDES]
        self._world = FloorWorld(scene, palms_deg=(steep[0], steep[1]), gaps_m=(_GAP_M, _GAP_M))
        pivots, _ = _core.standing_start(self._spec)
        self.state = self._world.state
        """Of the world."""
        left, right = (at[1] - now for at, now in zip(pivots, self.heights_m, strict=True))
        self.state = self._world.move(up_m=(left, right))
        for side, at in zip(SIDES, pivots, strict=True):
            assert self.state.pivots_m[side] == pytest.approx(at)
        self._start_x = self._world.state.com_m[0]
        self._watchdog = round(scene.control.watchdog_s / scene.control.period_s)
        self.commands = dict.fromkeys(SIDES, RawCommand((0.0, 0.0)))
        self._silent = dict.fromkeys(SIDES, 0)
        self._rolled = dict.fromkeys(SIDES, 0.0)
        self.outcome = "running"
        self.ticks = 0

    @property
    def midpoint(self) -> float:
        """Of the pivots [m]."""
        return sum(self.state.pivots_m[side][0] for side in SIDES) / 2

    @property
    def moved_m(self) -> float:
        """Displacement of the centre of mass."""
        return self.state.com_m[0] - self._start_x

    @property
    def heights_m(self) -> tuple[float, float]:
        """Of the pivots."""
        pivots = self.state.pivots_m
        return pivots["left"][1], pivots["right"][1]

    def drop_reason(self) -> str | None:
        """Why the last motion ended early."""
        return self.state.end or None

    def greeting(self, side: int) -> list[Any]:
        return []

    def frames(self) -> tuple[None, None]:
        return None, None

    def command_in(self, frame: Any) -> Any:
        raise ConnectionLost("there are no motor boards")

    def rest(self, command: Any) -> None:
        return None

    def write(self, side: Side, command: RawCommand) -> None:
        """The motors of a robot are commanded."""
        self.commands[side], self._silent[side] = command, 0

    def read(self, side: Side) -> RawReading:
        """What the hardware of a robot reads."""
        turn = self._rolled[side] / self.hardware.wheel_radius_m / (2 * math.pi)
        counts = float(math.floor(turn * self.hardware.encoder_ticks_per_turn))
        pressed, half = self.state.touched_m[side], 0.5 * self.scene.palm_of(side).length_m
        # Switches do not feel what touches the nose, and the heel presses the outer one.
        at = None if pressed is None or pressed <= _ROUNDING_M - half else min(half, pressed)
        zones = self.hardware.switches
        closed = tuple(at is not None and zone.from_m <= at <= zone.to_m for zone in zones)
        has_encoders = self.hardware.encoder_ticks_per_turn > 0
        return RawReading((counts, counts) if has_encoders else None, closed)

    def step(self, left: Any = None, right: Any = None) -> None:
        """One control period. Arms and palms hold without a command; wheels stop after a while."""
        self.ticks += 1
        before, heights = self.state, self.heights_m
        ways, rises, angles = [], [], []
        for k, side in enumerate(SIDES):
            self._silent[side] += 1
            command = self.commands[side]
            is_heard = self._silent[side] <= self._watchdog
            rate = sum(command.wheels_rad_s) / 2 if is_heard else 0.0
            way = rate * self.hardware.wheel_radius_m * self.scene.control.period_s
            ways.append(way if side == "left" else -way)
            angles.append(self._turned(side, math.radians(before.palms_deg[side])))
            # The arm yields to the floor.
            floor = self._spec.palms[k].lowest_pivot(angles[k])
            now = before.pivots_m[side][1]
            height = now if command.arm_rad is None else self._height(k, command.arm_rad)
            rises.append(max(height, floor) - now)
        palms = (math.degrees(angles[0]), math.degrees(angles[1]))
        self.state = after = self._world.move(*ways, up_m=(rises[0], rises[1]), palms_deg=palms)
        if after.end == "jammed":  # wheels that stall hold up nothing else
            goals = [height + up for height, up in zip(heights, rises, strict=True)]
            for left_m, right_m in ((0.0, 0.0), (ways[0], 0.0), (0.0, ways[1])):
                at = self.heights_m
                ups = goals[0] - at[0], goals[1] - at[1]
                self.state = after = self._world.move(left_m, right_m, up_m=ups, palms_deg=palms)
        for side, sense in zip(SIDES, (1, -1), strict=True):
            moved = after.pivots_m[side][0] - before.pivots_m[side][0]
            self._rolled[side] += sense * moved
        if after.end not in ("", "jammed"):
            self.outcome = "dropped"

    def _turned(self, side: Side, now: float) -> float:
        servo, palm = self.commands[side].servo_rad, self.scene.palm_of(side)
        goal = now if servo is None else palm_angle(self.hardware, servo)
        most = math.radians(palm.rate_deg_s) * self.scene.control.period_s
        return max(now - most, min(now + most, goal))

    def _height(self, k: int, arm_rad: float) -> float:
        """As a person has measured it: the nose of the steep palm on the floor, and up."""
        hardware, palm = self.hardware, self.scene.palm_of(SIDES[k])
        low = self._spec.palms[k].lowest_pivot(math.radians(palm.steep_deg))
        top = self.scene.arm.of(SIDES[k]).carry_height_m
        way = hardware.arm_top_deg - hardware.arm_floor_deg
        return low + (math.degrees(arm_rad) - hardware.arm_floor_deg) / way * (top - low)


class BuiltRobot(HardwareDriver):
    """A driver as a user would write it, whose hardware is in the `BuiltWorld`."""

    has_watchdog = has_arm = True
    world: ClassVar[BuiltWorld]

    def read_raw(self) -> RawReading:
        return self.world.read(self.settings.side)

    def write_raw(self, command: RawCommand) -> None:
        self.world.write(self.settings.side, command)


class LateGuard(guard.GuardedDriver):
    """A driver in a guard process, which is in this process here: commands and readings arrive some
    ticks late."""

    late = 3
    has_arm = True

    def __init__(self, settings: DriverSettings) -> None:
        self._world, self._ticks = BuiltRobot.world, -1
        super().__init__("built", settings)

    def _start(self) -> None:
        driver = BuiltRobot(self._settings)
        there: deque[Any] = deque()
        back: deque[str] = deque()
        obeyed: list[float] = []

        def poll() -> Any:
            if self._ticks != self._world.ticks:
                self._ticks = self._world.ticks
                if len(there) > self.late:
                    drive = Drive(*there.popleft()[2])
                    driver.write(drive)
                    obeyed[:] = targets(drive)
                seen = driver.read()
                assert seen is not None
                content = [asdict(seen), None, True, [0.0, 0.0], obeyed or None]
                back.append(json.dumps(["reading", content]))
            return json.loads(back.popleft()) if len(back) > self.late else None

        def receive(_: float) -> Any:
            while (frame := poll()) is None:
                self._ticks = -1  # the first reading is as old
            return frame

        line = SimpleNamespace(poll=poll, receive=receive, offer=there.append, close=lambda: None)
        self._guard = cast(Any, line)

    def _end(self) -> None:
        pass


def built_pair(
    folder: Path,
    patch: pytest.MonkeyPatch,
    scene: Scene,
    values: Mapping[str, object] | None = None,
    driver: Any = BuiltRobot,
) -> tuple[SimulatedPair, BuiltWorld]:
    """A pair of such robots in a scene; `values` of ``pair.toml`` beside the usual ones."""
    wanted = {**UP, "driver.kind": "built", **ARM, **(values or {})}
    hardware = {key[9:]: value for key, value in wanted.items() if key.startswith("hardware.")}
    world = BuiltWorld(scene, HardwareParameters.model_validate(hardware))
    patch.setattr(BuiltRobot, "world", world, raising=False)
    patch.setitem(DRIVERS._entries, "built", driver)
    air = Air()
    now = SimpleNamespace(monotonic=lambda: air.period_s * air.now)
    patch.setattr(hardware_driver, "time", now)
    folder.mkdir(exist_ok=True)

    def open_driver(pair: Pair, side: Side, scene: Scene, state: StoredState) -> Driver:
        return open_pair_driver(pair, side, scene, epoch=state.epoch, stored_arm=state.arm)

    pair = SimulatedPair(
        folder, "shared-sign", air, wanted, scene.model_dump(exclude_unset=True), stage=world,
        scene="paper", open_driver=open_driver,
    )  # fmt: skip
    return pair, world
