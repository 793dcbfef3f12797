# SPDX-License-Identifier: Apache-2.0
"""Simulated robots with imperfections: motors, sensors, both worlds, and carries that fail."""

import math
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES, Side
from palmbots.drivers.driver import Drive, RawCommand
from palmbots.drivers.hardware import HardwareParameters
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.links.local_connection import listen
from palmbots.pair.launcher import UP
from palmbots.simulation.driven_world import QuasistaticWorld, as_built
from palmbots.simulation.imperfect_robot import ImperfectRobot
from palmbots.simulation.imperfections import Imperfections, load_imperfections
from palmbots.simulation.live_world import LiveCarry, run_live_world
from palmbots.simulation.world_stage import ImperfectStage, PerfectStage
from palmbots.simulation.worlds import world_entry
from palmbots.station.simulated_pair import Air, SimulatedPair
from traces import error_trace
from waiting import wait_until

QUIET = {"robot.noise_m_s": 0.0, "task.inertia": True}
RIM = 0.04


def robot(**values: Any) -> ImperfectRobot:
    params = Imperfections.model_validate(values).of("left")
    return ImperfectRobot(params, pb.load_scene("paper", QUIET), "left", 0)


def rims_after(one: ImperfectRobot, command: float, ticks: int) -> tuple[float, float]:
    rims = (0.0, 0.0)
    for _ in range(ticks):
        rims = one.move(RawCommand((command / RIM, command / RIM)))
    return rims


def test_a_wheel_covers_what_its_size_gives() -> None:
    left, right = rims_after(robot(wheel_scale=1.1, trim=0.04), 0.06, 20)
    assert left == pytest.approx(0.06 * 1.1 * 1.02)
    assert right == pytest.approx(0.06 * 1.1 * 0.98)


ERRORS: dict[str, dict[str, Any]] = {
    "noise": {},
    "all": {"robot.gain": 1.04, "robot.gain_sd": 0.03, "robot.bias_m_s": 0.01,
            "robot.white_noise_m_per_sqrt_s": 0.002, "robot.standing_noise_m_s": 0.004},
    "carry": {"robot.error_trace": ..., "robot.trace_gain": "carry", "robot.bias_m_s": 0.01},
    "segment": {"robot.error_trace": ..., "robot.trace_gain": "segment", "robot.bias_m_s": 0.01},
}  # fmt: skip


@pytest.mark.parametrize("errors", ERRORS)
@pytest.mark.parametrize("side", ["left", "right"])
def test_errors_are_those_of_a_carry_with_the_same_seed(
    errors: str, side: Side, tmp_path: Path
) -> None:
    """The right robot looks back, so its wheels roll backwards."""
    slopes = 0.001 * np.arange(-3, 4)
    segments = [slope * 0.1 * np.arange(8) for slope in slopes]
    file = error_trace(tmp_path / "errors.csv", segments, 0.1, 1 + 0.01 * np.arange(7))
    keys = {key: file if value is ... else value for key, value in ERRORS[errors].items()}
    scene = pb.load_scene("paper", keys)
    carry = pb.carry(scene, "none", seed=3)
    assert carry.trace is not None
    wanted = carry.trace["speed"].values[:200, SIDES.index(side)]
    one = ImperfectRobot(Imperfections().of(side), scene, side, 3)
    forward = 1 if side == "left" else -1
    command = RawCommand((forward * 0.06 / RIM, forward * 0.06 / RIM))
    found = [one.move(command) for _ in range(len(wanted))]
    assert len(found) > 50
    assert np.array(found)[20:] * forward == pytest.approx(np.column_stack([wanted] * 2)[20:])


def test_brakes_leave_the_share_of_the_noise_that_the_scene_states() -> None:
    scene = pb.load_scene("paper", {"robot.standing_noise_m_s": 0.004})
    driven, braked = (ImperfectRobot(Imperfections().of("left"), scene, "left", 3) for _ in "ab")
    for _ in range(50):
        rim = driven.move(RawCommand((0.06 / RIM, 0.06 / RIM)))[0]
        creep = braked.move(RawCommand((0.0, 0.0)))[0]
    assert creep == pytest.approx(0.4 * (rim - 0.06)) != 0


def test_dead_zone_and_stiction() -> None:
    one = robot(dead_zone_m_s=0.01, stiction_m_s=0.03)
    assert rims_after(one, 0.029, 20) == (0, 0)
    assert rims_after(one, 0.031, 20) == pytest.approx((0.021, 0.021))
    assert rims_after(one, 0.015, 20) == pytest.approx((0.005, 0.005))  # it turns already
    assert rims_after(one, 0.009, 20) == (0, 0)
    assert rims_after(one, 0.02, 20) == (0, 0)
    assert rims_after(one, -0.05, 20) == pytest.approx((-0.04, -0.04))


def test_wheels_need_their_time_to_stop() -> None:
    one = robot(motor_acceleration_m_s2=0.5)
    rims_after(one, 0.06, 100)
    ticks = next(n for n in range(100) if one.move(RawCommand((0.0, 0.0))) == (0, 0))
    assert (ticks + 1) * 0.01 == pytest.approx(0.06 / 0.5, abs=0.011)


def test_encoders_count_whole_steps_and_switches_close_between_their_edges() -> None:
    one = robot(encoder_ticks_per_turn=20, wheel_scale=1.1)
    one_count = 2 * math.pi * RIM * 1.1 / 20
    assert one.reading((0.99 * one_count, 2.01 * one_count), 0.0, 0.2).wheel_counts == (0, 2)
    assert one.reading((-0.01 * one_count, 0.0), None, 0.2).wheel_counts == (-1, 0)
    assert one.reading((0, 0), None, 0.2).closed == (False, False, False)
    assert one.reading((0, 0), -0.02, 0.2).closed == (True, False, False)
    assert one.reading((0, 0), 0.02, 0.2).closed == (False, False, True)
    assert robot(encoder_ticks_per_turn=0).reading((0, 0), 0.0, 0.2).wheel_counts is None


def test_servo_turns_the_palm_at_its_rate_to_an_angle_that_is_off() -> None:
    one = robot(servo_zero_deg=87, servo_scale=2, servo_reports=True)
    command = RawCommand((0.0, 0.0), math.radians(87 + 2 * 5))
    ticks = 0
    while one.palm_rad != pytest.approx(math.radians(5)):
        one.move(command)
        ticks += 1
    assert ticks == pytest.approx((15 - 5) / 50 / 0.01, abs=1)  # 50 degrees/s
    servo = one.reading((0, 0), None, one.palm_rad).servo_rad
    assert servo == pytest.approx(math.radians(97))


def test_battery_sags_drains_and_slows() -> None:
    values = {"battery_v": 8.0, "battery_sag_v": 0.5, "battery_drain_v_per_min": 1.0}
    one = robot(**values, battery_slows=True)
    assert one.battery_v == 8.0
    rims_after(one, 0.06, 3000)
    assert one.battery_v == pytest.approx(7.0, abs=0.01)
    assert rims_after(one, 0.06, 1)[0] == pytest.approx(0.06 * 7 / 8, rel=1e-2)
    rims_after(one, 0.0, 100)
    assert one.battery_v == pytest.approx(7.5, abs=0.01)


def test_the_driven_world_is_the_quasistatic_one() -> None:
    """Robots without noise, through wheels and palms that are moved from outside."""
    scene = pb.load_scene("paper", QUIET)
    perfect = PerfectStage(scene, "quasistatic", 0)
    driven = QuasistaticWorld(scene)
    params = Imperfections(motor_acceleration_m_s2=0.5).of("left")
    robots = [ImperfectRobot(params, scene, side, 0) for side in ("left", "right")]
    # Travel, away from the partner, at rest; the palm of the right robot turns up and down.
    script = [((0, 0, False), (0, 0, False), 100), ((0, 1, False), (1, 0, False), 40),
              ((0, 2, False), (1, 2, False), 40), ((0, 0, False), (0, 0, False), 40),
              ((0, 0, True), (0, 0, True), 40)]  # fmt: skip
    speed = scene.robot_of("left").speed_m_s
    correction = scene.robot_of("left").correction_m_s
    angles = [math.radians(15.0), math.radians(5.0)]
    for left, right, ticks in script:
        for _ in range(ticks):
            perfect.step(left, right)
            rims = []
            for command, sense, one in zip((left, right), (1, -1), robots, strict=True):
                palm, move, stop = command
                wanted = sense * (0 if stop else speed)  # forward is towards the partner
                wanted += (0, -correction, correction)[move]
                rates = (wanted / RIM, wanted / RIM)
                servo = math.radians(90) + angles[palm]
                rims.append(one.move(RawCommand(rates, servo)))
            driven.step(as_built((rims[0], rims[1])), (robots[0].palm_rad, robots[1].palm_rad))
            assert driven.advance == pytest.approx(perfect.midpoint, abs=1e-9)
            contacts = perfect._carry.sight().contacts
            assert driven.pressed == pytest.approx(contacts, abs=1e-9)
            assert driven.wrists() == pytest.approx(perfect._carry.sight().palms, abs=1e-12)
    assert any(abs(p) > 0.005 for p in driven.pressed if p is not None)


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_programs_read_how_far_their_own_robot_has_moved(direction: str) -> None:
    """In the direction of the task, also where a robot corrects and its partner does not."""
    scene = pb.load_scene("paper", QUIET | {"task.direction": direction})
    stage = PerfectStage(scene, "quasistatic", 0)
    speed, correction = scene.robot_of("left").speed_m_s, scene.robot_of("left").correction_m_s
    assert [frame.distance_m for frame in stage.frames()] == [0, 0]
    for _ in range(300):
        stage.step((0, 0, False), (0, 0, False))
    travelled = [frame.distance_m for frame in stage.frames()]
    assert travelled == pytest.approx([3 * speed] * 2, abs=0.02)
    for left, right in (((0, 1, False), (0, 0, False)), ((0, 0, False), (0, 1, False))):
        before = [frame.distance_m for frame in stage.frames()]
        for _ in range(20):
            stage.step(left, right)
        moved = np.subtract([frame.distance_m for frame in stage.frames()], before)
        apart = float(moved[1] - moved[0]) * (1 if direction == "forward" else -1)
        assert 0.1 * correction < apart < 0.2 * correction + 1e-9
        same = moved[1] if left[1] == 1 else moved[0]
        assert same == pytest.approx(0.2 * speed, abs=0.1 * speed)
    assert stage.outcome == "running"


@pytest.mark.parametrize("heights", [(0.0, 0.01), (0.0, -0.01), (0.008, 0.0)])
def test_unequal_pivots_tilt_the_object_in_both_worlds(heights: tuple[float, float]) -> None:
    """The contact vertices stay where the scene has them on each palm, and rise with the pivots."""
    scene = pb.load_scene("paper", QUIET)
    rise = heights[1] - heights[0]
    mujoco: Any = world_entry("mujoco")
    moved = mujoco.driven(scene, heights)
    planar = QuasistaticWorld(scene, heights)
    assert planar.pressed == pytest.approx((0, 0), abs=1e-12)
    assert moved.contacts == pytest.approx((0, 0), abs=5e-4)
    (_, _, left), (_, _, right) = moved._vertices()
    assert right - left == pytest.approx(rise, abs=2e-4)
    # The core sees the same object from the line between the pivots.
    along, across = planar._world.contact_vector
    back = math.sin(planar._tilt) * along + math.cos(planar._tilt) * across
    assert back == pytest.approx(rise, abs=1e-9)
    # While the robots approach each other, the same contact slides in both worlds, by as much.
    for _ in range(60):
        for world in (moved, planar):
            world.step(((0.02, 0.02), (-0.02, -0.02)), planar.wrists())
    assert max(abs(p) for p in moved.contacts) > 0.005
    assert moved.contacts == pytest.approx(planar.pressed, abs=1.5e-3)


CROOKED = {
    "left": {"trim": 0.06, "wheel_scale": 1.03, "dead_zone_m_s": 0.008, "stiction_m_s": 0.015},
    "right": {"trim": 0.05, "wheel_scale": 0.97, "servo_zero_deg": 88.0},
}


def test_robots_that_do_not_drive_straight_drop_the_object_in_mujoco(tmp_path: Path) -> None:
    imperfections = Imperfections.model_validate(CROOKED)
    pair = SimulatedPair(
        tmp_path, "resilient", Air(), UP, {"task.distance_m": 1.5},
        world="mujoco", imperfections=imperfections,
    )  # fmt: skip
    assert pair.carry_until_the_end() == "dropped"
    assert 0.3 < pair.stage.midpoint < 1.4


class LiveWorld:
    """A world of imperfect robots that runs in a thread."""

    def __init__(self, folder: Path, table: dict[str, Any]) -> None:
        self.address = f"unix:{folder / 'w'}"
        self.door = listen(self.address)
        self.result: LiveCarry | None = None
        self.imperfections = Imperfections.model_validate(table)
        self.thread = threading.Thread(target=self._run)
        self.thread.start()

    def _run(self) -> None:
        scene = pb.load_scene("paper")
        self.result = run_live_world(scene, self.door, rate=10, imperfections=self.imperfections)


def test_over_real_sockets_readings_are_those_of_the_hardware(tmp_path: Path) -> None:
    world = LiveWorld(tmp_path, {"clock_ppm": 50_000, "battery_v": 7.7})
    drivers = [
        SimulatedDriver(
            world.address, side, 1, 0.001, hardware=HardwareParameters(), leads=side == "right"
        )
        for side in ("left", "right")
    ]  # fmt: skip
    start = [driver.read() for driver in drivers]
    assert all(one is not None and one.battery_v == 7.7 for one in start)
    assert drivers[0].clock_rate == pytest.approx(1.05)
    palm = math.radians(15)

    def have_arrived() -> bool:
        found = []
        for driver, before in zip(drivers, start, strict=True):
            driver.write(Drive(0, 0, False, True, palm, 0.06))
            after = driver.read()
            assert before is not None and after is not None
            found.append(after.distance_m - before.distance_m > 0.05 and after.palm_at_target)
        return all(found)

    wait_until(have_arrived)
    raw = [driver.read_raw() for driver in drivers]
    assert raw[0] is not None and raw[0].wheel_counts is not None and raw[0].wheel_counts[0] > 0
    assert raw[1] is not None and raw[1].wheel_counts is not None and raw[1].wheel_counts[0] < 0
    # Nobody writes any more: the motor board stops the wheels.

    def rests() -> bool:
        before = drivers[0].read()
        time.sleep(0.1)
        after = drivers[0].read()
        assert before is not None and after is not None
        return before.distance_m == after.distance_m

    wait_until(rests)
    for driver in drivers:
        driver.close()
    world.thread.join(60)
    world.door.close()
    assert world.result is not None


def test_the_stage_of_a_pair_has_its_own_noise_for_each_robot() -> None:
    scene = pb.load_scene("paper")
    stages = [ImperfectStage(scene, "quasistatic", seed, Imperfections()) for seed in (0, 0, 1)]
    command = RawCommand((1.5, 1.5))
    for _ in range(50):
        for stage in stages:
            stage.step(command, command)
    rolled = [stage._world.rolled() for stage in stages]
    assert rolled[0] == rolled[1] != rolled[2]
    assert rolled[0][0] != rolled[0][1]


def test_imperfections_come_from_a_file_and_from_single_keys(tmp_path: Path) -> None:
    file = tmp_path / "robots.toml"
    file.write_text("wheel_scale = 1.02\n[left]\ntrim = 0.01\n")
    found = load_imperfections([str(file), "left.trim=0.03", "right.wheel_scale=0.9"])
    assert (found.of("left").trim, found.of("left").wheel_scale) == (0.03, 1.02)
    assert (found.of("right").trim, found.of("right").wheel_scale) == (0.0, 0.9)
