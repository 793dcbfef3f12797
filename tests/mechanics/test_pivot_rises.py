# SPDX-License-Identifier: Apache-2.0
"""Properties at unequal pivot heights, against motions of the exact world and against `analyze`."""

import itertools
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.mechanics.lift_margins import PROPERTIES
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.scene.unequal_pivots import raise_right_pivot

SHALLOW, STEEP = math.radians(5), math.radians(15)
MOVES = 1e-4


def world(scene: Scene, angles: tuple[float, float], p: tuple[float, float], rise: float) -> Any:
    """The exact world in a state, on the slope of the line between its pivots."""
    spec = to_spec(scene)
    palms = spec.palms
    for palm, angle in zip(palms, angles, strict=True):
        palm.steep = palm.shallow = angle
    spec.palms, spec.start = palms, p
    raise_right_pivot(spec, rise)
    return _core.World(spec), tuple(palm.steep for palm in spec.palms)


def moved(
    scene: Scene, angles: tuple[float, float], p: tuple[float, float], rise: float, by: float
) -> list[float]:
    """How far each contact moves outward when the palms close; empty: the object falls."""
    one, turned = world(scene, angles, p, rise)
    if one.advance(by, turned)[0]:
        return []
    return [after - before for after, before in zip(one.contacts, p, strict=True)]


def steps(share: float, rise: float) -> Iterator[bool]:
    """Whether only the right contact moves, for properties 1 and 2 on a grid of contacts; whether
    the object is held without another contact, for two palms that are both shallow or steep."""
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0})
    half = 0.0745 * share  # a contact at the very end may leave the palm
    for angle, *p in itertools.product((SHALLOW, STEEP), *2 * [(-half, 0.0, half)]):
        yield bool(moved(scene, (angle, angle), (p[0], p[1]), rise, MOVES))
    for number, shallow in itertools.product((1, 2), (0, 1)):
        angles = (SHALLOW, STEEP) if shallow == 0 else (STEEP, SHALLOW)
        slides = shallow if number == 1 else 1 - shallow
        end = -half if number == 1 else half
        for own, other in itertools.product((end, 0.01 * end), (-half, 0.0, half)):
            p = (own, other) if slides == 0 else (other, own)
            by = moved(scene, angles, p, rise, -MOVES if number == 1 else MOVES)
            yield bool(by) and abs(by[1 - slides]) < 1e-9 and by[slides] * (3 - 2 * number) > 0


@pytest.mark.parametrize("share", [0.5, 1.0])
def test_the_permitted_rise_is_that_of_the_exact_world(share: float) -> None:
    spec = to_spec(pb.load_scene("paper"))
    most = _core.PivotRises(spec, share).permitted_m(PROPERTIES)
    assert 0.001 < most < 0.1
    for sign in (1, -1):
        assert all(steps(share, 0.97 * sign * most))
    assert not all(all(steps(share, 1.1 * sign * most)) for sign in (1, -1))


FORCES = ("property 0", "property 1", "property 2")


@pytest.mark.parametrize(("share", "proved"), [(0.96, True), (1.04, False)])
def test_a_certificate_proves_the_permitted_rise(share: float, proved: bool) -> None:
    """A pivot that is higher by d is a surface that is farther from its pivot by d / cos θ."""
    scene = pb.load_scene("paper")
    spec = to_spec(scene)
    rise = share * _core.PivotRises(spec, 0.5).permitted_m(PROPERTIES, clear=False)
    end, offset = 0.25 * spec.palms[0].usable, 0.5 * rise / math.cos(STEEP)
    found = pb.certify(
        scene, region_m=(-end, end), offset_m=(-offset, offset), claims=FORCES, max_boxes=2000
    )
    assert found.holds == proved


@pytest.mark.parametrize("name", ["box", "bottle"])
def test_a_certificate_proves_the_properties_on_the_floor(name: str) -> None:
    """Contacts count from the nose, which is level on the floor, and corrections end at the middle
    of the palm."""
    keys = {"palm.heel_m": 0.0} | ({} if name == "box" else {"object": name})
    scene = pb.load_scene("lift", keys)
    spec = to_spec(scene)
    palm = spec.palms[0]
    reach, half = 0.5 * palm.usable, 0.5 * palm.length
    lifts = [
        (palm.lowest_pivot(angle) - half * math.sin(angle)) / math.cos(angle)
        for angle in (palm.shallow, palm.steep)
    ]
    found = pb.certify(
        scene,
        region_m=(min(half - reach, -1e-6), half + reach),
        beyond_m=half,
        length_m=(2 * (half + reach), 2 * (half + reach)),
        offset_m=(min(lifts), max(lifts)),
        claims=FORCES,
        max_boxes=2000,
    )
    on_floor = _core.PivotRises(spec).holding(on_floor=True, clear=False)
    assert found.holds == (on_floor == PROPERTIES) == (name == "box")


def test_level_pivots_have_the_properties_that_analyze_proves() -> None:
    rng = np.random.default_rng(5)
    seen = set()
    for _ in range(25):
        keys = {
            "palm.shallow_deg": float(rng.uniform(2, 12)),
            "palm.steep_deg": float(rng.uniform(14, 35)),
            "palm.friction": float(rng.uniform(0.1, 0.9)),
            "object.com_m": [float(rng.uniform(0.1, 0.15)), 0.04],
        }
        analysis = pb.analyze("paper", overrides=keys)
        found = _core.PivotRises(to_spec(analysis.scene)).holding(clear=False)
        for number in PROPERTIES:
            proved = all(analysis.properties[number, side].holds for side in ("left", "right"))
            seen.add((number, proved))
            if proved:
                assert number in found, (keys, number)
            if number in found:  # a sample may miss what fails between its places
                margins = [
                    analysis.properties[number, side].margins.com_m for side in ("left", "right")
                ]
                assert all(one is not None and one > -1e-3 for one in margins), (keys, number)
    assert len(seen) > 4


def test_a_mirrored_scene_has_the_same_properties() -> None:
    keys = {"object.com_m": [0.118, 0.04], "palm.left.friction": 0.35}
    scene = pb.load_scene("lift", keys)
    ours, theirs = (_core.PivotRises(to_spec(one)) for one in (scene, scene.mirrored()))
    for rise in (0.0, 0.01, 0.03, -0.02):
        for on_floor in (False, True):
            assert ours.holding(rise, on_floor) == theirs.holding(-rise, on_floor)


def test_noses_on_the_floor_take_room_from_the_properties_and_give_clearance() -> None:
    """The pivot of a shallow palm is the lower one, so the object tilts away from that palm."""
    rises = _core.PivotRises(to_spec(pb.load_scene("lift")))
    assert rises.holding() == rises.holding(on_floor=True) == PROPERTIES
    lower = rises.permitted_m(PROPERTIES, on_floor=True, clear=False)
    assert 0 < lower < rises.permitted_m(PROPERTIES, clear=False) - 0.01
    assert rises.permitted_m(PROPERTIES, on_floor=True) > rises.permitted_m(PROPERTIES)
