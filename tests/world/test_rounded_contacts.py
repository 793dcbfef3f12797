# SPDX-License-Identifier: Apache-2.0
"""Rounded corners of the object: what stands on an arc rolls."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

import palmbots as pb
import palmbots._core as _core
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import contact_radii, to_spec

SIDES = (-1.0, 1.0)  # world x of "outward"


def scene(radius_m: Any, **keys: float) -> Any:
    given = {name.replace("__", "."): value for name, value in keys.items()}
    return load_scene("paper", given | {"object.edge_radius_m": radius_m})


class Rolling:
    """A world, and how far each contact has rolled and slid.

    On a palm that rises outward by θ, a contact that rolls keeps p + R (ϑ − turn of the palm),
    where the palm turns by −θ on the left and by θ on the right, with the sign of outward.
    """

    def __init__(self, at: Any) -> None:
        self.spec = to_spec(at)
        self.radii = contact_radii(self.spec)
        self.world = _core.World(self.spec)

    def angle(self) -> float:
        """Of the object."""
        dx, dy = self.world.contact_vector
        return math.atan2(dy, dx)

    def run(self, k: int, p: float, angle: float) -> float:
        return p + SIDES[k] * self.radii[k] * (angle - SIDES[k] * self.world.palms[k])

    def runs(self) -> list[float]:
        return [self.run(k, p, self.angle()) for k, p in enumerate(self.world.contacts)]

    def centre(self, k: int, p: float) -> np.ndarray:
        """Of a circle that touches its palm at p."""
        palm = self.world.palms[k]
        along = np.array([SIDES[k] * math.cos(palm), math.sin(palm)])
        normal = np.array([-SIDES[k] * math.sin(palm), math.cos(palm)])
        pivot = np.array([SIDES[k] * self.world.separation / 2, 0.0])
        return pivot + p * along + (self.spec.palms[k].offset + self.radii[k]) * normal

    def independent(self, held: int, run: float) -> tuple[float, float, float]:
        """Both coordinates and the object's angle, from the positions of two circles on two lines.

        The circle of the side `held` has rolled and slid by `run`; the other one slides freely.
        """

        def faults(unknown: np.ndarray) -> list[float]:
            left, right, angle = unknown
            between = self.centre(1, right) - self.centre(0, left)
            return [
                between[0] - self.spec.width * math.cos(angle),
                between[1] - self.spec.width * math.sin(angle),
                self.run(held, (left, right)[held], angle) - run,
            ]

        guess = [*self.world.contacts, self.angle()]
        left, right, angle = least_squares(faults, guess, xtol=1e-15, ftol=1e-15, gtol=1e-15).x
        return float(left), float(right), float(angle)


@pytest.mark.parametrize("radius", [0.01, 0.06, [0.03, 0.01, 0.0, 0.0], [0.04, 0.0, 0.0, 0.02]])
def test_a_contact_that_sticks_rolls(radius: Any) -> None:
    """Palms turn and robots move by random steps; wherever one contact sticks, it has rolled."""
    draw = np.random.default_rng(1)
    compared = 0
    for _ in range(12):
        rolling = Rolling(scene(radius))
        for _ in range(40):
            before = rolling.runs()
            left, right = np.radians(draw.uniform(8, 18, 2)).tolist()
            ended, _, *motion, pieces = rolling.world.advance(
                draw.uniform(-0.004, 0.004), (left, right)
            )
            if ended:
                break
            if sorted(map(abs, motion)) != [0, 1] or pieces != 1:
                continue  # both slide, or another one does from some instant on
            held = motion.index(0)
            assert rolling.runs()[held] == pytest.approx(before[held], abs=1e-14)
            found = (*rolling.world.contacts, rolling.angle())
            assert found == pytest.approx(rolling.independent(held, before[held]), abs=1e-11)
            compared += 1
    assert compared > 100


def put_over_a_floor(other: Any, world: Any, pivots_m: float) -> None:
    """Makes `other` the same world with a floor so far below that nothing touches it: there every
    step looks for contacts of any kind."""
    x, y, angle = world.pose
    left, right = ((place, height + pivots_m) for place, height in world.pivots)
    other.put((left, right), world.palms, (x, y + pivots_m), angle)


@pytest.mark.parametrize("radius", [0.003, 0.06, [0.03, 0.01, 0.0, 0.0], [0.04, 0.0, 0.0, 0.02]])
def test_steps_agree_with_those_that_look_for_any_contact(radius: Any) -> None:
    """In which the motion follows from the contact modes that are possible and in balance."""
    draw = np.random.default_rng(2)
    alike = switched = 0
    for _ in range(12):
        at = scene(radius, start__left_m=draw.uniform(-0.03, 0.03))
        spec = to_spec(at)
        one, other = _core.World(spec), _core.World(spec, True)
        for _ in range(60):
            put_over_a_floor(other, one, 10.0)
            palms = one.palms
            if draw.random() < 0.6:
                palms = tuple(np.clip(palms + np.radians(draw.uniform(-1, 1, 2)), 0.08, 0.3))
            change, push = draw.uniform(-0.002, 0.002), draw.choice([0.0, 0.01])
            ended, fraction, *_, pieces = one.advance(change, palms, push)
            ended_there, fraction_there, *_ = other.advance(change, palms, push)
            assert ended == ended_there and fraction == pytest.approx(fraction_there, abs=1e-9)
            if ended:
                break
            # The other world slides on until a force lacks 1e-10 of the weight.
            assert one.contacts == pytest.approx(other.contacts, abs=3e-9)
            assert one.pose[2] == pytest.approx(other.pose[2], abs=3e-9)
            alike += 1
            switched += pieces == 2
    assert alike > 300 and switched > 10, (alike, switched)


@pytest.mark.parametrize("controller", ["distributed", "shared-sign"])
def test_a_tiny_radius_changes_nothing(controller: str) -> None:
    """The step that knows rolling agrees with the one that knows sharp vertices only."""
    sharp, round_ = (
        pb.carry(scene(radius), controller=controller, seed=3).trace for radius in (0.0, 1e-9)
    )
    assert sharp is not None and round_ is not None
    first = slice(0, 1000)
    difference = np.abs(sharp["contact"][first].values - round_["contact"][first].values)
    assert difference.max() < 1e-6


def test_rolling_is_that_of_another_engine() -> None:
    """Corrections from 3 cm off: MuJoCo rolls balls on boxes. A radius of 3 cm shifts the contacts
    by 9 mm, in both worlds alike."""
    off = {"robot__noise_m_s": 0.0, "start__left_m": 0.03, "start__right_m": -0.03}
    off["task__distance_m"] = 0.45  # 700 ticks
    traces = {
        (radius, world): pb.carry(scene(radius, **off), seed=0, world=world).trace
        for radius in (0.0, 0.03)
        for world in ("quasistatic", "mujoco")
    }
    places = {key: trace["contact"].values[:700] for key, trace in traces.items() if trace}
    assert np.abs(places[0.03, "quasistatic"] - places[0.03, "mujoco"]).max() < 1e-3
    assert np.abs(places[0.03, "quasistatic"] - places[0.0, "quasistatic"]).max() > 8e-3


def test_rounding_reaches_area_mass_and_centroid() -> None:
    """By closed forms: four quarter circles in place of four squares."""
    long, high, r = 0.3, 0.2, 0.05
    full = load_scene({"object": {"box_m": [long, high], "edge_radius_m": r}}).object
    area = long * high - (4 - math.pi) * r * r
    assert full.mass_kg == pytest.approx(125 * area * full.depth_m, rel=1e-9)
    assert full.com_m == pytest.approx((long / 2, high / 2), abs=1e-12)
    one = load_scene({"object": {"box_m": [long, high], "edge_radius_m": [r, 0, 0, 0]}}).object
    cut = (1 - math.pi / 4) * r * r
    near = r * (10 - 3 * math.pi) / (12 - 3 * math.pi)  # its centroid, from the sharp corner
    x = (long * high * long / 2 - cut * near) / (long * high - cut)
    y = (long * high * high / 2 - cut * near) / (long * high - cut)
    assert one.com_m == pytest.approx((x, y), abs=1e-9)


def test_silhouette_is_drawn_along_the_arcs() -> None:
    spec = to_spec(scene(0.04))
    corners = np.array([(x, y) for x, y, _ in spec.corners])
    points = np.array(spec.silhouette)
    nearest = np.hypot(*(points[:, None] - corners[None]).transpose(2, 0, 1)).min(axis=1)
    assert nearest == pytest.approx(0.04, abs=1e-12)
    assert len(points) == 4 * 13
    assert spec.corners[0][:2] == pytest.approx((0, 0), abs=1e-15)
    assert spec.width == pytest.approx(0.25 - 2 * 0.04)
    sharp = to_spec(scene(0.0))
    assert sharp.silhouette == [(x, y) for x, _, y, _ in sharp.outline]


def test_an_arc_lies_in_a_palm_only_between_its_ends() -> None:
    """A left side that bulges by 2 mm. The whole circle of its arc would lie in the right palm."""
    box = [(0.0, 0.0), (0.25, 0.0), (0.25, 0.16), (0.0, 0.16), (-0.002, 0.08)]
    bulging = {"vertices_m": box, "contacts": (0, 1), "edge_radius_m": [0.0, 0.0, 0.0, 0.0, 0.24]}
    assert pb.carry("paper", seed=1, overrides={"object": bulging}).outcome == "delivered"
