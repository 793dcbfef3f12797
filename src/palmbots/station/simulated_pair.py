# SPDX-License-Identifier: Apache-2.0
"""Two robots, a station and a world in one process, on a clock of their own, without sockets.

What runs is what the processes of `palmbots up` run: the loop and the driver of each robot, its
motor board, and the station. Only radio, clocks, sockets and disks are replaced.
"""

from collections import defaultdict, deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args

from palmbots._types import SIDES, Side
from palmbots.clocks.control_clock import JITTER_LIMITS_MS
from palmbots.drivers.driver import Driver
from palmbots.drivers.hardware import HardwareParameters
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.links.impairment import ImpairedPackets, Impairment
from palmbots.links.link import Link
from palmbots.links.local_connection import ConnectionLost
from palmbots.pair.pair_file import Pair, init_pair, load_pair
from palmbots.pair.stored_state import StoredState
from palmbots.robot.live_robot import logged_program, ticks_in
from palmbots.robot.logged_steps import RobotLog
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.robot.robot_loop import RobotEnd, RobotLoop
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.live_world import Board
from palmbots.simulation.world_stage import ImperfectStage, Stage, perfect_stage
from palmbots.station.carry_script import carry_once
from palmbots.station.station import PERIOD_S, Station
from palmbots.station.station_log import StationLog
from palmbots.wire import Operation, RobotMode, Role

_MOST_TICKS = 20_000
_ROUNDING_S = 1e-6


class Air:
    """A radio between the three ends, on the time of the pair.

    Args:
        seed: of the packets' fates.
        impairment: numbers of `palmbots.links.impairment.Impairment`; a delay of 10 ms by default.
    """

    def __init__(self, seed: int = 0, **impairment: float) -> None:
        packets = ImpairedPackets(Impairment(**({"delay_ms": 10.0} | impairment)), seed)
        self.now = 0
        """Control periods since the start."""
        self.period_s = 0.01
        """Of the pair, which sets it."""
        self.cut = packets.cut
        self.hold = packets.hold
        self._packets = packets
        self._arrived: defaultdict[str, list[bytes]] = defaultdict(list)

    @property
    def _now_s(self) -> float:
        return self.period_s * self.now

    def send(self, sender: str, receiver: str, data: bytes) -> None:
        """Send a packet, which may be lost, late or repeated."""
        self._packets.send(self._now_s, sender, receiver, data)

    def receive(self, receiver: str) -> list[bytes]:
        """The packets that have arrived."""
        for end, data in self._packets.due(self._now_s + _ROUNDING_S):
            self._arrived[end].append(data)
        return self._arrived.pop(receiver, [])

    def link(self, end: str) -> Link:
        """The link of one end."""
        return _AirLink(self, end)


@dataclass
class _AirLink:
    air: Air
    end: str

    def send(self, receiver: Role, data: bytes) -> None:
        self.air.send(self.end, receiver, data)

    def receive(self) -> list[bytes]:
        return self.air.receive(self.end)

    def close(self) -> None:
        pass


class _Line:
    """One end of a connection inside this process (`palmbots.links.local_connection`)."""

    def __init__(self, peer: "_Line | None" = None) -> None:
        self.peer = peer or _Line(self)
        self.frames: deque[Any] = deque()
        self.is_open = True

    def offer(self, frame: Any) -> bool:
        if not self.peer.is_open:
            raise ConnectionLost("the other end is gone")
        self.peer.frames.append(frame)
        return True

    send = offer

    def poll(self) -> Any:
        if not self.frames and not self.peer.is_open:
            raise ConnectionLost("the other end is gone")
        return self.frames.popleft() if self.frames else None

    def close(self) -> None:
        self.is_open = False


class _Memory:
    """What a robot stores; it survives the robot's boots."""

    works = is_done = True

    def __init__(self) -> None:
        self.state = StoredState()

    def keep(self, state: StoredState) -> None:
        self.state = state

    def boot(self) -> StoredState:
        self.state = self.state.booted()
        return self.state

    def settle(self) -> None:
        pass


class SimulatedPair:
    """Everything that `palmbots up` starts, stepped tick by tick.

    Args:
        folder: for the files of the pair.
        controller: of the robots.
        air: the radio.
        values: for ``pair.toml``.
        overrides: of the scene.
        world: its name.
        seed: of the noise.
        imperfections: what the robots really are; None: they are as in the scene.
        hardware: what each robot's program takes its hardware for, if it is imperfect.
        logs: whether robots and station log.
        scene: of the carry.
        stage: to which the motor boards are connected; None: the simulated world.
        open_driver: opens the driver of a robot in a scene, after what it has stored; None: one of
            the simulated world.
    """

    def __init__(
        self,
        folder: Path,
        controller: str,
        air: Air,
        values: Mapping[str, object] | None = None,
        overrides: Mapping[str, Any] | None = None,
        *,
        world: str = "quasistatic",
        seed: int = 0,
        imperfections: Imperfections | None = None,
        hardware: Mapping[Side, HardwareParameters] | None = None,
        logs: bool = False,
        scene: str = "paper",
        stage: Stage | None = None,
        open_driver: Callable[[Pair, Side, Scene, StoredState], Driver] | None = None,
    ) -> None:
        self.scene = load_scene(scene, {"task.distance_m": 0.3, **(overrides or {})})
        (folder / "scene.toml").write_text(self.scene.to_toml())
        file = folder / "pair.toml"
        init_pair(file, scene="scene.toml", controller=controller, values=dict(values or {}))
        self.pair, self.air = load_pair(file).with_logs(None, is_off=not logs), air
        self.period_s = air.period_s = self.scene.control.period_s
        watchdog = round(self.scene.control.watchdog_s / self.period_s)
        self._open_driver = open_driver
        self.stage: Stage
        if stage is not None:
            self.stage = stage
        elif imperfections is None:
            self.stage = perfect_stage(self.scene, world, seed)
        else:
            self.stage = ImperfectStage(self.scene, world, seed, imperfections)
        self._boards: dict[Side, Board] = {
            side: Board(self.stage, k, watchdog, 1.0) for k, side in enumerate(SIDES)
        }
        self._hardware = hardware or {}
        self.keepers: dict[Side, _Memory] = {side: _Memory() for side in SIDES}
        """What keeps the state of each robot; a test may make its disk slow (`is_done`)."""
        self._loops: dict[Side, RobotLoop] = {}
        self.frozen: set[Side] = set()
        """The robots whose programs are held up."""
        self.clock_rate: dict[Side, float] = dict.fromkeys(SIDES, 1.0)
        self._clock: dict[Side, float] = dict.fromkeys(SIDES, 0.0)
        self.lines: list[str] = []
        """What the station and the robots say."""
        self._station_log: StationLog | None = None
        for side in self.scene.working_sides:
            self.boot(side)
        self._start_station()

    @property
    def robots(self) -> dict[Side, Any]:
        """The core's programs of the robots that have power."""
        return {side: loop.robot for side, loop in self._loops.items()}

    @property
    def stored(self) -> dict[Side, StoredState]:
        """What the robots remember over a boot."""
        return {side: memory.state for side, memory in self.keepers.items()}

    @property
    def commands(self) -> dict[Side, Any]:
        """The newest command to each motor board; palm, move and stop for perfect robots."""
        return {side: board.command for side, board in self._boards.items()}

    def modes(self) -> tuple[RobotMode, ...]:
        """The modes of the robots that have power."""
        return tuple(loop.robot.mode for loop in self._loops.values())

    def end_of(self, side: Side) -> RobotEnd:
        """How the program of a robot has run so far."""
        return self._loops[side].end({})

    def now_s(self) -> float:
        """The time since the start."""
        return self.period_s * self.air.now

    def power_off(self, side: Side) -> None:
        """A robot without power: it hears nothing, and its wheels rest."""
        if (loop := self._loops.pop(side, None)) is not None:
            loop.close()
        board = self._boards[side]
        board.unplug()
        board.command = self.stage.rest(board.command)

    def boot(self, side: Side, scene: Scene | None = None) -> None:
        """Start the program of a robot; `scene`: another one than the pair's."""
        self.power_off(side)
        pair, chosen, memory = self.pair, scene or self.scene, self.keepers[side]
        state = memory.boot()
        if self._open_driver is None:
            driver = self._simulated_driver(side, chosen)
        else:
            driver = self._open_driver(pair, side, chosen, state)
        gauge = ReadingGauge(pair, side, chosen, driver.read(), state)

        def start(state: StoredState) -> tuple[Any, RobotLog]:
            return logged_program(
                pair, side, state, chosen, 1.0, self.lines.append, has_encoders=gauge.has_encoders
            )

        loop = RobotLoop(
            side, chosen, start, driver, self.air.link(side), _clock(), memory, gauge,
            watchdog=ticks_in(chosen.control.watchdog_s, self.period_s),
            on_line=self.lines.append,
        )  # fmt: skip
        loop.start(state, may_resume=pair.settings.limits.after_reboot == "rejoin")
        self._loops[side] = loop
        self._loops = {one: self._loops[one] for one in SIDES if one in self._loops}

    def _simulated_driver(self, side: Side, scene: Scene) -> Driver:
        """A driver that is connected to the motor board of a robot."""
        line, board = _Line(), self._boards[side]
        leads = (side == "right") == (scene.task.direction == "forward")
        driver = SimulatedDriver(
            line, side, 1, self.period_s,
            hardware=self._hardware.get(side), leads=leads, time=self.now_s,
        )  # fmt: skip
        line.peer.poll()  # the greeting, which an entrance takes
        board.plug(line.peer)  # ty: ignore[invalid-argument-type]  # has all that a board uses
        board.send(self.stage.frames()[SIDES.index(side)])
        return driver

    def press(self, side: Side, operation: Operation) -> None:
        """The operator presses a button of a robot."""
        self._loops[side].robot.operate(get_args(Operation).index(operation))

    def restart_station(self) -> None:
        """Start the station anew, after it has stored what it had to."""
        self._close_station()
        self._start_station()

    def _close_station(self) -> None:
        self.station.close()
        if self._station_log is not None:
            self._station_log.close()

    def _start_station(self) -> None:
        link = self.air.link("station")
        self.station = Station(self.pair, link, self.lines.append, self.now_s)
        if self.pair.log_folder() is not None:
            epoch = self.station.epoch
            self._station_log = StationLog(self.pair, epoch, self.scene, self.lines.append)
            self.station.on_note(self._station_log)

    def tick(self) -> None:
        """One control period of everything."""
        self.air.now += 1
        for (side, board), frame in zip(self._boards.items(), self.stage.frames(), strict=True):
            board.send(frame)
            if side not in self._loops:
                continue
            self._clock[side] += self.clock_rate[side]
            elapsed = int(self._clock[side])
            if elapsed > 0 and side not in self.frozen:
                self._clock[side] -= elapsed
                self._loops[side].step(elapsed)
        if self.air.now % round(PERIOD_S / self.period_s) == 0:
            self.station.step()
        self.move()

    def move(self) -> None:
        """The world alone: one control period with the newest commands."""
        for board in self._boards.values():
            board.take()
        self.stage.step(*self.commands.values())

    def run(self, ticks: int) -> None:
        """Let so many control periods pass."""
        for _ in range(ticks):
            self.tick()

    def run_until(self, modes: tuple[str, ...], within: int = 2000) -> None:
        """Tick until both robots are in one of these modes.

        Raises:
            AssertionError: they are not in time.
        """
        for _ in range(within):
            if all(mode in modes for mode in self.modes()):
                return
            self.tick()
        raise AssertionError((self.modes(), self.lines))

    def wish(self, operation: Operation, *modes: str) -> None:
        """The operator wants something, until both robots are in one of these modes."""
        self.station.wish(operation)
        self.run_until(modes)

    def start(self) -> None:
        """Arm and start both robots."""
        self.wish("arm", "armed")
        self.wish("start", "carrying", "holding")

    def carry(self) -> bool:
        """What `palmbots station --auto` does; whether both robots are done."""
        for done in carry_once(self.station, 600):
            if done is not None:
                return done
            self.run(round(PERIOD_S / self.period_s))
        raise AssertionError

    def carry_until_the_end(self) -> str:
        """Arm, start and carry; ``delivered``, ``dropped``, or why the robots stopped."""
        self.start()
        for _ in range(_MOST_TICKS):
            if self.stage.outcome != "running":
                return "dropped"
            if set(self.modes()) == {"done"}:
                return "delivered"
            if "fault" in self.modes():
                return "/".join(robot.fault for robot in self.robots.values())
            self.tick()
        return "timeout"

    def close(self) -> None:
        """Write what is left of the logs."""
        for loop in self._loops.values():
            loop.close()
        self._close_station()


def _clock() -> Any:
    """A `palmbots.clocks.clock.Clock` that is never late; the pair grants the ticks."""
    jitter = (0,) * (len(JITTER_LIMITS_MS) + 1)
    return SimpleNamespace(
        is_stepped=True, overruns=0, recent_overruns=0, jitter=jitter, forget=lambda: None
    )
