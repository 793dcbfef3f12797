# SPDX-License-Identifier: Apache-2.0
"""The arm of a real robot: as fast as the scene allows, and within a step after a boot."""

import math
import random
from dataclasses import replace

import pytest

import palmbots as pb
from palmbots.drivers.arm import FOLLOWS, HOLDS, RISES, SINKS, ArmMotion, ArmShape, arm_shape
from palmbots.drivers.driver import Drive, DriverSettings, RawReading
from palmbots.drivers.driver_registry import open_driver
from palmbots.drivers.hardware import HardwareParameters, arm_servo_angle, servo_angle
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.errors import PalmbotsError

SHAPE = ArmShape(floors_m=(0.02, 0.008), top_m=0.15, rate_m_s=0.05, step_m=0.027)
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
    assert (arm.pivot_m, arm.steps, arm.is_there) == (0.02, 0, True)
    arm.move(FOLLOWS, 1, PERIOD_S)
    assert (arm.pivot_m, arm.steps) == (pytest.approx(0.008), 0)
    before, ticks = arm.pivot_m, 0
    while not (ticks and arm.is_there):
        arm.move(RISES, 0, PERIOD_S)
        assert 0 <= arm.pivot_m - before <= 0.05 * PERIOD_S + 0.012 * (ticks == 0) + 1e-12
        assert arm.steps == math.floor((arm.pivot_m - 0.02) / 0.027 + 1e-12)
        before, ticks = arm.pivot_m, ticks + 1
    assert arm.pivot_m == 0.15
    assert ticks == pytest.approx(0.13 / 0.05 / PERIOD_S, abs=26)
    arm.move(HOLDS, 1, PERIOD_S)
    assert (arm.pivot_m, arm.is_there) == (0.15, True)
    arm.move(SINKS, 1, PERIOD_S)
    assert not arm.is_there
    while not arm.is_there:
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
        again = ArmMotion(SHAPE, arm.edge)
        assert abs(again.pivot_m - arm.pivot_m) <= SHAPE.step_m
        if arm.pivot_m in (0.02, 0.15):
            assert again.pivot_m == arm.pivot_m
        elif rises:
            assert again.pivot_m <= arm.pivot_m
        else:
            assert again.pivot_m >= arm.pivot_m


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


def test_a_driver_without_an_arm_is_refused() -> None:
    settings = DriverSettings("left", True, "", 0.01, 0.1, arm=SHAPE)
    with pytest.raises(PalmbotsError, match=r"^driver.kind: serial moves no arm, which a job on "):
        open_driver("serial", settings)
