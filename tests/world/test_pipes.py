# SPDX-License-Identifier: Apache-2.0
"""A pipe between two palms: one arc touches both, so that geometry alone places the contacts, and
friction decides only which of them rolls."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.mechanics.contact_points import touching
from palmbots.mechanics.state import palm_state
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import FloorWorld

RADIUS = 0.08
OUT = (-1.0, 1.0)
EIGHTS = [math.radians(45 * k - 112.5) for k in range(8)]
FAR = RADIUS / math.cos(math.pi / 8)
OCTAGON = [[0.2 + FAR * math.cos(a), 0.2 + FAR * math.sin(a)] for a in EIGHTS]
PIPES: list[tuple[str, dict[str, Any]]] = [
    ("pipe", {}),
    ("paper", {"object.vertices_m": OCTAGON, "object.edge_radius_m": RADIUS, "palm.length_m": 0.08,
               "palm.shallow_deg": 45, "palm.steep_deg": 50}),
]  # fmt: skip


def scene(**keys: Any) -> pb.Scene:
    return load_scene("pipe", {name.replace("__", "."): value for name, value in keys.items()})


def places(separation: float, palms: Any) -> tuple[float, float]:
    """Both contact coordinates, from where the lines of the palms meet."""
    both = sum(palms)
    left, right = (
        RADIUS * math.tan(both / 2) - separation * math.sin(palms[1 - k]) / math.sin(both)
        for k in (0, 1)
    )
    return left, right


def runs(world: _core.World) -> list[float]:
    """What stays constant while a contact rolls."""
    *_, angle = world.pose
    return [
        p + OUT[k] * RADIUS * (angle - OUT[k] * world.palms[k])
        for k, p in enumerate(world.contacts)
    ]


def slider(palms: Any, friction: Any, slope: float, closing: bool) -> int:
    """The side whose contact slides: at the squeeze at which it does, the other one sticks.

    The COM is at the centre, so both friction forces have the same size T.
    """
    sense = 1.0 if closing else -1.0
    normals = [np.array([-OUT[k] * math.sin(palms[k]), math.cos(palms[k])]) for k in (0, 1)]
    along = [np.array([OUT[k] * math.cos(palms[k]), math.sin(palms[k])]) for k in (0, 1)]
    found = []
    for k in (0, 1):
        columns = [*normals]
        columns[k] = normals[k] - sense * friction[k] * (along[0] + along[1])
        presses = np.linalg.solve(np.array(columns).T, [slope, 1.0])
        most = friction[1 - k] * presses[1 - k]
        if min(presses) >= 0 and friction[k] * presses[k] < most:
            found.append(k)
    assert len(found) == 1
    return found[0]


@pytest.mark.parametrize(("name", "outline"), PIPES)
def test_contacts_are_where_a_circle_touches_and_one_of_them_rolls(
    name: str, outline: dict[str, Any]
) -> None:
    """Palms turn and robots move by random steps."""
    draw = np.random.default_rng(3)
    rolled = np.zeros(2, int)
    for _ in range(30):
        friction = draw.uniform(0.1, 0.5, 2).tolist()
        keys = {
            "palm.left.friction": friction[0],
            "palm.right.friction": friction[1],
            "task.slope_deg": float(draw.choice([0.0, draw.uniform(-4, 4)])),
        }
        world = _core.World(to_spec(load_scene(name, outline | keys)))
        assert world.check() == ""
        for _ in range(30):
            left, right = world.palms
            if draw.random() < 0.5:
                left, right = np.radians(draw.uniform(44, 56, 2)).tolist()
            before, separation = runs(world), world.separation
            change = draw.uniform(-0.002, 0.002)
            reason, _, *motion, pieces = world.advance(change, (left, right))
            if reason:
                assert reason == "off-palm"
                break
            there = places(separation + change, (left, right))
            assert world.contacts == pytest.approx(there, abs=1e-13)
            if pieces == 1 and sorted(map(abs, motion)) == [0, 1]:
                sticks = motion.index(0)
                assert runs(world)[sticks] == pytest.approx(before[sticks], abs=1e-13)
                rolled[sticks] += 1
    assert min(rolled) > 50


def test_the_contact_that_slides_is_the_one_whose_friction_ends_first() -> None:
    draw = np.random.default_rng(5)
    counts = np.zeros((2, 2), int)
    for _ in range(200):
        friction = draw.uniform(0.1, 0.5, 2).tolist()
        slope = float(draw.choice([0.0, draw.uniform(-0.05, 0.05)]))
        at = scene(
            palm__left__friction=friction[0],
            palm__right__friction=friction[1],
            task__slope_deg=math.degrees(math.atan(slope)),
        )
        world = _core.World(to_spec(at))
        goal = tuple(np.radians(draw.uniform(44, 56, 2)).tolist())
        assert world.advance(0.0, goal)[0] == ""
        closing = bool(draw.random() < 0.5)
        reason, _, *motion, _ = world.advance(-1e-5 if closing else 1e-5, goal)
        expected = slider(goal, friction, slope, closing)
        assert reason == ""
        assert motion[expected] == (1 if closing else -1)
        assert motion[1 - expected] == 0
        counts[int(closing), expected] += 1
    assert counts.min() > 20


def test_contact_modes_are_those_of_the_closed_form_and_of_any_contacts() -> None:
    """The nine contact modes see the pipe as a sharp object at the points that it touches."""
    draw = np.random.default_rng(6)
    for _ in range(60):
        friction = draw.uniform(0.1, 0.5, 2).tolist()
        keys = {"palm.left.friction": friction[0], "palm.right.friction": friction[1]}
        angles = draw.uniform(44, 56, 2).tolist()
        state = palm_state("pipe", float(draw.uniform(-0.01, 0.01)), 0.0, *angles, keys)
        found = pb.contact_modes(
            "pipe", p_left_m=state.p_m[0], p_right_m=state.p_m[1], theta_left_deg=angles[0],
            theta_right_deg=angles[1], overrides=keys,
        )  # fmt: skip
        spread = float(state.spec.width) + sum(map(math.sin, state.theta_rad)) * RADIUS
        left, right = places(
            spread - sum(p * math.cos(t) for p, t in zip(state.p_m, state.theta_rad, strict=True)),
            state.theta_rad,
        )
        assert state.p_m == pytest.approx((left, right), abs=1e-12)
        for closing, mode in ((True, found.closing), (False, found.opening)):
            slides = slider(state.theta_rad, friction, 0.0, closing)
            words = ["ST", "ST"]
            words[slides] = "SL" if (slides == 0) == closing else "SR"
            assert mode == tuple(words)
            touched = touching(state)
            assert (touched.closing() if closing else touched.opening()) == (mode,)


def test_where_left_and_right_are_alike_both_slide_and_nothing_turns() -> None:
    world = _core.World(to_spec(scene()))
    for change in (-0.001, 0.002, -0.003):
        assert world.advance(change, world.palms)[:4:2] == ("", -int(math.copysign(1, change)))
        assert world.contacts[0] == world.contacts[1]
        assert world.pose[2] == pytest.approx(0.0, abs=1e-15)


def test_the_mirrored_pipe_moves_alike_to_the_last_bit() -> None:
    frictions = {"palm.left.friction": 0.2, "palm.right.friction": 0.35}
    mirrored = {"palm.left.friction": 0.35, "palm.right.friction": 0.2}
    offset = {"object.com_m": [0.085, 0.08]}, {"object.com_m": [0.075, 0.08]}
    draw = np.random.default_rng(8)
    for keys in ({}, {}), offset:
        one, two = (
            _core.World(to_spec(load_scene("pipe", own | com)))
            for own, com in zip((frictions, mirrored), keys, strict=True)
        )
        for _ in range(60):
            change = float(draw.uniform(-0.002, 0.002))
            left, right = np.radians(draw.uniform(44, 56, 2)).tolist()
            done = one.advance(change, (left, right))
            reason, fraction, *motion, pieces = two.advance(change, (right, left))
            assert (reason, fraction, *motion[::-1], pieces) == done
            assert one.contacts == two.contacts[::-1]
            assert one.pose[2] == -two.pose[2]
            if reason:
                break


@pytest.mark.parametrize("controller", ["centralized", "distributed", "silent", "shared-sign"])
def test_controllers_carry_it_in_both_worlds(controller: str) -> None:
    done = [
        pb.carry("pipe", controller, world=world, overrides={"task.distance_m": 0.3})
        for world in ("quasistatic", "mujoco")
    ]
    turns = []
    for carry in done:
        assert carry.outcome == "delivered"
        assert carry.trace is not None
        turns.append(float(carry.trace["object"][-1]))
        assert max(carry.contact_peak_m.left, carry.contact_peak_m.right) < 0.03
    assert turns[1] == pytest.approx(turns[0], abs=math.radians(8))


def test_resilient_refuses_it_for_its_short_palms() -> None:
    with pytest.raises(pb.SceneError, match=r"radio\.lease_s"):
        pb.carry("pipe", "resilient")


def test_it_does_not_stand_on_the_floor() -> None:
    with pytest.raises(pb.SceneError, match="does not stand on its contact vertices"):
        FloorWorld("pipe")
