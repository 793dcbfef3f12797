# SPDX-License-Identifier: Apache-2.0
"""Robots whose force along the floor is limited."""

import math

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from limited_robots import Stalls, run
from palm_scripts import Drive, world_of
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec

WEIGHT = 0.5 * _core.standard_gravity
SCRIPTS = 12


def test_a_linear_program_agrees_who_stalls() -> None:
    found = Stalls()
    for seed in range(SCRIPTS):
        run(seed, found)
    assert found.faults == []
    assert found.drives > 100
    assert min(found.stalls[1], found.stalls[2]) > 10, found


def test_the_program_notices_limits_that_are_not_kept() -> None:
    found = Stalls()
    for seed in range(4):
        run(seed, found, limits_of_judge=0.7)
    assert len(found.faults) > 10


def limited_script(seed: int) -> tuple[_core.World, Drive]:
    """One of those that benchmarks/bench_contact_steps.py times."""
    rng = np.random.default_rng([seed, 2])
    limits = rng.choice([0.3, 0.6, 1.0, 2.0], 2).tolist()
    world, _, on_floor = world_of(rng, (limits[0], limits[1]))
    return world, Drive(rng, on_floor)


def test_a_force_that_hardly_exceeds_a_limit_is_one_event() -> None:
    """The force that two stalled robots need grows by 1e-8 weights in a period."""
    world, drive = limited_script(57)
    for k in range(111):
        reason, *_, pieces = world.move(*drive.next(k, world.palms))
        assert reason == "" and pieces < 20


def test_more_than_200_events_in_a_step_end_it_as_jammed() -> None:
    world, drive = limited_script(1722)
    for k in range(101):
        reason, done, *_, pieces = world.move(*drive.next(k, world.palms))
    assert (reason, pieces) == ("jammed", 201) and 0 < done < 1


@pytest.mark.parametrize("way", [-1, 1])
@pytest.mark.parametrize("com", [0.11, 0.125, 0.13])
@pytest.mark.parametrize(("theta", "friction"), [(5, 0.3), (15, 0.3), (15, 0.5), (20, 0.2)])
def test_squeeze_at_which_the_box_slides(theta: int, friction: float, com: float, way: int) -> None:
    """On level contacts, the first one to slide closes at V tan(θ + φ) with the smaller load V and
    opens at V tan(θ - φ) with the larger one, if that squeeze is an outward pull."""
    keys = {"palm.steep_deg": theta, "palm.shallow_deg": theta - 1, "palm.friction": friction}
    tan = math.tan(math.radians(theta) - way * math.atan(friction))
    loads = com / 0.25, 1 - com / 0.25
    squeeze = (min(loads) if way < 0 else (max if tan > 0 else min)(loads)) * tan
    for share in (0.97, 1.03):
        limit = abs(squeeze) * WEIGHT * share
        scene = load_scene("paper", keys | {"object.com_m": [com, 0.04], "robot.traction_n": limit})
        world = _core.World(to_spec(scene))
        before = world.pivots
        reason = world.move(((-way * 1e-4, 0.0), (0.0, 0.0)), world.palms)[0]
        moved = world.pivots[0][0] - before[0][0]
        if way > 0 and tan > 0 and share < 1:
            assert reason == "jammed"  # the robots cannot hold it
        else:
            assert reason == ""
            assert moved == pytest.approx(-way * 1e-4 if share > 1 else 0.0, abs=1e-12)


def test_a_robot_behind_a_slower_one_takes_its_speed() -> None:
    """Until the palm of one that leads has turned so far that its contact slides."""
    world = _core.World(to_spec(load_scene("paper", {"robot.motor_force_n": 0.2 * WEIGHT})))
    before = world.pivots
    assert world.move(((3e-4, 0.0), (1e-4, 0.0)), world.palms)[0] == ""
    moved = [b[0] - a[0] for a, b in zip(before, world.pivots, strict=True)]
    assert moved == pytest.approx([1e-4, 1e-4], abs=1e-15)
    assert world.contacts == (0.0, 0.0)


def test_while_a_palm_turns_a_stalled_robot_keeps_both_contacts() -> None:
    world = _core.World(to_spec(load_scene("paper", {"robot.motor_force_n": 0.2 * WEIGHT})))
    world.shift(0, 0.02)
    contacts = world.contacts
    turned = world.palms[0] + math.radians(0.5), world.palms[1]
    before = world.pivots
    assert world.move(((5e-4, 0.0), (1e-4, 0.0)), turned)[0] == ""
    moved = [b[0] - a[0] for a, b in zip(before, world.pivots, strict=True)]
    assert moved[1] == pytest.approx(1e-4, abs=1e-15)
    assert 0 < moved[0] < 5e-4
    assert moved[0] != pytest.approx(1e-4, abs=1e-6)
    np.testing.assert_allclose(world.contacts, contacts, rtol=0, atol=1e-12)


@pytest.mark.parametrize("is_mirrored", [False, True])
def test_a_contact_slides_at_the_limit_of_a_robot_while_a_palm_turns(is_mirrored: bool) -> None:
    """The robots pull apart. At their speeds the pull at which the right contact slides would grow;
    if it stuck, that pull would fall, because the palms turn up. So it slides at the limit."""
    theta, phi, com = math.radians(15), math.atan(0.6), 0.12
    limit = com / 0.25 * math.tan(phi - theta) * (1 + 2e-5)
    keys = {"object.com_m": [com, 0.1], "palm.steep_deg": 15, "palm.shallow_deg": 14}
    forces = {"palm.friction": 0.6, "robot.motor_force_n": limit * WEIGHT}
    scene = load_scene("paper", keys | forces)
    world = _core.World(to_spec(scene.mirrored() if is_mirrored else scene))
    order = slice(None, None, -1 if is_mirrored else 1)
    rows = []
    for _ in range(20):
        before = world.pivots[order]
        goal = world.palms[0] + math.radians(0.001), world.palms[1] + math.radians(0.001)
        assert world.move(((-1e-4, 0.0), (1e-4, 0.0)), goal)[0] == ""
        (left, _), (right, _) = world.pivots[order]
        rows.append((abs(left - before[0][0]), abs(right - before[1][0]), *world.contacts[order]))
        dx, dy = world.contact_vector
        dy *= -1 if is_mirrored else 1
        over = com * dx / 0.25 - 0.1 * dy / 0.25  # the COM from the left contact, along the floor
        edge = math.tan(goal[0] - phi)
        assert -edge * over / (dx + edge * dy) == pytest.approx(limit, abs=1e-12)
    ways, contacts = np.array(rows)[:, :2], np.array(rows)[:, 2:]
    assert np.ptp(ways[1:], axis=0) == pytest.approx([0, 0], abs=1e-6)
    assert ways[1:, 1] == pytest.approx(1e-4, abs=1e-15)
    assert np.all((ways[:, 0] > 1e-5) & (ways[:, 0] < 5e-5))
    assert np.all(contacts[:, 0] == 0.0) and np.all(np.diff(contacts[:, 1]) < -1e-4)


@pytest.mark.parametrize("keys", [
    {"robot.motor_force_n": 1.1},
    {"robot.left.motor_force_n": 0.9, "robot.right.traction_n": 1.2, "robot.noise_m_s": 0.02},
])  # fmt: skip
def test_the_mirrored_carry_is_the_mirror_image(keys: dict[str, float]) -> None:
    scene = load_scene("paper", keys)
    one, two = pb.carry(scene, "shared-sign"), pb.carry(scene.mirrored(), "shared-sign")
    assert one.trace is not None and two.trace is not None
    assert sum(one.stalled_s.values()) > 0
    assert one.stalled_s.values() == two.stalled_s.values()[::-1]
    for name in ("contact", "palm", "sign"):
        np.testing.assert_array_equal(one.trace[name], two.trace[name].to_numpy()[:, ::-1])
    np.testing.assert_array_equal(one.trace.midpoint, -two.trace.midpoint.to_numpy())


def test_a_high_limit_changes_nothing() -> None:
    """To rounding: a step with limits is computed in another way."""
    free = pb.carry("paper", "shared-sign")
    high = pb.carry(load_scene("paper", {"robot.motor_force_n": 1000.0}), "shared-sign")
    assert high.stalled_s.values() == (0.0, 0.0)
    assert high.correction_count == free.correction_count
    np.testing.assert_allclose(high.contact_rms_m.values(), free.contact_rms_m.values(), rtol=1e-6)


@pytest.mark.parametrize("key", ["robot.motor_force_n", "robot.traction_n"])
def test_a_nose_stalls_robots_that_are_too_weak(key: str) -> None:
    """A job that is refused, started nevertheless: at the first nose the robots stand."""
    spec = to_spec(load_scene("lift", {key: 1.5, "task.timeout_s": 20}))
    run = _core.run(spec, "shared-sign", 0, "double", False)
    assert run.outcome == "stalled"
    assert min(run.stalled_s) > 5
    assert {name for _, name, *_ in run.phases} <= {"dock", "retreat"}, run.phases
