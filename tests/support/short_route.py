# SPDX-License-Identifier: Apache-2.0
"""A route with one turn by 45°, which takes one stage."""

from functools import cache

from palmbots.mujoco import RoutePlan
from palmbots.mujoco.route_planner import plan_stages
from palmbots.scene.scene import load_scene

BEND = {"task.route.waypoints_m": [[0, 0], [1.2, 0], [2.0, 0.8]], "task.route.walls_m": []}
TYPED = tuple(word for key, value in BEND.items() for word in ("--set", f"{key}={value}"))


@cache
def short_plan() -> RoutePlan:
    """Its plan, from a few simulated routes."""
    return plan_stages(load_scene("around-wall", BEND), "shared-sign", members=5)
