# SPDX-License-Identifier: Apache-2.0
"""A small object goes from one palm to the other: the steep palm of the partner takes the place of
the wall of a lone robot (docs/theory/lifting.md)."""

import math

import pytest

from palmbots.mechanics.lifting_bodies import Plate, plate_on_floor, standing
from palmbots.mechanics.lifting_forces import least_partner_angle
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_world import FloorWorld

SHALLOW = 9.0
LENGTH = 0.15
NEAR = 1e-4
WEIGHT = 0.2 * 9.80665


def keys(**others: float) -> dict[str, object]:
    given = {key.replace("__", "."): value for key, value in others.items()}
    return {"floor.walls": [], **given}


def gap(world: FloorWorld) -> float:
    """Between the noses of the palms, on the floor [m]."""
    state = world.state
    return (
        state.pivots_m.right[0]
        - state.pivots_m.left[0]
        - 0.5
        * LENGTH
        * sum(
            math.cos(math.radians(angle)) for angle in (state.palms_deg.left, state.palms_deg.right)
        )
    )


def takes(world: FloorWorld, side: int, shallow: float = SHALLOW) -> bool:
    """Drives the shallow palm of this side in until the object lies flush on it, or the noses meet.

    Returns whether it lies flush.
    """
    inward = 1 - 2 * side
    while (room := gap(world)) > NEAR and not world.state.end:
        step = min(0.005, room)
        state = world.move(*((step, 0.0) if side == 0 else (0.0, -step)))
        if state.tilt_deg == pytest.approx(-inward * shallow, abs=0.01) and not state.grounds:
            return True
    return False


def carries_away(world: FloorWorld, side: int, way: float) -> None:
    """Backs off a little, raises the palm and drives. Only this palm touches the object."""
    back = -0.005 * (1 - 2 * side)
    for moves, up in ((back, 0.0), (0.0, 0.1), (way, 0.0)):
        pair, ups = [0.0, 0.0], [0.0, 0.0]
        pair[side], ups[side] = moves, up
        state = world.move(*pair, up_m=(ups[0], ups[1]))
        assert (state.end, state.grounds) == ("", ())
    touched = (state.touched_m.left, state.touched_m.right)
    assert touched[1 - side] is None
    assert touched[side] is not None


@pytest.mark.parametrize("steep", [26.5, 30.0, 34.0])
def test_the_palm_of_the_partner_takes_the_place_of_the_wall(steep: float) -> None:
    """The left palm takes the object from the floor, carries it and tips it out. Then the right
    palm takes the object over."""
    world = FloorWorld("lone", palms_deg=(SHALLOW, steep), gaps_m=(0.03, 0.005), overrides=keys())
    assert takes(world, 0)
    carries_away(world, 0, 0.0)
    world.move(0.0, 0.4)
    world.move(0.3, 0.0)
    world.move(up_m=(-0.1, 0.0))
    tipped = world.move(palms_deg=(steep, SHALLOW), follow_floor=True)
    assert (tipped.end, tipped.on_floor) == ("", True)
    for _ in range(100):
        if world.move(-0.002, 0.0).touched_m.left is None:
            break
    put_down = world.state
    assert (put_down.end, put_down.grounds) == ("", ("floor",))
    assert put_down.tilt_deg == pytest.approx(0.0, abs=1e-6)
    assert takes(world, 1)
    carries_away(world, 1, 0.3)
    assert world.state.com_m[0] == pytest.approx(put_down.com_m[0] + 0.3, abs=0.01)


@pytest.mark.parametrize("radius", [0.002, 0.003, 0.005])
@pytest.mark.parametrize("com", [0.04, 0.045, 0.05, 0.055])
def test_the_partner_holds_from_the_angle_on_at_which_the_second_nose_gets_under(
    radius: float, com: float
) -> None:
    """Below it the corner on the partner's palm climbs, and the object does not come to lie flush.

    The angle follows from the forces alone. The partner's contact leans as its palm, or as its nose
    if that is steeper.
    """
    given = keys(object__edge_radius_m=radius) | {"object.com_m": [com, 0.025]}
    spec = to_spec(load_scene("lone", given))
    own, partner = spec.palms

    def plates(angle: float) -> tuple[Plate, Plate]:
        shallow = plate_on_floor(own, math.radians(SHALLOW))
        return shallow, plate_on_floor(partner, math.radians(angle))

    body = standing(spec, WEIGHT)
    least = math.degrees(least_partner_angle(body, plates(60.0), 0))
    outcomes = set()
    for angle in (least - 1.0, least + 1.0):
        lean = math.degrees(plates(angle)[1].nose_lean(radius))
        world = FloorWorld(
            "lone", palms_deg=(SHALLOW, angle), gaps_m=(0.03, 0.005), overrides=given
        )
        assert takes(world, 0) == (lean >= least), (least, angle)
        outcomes.add(lean >= least)
    assert outcomes == ({True} if com > 0.05 else {False, True})


@pytest.mark.parametrize(("shallow", "steep"), [(SHALLOW, 45.0), (6.0, 39.0)])
def test_a_palm_that_is_too_steep_is_a_wall_but_does_not_put_down(
    shallow: float, steep: float
) -> None:
    """The object slides down the palm by itself, so no balance is left: at 45° it falls too far,
    at 39° by nearly the height of its far vertex on the palm."""
    end, slides = slide(shallow, steep)
    assert end == "fell" if steep == 45.0 else (end == "" and max(slides) > 5e-3)


def test_friction_takes_up_most_of_a_slide() -> None:
    """At 39° the object slides down by 15 mm. Less than 3 mm of that count, and more than 0.5."""
    ends = [slide(6.0, 39.0, world__fall_m=most)[0] for most in (0.003, 0.0005)]
    assert ends == ["", "fell"]


def slide(shallow: float, steep: float, **others: float) -> tuple[str, list[float]]:
    """How the object gets down from the left palm once it is steep: the end, and the falls [m]."""
    world = FloorWorld(
        "lone", palms_deg=(shallow, steep), gaps_m=(0.03, 0.005), overrides=keys(**others)
    )
    assert takes(world, 0, shallow)
    carries_away(world, 0, 0.0)
    world.move(0.0, 0.4)
    world.move(up_m=(-0.1, 0.0))
    world.move(palms_deg=(steep, shallow), follow_floor=True)
    states = [world.move(-0.002, 0.0) for _ in range(50)]
    return states[-1].end, [fall.height_m for state in states for fall in state.falls]


def test_at_the_shallow_angle_of_the_scene_no_steep_angle_does_both() -> None:
    """The nose is higher there. At 39° the palm is a wall, but too steep to put down."""
    world = FloorWorld("lone", palms_deg=(6.0, 38.0), gaps_m=(0.03, 0.005), overrides=keys())
    assert not takes(world, 0, 6.0)
