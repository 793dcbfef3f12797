# SPDX-License-Identifier: Apache-2.0
"""Two robots, a station and a world in one process, on a clock of their own, without sockets.

What runs is what the processes run: the core's program of each robot, and the station.
"""

import random
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import palmbots as pb
import palmbots._core as _core
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.stored_state import StoredState
from palmbots.robot.live_robot import live_program
from palmbots.simulation.quasistatic import QuasistaticEpisode
from palmbots.station.carry_script import carry_once
from palmbots.station.station import PERIOD_S, Station

ENDS = ("left", "right", "station")


@dataclass
class Air:
    """A radio between the three ends: delay and jitter [ticks], loss and copies."""

    delay: int = 1
    loss: float = 0.0
    jitter: int = 0
    duplicate: float = 0.0
    seed: int = 0
    now: int = 0
    under_way: list[tuple[int, str, str, bytes]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.chance = random.Random(self.seed)
        self.cut: set[tuple[str, str]] = set()

    def send(self, sender: str, receiver: str, data: bytes) -> None:
        if self.chance.random() < self.loss or (sender, receiver) in self.cut:
            return
        for _ in range(2 if self.chance.random() < self.duplicate else 1):
            due = self.now + self.delay + self.chance.randint(-self.jitter, self.jitter)
            self.under_way.append((max(due, self.now + 1), sender, receiver, data))

    def receive(self, receiver: str) -> list[bytes]:
        arrived = [p for p in self.under_way if p[2] == receiver and p[0] <= self.now]
        arrived.sort(key=lambda packet: packet[0])
        self.under_way = [p for p in self.under_way if p not in arrived]
        return [data for *_, data in arrived]


class AirLink:
    def __init__(self, air: Air, end: str) -> None:
        self.air, self.end = air, end

    def send(self, receiver: str, data: bytes) -> None:
        self.air.send(self.end, receiver, data)

    def receive(self) -> list[bytes]:
        return self.air.receive(self.end)

    def close(self) -> None:
        pass


class LivePair:
    """Everything that `palmbots up` starts, stepped tick by tick."""

    def __init__(
        self, folder: Path, controller: str, air: Air, values: dict[str, object] | None = None,
        overrides: dict[str, Any] | None = None,
    ) -> None:  # fmt: skip
        scene = pb.load_scene("paper", {"task.distance_m": 0.3} | (overrides or {}))
        (folder / "scene.toml").write_text(scene.to_toml())
        file = init_pair(
            folder / "pair.toml", scene="scene.toml", controller=controller, values=values
        )[0]
        self.pair, self.scene, self.air = load_pair(file), scene, air
        self.watchdog_ticks = round(scene.control.watchdog_s / scene.control.period_s)
        endless = pb.load_scene(scene, {"task.distance_m": 1000.0, "task.timeout_s": 10000.0})
        self.world = QuasistaticEpisode(endless, 0, record=False)
        self.stored = {side: StoredState() for side in ("left", "right")}
        self.robots: dict[str, Any] = {}
        self.commands: dict[str, tuple[int, int, bool]] = {}
        self.by_hand: set[str] = set()
        self.frozen: dict[str, int] = {}  # the ticks for which each robot has not been stepped
        self.clock_rate = {"left": 1.0, "right": 1.0}
        self.clock = {"left": 0.0, "right": 0.0}
        for side in self.stored:
            self.boot(side)
        self.lines: list[str] = []
        self.restart_station()

    def boot(self, side: str) -> None:
        self.stored[side] = self.stored[side].booted()
        self.robots[side] = live_program(self.pair, side, self.stored[side], self.scene)  # type: ignore[arg-type]
        self.commands[side] = (0, 0, True)

    def restart_station(self) -> None:
        self.station = Station(
            self.pair, AirLink(self.air, "station"), self.lines.append, lambda: 0.01 * self.air.now
        )  # type: ignore[arg-type]

    def modes(self) -> tuple[str, str]:
        return self.robots["left"].mode, self.robots["right"].mode

    def tick(self) -> None:
        """One control period of everything."""
        self.air.now += 1
        for side, seen in zip(self.stored, self.world.seen(), strict=True):
            robot = self.robots.get(side)
            if robot is None:
                continue
            covered = self.world.midpoint >= self.scene.task.distance_m
            self.clock[side] += self.clock_rate[side]
            if side in self.frozen:
                self.frozen[side] += 1
                if self.frozen[side] > self.watchdog_ticks:  # the motor board rests the wheels
                    self.commands[side] = (self.commands[side][0], 0, True)
                continue
            elapsed = int(self.clock[side])
            if elapsed == 0:
                continue
            self.clock[side] -= elapsed
            read = getattr(robot, "reading", _core.runtime.Reading)
            share = max(0.0, min(1.0, self.world.midpoint / self.scene.task.distance_m))
            reading = read(
                seen[0],
                seen[1],
                covered=covered,
                stop=side in self.by_hand,
                progress=round(65535 * share),
            )
            answer = robot.step(elapsed, reading, self.air.receive(side))
            palm, move, stop, packets, *_, assists = answer
            wheels = robot.wheels
            self.commands[side] = (palm, move if wheels else 0, stop or not wheels)
            state = self.stored[side]
            self.stored[side] = StoredState(state.epoch, assists, *robot.to_store)
            for receiver, data, _ in packets:
                self.air.send(side, ENDS[receiver], data)
        if self.air.now % round(PERIOD_S / 0.01) == 0:
            self.station.step()
        left, right = self.commands["left"], self.commands["right"]
        self.world.stop(left[2], right[2])
        self.world.step((*left[:2], 0), (*right[:2], 0), 1)

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.tick()

    def run_until(self, modes: tuple[str, ...], within: int = 2000) -> None:
        """Tick until both robots are in one of these modes."""
        for _ in range(within):
            if all(mode in modes for mode in self.modes()):
                return
            self.tick()
        raise AssertionError((self.modes(), self.lines))

    def wish(self, operation: Any, *modes: str) -> None:
        self.station.wish(operation)
        self.run_until(modes)

    def start(self) -> None:
        self.wish("arm", "armed")
        self.wish("start", "carrying", "holding")

    def carry(self) -> bool:
        """What `palmbots station --auto` does; whether both robots are done."""
        for done in carry_once(self.station, 600):
            if done is not None:
                return done
            self.run(round(PERIOD_S / 0.01))
        raise AssertionError
