# SPDX-License-Identifier: Apache-2.0
"""Slip across askew palms: against another minimizer, closed forms, and MuJoCo itself."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize

from palmbots.mujoco.curved_world import CurvedWorld
from palmbots.mujoco.drift_forecast import contact_compliance
from palmbots.mujoco.slip_statics import Pair, slip
from palmbots.scene.scene import load_scene

BOX = Pair(
    friction=(0.3, 0.3), load=(0.5, 0.5), apart=0.25, half=0.0343, com_height=0.04, give=0.31e-3
)
STEEP, SHALLOW = math.radians(15), math.radians(5)


def oracle(
    pair: Pair, angles: tuple[float, float], beta: float, closing: bool, aside: float
) -> tuple[np.ndarray, np.ndarray]:
    """The same statics contact by contact in three dimensions, with a minimizer of SciPy's."""
    sense = 1 if closing else -1
    ends = [
        v * math.tan(t + sense * math.atan(mu))
        for v, t, mu in zip(pair.load, angles, pair.friction, strict=True)
    ]
    squeeze = min(ends) if closing else max(ends)
    gradient, heading, normal = [], [], []
    for k, out in ((0, -1), (1, 1)):
        forward = np.array([math.cos(beta), out * math.sin(beta)])
        heading.append(forward)
        gradient.append(out * math.tan(angles[k]) * forward)
        normal.append(pair.load[k] * math.cos(angles[k]) + squeeze * math.sin(angles[k]))
    height = [float(g @ (0, 2 * pair.half)) for g in gradient]  # of one end over the other
    roll = sum(height) / 2 / (2 * pair.half)
    middle = aside - pair.com_height * roll
    spread = (height[1] - height[0]) / (4 * pair.give) * pair.half
    spread = math.copysign(min(abs(spread), max(0, pair.half - abs(middle))), spread)
    contacts = []
    for k, out in ((0, -1), (1, 1)):
        left = np.array([-heading[k][1], heading[k][0]])
        pressed = min(max((middle + out * spread) / pair.half, -1), 1)
        for end in (-1, 1):
            place = np.array([out * pair.apart / 2, 0]) + end * pair.half * left
            drive = np.zeros(2)
            if k == 0:
                arm = end * pair.half * left
                turn = 2 * math.sin(beta) / pair.apart
                drive = sense * (heading[0] + turn * np.array([-arm[1], arm[0]]))
            contacts.append((k, place, drive, 0.5 * (1 + end * pressed)))

    def moves(q: np.ndarray) -> list[tuple[int, np.ndarray, float]]:
        turning = q[2] / pair.apart
        return [
            (k, np.array([q[0] - turning * r[1], q[1] + turning * r[0]]) - drive, share)
            for k, r, drive, share in contacts
        ]

    def power(q: np.ndarray) -> float:
        total = 0.0
        for k, v, share in moves(q):
            rise = float(gradient[k] @ v)
            long = math.sqrt(float(v @ v) + rise * rise + 1e-8)
            total += share * (pair.friction[k] * normal[k] * long + pair.load[k] * rise)
        return total

    q = minimize(power, np.zeros(3), method="Powell", options={"xtol": 1e-10, "ftol": 1e-14}).x
    q = minimize(power, q, method="Nelder-Mead", options={"xatol": 1e-9, "fatol": 1e-15}).x
    along, across = np.zeros(2), np.zeros(2)
    for k, v, _ in moves(q):
        along[k] += (-1, 1)[k] * float(v @ heading[k]) / math.cos(angles[k]) / 2
        across[k] += float(v @ (-heading[k][1], heading[k][0])) / 2
    return along, across


@pytest.mark.parametrize(
    ("angles", "beta", "closing", "aside", "pair"),
    [
        ((SHALLOW, STEEP), 0.03, True, 0.0, BOX),
        ((SHALLOW, STEEP), 0.125, True, 0.0, BOX),
        ((SHALLOW, STEEP), 0.125, True, -0.02, BOX),
        ((STEEP, SHALLOW), 0.0625, True, -0.01, BOX),
        ((SHALLOW, STEEP), 0.125, False, 0.01, BOX),
        ((0.2, STEEP), 0.1, True, 0.0, Pair((0.5, 0.3), (0.6, 0.4), 0.3, 0.05, 0.1, 1e-4)),
    ],
)
def test_another_minimizer_finds_the_same(
    angles: tuple[float, float], beta: float, closing: bool, aside: float, pair: Pair
) -> None:
    along, across = oracle(pair, angles, beta, closing, aside)
    found = slip(pair, angles, beta, closing, aside)
    assert found.along == pytest.approx(along, abs=0.01)
    assert found.across == pytest.approx(across, abs=0.01)


@pytest.mark.parametrize("beta", [0.01, 0.05, 0.125])
@pytest.mark.parametrize("friction", [0.2, 0.3, 0.5])
def test_lateral_slip_at_equal_angles_has_a_closed_form(beta: float, friction: float) -> None:
    """No warp, and both contacts at their limit, so that nothing resists turning: across the palm
    friction and the slope of the weight balance, μ (v/u + sin β) = −sin θ sin β."""
    pair = Pair((friction, friction), (0.5, 0.5), 0.25, 0.0343, 0.0, 1e-3)
    found = slip(pair, (STEEP, STEEP), beta, True)
    wanted = -(1 + math.sin(STEEP) / friction) * math.sin(beta)
    assert float(found.rate) == pytest.approx(wanted, rel=0.05)


def test_lateral_slip_is_zero_on_a_straight_path() -> None:
    for angles in ((SHALLOW, STEEP), (STEEP, STEEP)):
        found = slip(BOX, angles, 0.0, [True, False])
        assert np.abs(found.across).max() < 1e-3
        assert np.abs(found.along).max() == pytest.approx(1 / math.cos(max(angles)), rel=0.03)


def test_left_and_right_are_mirror_images() -> None:
    one = slip(BOX, (SHALLOW, STEEP), 0.1, True, -0.01)
    two = slip(BOX, (STEEP, SHALLOW), 0.1, True, -0.01)
    assert one.along == pytest.approx(two.along[::-1], abs=0.01)
    assert one.across == pytest.approx(two.across[::-1], abs=0.01)


# --- against MuJoCo -----------------------------------------------------------------------------


def test_contacts_are_compliant_like_springs() -> None:
    """With palms askew the loads at both ends of an edge differ by the warp over the give."""
    scene = load_scene("paper", {"task.path.kind": "arc", "task.path.radius_m": 4.0})
    give = contact_compliance(scene)
    assert give == pytest.approx(BOX.give, rel=0.1)
    world = CurvedWorld(scene)
    for _ in range(650):
        world.move((0.06, 0.06), (STEEP, STEEP))
    for tick in range(40):
        world.move((0.06, 0.06), (STEEP + (tick + 1) / 40 * (SHALLOW - STEEP), STEEP))
    forces = {}
    for i in range(world.data.ncon):
        contact = world.data.contact[i]
        names = " ".join(str(world.model.geom(int(g)).name) for g in contact.geom)
        if "vertex" in names:
            end = "near" if "near" in names else "far"
            forces[("left" in names, end)] = float(world.data.efc_force[contact.efc_address])
    beta = math.asin(BOX.apart / 2 / 4.0)
    warp = (math.tan(STEEP) - math.tan(SHALLOW)) * math.sin(beta) * 2 * BOX.half
    for left, outer, inner in ((True, "near", "far"), (False, "far", "near")):
        one, two = forces[left, outer], forces[left, inner]
        assert (one - two) / (one + two) == pytest.approx(warp / (4 * give), rel=0.2)


def closed(radius: float, angles: tuple[float, float], closing: bool) -> np.ndarray:
    """Slip across while palms in the middle of a circle are driven by 10 mm [m for each metre]."""
    scene = load_scene("paper", {"task.path.kind": "arc", "task.path.radius_m": radius})
    world = CurvedWorld(scene)
    v, steep, period = 0.06, (STEEP, STEEP), 0.01
    for _ in range(650):
        world.move((v, v), steep)
    for tick in range(40):
        part = (tick + 1) / 40
        left, right = (STEEP + part * (a - STEEP) for a in angles)
        world.move((v, v), (left, right))
    before = np.array(world.lateral)
    for _ in range(100):
        world.move((v + (0.01 if closing else -0.01), v), angles)
    return (np.array(world.lateral) - before) / (100 * 0.01 * period)


@pytest.mark.parametrize(("radius", "known"), [(4.0, -0.065), (2.0, -0.19), (1.0, -0.43)])
def test_lateral_slip_of_a_mujoco_correction_agrees_with_statics(
    radius: float, known: float
) -> None:
    """The numbers of docs/guide/mujoco.md."""
    beta = math.asin(BOX.apart / 2 / radius)
    seen = closed(radius, (SHALLOW, STEEP), True)
    assert seen == pytest.approx(slip(BOX, (SHALLOW, STEEP), beta, True).across, rel=0.35, abs=0.02)
    assert seen[0] == pytest.approx(known, rel=0.06)
    opened = closed(radius, (SHALLOW, STEEP), False)
    assert np.abs(opened).max() < 0.05
