# SPDX-License-Identifier: Apache-2.0
"""Objects that are picked up from the floor and put down by hand, against closed forms."""

import math
from typing import Any

import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots._types import Side
from palmbots.scene.spec import to_spec
from palmbots.simulation import FloorState, FloorWorld

RADIUS_M = 0.003
KEEL = {
    "object.vertices_m": [[0, 0], [0.125, -0.01], [0.25, 0], [0.25, 0.1]],
    "object.contacts": [0, 2],
}
ROUNDED: dict[str, Any] = {"object.edge_radius_m": RADIUS_M}
NOSE_M = 0.0003
PLATE = ROUNDED | {"palm.thickness_m": NOSE_M, "palm.heel_m": 0.012}


def picked_up(**given: Any) -> FloorWorld:
    """A rounded box between the middles of its palms, still low."""
    world = FloorWorld(overrides=PLATE, **given)
    state = world.move(0.08, -0.08)
    assert not state.end and not state.on_floor
    return world


def corner_height(state: FloorState, side: Side) -> float:
    """Of the centre of the arc that rolls on a palm."""
    p, theta = state.touched_m[side], math.radians(state.palms_deg[side])
    assert p is not None
    return state.pivots_m[side][1] + p * math.sin(theta) + RADIUS_M * math.cos(theta)


@pytest.mark.parametrize("keys", [ROUNDED, PLATE])
def test_closing_picks_the_object_up(keys: dict[str, Any]) -> None:
    world = FloorWorld(overrides=keys)
    assert world.state.touched_m.values() == (None, None) and not world.state.end
    assert world.state.on_floor
    before = world.move(0.009, -0.009)
    assert before.on_floor and before.com_m == pytest.approx((0, 0.04), abs=1e-12)
    after = world.move(0.071, -0.071)
    left, right = after.touched_m.values()
    assert left is not None and left == right and not after.on_floor
    box = 0.04 - RADIUS_M  # the COM over the centres of the arcs
    assert after.com_m[1] == pytest.approx(corner_height(after, "left") + box, abs=1e-12)
    assert after.tilt_deg == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("radius_m", "theta_deg", "friction"),
    [(0.003, 15, 0.3), (0.003, 8, 0.5), (0.01, 15, 0.2), (0.02, 30, 0.3)],
)
def test_a_nose_gets_under_an_edge_if_it_is_thin_enough(
    radius_m: float, theta_deg: float, friction: float
) -> None:
    # The force at the upper edge of the nose leans by ψ + φ from the vertical, where the arc has
    # its centre in the direction ψ with cos ψ = 1 − t / r: it can lift if that is less than 90°.
    height = radius_m * (1 - math.sin(math.atan(friction)))
    for share, lifts in ((0.98, True), (1.02, False)):
        keys = {
            "object.edge_radius_m": radius_m,
            "palm.friction": friction,
            "palm.thickness_m": share * height / math.cos(math.radians(theta_deg)),
        }
        world = FloorWorld(palms_deg=(theta_deg, theta_deg), overrides=keys)
        end = world.move(0.05, -0.05).end
        assert end == ("" if lifts else "jammed")


def test_a_palm_pushes_the_object_until_the_other_one_holds_against_it() -> None:
    state = FloorWorld(overrides=PLATE, gaps_m=(0.005, 0.05)).move(0.02, -0.02)
    assert state.on_floor and state.touched_m.right is None
    # The nose meets the arc where that is as high as the nose.
    high = NOSE_M * math.cos(math.radians(15))
    inset = RADIUS_M - math.sqrt(RADIUS_M**2 - (RADIUS_M - high) ** 2)
    assert state.com_m == pytest.approx((0.02 - 0.005 - inset, 0.04), abs=1e-12)


def test_palms_at_different_angles_tilt_the_object() -> None:
    world = picked_up()
    state = world.move(palms_deg=(5, 15), follow_floor=True)
    ends = {
        side: state.pivots_m[side][1] - 0.075 * math.sin(theta) + 0.0003 * math.cos(theta)
        for side, theta in zip(("left", "right"), map(math.radians, (5, 15)), strict=True)
    }
    # The lower corner of the nose stays on the floor.
    thick = {"left": math.cos(math.radians(5)), "right": math.cos(math.radians(15))}
    assert all(ends[s] == pytest.approx(0.0006 * thick[s], abs=1e-12) for s in ("left", "right"))
    rise = corner_height(state, "right") - corner_height(state, "left")
    assert math.sin(math.radians(state.tilt_deg)) == pytest.approx(rise / 0.244, abs=1e-12)
    raised = world.move(0.05, 0.05, up_m=(0.1, 0.1))
    assert raised.touched_m.values() == pytest.approx(state.touched_m.values(), abs=1e-12)
    assert raised.com_m[1] - state.com_m[1] == pytest.approx(0.1, abs=1e-12)
    assert raised.com_m[0] - state.com_m[0] == pytest.approx(0.05, abs=1e-12)


@pytest.mark.parametrize(("floor", "is_dragged"), [(0.1, True), (0.35, False)])
def test_the_corner_that_stands_stays_while_the_other_palm_leaves(
    floor: float, is_dragged: bool
) -> None:
    # It stays if |tan(θ − φ)| V ≤ μ V' of the floor, with the loads V of the palm and V' of the
    # floor: here both are near one half, and |tan(5° − 16.7°)| = 0.21.
    world = picked_up(floor_friction=floor)
    world.move(palms_deg=(5, 15), follow_floor=True)
    states = [world.move(-0.01, 0.01)]
    while not (states[-1].touched_m.right is None or states[-1].end):
        states.append(world.move(-0.01, 0.01))
    stands = states[-1]
    assert stands.on_floor and stands.touched_m.left is not None

    def foot(state: FloorState) -> float:
        """Of the right corner, where its arc rolls on the floor."""
        angle = math.radians(state.tilt_deg)
        x, y = 0.125 - RADIUS_M, RADIUS_M - 0.04
        return state.com_m[0] + x * math.cos(angle) - y * math.sin(angle) + RADIUS_M * angle

    later = world.move(-0.02, 0.02)
    assert not later.end and later.touched_m.left is not None
    assert (abs(foot(later) - foot(stands)) > 1e-3) == is_dragged
    assert is_dragged or abs(foot(later) - foot(stands)) < 1e-9


def test_it_is_put_down_flat() -> None:
    world = picked_up()
    world.move(palms_deg=(5, 15), follow_floor=True)
    for _ in range(20):
        state = world.move(-0.01, 0.01)
    assert not state.end and state.touched_m.values() == (None, None) and state.on_floor
    assert state.com_m[1] == pytest.approx(0.04, abs=1e-12)
    assert state.tilt_deg == pytest.approx(0, abs=1e-9)


def test_mirrored_motions_give_the_mirrored_states_to_the_last_bit() -> None:
    motions = [(0.03, -0.01), (0.06, -0.07), (-0.02, 0.01)]
    ours = FloorWorld(palms_deg=(15, 8), gaps_m=(0.004, 0.02), overrides=PLATE)
    theirs = FloorWorld(palms_deg=(8, 15), gaps_m=(0.02, 0.004), overrides=PLATE)
    for left, right in motions:
        one, two = ours.move(left, right), theirs.move(-right, -left)
        assert (one.end, one.on_floor, one.tilt_deg) == (two.end, two.on_floor, -two.tilt_deg)
        assert one.touched_m.values() == two.touched_m.values()[::-1]
        assert one.com_m == (-two.com_m[0], two.com_m[1])


def test_off_the_floor_it_is_the_world_of_a_carry() -> None:
    world = picked_up()
    world.move(palms_deg=(5, 15), follow_floor=True)
    heights = [0.1 - height for _, height in world.state.pivots_m.values()]
    level = world.move(up_m=(heights[0], heights[1]))
    angles = math.radians(5), math.radians(15)
    spec = to_spec(pb.load_scene("paper", ROUNDED))
    palms = spec.palms
    palms[0].steep = angles[0]
    left, right = level.touched_m.values()
    assert left is not None and right is not None
    spec.palms, spec.start = palms, (left, right)
    other = _core.World(spec)
    for closing in (0.01, -0.03, 0.02):
        assert not other.advance(-2 * closing, angles)[0]
        state = world.move(closing, -closing)
        assert state.touched_m.values() == pytest.approx(other.contacts, abs=1e-9)


def test_two_heels_stop_the_palms() -> None:
    assert picked_up().move(0.1, -0.1).end == "jammed"


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"palms_deg": (-5, 15)}, "palms_deg: value is -5; allowed: from 0 to 80"),
        (
            {"gaps_m": (0.01, math.nan)},
            "gaps_m: value is nan; allowed: a finite number, at least 0",
        ),
        (
            {"floor_friction": math.inf},
            "floor_friction: value is inf; allowed: a finite number, at least 0",
        ),
        (
            {
                "overrides": {
                    "object.vertices_m": [[0, 0], [0.125, -0.01], [0.25, 0], [0.25, 0.1]],
                    "object.contacts": [0, 2],
                }
            },
            "does not stand on its contact vertices",
        ),
    ],
)
def test_bad_input_is_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(pb.PalmbotsError, match=message):
        FloorWorld(**given)


def test_bad_motions_are_refused() -> None:
    world = FloorWorld()
    with pytest.raises(pb.PalmbotsError, match="palms_deg: value is 90"):
        world.move(palms_deg=(90, 5))
    with pytest.raises(pb.PalmbotsError, match="left_m: value is nan"):
        world.move(math.nan)
    with pytest.raises(pb.PalmbotsError, match="up_m: value is inf"):
        world.move(up_m=(0.1, math.inf))


def test_what_topples_on_a_slope_is_refused() -> None:
    # Uphill is the direction of travel, so the object topples backwards, about its left vertex:
    # the COM is 40 mm high, and 40 mm × tan 20° = 14.6 mm.
    for com_x, stands in ((0.014, False), (0.015, True), (0.236, True)):
        keys = {"object.com_m": [com_x, 0.04], "task.slope_deg": 20}
        if stands:
            world = FloorWorld(overrides=keys, floor_friction=1)
            assert not world.move(0.001, -0.001).end
            continue
        with pytest.raises(pb.PalmbotsError, match="does not stand on its contact vertices"):
            FloorWorld(overrides=keys, floor_friction=1)


def under_a_box_at_a_wall(**keys: Any) -> FloorWorld:
    """A palm that drives under it lets the far corner drop, where the contact passes from the nose
    to the palm."""
    box = {
        "object.vertices_m": [[0, 0], [0.1, 0], [0.1, 0.08], [0, 0.08]],
        "object.com_m": [0.05, 0.04],
        "object.edge_radius_m": RADIUS_M,
        "floor.walls": [{"at_m": 0.0505}],
    }
    return FloorWorld("lift", palms_deg=(8.0, 15.0), gaps_m=(0.001, None), overrides=box | keys)


def arc_centre(state: FloorState, along: float, up: float = RADIUS_M - 0.04) -> tuple[float, float]:
    """Of a lower corner of that box, from its COM."""
    (x, y), tilt = state.com_m, math.radians(state.tilt_deg)
    return (
        x + along * math.cos(tilt) - up * math.sin(tilt),
        y + along * math.sin(tilt) + up * math.cos(tilt),
    )


def test_a_fall_states_how_far_a_corner_falls_and_what_energy_that_releases() -> None:
    """A world without falls ends where the object begins to fall."""
    stopped, world = under_a_box_at_a_wall(**{"world.fall_m": 0.0}), under_a_box_at_a_wall()
    start = world.state.pivots_m.left[0]
    while not (before := stopped.move(0.0005)).end:
        assert not before.falls
    assert before.end == "fell"
    after = world.move(before.pivots_m.left[0] - start + 1e-9)
    (fall,) = after.falls
    drop = arc_centre(before, 0.047)[1] - arc_centre(after, 0.047)[1]
    assert fall.height_m == pytest.approx(drop, rel=1e-3)
    weight = 0.1 * _core.standard_gravity  # of 0.1 × 0.08 × 0.1 m³ at 125 kg/m³
    released = weight * (before.com_m[1] - after.com_m[1])
    assert fall.energy_j == pytest.approx(released, rel=1e-3) and released > 0


def test_an_object_does_not_fall_through_a_nose() -> None:
    """The far corner drops back to the floor; the near arc then stays outside the nose."""
    radius, half, theta = RADIUS_M, 0.075, math.radians(8.0)
    world = under_a_box_at_a_wall()
    falls = 0
    for _ in range(60):
        state = world.move(0.0005)
        assert not state.end
        falls += len(state.falls)
        centre = arc_centre(state, radius - 0.05)
        pivot = state.pivots_m.left
        nose = pivot[0] + half * math.cos(theta), pivot[1] - half * math.sin(theta)
        assert math.dist(centre, nose) >= radius - 1e-9
    assert falls > 0


def test_a_contact_that_runs_off_its_feature_is_reported() -> None:
    """A palm pushes against the side of a wide lid, and then sinks below it."""
    lid = [[0, 0], [0.25, 0], [0.25, 0.02], [0.35, 0.02], [0.35, 0.1], [-0.1, 0.1], [-0.1, 0.02]]
    keys = {"object.vertices_m": [*lid, [0, 0.02]], "object.com_m": [0.125, 0.05]}
    world = FloorWorld(overrides=keys)
    for left, up, touches, run_off in (
        (0.0, 0.05, False, ()),
        (0.012, 0.0, True, ()),
        (0.0, -0.029, True, ()),
        (0.0, -0.002, False, ("left palm",)),
        (0.0, -0.002, False, ()),
    ):
        state = world.move(left, up_m=(up, 0.0))
        assert (state.touched_m.left is not None, state.run_off) == (touches, run_off)
    # Where it withdraws instead, its force is zero.
    world = FloorWorld(overrides=keys)
    world.move(up_m=(0.05, 0.0))
    assert world.move(0.012).touched_m.left is not None
    state = world.move(-0.001)
    assert (state.touched_m.left, state.run_off) == (None, ())


@pytest.mark.parametrize("pieces", [2, 7, 300])
def test_a_motion_in_one_piece_is_that_in_many(pieces: int) -> None:
    """The first nose pushes the box against the second one, then both get under. In one piece the
    object jammed: the nose sticks on an arc that is a tenth as large as its way."""
    states = []
    for n in (1, pieces):
        world = FloorWorld("plate", palms_deg=(8.0, 15.0), overrides=ROUNDED)
        assert not any(world.move(0.03 / n).end for _ in range(n))
        states.append(world.state)
    whole, cut = states
    assert not whole.on_floor and whole.com_m == pytest.approx(cut.com_m, abs=1e-9)
