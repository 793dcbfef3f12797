# SPDX-License-Identifier: Apache-2.0
"""Heavy objects in MuJoCo: palms carry them, and robots tip where statics says so."""

import pytest

import palmbots as pb
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
