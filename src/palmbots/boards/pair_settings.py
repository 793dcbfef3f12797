# SPDX-License-Identifier: Apache-2.0
"""The settings of a pair's boards, from its ``pair.toml``, and the refusal of what cannot work."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.boards.settings_page import (
    MOST_POWER,
    PERIODS_S,
    SWITCHES,
    WATCHDOGS_S,
    BoardSettings,
    radio_settings,
    settings_page,
)
from palmbots.control.registry import ControllerEntry
from palmbots.drivers.arm import ArmShape, arm_shape
from palmbots.drivers.hardware import (
    HardwareParameters,
    arm_servo_angle,
    check_arm_hardware,
    motor_command,
    motor_power,
    oriented,
    servo_angle,
    servo_pulse_s,
    wheel_rates,
)
from palmbots.errors import PalmbotsError
from palmbots.pair.board_keys import PULSES_S, BoardTable
from palmbots.pair.drive_table import drive_table
from palmbots.pair.pair_file import Pair
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.robot.core_program import controller_of
from palmbots.robot.live_robot import core_settings
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

BOOTS_PER_IMAGE = 16384
"""How many boots an image may count. Each new image begins beyond those of the one before."""
PALM_SWITCHES = 7
"""Switches along the palm; the two others of the matrix feel its ends."""
MOST_ARM_STEPS = 15
"""How many steps of its arm a board can store."""
MOST_BATTERY_V = 3.3
"""The board measures its own supply."""


@dataclass(frozen=True)
class BoardPair:
    """A pair whose robots are boards."""

    pair: Pair
    scene: Scene
    entry: ControllerEntry

    def page(self, side: Side, first_epoch: int) -> bytes:
        """The page of the settings of one robot."""
        spec = to_spec(self.scene)
        table = b""
        if self.entry.machines is not None:
            table = self.entry.for_core(spec).image(SIDES.index(side))
        return settings_page(self.settings(side, first_epoch), table)

    def dongle_page(self) -> bytes:
        """The page of the settings of the station's radio, which has no key."""
        board = self.pair.settings.board
        return settings_page(radio_settings(board.channel, board.power_dbm))

    def settings(self, side: Side, first_epoch: int) -> BoardSettings:
        """The settings of one robot.

        Args:
            side: which of the two.
            first_epoch: epoch of the first boot with the image.
        """
        pair, scene, entry = self.pair, self.scene, self.entry
        assert entry.board_number is not None  # `board_pair` has refused the others
        board, hardware = pair.settings.board, pair.settings.hardware.of(side)
        spec = to_spec(scene)
        period_s = scene.control.period_s
        robot, palm = scene.robot_of(side), scene.palm_of(side)
        travel_s = scene.task.distance_m / robot.speed_m_s if robot.speed_m_s > 0 else 0.0
        core = core_settings(pair, scene, entry, travel_s)
        turn_s = abs(palm.steep_deg - palm.shallow_deg) / palm.rate_deg_s
        leads = (side == "right") == (scene.task.direction == "forward")
        palm_us = tuple(
            round(1e6 * servo_pulse_s(hardware, servo_angle(hardware, math.radians(angle))))
            for angle in (palm.steep_deg, palm.shallow_deg)
        )
        signs = {"-": "minus", "0": "zero", "+": "plus"}
        along = [SWITCHES.index(signs[zone.sign]) for zone in hardware.switches]
        ends = [SWITCHES.index("steep-end"), SWITCHES.index("shallow-end")]
        places = [SWITCHES.index(name) for name in _places(board)]
        slew = abs(palm_us[1] - palm_us[0]) * period_s / turn_s if turn_s > 0 else 2000
        return BoardSettings(
            role=SIDES.index(side), key=pair.key, pair=pair.settings.pair.number,
            first_epoch=first_epoch, last_epoch=first_epoch + BOOTS_PER_IMAGE - 1,
            number=core["number"], period_us=round(1e6 * period_s),
            watchdog_us=round(1e6 * scene.control.watchdog_s), lease=core["lease"],
            station_limit=core["station_limit"], time_limit=core["time_limit"],
            travel=core["travel"], stopping_limit=core["stopping_limit"],
            stopping=math.ceil(hardware.stopping_s / period_s - 1e-9),
            turn_limit=math.ceil(2 * turn_s / period_s) + 20,
            most_overruns=core["most_overruns"], state_period=core["state_period"],
            status_period=core["status_period"], order_age=order_periods(core),
            least_battery_mv=round(1000 * hardware.battery_low_v),
            controller=entry.board_number,
            channel=board.channel, power_dbm=board.power_dbm, rejoins=core["rejoins"],
            stops_without_station=core["stops_without_station"],
            stops_without_partner=core["stops_without_partner"], has_radio=core["has_radio"],
            leads=leads, may_stop=bool(spec.brake), by_touch=bool(spec.start_by_touch),
            wheel_kind=int(board.wheels == "motor-board"),
            debounce=max(1, math.ceil((board.bounce_s - 1e-9) / period_s)),
            palm_slew_us=max(1, math.ceil(slew - 1e-9)),
            wheel_slew=self._wheel_slew(hardware, period_s),
            switches=(*along, *[0] * (PALM_SWITCHES - len(along) - len(places)), *places, *ends),
            palm_us=(palm_us[0], palm_us[1]), wheels=self._wheels(side, hardware, leads),
            times=tuple(_core.runtime.times(spec, entry.name)),
            **self._job(side, hardware),
        )  # fmt: skip

    def _job(self, side: Side, hardware: HardwareParameters) -> dict[str, Any]:
        """The settings of a job on the floor or at a stand; none for another carry."""

        def pulse_us(shape: ArmShape, height_m: float) -> float:
            return 1e6 * servo_pulse_s(hardware, arm_servo_angle(hardware, shape, height_m))

        return job_settings(self.scene, side, pulse_us)

    def _share(self, power: float) -> int:
        """A share of full power as a pulse [us] or a speed of the motor board."""
        board = self.pair.settings.board
        if board.wheels == "motor-board":
            return round(MOST_POWER * power)
        return round(1e6 * (board.wheel_rest_s + board.wheel_full_s * power))

    def _wheel_slew(self, hardware: HardwareParameters, period_s: float) -> int:
        share = hardware.acceleration_m_s2 * period_s / hardware.full_speed_m_s
        return max(1, abs(self._share(share) - self._share(0.0)))

    def _wheels(self, side: Side, hardware: HardwareParameters, leads: bool) -> tuple[int, ...]:
        """Of the left and the right wheel, by stop and move."""
        drives = drive_table(self.scene, side)
        sense = -1.0 if leads else 1.0  # forward is towards the partner
        found: list[tuple[int, int]] = []
        for stop in (False, True):
            for move in (0, 1, 2):
                rates = wheel_rates(hardware, sense * drives[0, move, stop, True].speed_m_s)
                commands = [motor_command(hardware, rate, turns=True) for rate in rates]
                powers = oriented(hardware, [motor_power(hardware, c) for c in commands])
                found.append((self._share(powers[0]), self._share(powers[1])))
        return (*(left for left, _ in found), *(right for _, right in found))


def job_settings(
    scene: Scene, side: Side, pulse_us: Callable[[ArmShape, float], float]
) -> dict[str, Any]:
    """The settings of a job on the floor or at a stand; none for another carry.

    Args:
        scene: the scene.
        side: of the robot.
        pulse_us: the pulse [us] with which an arm has its pivot at a height [m].
    """
    spec = to_spec(scene)
    if not spec.uses_floor:
        return {}
    shape = arm_shape(scene, side)
    pulses = partial(pulse_us, shape)
    per_m = abs(pulses(shape.top_m) - pulses(shape.floors_m[0]))
    per_m *= 256 / (shape.top_m - shape.floors_m[0])
    steep, shallow = (round(pulses(height)) for height in shape.floors_m)
    first, last = (round(pulses(height)) for height in shape.lows_m)
    return {
        "phase_times": tuple(_core.runtime.phase_times(spec)),
        "arm_floor_us": (steep, shallow),
        "arm_low_us": (first, last),
        "arm_clear_us": round(pulses(shape.clear_m)),
        "arm_top_us": round(pulses(shape.top_m)),
        "arm_slew": max(1, round(per_m * shape.rate_m_s * scene.control.period_s)),
        "arm_step": max(1, round(per_m * shape.step_m)),
        "job": _job_bits(scene, side),
        "table": _core.runtime.job_table(spec),
    }


def _job_bits(scene: Scene, side: Side) -> int:
    """The bits of a job on the floor or at a stand (`BoardSettings.job`)."""
    begins, ends = scene.task.ends
    leads = (side == "right") == (scene.task.direction == "forward")
    level_only = _core.corrects_level_only(to_spec(scene))
    bits = (True, begins != "palms", ends != "palms", scene.task.dock == "one-first" and not leads,
            begins == "stand", ends == "stand", level_only)  # fmt: skip
    return sum(bit << place for place, bit in enumerate(bits))


def _places(board: BoardTable) -> tuple[str, ...]:
    """The switches that are not on the palm, the last of the row."""
    given = {"beneath": board.stand_switch, "goal": board.goal_switch}
    return tuple(name for name, is_there in given.items() if is_there)


def order_periods(core: Mapping[str, Any]) -> int:
    """The greatest age of an order, in periods of the status."""
    return max(1, min(0xFF, round(core["order_age"] / core["status_period"])))


def board_pair(pair: Pair) -> BoardPair:
    """Check that the robots of a pair can be boards.

    Raises:
        PalmbotsError: they cannot; the message says what to change.
    """
    scene = pair.checked_scene()
    entry = controller_of(pair)
    if entry.team == "station":
        raise PalmbotsError(
            f"pair.controller: {entry.name} needs a station that decides; allowed: a controller "
            "that runs on the robots"
        )
    if entry.board_number is None:
        raise PalmbotsError(
            f"pair.controller: {entry.name} is a class in Python; allowed: a shipped controller, "
            "or a policy FILE.toml"
        )
    if entry.machines is not None:
        _check_table(entry, scene)
    _check_times(scene)
    core_settings(pair, scene, entry, 0.0)  # refuses time bounds that cannot be kept
    board = pair.settings.board
    _check_switches(board, scene)
    for side in scene.working_sides:
        hardware = pair.settings.hardware.of(side)
        _check_hardware(hardware, side, scene, most=PALM_SWITCHES - len(_places(board)))
    if board.wheels == "motor-board" and not 0 < board.motor_timeout_s <= scene.control.watchdog_s:
        kept = "keeps its last speed" if board.motor_timeout_s == 0 else "stops too late"
        raise PalmbotsError(
            f"board.motor_timeout_s: value is {board.motor_timeout_s:g}: a motor board that {kept} "
            "while the processor is silent is refused; allowed: more than 0, at most "
            f"control.watchdog_s, {scene.control.watchdog_s:g} s"
        )
    return BoardPair(pair, scene, entry)


def _check_table(entry: ControllerEntry, scene: Scene) -> None:
    entry.for_core(to_spec(scene))


def _check_times(scene: Scene) -> None:
    period_s, watchdog_s = scene.control.period_s, scene.control.watchdog_s
    period_us = 1e6 * period_s
    is_whole = abs(period_us / 5 - round(period_us / 5)) < 1e-6
    if not PERIODS_S[0] <= period_s <= PERIODS_S[1] or not is_whole:
        raise PalmbotsError(
            f"control.period_s: value is {period_s:g}; allowed on a board: a multiple of 5 µs, "
            f"from {PERIODS_S[0]:g} to {PERIODS_S[1]:g} s"
        )
    least_s = max(WATCHDOGS_S[0], 2 * period_s)
    if not least_s <= watchdog_s <= WATCHDOGS_S[1]:
        raise PalmbotsError(
            f"control.watchdog_s: value is {watchdog_s:g}; allowed on a board: {least_s:g} to "
            f"{WATCHDOGS_S[1]:g} s, because an erase of its flash memory takes 0.088 s, and its "
            "wheels keep turning until a reset"
        )
    for side, robot in zip(SIDES, to_spec(scene).robots, strict=True):
        if robot.stride > 1:
            raise PalmbotsError(
                f"robot.{side}.period_s: value is {scene.robot_of(side).period_s:g}; allowed on a "
                f"board: control.period_s, {period_s:g}"
            )


def _check_switches(board: BoardTable, scene: Scene) -> None:
    """Refuse a job for which the board lacks the switch of a place, or has one that misleads."""
    if scene.task.ends[0] == "stand" and not board.stand_switch:
        raise PalmbotsError(
            "board.stand_switch: value is false, and without encoders a board notices only by this "
            "switch that it is below an object on a stand; allowed: true"
        )
    if scene.task.dock == "hand-over" and board.goal_switch:
        raise PalmbotsError(
            'board.goal_switch: value is true, and with task.dock = "hand-over" the robot that '
            "takes the object drives past that place twice; allowed: false"
        )


def _check_arm(hardware: HardwareParameters, side: Side, scene: Scene) -> None:
    shape = arm_shape(scene, side)
    check_arm_hardware(hardware, side, shape)
    steps = (shape.top_m - min(shape.lows_m)) / shape.step_m
    if steps >= MOST_ARM_STEPS:
        raise PalmbotsError(
            f"arm.carry_height_m: the arm of the {side} robot would rise {steps:.1f} steps of "
            f"{1000 * shape.step_m:.3g} mm (arm.rate_m_per_s times lease and delay); allowed on a "
            f"board: fewer than {MOST_ARM_STEPS}"
        )


def _check_hardware(hardware: HardwareParameters, side: Side, scene: Scene, *, most: int) -> None:
    if len(hardware.switches) > most:
        raise PalmbotsError(
            f"hardware.switches: {len(hardware.switches)} switches on the {side} palm; allowed on "
            f"a board: at most {most}"
        )
    if to_spec(scene).uses_floor:
        _check_arm(hardware, side, scene)
    if hardware.battery_low_v > MOST_BATTERY_V:
        raise PalmbotsError(
            f"hardware.battery_low_v: value is {hardware.battery_low_v:g}; allowed on a board: at "
            f"most {MOST_BATTERY_V:g} V, because it measures its own supply"
        )
    limit_s = stopping_limit_s(scene)
    if hardware.stopping_s > limit_s + 1e-9:
        raise PalmbotsError(
            f"hardware.stopping_s: value is {hardware.stopping_s:g}; allowed: at most "
            f"{limit_s:g} s, the time in which the scene's robots brake"
        )
    palm = scene.palm_of(side)
    for key, angle in (("steep_deg", palm.steep_deg), ("shallow_deg", palm.shallow_deg)):
        wanted = hardware.servo_zero_deg + hardware.servo_scale * angle
        if not hardware.servo_min_deg <= wanted <= hardware.servo_max_deg:
            raise PalmbotsError(
                f"palm.{key}: the servo of the {side} robot would have to turn to {wanted:g} "
                f"degrees; allowed: hardware.servo_min_deg to servo_max_deg, "
                f"{hardware.servo_min_deg:g} to {hardware.servo_max_deg:g}"
            )
    for name in ("servo_min_pulse_s", "servo_max_pulse_s"):
        pulse_s = getattr(hardware, name)
        if not PULSES_S[0] <= pulse_s <= PULSES_S[1]:
            raise PalmbotsError(
                f"hardware.{name}: value is {pulse_s:g}; allowed on a board: {PULSES_S[0]:g} to "
                f"{PULSES_S[1]:g} s"
            )
