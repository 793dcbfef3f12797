# SPDX-License-Identifier: Apache-2.0
"""The speeds that a robot's driver gets, against those of the simulated robots."""

from itertools import product
from typing import Any

import pytest

import palmbots as pb
from palmbots.pair.drive_table import drive_table
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.simulation.worlds import world_entry

QUIET: dict[str, Any] = {"robot.noise_m_s": 0.0, "robot.acceleration_m_s2": 1000.0}


@pytest.mark.parametrize("direction", ["forward", "backward"])
@pytest.mark.parametrize(("speed", "most"), [(0.06, 0.2), (0.06, 0.07), (0.01, 0.2)])
def test_speeds_are_those_of_simulated_robots(direction: str, speed: float, most: float) -> None:
    """Each robot alone gets each command in turn for one tick; the midpoint moves by half of what
    it moves."""
    keys = {"robot.speed_m_s": speed, "robot.max_speed_m_s": most, "task.direction": direction}
    scene = pb.load_scene("paper", QUIET | keys)
    sign = 1 if direction == "forward" else -1
    sides: tuple[Any, ...] = ("left", "right")
    for k, side in enumerate(sides):
        drives = drive_table(scene, side)
        for move, stop in product((0, 1, 2), (False, True)):
            episode: Any = world_entry("quasistatic").episode
            carry = episode(scene, 0, record=False)
            carry.stop(*(stop if k == i else True for i in (0, 1)))
            own, other = (0, move, 0), (0, 0, 0)
            _, _, _, midpoint, _ = carry.step(*((own, other) if k == 0 else (other, own)), 1)
            moved = sign * 2 * midpoint / scene.control.period_s
            assert moved == pytest.approx(drives[0, move, stop, True].speed_m_s, abs=1e-9)


def test_wheels_that_may_not_turn_stand() -> None:
    for shape, drive in drive_table(pb.load_scene("paper"), "left").items():
        assert (drive.palm, drive.move, drive.stop, drive.wheels) == shape
        assert drive.wheels or drive.speed_m_s == 0


@pytest.mark.parametrize(
    ("half_moves", "fastest", "slowest"), [(False, 0.05, -0.05), (True, 0.05, -0.04)]
)
def test_a_correction_is_shared_and_within_the_limit(
    half_moves: bool, fastest: float, slowest: float
) -> None:
    """Under a station both robots correct, each at half the speed, and none faster than it can."""
    keys = {"robot.speed_m_s": 0.01, "robot.correction_m_s": 0.08, "robot.max_speed_m_s": 0.05}
    scene = pb.load_scene("paper", QUIET | keys)
    for side in ("left", "right"):
        speeds = {
            drive.speed_m_s for drive in drive_table(scene, side, half_moves=half_moves).values()
        }
        assert (max(speeds), min(speeds)) == pytest.approx((fastest, slowest))


def test_no_robot_may_take_longer_to_stop_than_the_slower_one() -> None:
    keys = {"robot.acceleration_m_s2": 0.5, "robot.right.acceleration_m_s2": 0.25}
    scene = pb.load_scene("paper", keys)
    assert stopping_limit_s(scene) == pytest.approx(scene.robot_of("right").speed_m_s / 0.25)
