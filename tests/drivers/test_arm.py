# SPDX-License-Identifier: Apache-2.0
"""The arm of a real robot: as fast as the scene allows, and within a step after a boot."""

import math
import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from live_faults import SHORT_WAY
from palmbots._types import SIDES
from palmbots.drivers.arm import (
    FOLLOWS,
    HOLDS,
    REACHES,
    RISES,
    SINKS,
    ArmMotion,
    ArmShape,
    StoredArm,
    arm_shape,
)
from palmbots.drivers.driver import Drive, DriverSettings, RawReading, targets
from palmbots.drivers.driver_registry import open_driver
from palmbots.drivers.hardware import HardwareParameters, arm_servo_angle, servo_angle
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.errors import PalmbotsError
from palmbots.pair.launcher import UP
from palmbots.simulation.world_stage import FloorStage
from palmbots.station.simulated_pair import Air, SimulatedPair

SHAPE = ArmShape(
    floors_m=(0.02, 0.008), top_m=0.15, rate_m_s=0.05, step_m=0.027, ends=("floor", "floor"),
    lows_m=(0.02, 0.02),
)  # fmt: skip
PERIOD_S = 0.01


def test_the_shape_is_that_of_the_scene() -> None:
    shape = arm_shape(pb.load_scene("lift"), "left")
    # A pivot below the middle of a palm whose nose is on the floor: half the length times the sine,
    # and less than the thickness of the plate.
    for height_m, angle_deg in zip(shape.floors_m, (15.0, 5.0), strict=True):
        assert height_m == pytest.approx(0.075 * math.sin(math.radians(angle_deg)), abs=1.5e-3)
    assert (shape.top_m, shape.rate_m_s) == (0.15, 0.05)
    assert 0.005 < shape.step_m < 0.05


def test_an_arm_rises_holds_and_sinks_at_its_rate() -> None:
    arm = ArmMotion(SHAPE)
    arm.move(FOLLOWS, 0, PERIOD_S)
    assert (arm.pivot_m, arm.steps, arm.is_there(True)) == (0.02, 0, True)
    arm.move(FOLLOWS, 1, PERIOD_S)
    assert (arm.pivot_m, arm.steps) == (pytest.approx(0.008), 0)
    before, ticks = arm.pivot_m, 0
    while not (ticks and arm.is_there(True)):
        arm.move(RISES, 0, PERIOD_S)
        assert 0 <= arm.pivot_m - before <= 0.05 * PERIOD_S + 0.012 * (ticks == 0) + 1e-12
        assert arm.steps == math.floor((arm.pivot_m - 0.02) / 0.027 + 1e-12)
        before, ticks = arm.pivot_m, ticks + 1
    assert arm.pivot_m == 0.15
    assert ticks == pytest.approx(0.13 / 0.05 / PERIOD_S, abs=26)
    arm.move(HOLDS, 1, PERIOD_S)
    assert (arm.pivot_m, arm.is_there(False)) == (0.15, True)
    arm.move(SINKS, 1, PERIOD_S)
    assert not arm.is_there(True)
    while not arm.is_there(True):
        arm.move(SINKS, 1, PERIOD_S)
    assert arm.pivot_m == pytest.approx(0.008)


@pytest.mark.parametrize("seed", range(20))
def test_after_a_boot_an_arm_is_where_its_partner_may_rely_on(seed: int) -> None:
    """It goes on at the end of its step from which it came, or at the top."""
    chance = random.Random(seed)
    arm = ArmMotion(SHAPE)
    rises = True
    for _ in range(30):
        rises = chance.random() < 0.5
        for _ in range(chance.randrange(1, 200)):
            arm.move(RISES if rises else SINKS, 0, PERIOD_S)
        again = ArmMotion(SHAPE, arm.stored)
        for _ in range(3):  # it boots again and again, and does not climb meanwhile
            again = ArmMotion(SHAPE, again.stored)
        assert abs(again.pivot_m - arm.pivot_m) <= SHAPE.step_m
        if arm.pivot_m in (0.02, 0.15):
            assert again.pivot_m == arm.pivot_m
        elif rises:
            assert again.pivot_m <= arm.pivot_m + 1e-12
        else:
            assert again.pivot_m >= arm.pivot_m - 1e-12


AT_STANDS = replace(SHAPE, ends=("stand", "stand"), lows_m=(0.06, 0.05), clear_m=0.1)


def test_at_a_stand_an_arm_stops_where_its_palm_touches_and_counts_from_there() -> None:
    arm = ArmMotion(AT_STANDS)
    assert arm.pivot_m == 0.06
    arm.move(FOLLOWS, 0, PERIOD_S)
    assert (arm.pivot_m, arm.steps) == (0.06, 0)
    for _ in range(10):
        arm.move(REACHES, 0, PERIOD_S)
    assert arm.pivot_m == pytest.approx(0.065)
    assert arm.stored == StoredArm(0.06, 0.06)  # little is stored while it moves
    for _ in range(3):  # a command that is late no longer lifts the object
        arm.move(REACHES, 0, PERIOD_S, touches=True)
        assert arm.pivot_m == pytest.approx(0.065)
    arm.move(HOLDS, 0, PERIOD_S)
    assert arm.stored == pytest.approx(StoredArm(0.065, 0.065))
    for _ in range(60):
        arm.move(RISES, 0, PERIOD_S)
    assert arm.pivot_m == pytest.approx(0.095)
    assert arm.steps == 1
    assert arm.stored == pytest.approx(StoredArm(0.065 + 0.027, 0.065))


def test_boots_do_not_move_an_arm_that_holds() -> None:
    """Also at the end of the job, where a robot that has restarted does not know that yet."""
    for ticks in range(0, 220, 7):
        arm = ArmMotion(AT_STANDS, StoredArm(0.15, 0.065))
        for _ in range(ticks):
            arm.move(SINKS, 0, PERIOD_S, ends=True)
        first = ArmMotion(AT_STANDS, arm.stored)
        again = first
        for _ in range(4):
            again = ArmMotion(AT_STANDS, again.stored)
            again.move(HOLDS, 0, PERIOD_S)
        assert arm.pivot_m - 1e-12 <= first.pivot_m <= arm.pivot_m + AT_STANDS.step_m
        assert again.pivot_m == first.pivot_m


def test_little_is_stored_in_a_whole_job() -> None:
    arm = ArmMotion(AT_STANDS)
    stored = {arm.stored}
    for motion, ends, ticks in (
        (FOLLOWS, False, 5), (REACHES, False, 50), (HOLDS, False, 5), (RISES, False, 200),
        (HOLDS, False, 5), (HOLDS, True, 5), (SINKS, True, 250), (FOLLOWS, True, 5),
        (FOLLOWS, False, 50),
    ):  # fmt: skip
        for _ in range(ticks):
            arm.move(motion, 0, PERIOD_S, ends=ends)
            stored.add(arm.stored)
    assert len(stored) <= 10


def test_an_arm_that_feels_nothing_reaches_no_higher_than_the_object_can_be() -> None:
    arm = ArmMotion(AT_STANDS)
    for _ in range(200):
        arm.move(REACHES, 0, PERIOD_S)
    assert arm.pivot_m == AT_STANDS.clear_m


def test_at_the_end_of_the_job_an_arm_sinks_to_below_the_object_there() -> None:
    arm = ArmMotion(AT_STANDS, StoredArm(0.15, 0.065))
    assert (arm.pivot_m, arm.steps) == (0.15, 3)
    arm.move(HOLDS, 0, PERIOD_S, ends=True)
    assert arm.steps == 3  # from 5 cm on
    for _ in range(300):
        arm.move(SINKS, 0, PERIOD_S, ends=True)
    assert (arm.pivot_m, arm.steps, arm.is_there(False)) == (0.05, 0, True)
    # Disarmed, it goes to where the next job begins, no faster than it may.
    arm.move(FOLLOWS, 0, PERIOD_S)
    assert arm.pivot_m == pytest.approx(0.05 + 0.05 * PERIOD_S)


def test_an_arm_that_was_never_commanded_is_where_the_job_begins() -> None:
    assert ArmMotion(SHAPE).pivot_m == 0.02
    up = ArmMotion(replace(SHAPE, ends=("palms", "floor")))
    assert (up.pivot_m, up.steps) == (0.15, 4)
    assert ArmMotion(replace(SHAPE, ends=("palms", "floor")), StoredArm(0.02, 0.02)).pivot_m == 0.02


def test_after_another_job_steps_count_from_where_this_one_begins() -> None:
    """The height at which a palm touched is that of an object on another stand."""
    assert ArmMotion(SHAPE, StoredArm(0.15, 0.1)).steps == 4
    assert ArmMotion(AT_STANDS, StoredArm(0.1, 0.02)).steps == 1
    assert ArmMotion(AT_STANDS, StoredArm(0.15, 0.12)).steps == 1


@pytest.mark.parametrize(
    ("scene", "overrides"),
    [
        ("lift", {"task.distance_m": 0.3}),
        ("lift", {"task.distance_m": 0.3, "task.from": "palms"}),
        ("stand", SHORT_WAY["stand"]),
        ("stand", SHORT_WAY["stand"] | {"task.dock": "one-first",
         "floor.stands": [{"from_m": x - 0.2, "to_m": x + 0.2, "height_m": h, "gap_m": 0.26}
                          for x, h in ((0.0, 0.1), (0.5, 0.08))]}),
        ("lone", SHORT_WAY["lone"]),
        ("handover", SHORT_WAY["handover"]),
    ],
)  # fmt: skip
def test_it_moves_and_counts_as_the_simulated_arm(
    scene: str, overrides: dict[str, Any], tmp_path: Path
) -> None:
    """Tick by tick, in a whole job. On the floor the arm of the world follows the palm that turns;
    that of a driver is at once where the palm turns to, and yields to the floor."""
    pair = SimulatedPair(
        tmp_path, "shared-sign", Air(), UP, {"arm.height_error_m": 0.0, **overrides}, scene=scene
    )
    assert isinstance(pair.stage, FloorStage)
    arms = {side: ArmMotion(arm_shape(pair.scene, side)) for side in pair.scene.working_sides}
    pair.start()
    ticks = 0
    while set(pair.modes()) != {"done"}:
        pair.tick()
        for side, arm in arms.items():
            k, robot = SIDES.index(side), pair.robots[side]
            arm.move(robot.arm, pair.commands[side][0], PERIOD_S, ends=robot.arm_ends)
            seen, height_m = pair.stage.frames()[k], pair.stage.heights_m[k]
            steep_m = max(arm_shape(pair.scene, side).floors_m)
            if min(arm.pivot_m, height_m) > steep_m:
                assert arm.pivot_m == pytest.approx(height_m, abs=1e-9)
                assert arm.is_there(True) == seen.arm_there
                assert arm.steps == seen.arm_steps
            assert max(arm.pivot_m, height_m) <= max(min(arm.pivot_m, height_m), steep_m) + 1e-9
        ticks += 1
        assert ticks < 9000, pair.robots
    pair.close()


def test_a_driver_turns_the_servo_of_the_arm() -> None:
    hardware = HardwareParameters(arm_floor_deg=150, arm_top_deg=30)
    io = HardwareIo(hardware, leads=False, arm=SHAPE)
    seen = io.reading(RawReading((0.0, 0.0), (False, True, False)), 0.0)
    assert (seen.arm_there, seen.arm_steps) == (False, 0)
    for tick in range(200):
        drive = Drive(0, 0, True, False, 0.2, 0.0, arm=RISES)
        command = io.command(drive, tick * PERIOD_S)
    assert command.arm_rad is not None
    share = (math.degrees(command.arm_rad) - 150) / (30 - 150)
    assert 0.13 * share == pytest.approx(199 * PERIOD_S * 0.05)
    after = io.command(Drive(0, 0, True, False, 0.2, 0.0, arm=RISES), 60.0)  # it was held up
    assert after.arm_rad is not None
    assert abs(after.arm_rad - command.arm_rad) < math.radians(120 / 0.13 * 0.05 * 0.051)
    assert arm_servo_angle(hardware, SHAPE, 0.15) == pytest.approx(math.radians(30))


def test_an_arm_is_down_once_its_palm_has_turned() -> None:
    """The floor is higher for a steep palm, which turns for a while."""
    hardware = HardwareParameters(arm_floor_deg=150, arm_top_deg=30)
    io = HardwareIo(hardware, leads=False, arm=SHAPE)
    steep, shallow = (
        Drive(palm, 0, True, False, rad, 0.0, arm=SINKS) for palm, rad in ((0, 0.26), (1, 0.09))
    )

    def is_down(drive: Drive, palm_rad: float, now_s: float) -> bool:
        io.command(drive, now_s)
        servo_rad = servo_angle(hardware, palm_rad)
        return io.reading(RawReading((0.0, 0.0), (False, True, False), servo_rad), now_s).arm_there

    io.command(replace(steep, arm=RISES), 0.0)
    assert is_down(steep, 0.26, 0.01)
    sunk = [is_down(shallow, 0.09, 0.01 * tick) for tick in range(2, 60)]
    assert not sunk[0]
    assert sunk[-1]
    assert not is_down(steep, 0.09, 0.61)
    assert not is_down(steep, 0.2, 0.62)
    assert is_down(steep, 0.26, 0.63)


def test_a_switch_stops_an_arm_before_the_program_knows() -> None:
    hardware = HardwareParameters(arm_floor_deg=150, arm_top_deg=30)
    io = HardwareIo(hardware, leads=False, arm=AT_STANDS)
    reach = Drive(0, 0, True, False, 0.26, 0.0, arm=REACHES)

    def angles(closed: bool, ticks: range) -> list[float | None]:
        found = []
        for tick in ticks:
            io.reading(RawReading((0.0, 0.0), (False, closed, False)), tick * PERIOD_S)
            found.append(io.command(reach, tick * PERIOD_S).arm_rad)
        return found

    assert len(set(angles(False, range(10)))) == 10
    assert len(set(angles(True, range(10, 20)))) == 1


def test_what_has_been_reached_refers_to_the_end_of_the_job_that_was_commanded() -> None:
    drive = Drive(0, 0, True, False, 0.26, 0.0, arm=SINKS)
    assert targets(replace(drive, arm_ends=True)) != targets(drive)


def test_a_driver_without_an_arm_is_refused() -> None:
    settings = DriverSettings("left", True, "", 0.01, 0.1, arm=SHAPE)
    with pytest.raises(PalmbotsError, match=r"^driver.kind: serial moves no arm, which a job on "):
        open_driver("serial", settings)
