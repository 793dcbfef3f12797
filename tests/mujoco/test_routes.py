# SPDX-License-Identifier: Apache-2.0
"""Routes of several jobs: the plan, carries along it in both worlds, and jobs on curved paths."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.control.registry import resolve
from palmbots.errors import SceneError
from palmbots.mujoco import RouteCarry, RoutePlan
from palmbots.mujoco.carry_runner import WORLD, run
from palmbots.mujoco.curved_world import CurvedLiftWorld, world_of
from palmbots.mujoco.drift_forecast import Forecast
from palmbots.mujoco.lift_world import LiftWorld
from palmbots.mujoco.route_carry import carry_route
from palmbots.mujoco.route_geometry import heading
from palmbots.mujoco.route_planner import plan_stages
from palmbots.mujoco.route_stage import Offset, Pair, StageForecast, left_over, stage_seed
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.prepare import prepare
from palmbots.simulation.result import make_carry
from short_route import BEND, short_plan

ROUND = load_scene("around-wall")
FEW = 5  # members of a forecast


def route(*points: tuple[float, float], **keys: Any) -> Scene:
    found = {"task.route.waypoints_m": [list(point) for point in points]} | keys
    return load_scene(ROUND, found | {"task.route.walls_m": []})


def planned(scene: Scene, members: int = FEW) -> RoutePlan:
    return plan_stages(scene, "shared-sign", members=members)


SHORT = load_scene(ROUND, BEND)
CORNER = route((0, 0), (2.2, 0), (2.2, 2.2))


@pytest.fixture(scope="module")
def bend() -> RoutePlan:
    return short_plan()


@pytest.fixture(scope="module")
def corner() -> RoutePlan:
    return planned(CORNER)


# --- The plan -------------------------------------------------------------------------------------


def test_a_corner_that_would_use_up_the_palms_is_divided(
    bend: RoutePlan, corner: RoutePlan
) -> None:
    assert len(bend.stages) == 1
    assert len(corner.stages) == 2
    for stage in (*bend.stages, *corner.stages):
        assert stage.turn_deg == pytest.approx(45, abs=0.5)
        assert stage.drift_m < 0  # towards the outside of a left turn
        assert stage.worst_m <= 0.8 * corner.budget_m
    # With palms twice as wide one stage turns the corner.
    assert len(planned(load_scene(CORNER, {"palm.width_m": 0.09})).stages) == 1


def test_each_stage_begins_where_the_object_stands_after_the_one_before(corner: RoutePlan) -> None:
    first, second = corner.stages
    way = heading(*first.waypoints_m[-2:])
    x, y = first.waypoints_m[-1]
    stands = (x - first.drift_m * math.sin(way), y + first.drift_m * math.cos(way))
    assert stands == pytest.approx(second.waypoints_m[0], abs=1e-3)
    axis = heading(*second.waypoints_m[:2])
    assert way + math.radians(first.drift_deg) == pytest.approx(axis, abs=1e-9)


def test_a_plan_of_the_mirrored_scene_is_its_mirror_image(bend: RoutePlan) -> None:
    (other,) = planned(SHORT.mirrored()).stages
    (own,) = bend.stages
    mirrored = np.array(own.waypoints_m) * (1, -1)
    assert np.array(other.waypoints_m) == pytest.approx(mirrored, abs=1e-4)
    for name in ("turn_deg", "drift_m", "drift_deg"):
        assert getattr(other, name) == pytest.approx(-getattr(own, name), abs=1e-3)
    for name in ("spread_m", "spread_deg", "worst_m"):
        assert getattr(other, name) == pytest.approx(getattr(own, name), abs=1e-3)


def test_the_shift_is_the_mean_of_the_members_and_what_is_left_over_is_their_spread(
    bend: RoutePlan,
) -> None:
    """Each member is simulated again by its seed."""
    pair, (stage,) = Pair(SHORT), bend.stages
    forecast = StageForecast(pair, resolve("shared-sign"), pair.stage_scene(pair.points))
    ends = [forecast.drift(forecast.run(2**41 + k).trace, Offset())[0] for k in range(FEW)]
    aside = np.array([end.aside_m for end in ends])
    assert stage.drift_m == pytest.approx(aside.mean())
    assert stage.spread_m == pytest.approx(aside.std(ddof=1))
    drift = Offset(0.0, stage.drift_m, math.radians(stage.drift_deg))
    assert sum(left_over(end, drift).aside_m for end in ends) == pytest.approx(0.0, abs=1e-12)


def test_offsets_that_are_left_over_end_a_route(monkeypatch: pytest.MonkeyPatch) -> None:
    """Robots that would find the axis by a wrong forecast run out of room, and are refused."""
    wrong = Offset(0.0, 0.03, 0.0)

    def biased(end: Offset, drift: Offset) -> Offset:
        found = left_over(end, drift)
        return replace(found, aside_m=found.aside_m - wrong.aside_m)

    monkeypatch.setattr("palmbots.mujoco.route_planner.left_over", biased)
    zigzag = [(0.0, 0.0)]
    for k in range(4):
        way = math.radians(40 * k)
        x, y = zigzag[-1]
        zigzag.append((x + 6 * math.cos(way), y + 6 * math.sin(way)))
    with pytest.raises(
        SceneError, match=r"task.route: after \d stages? the offset .* leaves no room"
    ):
        planned(route(*zigzag), members=2)


# --- Carries along it -----------------------------------------------------------------------------


def test_the_quasistatic_carry_is_the_chain_of_its_jobs(corner: RoutePlan) -> None:
    found = carry_route(plan=corner, seed=7)
    assert [one.outcome for one in found.stages] == ["delivered", "delivered"]
    assert found == carry_route(plan=corner, seed=7)
    pair, stage = Pair(CORNER), corner.stages[0]
    alone = load_scene(
        pair.stage_scene(stage.waypoints_m), {"task.path.kind": "straight", "mujoco.axle_m": 0.0}
    )
    first = pb.carry(alone, "shared-sign", seed=stage_seed(7, 0))
    assert found.carries[0].trace_hash == first.trace_hash
    assert first.floor_job is not None
    assert found.stages[0].ahead_m == first.floor_job.missed_m
    # The next stage corrects what the first one missed along the way.
    length = found.carries[1].scene.task.distance_m + found.stages[0].ahead_m
    assert length == pytest.approx(corner.stages[1].length_m)


def test_an_object_that_drifts_over_the_side_is_dropped(bend: RoutePlan) -> None:
    narrow = load_scene(SHORT, {"palm.width_m": 0.02})
    found = carry_route(plan=replace(bend, scene=narrow), seeds=2)
    assert (found.outcome, found.stages[0].reason) == ("dropped", "off-palm")
    assert found.statistics is not None
    assert (found.statistics.dropped, found.statistics.carries) == (2, 2)


def displaced(scene: Scene, aside: float, turn: float, seed: int = 0) -> tuple[Any, Any]:
    world = (CurvedLiftWorld if scene.task.path.is_curved else LiftWorld)(
        scene, displaced=(aside, turn)
    )
    prepared = prepare(scene, "shared-sign", WORLD)
    return world, make_carry(
        prepared, seed, run(prepared, seed, record=True, start=world), record=True
    )


def test_a_displaced_object_stands_where_it_is_said_to() -> None:
    world = LiftWorld(load_scene("lift"), displaced=(0.01, math.radians(5)))
    x, y, turn = world.object_pose
    assert (x, y, turn) == pytest.approx((0.0, 0.01, math.radians(5)), abs=1e-4)


@pytest.mark.parametrize("degrees", [3.0, pytest.param(-1.5, marks=pytest.mark.slow)])
def test_docking_turns_the_object_about_the_nose_that_gets_under_last(degrees: float) -> None:
    """The contact that does not reach the heel keeps its lateral position, and the other one takes
    it over."""
    scene = load_scene("lift", {"task.distance_m": 0.05})
    for seed in (0, 1):  # either palm is the first one
        _, carry = displaced(scene, 0.0, math.radians(degrees), seed)
        assert carry.trace is not None
        assert carry.floor_job is not None
        contact, lateral = (
            carry.trace[name].transpose("time", "side").to_numpy()
            for name in ("contact", "lateral")
        )
        last = int(np.argmin(contact.max(axis=0)))
        raised = max(one.start_s for one in carry.floor_job.phases if one.phase == "raise")
        row = round(raised / scene.control.period_s)
        start = lateral[0, last]
        assert start == pytest.approx((last - 0.5) * 0.244 * math.radians(degrees), abs=2e-4)
        assert lateral[row, 0] == pytest.approx(lateral[row, 1], abs=5e-4)
        assert 0.5 < lateral[row, 0] / start < 1.1


@pytest.mark.slow
def test_a_job_on_a_curve_drifts_as_forecast() -> None:
    keys = {
        "task.path.kind": "arc", "task.path.radius_m": 0.6, "task.path.angle_deg": 45.0,
        "task.path.lead_in_m": 0.3, "task.distance_m": 1.5,
    }  # fmt: skip
    scene = load_scene("lift", keys)
    expected = np.mean([Forecast(scene, "shared-sign").seed(k)[-1] for k in range(6)])
    world = world_of(scene)
    assert isinstance(world, CurvedLiftWorld)
    for seed in (0, 1):
        carry = pb.carry(scene, "shared-sign", world="mujoco", seed=seed)
        assert carry.outcome == "delivered"
        assert carry.trace is not None
        lateral = carry.trace.lateral.transpose("time", "side").to_numpy()
        held = int(np.argmax(carry.trace.pivot_height.max("side").to_numpy()[::-1] > 0.1))
        assert lateral[-held - 1].mean() == pytest.approx(expected, abs=6e-3)
        assert carry.floor_job is not None
        assert carry.floor_job.moved_m == pytest.approx(1.5, abs=0.16)


@pytest.mark.slow
def test_mujoco_hands_on_the_pose_of_the_object(corner: RoutePlan) -> None:
    found = carry_route(plan=corner, world="mujoco", seed=1)
    assert found.is_delivered
    first, second = found.carries
    assert first.trace is not None
    assert second.trace is not None
    end = found.stages[0]
    lateral = second.trace.lateral.transpose("time", "side").to_numpy()[0]
    half = 0.122 * math.radians(end.turned_deg)
    assert lateral == pytest.approx([end.aside_m - half, end.aside_m + half], abs=5e-4)
    length = second.scene.task.distance_m + end.ahead_m
    assert length == pytest.approx(corner.stages[1].length_m)


@pytest.mark.soak
def test_objects_arrive_around_the_wall_in_mujoco() -> None:
    plan = planned(ROUND, members=24)
    assert len(plan.stages) == 4
    found: RouteCarry = carry_route(plan=plan, world="mujoco", seeds=12)
    assert found.statistics is not None
    assert found.statistics.dropped + found.statistics.stalled == 0
