# SPDX-License-Identifier: Apache-2.0
"""Two emulated boards in lockstep with the exact world, as `palmbots up --lockstep` has processes.

The world draws all random numbers and passes the packets. A board gets its readings through its
switches and the packets by its radio, and answers with pulses and packets. So a carry has the trace
of one inside a single program if the firmware is right.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import palmbots as pb
import palmbots._core as _core
from emulator.board import Board, Image
from emulator.lockstep_dongle import LockstepDongle, station_program
from emulator.processor import CYCLES_PER_US, Violation
from emulator.tick_record import read_record
from palmbots._types import SIDES
from palmbots.boards.pair_settings import job_settings
from palmbots.boards.settings_page import (
    PAGE_ADDRESS,
    SWITCHES,
    BoardSettings,
    settings_page,
)  # fmt: skip
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.drivers.arm import FOLLOWS, HOLDS, REACHES, RISES, SINKS, ArmShape
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.lockstep_world import remote

KEY = bytes(range(16))
PAIR = 7
NEVER = 0xFFFFFFFF
PHASE = _core.wire.packet_kinds.index("phase")
PALM_US = (1300, 1700)
WHEEL_US = (
    1500, 1540, 1460, 1510, 1550, 1470,
    1501, 1461, 1541, 1491, 1451, 1531,
)  # fmt: skip
"""Pulses of left and right wheel, by stop and move, all different so that a command can be read."""
SWITCH_OF_SIGN = {-1: (0, 1, 2), 0: (3,), 1: (4, 5, 6)}
STEEP_END, SHALLOW_END = 7, 8
GOAL, BENEATH = 0, 6
"""In a job on the floor or at a stand the first and the last switch are not on the palm."""
LAYOUT = tuple(
    SWITCHES.index(name) for name in ("minus", "minus", "minus", "zero", "plus", "plus", "plus",
                                      "steep-end", "shallow-end")
)  # fmt: skip
ONTO_STAND = 32
"""A bit of `BoardSettings.job`."""
ARM_US = (900, 2100)
"""Pulses of the arm with the nose of a steep palm on the floor, and while the pair carries."""


def _with_job(settings: BoardSettings, scene: Scene, side: int) -> BoardSettings:
    """The settings with those of a job on the floor, if there is one."""
    if not (job := job_settings(scene, SIDES[side], _arm_us)):
        return settings
    places = {GOAL: "goal", BENEATH: "beneath"}
    switches = (SWITCHES.index(places[k]) if k in places else m for k, m in enumerate(LAYOUT))
    return replace(settings, switches=tuple(switches), **job)


def _arm_us(shape: ArmShape, height_m: float) -> float:
    """The pulse with which an arm has its pivot at this height."""
    share = (height_m - shape.floors_m[0]) / (shape.top_m - shape.floors_m[0])
    return ARM_US[0] + share * (ARM_US[1] - ARM_US[0])


def lockstep_settings(scene: Scene, entry: ControllerEntry, side: int) -> BoardSettings:
    """The settings of a board whose carry is under way from the boot, and whose controller alone
    decides, as `_core.runtime.RuntimeSettings.lockstep` has them."""
    spec = to_spec(scene)
    assert entry.board_number is not None
    leader = 1 if scene.task.direction == "forward" else 0
    settings = BoardSettings(
        role=side, key=KEY, pair=PAIR, first_epoch=1, last_epoch=1000, number=0,
        period_us=round(1e6 * scene.control.period_s),
        watchdog_us=round(1e6 * scene.control.watchdog_s),
        lease=NEVER, station_limit=NEVER, time_limit=NEVER, travel=0, stopping_limit=0, stopping=0,
        turn_limit=NEVER, most_overruns=0xFFFF, state_period=0, status_period=0,
        least_battery_mv=0, controller=entry.board_number, channel=60, power_dbm=0,
        rejoins=False, stops_without_station=False, stops_without_partner=False, has_radio=True,
        leads=side == leader, may_stop=bool(spec.brake), by_touch=bool(spec.start_by_touch),
        is_under_way=True, wheel_kind=0, debounce=1, palm_slew_us=2000, wheel_slew=2000,
        palm_us=PALM_US, wheels=WHEEL_US,
        times=tuple(_core.runtime.times(spec, entry.name)), switches=LAYOUT,
    )  # fmt: skip
    return _with_job(settings, scene, side)


class LockstepBoard:
    """One robot on a board, driven tick by tick."""

    def __init__(self, image: Image, settings: BoardSettings, table: bytes, seed: int) -> None:
        page = settings_page(settings, table)
        flash = image.flash[:PAGE_ADDRESS] + page
        self.board = Board(replace(image, flash=flash), seed)
        self.board.on_send = self._sends
        self.side = settings.role
        self.period = settings.period_us * CYCLES_PER_US
        self.sent: list[bytes] = []
        self.rejected = self.late = self.rejected_phases = self.late_phases = 0
        self.lifts, self.table = settings.job != 0, settings.table
        self.sinks_to_floor = self.lifts and not settings.job & ONTO_STAND
        self.palm = 0
        self.arm_us = 0
        self.phase = ""
        self.instructions: list[int] = []
        self.chance = seed
        self.power_up()

    def _sends(self, data: bytes) -> None:
        self.sent.append(data)

    def power_up(self) -> None:
        """Boot, until the timer runs; the ticks are counted from then."""
        self.board.boot()
        self._wait_for_timer()

    def _wait_for_timer(self) -> None:
        board = self.board
        while board.timer.started_at is None:
            board.run_us(10)
        self.next_tick = board.timer.started_at + self.period
        self.executed: int | None = None
        self.rejected = self.late = self.rejected_phases = self.late_phases = 0

    def reboot(self) -> None:
        """The left board loses its supply for a moment; the right one hangs until its watchdog
        resets it. The height of an arm that reaches is not stored: it begins low again."""
        self.arm_us *= self.phase != "touch"
        if self.side == 0:
            self.board.cut_power()
            self.power_up()
            return
        board = self.board
        before = len(board.resets)
        board.halt += round(1e6 * CYCLES_PER_US)  # longer than any watchdog here
        while len(board.resets) == before:
            board.run_us(1000)
        self._wait_for_timer()

    def _run_tick(self, elapsed: int) -> None:
        """Let `elapsed` ticks begin, of which the program sees only the last."""
        board = self.board
        before = self.next_tick + (elapsed - 1) * self.period
        if elapsed > 1:
            board.run(self.next_tick - 1)
            board.halt += before - board.now
        board.run(before - 10)
        if self.executed is not None:  # all that it has done since the tick before
            self.instructions.append(board.meter.instructions - self.executed)
        self.executed = board.meter.instructions
        board.run(before + 1000 * CYCLES_PER_US)
        self.next_tick = before + self.period

    def _finish_sending(self, packets: int) -> None:
        """Run until so many packets have left, and the radio listens again."""
        board = self.board
        end = self.next_tick - 20 * CYCLES_PER_US
        while (len(self.sent) < packets or not board.radio.listens) and board.now < end:
            board.run_a_little(end)
        if len(self.sent) < packets or not board.radio.listens:
            raise Violation("the packets of a tick do not leave within it")

    def receive(self, packets: list[bytes]) -> None:
        """Packets arrive, one after the other."""
        for data in packets:
            self._finish_sending(0)
            self.board.radio.receive(data)
            self.board.run_us(20)

    def greeting(self, expected: int) -> list[bytes]:
        """A round of greetings: the packets that the board sends."""
        self.sent = []
        self._run_tick(1)
        self._finish_sending(expected)
        return self.sent

    def step(
        self, elapsed: int, sign: int, palm_at_target: bool, packets: list[bytes], senses: Any
    ) -> Any:
        """One tick, as the world asks for it. Nothing measures the arm."""
        self.receive(packets)
        touches, _, far_enough, _, beneath = senses
        self.chance = self.chance * 1103515245 + 12345 & 0x7FFFFFFF
        places = (GOAL, BENEATH) if self.lifts else ()
        switches = [one for one in SWITCH_OF_SIGN[sign] if one not in places]
        closed = 1 << switches[(self.chance >> 8) % len(switches)]
        if self.lifts:
            closed = (closed if touches else 0) | far_enough << GOAL | beneath << BENEATH
        if palm_at_target:
            closed |= 1 << (STEEP_END if self.palm == 0 else SHALLOW_END)
        self.sent = []
        record = self.feel(closed, elapsed)
        self._check_arm(record["arm"])
        self._check_phase(record["phase"], palm_at_target)
        palm, move, stop = self.command()
        self.palm = palm
        if (palm, move, stop) != (record["palm"], record["move"], record["stop"]):
            raise Violation("the pulses are not what was decided")
        return self._answer(palm, move, stop, record)

    def _check_arm(self, does: int) -> None:
        """The pulse of the arm is what was decided."""
        before, self.arm_us = self.arm_us, self.pulses[3] if self.pulses else 0
        if self.lifts and before:
            moved = self.arm_us - before
            rises = moved >= 0
            is_right = {
                FOLLOWS: True, REACHES: rises, HOLDS: moved == 0, RISES: rises, SINKS: moved <= 0,
            }[does]  # fmt: skip
            if not is_right:
                raise Violation(f"the arm moves by {moved} us where it should do {does}")

    def _check_phase(self, number: int, palm_at_target: bool) -> None:
        """It is down on the floor only with a palm that has turned."""
        before, self.phase = self.phase, _core.lift_state_numbers[32 * self.table + number]
        if self.sinks_to_floor and (before, self.phase) == ("lower", "down") and not palm_at_target:
            raise Violation("the board is down while its palm turns")

    def feel(self, closed: int, elapsed: int) -> dict[str, int]:
        """One tick with these switches closed, until all its packets have left."""
        self.board.close_switches(closed)
        self._run_tick(elapsed)
        record = self.record()
        self._finish_sending(record["packets"])
        return record

    @property
    def pulses(self) -> tuple[int, ...]:
        """The newest pulses."""
        return self.board.pwm.pulses or ()

    def raw_record(self) -> bytes:
        """The record of the newest tick, as the firmware has it in its memory."""
        return self.board.variable("tick_record")

    def command(self) -> tuple[int, int, bool]:
        """What the pulses command."""
        pulses = self.pulses
        palm, left, right, _ = pulses
        for stop in (0, 1):
            for move in (0, 1, 2):
                at = 3 * stop + move
                if (left, right) == (WHEEL_US[at], WHEEL_US[6 + at]):
                    return PALM_US.index(palm), move, bool(stop)
        raise Violation(f"pulses that are no command: {pulses}")

    def record(self) -> dict[str, int]:
        """What the firmware notes for a debugger."""
        return read_record(self.raw_record())

    def _answer(self, palm: int, move: int, stop: bool, record: dict[str, int]) -> Any:
        packets = [
            (data[2] >> 4, data, data[19] if data[1] == PHASE else record["message"])
            for data in self.sent
        ]
        rejected = record["rejected"] - self.rejected
        late = record["late"] - self.late
        phases = (
            record["phase"],
            (record["rejected_phases"] - self.rejected_phases) % 256,
            (record["late_phases"] - self.late_phases) % 256,
        )
        self.rejected, self.late = record["rejected"], record["late"]
        self.rejected_phases, self.late_phases = record["rejected_phases"], record["late_phases"]
        return (
            palm, move, stop, packets, record["name"], bool(record["waits"]), record["awaits"],
            rejected, late, phases, bool(record["assists"]),
        )  # fmt: skip


class LockstepBoards:
    """Both robots on boards, and the station of the centralized algorithm behind a third.

    Args:
        image: the program of a robot, as `make` takes it.
        scene: of the carry.
        entry: the controller.
        seed: of the boards' random numbers.
        make: makes the board of a robot.
        dongle: the program of the station's radio; a controller with a station needs it.
    """

    def __init__(
        self, image: Any, scene: Scene, entry: ControllerEntry, seed: int = 0,
        make: Callable[..., LockstepBoard] = LockstepBoard, dongle: Image | None = None,
    ) -> None:  # fmt: skip
        spec = to_spec(scene)
        tables = [b"", b""]
        if entry.machines is not None:
            machines = entry.for_core(spec)
            tables = [machines.image(side) for side in (0, 1)]
        self.boards = [
            make(image, lockstep_settings(scene, entry, side), tables[side], seed + side)
            for side in map(SIDES.index, scene.working_sides)
        ]
        self.dongle: LockstepDongle | None = None
        if entry.team == "station" and not spec.on_one_palm:
            if dongle is None:
                raise ValueError("a station needs its radio: give the image of the dongle")
            period_us = round(1e6 * scene.control.period_s)
            station = station_program(KEY, PAIR)
            self.dongle = LockstepDongle(dongle, station, period_us, seed + 2)
        program = _core.runtime.Robot(
            spec, entry.for_core(spec), 0, KEY, PAIR, epoch=1, assists=False,
            settings=_core.runtime.RuntimeSettings.lockstep(), carries=True,
        )  # fmt: skip
        if program.greet() is not None:
            self._greet()

    def _greet(self) -> None:
        for speaks in range(3):
            turn = {0: 0, 2: 1}.get(speaks) if self.dongle is not None else speaks % 2
            sent = [board.greeting(int(side == turn)) for side, board in enumerate(self.boards)]
            for side, packets in enumerate(sent):
                for data in packets:
                    if self.dongle is None:
                        self.boards[1 - side].receive([data])
                    else:
                        self.boards[side].receive([self.dongle.greet(side, data)])
        for board in self.boards:  # what was rejected before the carry does not count
            board.greeting(0)
            board.rejected = board.record()["rejected"]

    def exchange(self, tick: int, left: Any, right: Any, station: Any) -> list[Any]:
        """Give each board its input of a tick, and return the answers."""
        answers: list[Any] = []
        of_side = {board.side: board for board in self.boards}
        for side, given in enumerate((left, right)):
            if given is None:
                answers.append(None)
                continue
            elapsed, sign, palm_at_target, boots, packets, senses = given
            board = of_side[side]
            if boots:
                board.reboot()
            answers.append(board.step(elapsed, sign, palm_at_target, packets, senses))
        if self.dongle is None:
            return [*answers, None]
        return [*answers, self.dongle.step(None if station is None else station[4])]


def carry_on_boards(
    image: Any, scene: Scene, controller: str, seed: int = 0,
    make: Callable[..., LockstepBoard] = LockstepBoard, dongle: Image | None = None,
) -> tuple[Any, LockstepBoards]:  # fmt: skip
    """A carry with two boards in the loop of the world.

    Args:
        image: the program, as `make` takes it.
        scene: of the carry.
        controller: of the robots.
        seed: of the carry.
        make: makes a board.
        dongle: the program of the station's radio, for a controller with a station.
    """
    entry = resolve(controller)
    boards = LockstepBoards(image, scene, entry, seed, make, dongle)
    return pb.carry(scene, remote(entry, boards.exchange), seed=seed), boards
