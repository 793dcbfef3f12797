# SPDX-License-Identifier: Apache-2.0
"""Two emulated boards in real time: their own clocks, a radio between them, hands on their buttons.

The boards run one after the other for a millisecond each, which is the shortest delay of the radio.
A packet that arrives while a board does not listen is lost, and so are packets that overlap.
"""

import math
import random
from copy import deepcopy
from dataclasses import dataclass, field, replace
from typing import Any

import palmbots._core as _core
from emulator.board import Board, Image, PowerFailed
from emulator.peripherals.radio import airtime_us
from emulator.processor import CYCLES_PER_US
from emulator.tick_record import FAULTS, read_record
from palmbots._types import SIDES, Side
from palmbots.boards.pair_settings import BoardPair
from palmbots.boards.settings_page import PAGE_ADDRESS, SWITCHES
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.episode import Episode
from palmbots.simulation.world_stage import FloorCommand, FloorStage
from palmbots.simulation.worlds import DEFAULT_WORLD

QUANTUM_US = 1000.0
MODES = _core.wire.robot_modes
Command = tuple[int, int, bool]
"""Palm, move and stop."""
A, B = 1, 2
"""The buttons."""


@dataclass
class LiveBoard:
    """One robot: its board and what is connected to it."""

    board: Board
    layout: tuple[int, ...]
    seed: int
    is_on: bool = True
    held: int = 0
    stuck: int = 0
    """Switches that are closed whatever happens."""
    is_unplugged: bool = False
    bounces_us: float = 0.0
    outage_s: float = 0.05
    """How long the supply is away when it fails in an instruction."""
    outbox: list[tuple[int, bytes]] = field(default_factory=list)
    inbox: list[tuple[int, bytes, bool]] = field(default_factory=list)
    off_until: int = 0
    sent_epochs: set[int] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.chance = random.Random(self.seed)
        self.board.on_send = self._sends
        self.board.can_erase = lambda: self.mode in ("off", "disarmed")
        self.sign, self.at_target = 0, True

    def _sends(self, data: bytes) -> None:
        self.outbox.append((self.board.now, data))
        self.sent_epochs.add(int.from_bytes(data[5:8], "little"))

    def note(self, name: str) -> int:
        """A field of the record of the newest tick."""
        return read_record(self.board.variable("tick_record"))[name]

    @property
    def mode(self) -> str:
        """The mode of the robot."""
        return MODES[self.note("mode")] if self.is_on else "off"

    @property
    def fault(self) -> str:
        """What is wrong with the board."""
        return FAULTS[self.note("fault")]

    def command(self) -> Command:
        """Palm, move and stop, as the pulses have it, or the commands to the motor board."""
        pulses, speeds = self.board.pwm.pulses, self.board.twi.newest
        # A motor board gets a register, and then direction and speed of each wheel.
        commanded = pulses[1:2] if speeds is None and pulses else (speeds or b"")[2::2]
        turns = any(commanded)
        if not self.is_on or not turns:
            return (self.note("palm") if self.is_on else self.last_palm, 0, True)
        self.last_palm = self.note("palm")
        return self.note("palm"), self.note("move"), bool(self.note("stop"))

    last_palm = 0

    def feel(self, sign: int, at_target: bool, touches: bool = True, beneath: bool = False) -> None:
        """Close the switches of the palm, and that of its place below an object on a stand."""
        names = {-1: "minus", 0: "zero", 1: "plus"}
        meant = [i for i, m in enumerate(self.layout) if SWITCHES[m] == names[sign]]
        closed = 1 << meant[0] if meant and touches else 0
        if beneath and (own := SWITCHES.index("beneath")) in self.layout:
            closed |= 1 << self.layout.index(own)
        if at_target:
            closed |= 1 << (7 if self.note("palm") == 0 else 8)
        closed |= self.stuck
        if self.is_unplugged:
            closed = 0
        if self.bounces_us and closed != self.board.closed:
            self.bouncing = (self.board.now, self.board.closed, closed)
        self.board.close_switches(closed)

    bouncing: tuple[int, int, int] | None = None

    def bounce(self) -> None:
        """Let switches that have just changed chatter."""
        if self.bouncing is None:
            return
        since, before, after = self.bouncing
        if self.board.now - since > self.bounces_us * CYCLES_PER_US:
            self.board.close_switches(after)
            self.bouncing = None
        else:
            self.board.close_switches(self.chance.choice((before, after)))


class LivePair:
    """A pair of boards in the exact world, without station.

    Args:
        image: the program of a robot.
        boards: the settings of the pair.
        seed: of everything random.
        clocks: how fast the crystals are.
        loss: share of the packets that are lost.
        bit_errors: share of the packets in whose buffer a bit is wrong, of the length or of the
            content, although the radio's checksum is right.
        held_at_power_up: buttons that are held at power-up.
        dongle: the program of the station's radio, if there is one.
    """

    def __init__(
        self, image: Image, boards: BoardPair, seed: int = 0,
        clocks: tuple[float, float] = (1.0, 1.0), loss: float = 0.0, bit_errors: float = 0.0,
        held_at_power_up: int = 0, dongle: Image | None = None,
    ) -> None:  # fmt: skip
        self.scene = boards.scene
        self.period_us = 1e6 * self.scene.control.period_s
        self.loss, self.bit_errors = loss, bit_errors
        self.chance = random.Random(seed)
        self.seed = seed
        self._endless = load_scene(
            self.scene, {"task.distance_m": 1000.0, "task.timeout_s": 10000.0}
        )
        self.job: FloorStage | None = None
        """The world of a job on the floor or at a stand."""
        if to_spec(self.scene).uses_floor:
            self.job = FloorStage(self.scene, DEFAULT_WORLD, seed)
        else:
            self.world = Episode(self._endless, seed, record=False)
        self.damaged = 0
        """Packets with a wrong bit."""
        self.collided = 0
        """Packets that nobody has received because two overlapped."""
        self._commands: list[tuple[Command, Command]] = []
        self.robots: list[LiveBoard] = []
        for number, side in enumerate(self.scene.working_sides):
            settings = boards.settings(side, 1)
            flash = image.flash[:PAGE_ADDRESS] + boards.page(side, 1)
            board = Board(replace(image, flash=flash), seed + number, clocks[number])
            robot = LiveBoard(board, settings.switches, seed + number)
            board.hold_buttons(held_at_power_up)
            board.boot()
            self.robots.append(robot)
        self.ends = [*self.robots]
        if dongle is not None:
            flash = dongle.flash[:PAGE_ADDRESS] + boards.dongle_page()
            self.dongle = LiveBoard(Board(replace(dongle, flash=flash), seed + 2), (), seed + 2)
            self.dongle.board.boot()
            self.ends.append(self.dongle)
        self.time_us = 0.0

    def exchange_serial(self, to_dongle: bytes) -> bytes:
        """Give the dongle the bytes of its serial line, and take what it has written."""
        board = self.dongle.board
        board.uart.feed(to_dongle)
        written, board.serial_out = board.serial_out, b""
        return written

    def tick(self) -> None:
        """One control period of the world."""
        if self.job is None:
            for robot, seen in zip(self.robots, self.world.seen(), strict=True):
                robot.feel(seen[0], bool(seen[1]))
        else:
            frames = dict(zip(SIDES, self.job.frames(), strict=True))
            for side, robot in self.of_side.items():
                seen = frames[side]
                robot.feel(seen.sign, seen.palm_at_target, seen.has_contact, seen.beneath)
        end_us = self.time_us + self.period_us
        while self.time_us < end_us - 1e-6:
            self.time_us = min(end_us, self.time_us + QUANTUM_US)
            for end in self.ends:
                self._run(end)
            self._pass_packets()
        if self.job is not None:
            self.job.step(*(self._floor_command(side) for side in SIDES))
            return
        left, right = (robot.command() for robot in self.robots)
        if self.is_held:
            self._commands.append((left, right))
            self._obey(left, right)

    @property
    def of_side(self) -> dict[Side, LiveBoard]:
        """The robots that work."""
        return dict(zip(self.scene.working_sides, self.robots, strict=True))

    def _floor_command(self, side: Side) -> FloorCommand:
        """What a robot commands in a job; an arm without pulses holds."""
        assert self.job is not None
        robot = self.of_side.get(side)
        if robot is None or not robot.is_on or robot.mode == "off":
            return self.job.rest(None)
        return (*robot.command(), robot.note("arm"), robot.note("phase"))

    def _obey(self, left: Command, right: Command) -> None:
        self.world.stop(left[2], right[2])
        self.world.step((*left[:2], 0), (*right[:2], 0), 1)

    def _run(self, robot: LiveBoard) -> None:
        until = round(self.time_us * CYCLES_PER_US)
        board = robot.board
        if not robot.is_on:
            board.offset += until - board.now
            robot.inbox.clear()
            if until >= robot.off_until:
                robot.is_on = True
                board.boot()
            return
        robot.bounce()
        try:
            for time, data, crc_ok in sorted(robot.inbox):
                board.run(min(time, until))
                if board.radio.listens:
                    board.radio.fill_buffer(data, crc_ok)
            robot.inbox.clear()
            board.run(until)
        except PowerFailed:
            self.cut_power(robot, robot.outage_s)

    def cut_power(self, robot: LiveBoard, seconds: float) -> None:
        """Cut the supply of a board for a time."""
        robot.last_palm = robot.note("palm")
        robot.board.cut_power()
        robot.is_on = False
        robot.off_until = robot.board.now + round(1e6 * seconds * CYCLES_PER_US)

    def _pass_packets(self) -> None:
        sent = [(t, data, n) for n, end in enumerate(self.ends) for t, data in end.outbox]
        for end in self.ends:
            end.outbox.clear()
        spans = [(t, t + round(airtime_us(len(d)) * CYCLES_PER_US), n) for t, d, n in sent]
        for (time, data, sender), (begin, end, _) in zip(sent, spans, strict=True):
            collides = any(b < end and begin < e and n != sender for b, e, n in spans)
            self.collided += collides
            if collides:
                continue
            arrives = time + round((airtime_us(len(data)) + QUANTUM_US) * CYCLES_PER_US)
            for n, end in enumerate(self.ends):
                if n != sender and self.chance.random() >= self.loss:
                    end.inbox.append((arrives, self._on_the_way(data), True))

    def _on_the_way(self, data: bytes) -> bytes:
        """What comes into the buffer of the receiver: length and content."""
        content = bytearray([len(data), *data])
        if self.chance.random() < self.bit_errors:
            place = self.chance.randrange(8 * len(content))
            content[place // 8] ^= 1 << place % 8
            self.damaged += 1
        return bytes(content)

    def snapshot(self) -> Any:
        """All that there is, to go back to."""
        ends = [
            (end.board.snapshot(), deepcopy({k: v for k, v in vars(end).items() if k != "board"}))
            for end in self.ends
        ]
        return ends, list(self._commands), self.chance.getstate(), self.time_us

    def restore(self, snapshot: Any) -> None:
        """Go back. The world repeats the commands that it has obeyed."""
        ends, commands, chance, self.time_us = snapshot
        for end, (board, own) in zip(self.ends, ends, strict=True):
            end.board.restore(board)
            vars(end).update(deepcopy(own))
        self.chance.setstate(chance)
        self._commands = list(commands)
        self.world = Episode(self._endless, self.seed, record=False)
        for left, right in commands:
            self._obey(left, right)

    def run(self, seconds: float) -> None:
        """Run for a time."""
        for _ in range(math.ceil(seconds / self.scene.control.period_s)):
            self.tick()

    def run_until(self, *modes: str, within_s: float = 5.0) -> bool:
        """Run until both robots are in one of these modes; False: they are not in time."""
        for _ in range(math.ceil(within_s / self.scene.control.period_s)):
            if all(robot.mode in modes for robot in self.robots):
                return True
            self.tick()
        return all(robot.mode in modes for robot in self.robots)

    def press(self, buttons: int, *sides: int) -> None:
        """Press and release buttons of these robots, of both by default."""
        chosen = [self.robots[side] for side in sides] or self.robots
        for robot in chosen:
            robot.board.hold_buttons(buttons)
        self.run(0.1)
        for robot in chosen:
            robot.board.hold_buttons(0)
        self.run(0.1)

    def start(self) -> bool:
        """Arm and start both robots by their buttons; whether they carry.

        A robot that has not heard its partner's settings yet refuses to be armed, so its button is
        pressed again.
        """
        self.run(0.5)
        self.press(A)
        for _ in range(3):
            waiting = [n for n, robot in enumerate(self.robots) if robot.mode == "disarmed"]
            if waiting:
                self.run(0.5)
                self.press(A, *waiting)
        self.press(B)
        return self.run_until("carrying", "holding", within_s=2.0)

    @property
    def is_held(self) -> bool:
        """The object has not been dropped."""
        return (self.world if self.job is None else self.job).outcome != "dropped"

    def state(self) -> list[dict[str, Any]]:
        """What the robots report, for messages of tests."""
        return [{"mode": r.mode, "fault": r.fault, "resets": r.board.resets} for r in self.robots]
