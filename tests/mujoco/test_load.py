# SPDX-License-Identifier: Apache-2.0
"""Heavy objects in MuJoCo: palms carry them, and robots tip where statics says so."""

import pytest

import palmbots as pb
from palmbots._types import Side
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import load_scene


@pytest.mark.parametrize("key", ["mujoco.body_kg", None])
def test_robots_tip_beyond_the_static_limit_and_not_below_it(key: str | None) -> None:
    keys = {key: 6.0} if key else {}
    limit = pb.load_limits(overrides=keys).at_start_kg
    assert limit is not None
    for share, ends in ((0.9, ""), (1.15, "robot tipped")):
        world = MujocoWorld(load_scene("paper", keys | {"object.mass_kg": share * limit}))
        world.sight(first=True)
        assert all(-0.003 < lift < 0.001 for lift in world.lifts) or ends
        for _ in range(150):
            world.move((0.0, 0.0), (0.2618, 0.2618))
            world.sight()
            if world.end:
                break
        assert world.end == ends


def test_wheels_that_slip_and_robots_that_run_away_are_reported() -> None:
    near = {"task.distance_m": 0.3}
    calm = pb.carry(world="mujoco", overrides=near, record=False)
    assert calm.wheel_slip_m is not None
    assert max(map(abs, calm.wheel_slip_m.values())) < 0.01 * calm.distance_m
    assert "wheel" not in " ".join(calm.warnings)
    heavy = near | {"object.mass_kg": 3.0, "task.slope_deg": -6.0}
    cases: list[tuple[str, Side]] = [("forward", "left"), ("backward", "right")]
    for direction, first in cases:
        steep = heavy | {"task.direction": direction}
        done = pb.carry(controller="shared-sign", world="mujoco", overrides=steep, record=True)
        assert done.outcome == "delivered" and done.wheel_slip_m is not None
        # The speed of a robot is that of its rims and the slip.
        assert done.trace is not None
        slip = done.trace["wheel_slip"].sel(side=first).values[:-1].sum() * 0.01
        sense = 1 if direction == "forward" else -1
        assert done.wheel_slip_m[first] == pytest.approx(sense * slip, abs=1e-3)
        assert done.wheel_slip_m[first] < -0.1
        printed = " ".join(done.warnings)
        assert f"wheels of the {first} robot slip" in printed
        assert "robot.speed_m_s is 6 cm/s" in printed
