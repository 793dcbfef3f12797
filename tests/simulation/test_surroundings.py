# SPDX-License-Identifier: Apache-2.0
"""Objects at walls and on stands, against closed forms; walls and stands in the mirror."""

import math
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palm_scripts import BOX, LEANING, SIX, Drive, things_on_floor
from palmbots.scene.placement import floor_level
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import FloorState, FloorWorld
from palmbots.viz.solids import WORLD, Box, solids
from palmbots.viz.style import QUIET

RADIUS_M = 0.003
WALL_M = 0.08


def small_box(tall_m: float, **wall: float) -> dict[str, Any]:
    """A box 12 cm long, 2 cm in front of a wall."""
    return {
        "object.box_m": [0.12, tall_m],
        "object.edge_radius_m": RADIUS_M,
        "floor.walls": [{"at_m": WALL_M, **wall}],
    }


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.2])
def test_a_palm_raises_a_box_along_a_wall(friction: float) -> None:
    """The face of the box stays on the wall: the palm pushes with H = V tan(θ + φ), and the wall's
    friction adds μ H to the weight that V carries."""
    world = FloorWorld("plate", gaps_m=(0.01, None), overrides=small_box(0.12, friction=friction))
    first = world.move(0.06)
    assert first.grounds == ("wall",) and first.touched_m.right is None
    later = world.move(0.06)
    theta, phi = math.radians(15), math.atan(0.3)
    assert later.com_m[0] == pytest.approx(WALL_M - 0.06, abs=1e-12)
    assert later.com_m[1] - first.com_m[1] == pytest.approx(0.06 * math.tan(theta), abs=1e-12)
    assert later.tilt_deg == pytest.approx(0, abs=1e-9)
    found = world.contact_modes(0.01)
    assert {one.surface for one in found.contacts} == {"left palm", "wall"}
    (mode,) = found.modes
    walls = [k for k, one in enumerate(found.contacts) if one.surface == "wall"]
    pushes = sum(mode.forces[k].normal[0] for k in walls)
    ratio = math.tan(theta + phi)
    assert pushes == pytest.approx(ratio / (1 - friction * ratio), abs=1e-9)


def seen(state: FloorState, x: float, y: float) -> tuple[float, float]:
    """A point of the object, given from its COM [m]."""
    turn = math.radians(state.tilt_deg)
    return (
        state.com_m[0] + x * math.cos(turn) - y * math.sin(turn),
        state.com_m[1] + x * math.sin(turn) + y * math.cos(turn),
    )


def test_one_palm_takes_a_box_at_a_low_wall() -> None:
    """The far corner stays on the floor, the face beside it on the edge of the wall, and the near
    corner climbs the palm until the box lies flush on it. Then the palm takes the box along."""
    high = 0.03
    world = FloorWorld(
        "plate",
        palms_deg=(8, 15),
        gaps_m=(0.01, None),
        overrides=small_box(0.1, friction=0.3, height_m=high),
    )
    theta = math.radians(8)
    tilted = 0
    for _ in range(14):
        state = world.move(0.01)
        assert not state.end
        if state.grounds != ("floor", "wall") or state.tilt_deg > -0.5:
            continue
        tilted += 1
        near, far = (seen(state, x, RADIUS_M - 0.05) for x in (RADIUS_M - 0.06, 0.06 - RADIUS_M))
        turn = math.radians(state.tilt_deg)
        beside = (WALL_M - far[0]) * math.cos(turn) + (high - far[1]) * math.sin(turn)
        px, py = state.pivots_m.left
        above = (near[0] - px) * math.sin(theta) + (near[1] - py) * math.cos(theta)
        assert (far[1], beside, above) == pytest.approx(3 * (RADIUS_M,), abs=1e-12)
    assert tilted > 5
    flush = world.move(0.01)
    assert flush.tilt_deg == pytest.approx(-8, abs=1e-9) and flush.grounds == ("wall",)
    world.move(up_m=(0.05, 0))
    world.move(-0.1)
    taken = world.move(palms_deg=(0, 15))
    assert not taken.end and taken.grounds == () and taken.tilt_deg == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("friction", [0.001, 0.2, 0.4])
@pytest.mark.parametrize("side", [0, 1])
def test_a_box_tips_at_the_edge_of_a_stand(friction: float, side: int) -> None:
    """A level palm pushes with N = μ V at the height h above the stand, where V is the weight with
    what the palm's friction adds, f N. The box tips where weight and push turn it over the edge
    against that friction: d + N h = f N (a − d) for a COM that is d past the edge and a from the
    palm."""
    stand, edge, a, h = 0.3, 0.1, 0.125, 0.0015 - 0.0003
    ends = (-edge, 0.4) if side == 1 else (-0.4, edge)
    keys = {
        "palm.friction": friction,
        "floor.stands": [{"from_m": ends[0], "to_m": ends[1], "height_m": 0.1, "friction": stand}],
    }
    gaps = (0.01, None) if side == 0 else (None, 0.01)
    world = FloorWorld("plate", palms_deg=(0, 0), gaps_m=gaps, overrides=keys)
    assert world.state.grounds == ("stand",) and not world.state.on_floor
    assert world.state.com_m == pytest.approx((0, 0.14))
    pushes = stand / (1 - stand * friction)
    past = pushes * (friction * a - h) / (1 + friction * pushes)
    way, little = 0.01 + edge + past, 1e-7
    for push, tips in ((way - little, False), (2 * little, True)):
        state = world.move(*((push, 0) if side == 0 else (0, -push)))
        assert (state.end == "toppled" or abs(state.tilt_deg) > 1e-7) == tips
        assert tips or abs(state.com_m[0]) == pytest.approx(edge + past - little, abs=1e-9)


def test_two_palms_take_a_box_from_a_stand_narrower_than_the_box() -> None:
    keys = {
        "object.edge_radius_m": RADIUS_M,
        "floor.stands": [{"from_m": -0.04, "to_m": 0.06, "height_m": 0.2}],
    }
    world = FloorWorld("plate", overrides=keys)
    state = world.move(0.085, -0.085)
    assert not state.end and state.grounds == ()
    left, right = state.touched_m.values()
    assert left == right and left is not None
    raised = world.move(0.6, 0.6, up_m=(0.02, 0.02))
    assert raised.com_m == pytest.approx((0.6, state.com_m[1] + 0.02), abs=1e-12)
    # It is put down on the floor beside the stand.
    world.move(up_m=(-0.22, -0.22))
    state = world.move(-0.12, 0.12)
    assert state.grounds == ("floor",) and state.com_m[1] == pytest.approx(0.04, abs=1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_the_mirrored_surroundings_give_the_mirrored_motion_to_the_last_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shape = (BOX, LEANING, SIX)[rng.integers(3)]
    keys = {
        "object.vertices_m": shape,
        "object.edge_radius_m": float(rng.choice([0.0, 0.003])),
        "palm.left.friction": float(rng.choice([0.2, 0.3, 0.4])),
        "palm.thickness_m": float(rng.choice([0.0, 0.0015])),
        "task.slope_deg": float(rng.choice([0.0, 1.0])),
    }
    plain = to_spec(pb.load_scene("paper", keys))
    ends = [x - plain.com_left for x, _ in plain.silhouette]
    things, _, palms = things_on_floor(rng, (min(ends), max(ends)))
    while not things:
        things, _, palms = things_on_floor(rng, (min(ends), max(ends)))
    scene = pb.load_scene("paper", keys | things)
    there, pivots = standing(scene, palms)
    back = _core.World(to_spec(scene.mirrored()), True)
    back.set_phase("by_hand")
    (x, y), (other_x, other_y) = pivots
    back.put(((-other_x, other_y), (-x, y)), there.palms, there.pose[:2], 0.0)
    drive = Drive(rng, on_floor=True)
    for k in range(150):
        (left, right), turned = drive.next(k, there.palms)
        one = there.move((left, right), turned)
        two = back.move(((-right[0], right[1]), (-left[0], left[1])), turned[::-1])
        assert one[:2] == two[:2]
        (x, y, turn), (other_x, other_y, other_turn) = there.pose, back.pose
        assert (x, y, turn) == (-other_x, other_y, -other_turn)
        assert there.grounds == back.grounds
        if one[0]:
            break


def standing(scene: Scene, palms: list[bool]) -> tuple[_core.World, list[tuple[float, float]]]:
    """An object on the floor or on its stand; the noses are 5 mm beside it. Also the pivots."""
    spec = to_spec(scene)
    world = _core.World(spec, True)
    world.set_phase("by_hand")
    angles = math.radians(12), math.radians(12)
    left, right = (0.005 if is_there else 100.0 for is_there in palms)
    pivots, com = _core.standing_start(spec, angles, (left, right))
    world.put(pivots, angles, com, 0.0)
    return world, list(pivots)


def test_walls_and_stands_are_drawn_where_they_are() -> None:
    """In logs and viewers, whose origin is halfway between the pivots at the start of a job."""
    keys = {
        "palm.left.length_m": 0.1,
        "floor.walls": [{"at_m": -0.4}, {"at_m": 3.0, "height_m": 0.2}],
        "floor.stands": [{"from_m": 2.5, "to_m": 2.7, "height_m": 0.1}],
    }
    scene = pb.load_scene("lift", keys)
    spec = to_spec(scene)
    ((left, _), (right, _)), _ = _core.standing_start(spec)
    assert left + right > 0.01  # so that the object is not in the middle
    floor = floor_level(spec)
    shown = []
    for one in solids(scene, spec):
        if isinstance(one.shape, Box) and one.colour == QUIET and one.frame == WORLD:
            (wide, _, tall), (x, _, z) = one.shape.size, one.shape.centre
            x += (left + right) / 2
            shown.append((x - wide / 2, x + wide / 2, z - tall / 2 - floor, z + tall / 2 - floor))
    for one in ((-0.45, -0.4, 0, 0.5), (3.0, 3.05, 0, 0.2), (2.5, 2.7, 0, 0.1)):
        assert any(found == pytest.approx(one, abs=1e-9) for found in shown), one
