# SPDX-License-Identifier: Apache-2.0
"""The analysis of objects whose contact vertices are rounded, against brute force."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import Side
from palmbots.stability.clearance import outline_clearance
from palmbots.stability.margins import friction_ranges, slope_range
from palmbots.stability.problem import StabilityProblem, permitted, stability_problem
from sampled import amounts
from stability_oracle import (
    STEEP_CASES,
    contacts,
    happens,
    held_everywhere,
    random_situation,
    touched,
)

RADIUS_M = 0.03
# The analysis takes 1 / cos ϑ at its worst between the extreme object angles, so it may permit a
# little less than brute force.
COM_LOST_M = 1e-3
INSIDE_M = 1e-7


def holds_everywhere(at: StabilityProblem, number: int, shallow: Side, **changed: float) -> bool:
    grid = contacts(at, number, shallow, n=15)
    return bool(happens(at, number, shallow, at.palms(shallow), grid, **changed).all())


def sharp(at: StabilityProblem) -> StabilityProblem:
    """With sharp contact vertices at the centres of the arcs."""
    return at.with_(radius=(0.0, 0.0))


@pytest.mark.parametrize("cases", amounts(60, 150))
@pytest.mark.parametrize(("number", "shallow"), STEEP_CASES)
def test_permitted_com_against_brute_force(number: int, shallow: Side, cases: int) -> None:
    rng = np.random.default_rng(31)
    compared = differs = 0
    for _ in range(cases):
        at = random_situation(rng, RADIUS_M)
        low, high = permitted(at.envelope(), number, shallow, at.angles)
        if high - low < 4 * INSIDE_M:
            continue
        compared += 1
        inside = (low + INSIDE_M, 0.5 * (low + high), high - INSIDE_M)
        outside = (low - COM_LOST_M, high + COM_LOST_M)
        assert all(holds_everywhere(at, number, shallow, com_x=x) for x in inside), at
        assert not any(holds_everywhere(at, number, shallow, com_x=x) for x in outside), at
        differs += not all(holds_everywhere(sharp(at), number, shallow, com_x=x) for x in inside)
        differs += any(holds_everywhere(sharp(at), number, shallow, com_x=x) for x in outside)
    assert compared > cases / 5 and differs > cases / 8


@pytest.mark.parametrize("cases", amounts(24, 60))
def test_property_zero_against_brute_force(cases: int) -> None:
    rng = np.random.default_rng(32)
    held = 0
    for _ in range(cases):
        at = random_situation(rng, RADIUS_M)
        at = at.with_(friction=(at.friction[0] * rng.uniform(0.05, 0.6), at.friction[1]))
        low, high = permitted(at.envelope(), 0, "left", at.angles)
        if high - low < 4 * INSIDE_M:
            continue
        held += 1
        assert all(held_everywhere(at, x) for x in (low + INSIDE_M, high - INSIDE_M)), at
        assert not any(held_everywhere(at, x) for x in (low - COM_LOST_M, high + COM_LOST_M)), at
    assert held > cases / 6


def test_ranges_against_brute_force() -> None:
    """What a range contains holds everywhere, and it ends where something fails."""
    rng = np.random.default_rng(33)
    ends = 0
    for _ in range(150):
        at = random_situation(rng, 0.02)

        def holds(at: StabilityProblem = at, **changed: float) -> bool:
            return all(holds_everywhere(at, n, shallow, **changed) for n, shallow in STEEP_CASES)

        for low, high in friction_ranges(at):
            for mu, wanted in (
                (low + 1e-6, True),
                (high - 1e-6, True),
                (1.05 * high + 2e-2, False),
            ):
                if low < mu < 100 and high - low > 1e-5:
                    assert holds(friction_left=mu, friction_right=mu) == wanted, (at, mu)
                    ends += not wanted
        slopes = slope_range(at)
        if slopes is not None:
            sign = at.spec.direction
            for s, wanted in ((slopes[0] + 1e-6, True), (slopes[1] + 1e-2, False)):
                assert holds(slope=sign * s) == wanted, (at, s)
                ends += not wanted
    assert ends > 20


def test_contact_modes_are_those_of_a_sharp_object_at_the_touching_points() -> None:
    keys = {"object.edge_radius_m": [0.03, 0.01, 0, 0]}
    at = stability_problem(pb.load_scene("paper", keys))
    angles, p = (math.radians(9), math.radians(17)), (np.array(-0.02), np.array(0.05))
    found = pb.contact_modes(
        p_left_m=-0.02, p_right_m=0.05, theta_left_deg=9, theta_right_deg=17, overrides=keys
    )
    sharp = pb.contact_modes_batch(
        **touched(at, angles, p, *at.com), theta_left=angles[0], theta_right=angles[1],
        p_left=p[0], p_right=p[1], friction_left=0.3, friction_right=0.3,
    )  # fmt: skip
    assert found.squeeze.values() == pytest.approx([pytest.approx(i) for i in sharp.squeeze])
    for contact, centre, radius in zip(found.contacts, (0.0, at.width), at.radius, strict=True):
        arm = complex(*contact.point_m) - centre
        assert abs(arm) == pytest.approx(radius)
        outward = -1 if contact.side == "left" else 1
        theta = angles[contact.side == "right"]
        turned = math.radians(found.object_deg)
        assert np.angle(arm) == pytest.approx(outward * theta - turned - math.pi / 2)


@pytest.mark.parametrize("name", ["bottle", "carton"])
def test_clearance_against_the_points_of_the_outline(name: str) -> None:
    """A palm's line, turned by less than the margin either way, is below all points; by more, it
    is not. Where the margin is negative, turning by more one way puts it below all points."""
    at = stability_problem(pb.load_scene("paper", {"object": name}))
    closest = outline_clearance(at).rotation_margin
    side = ("left", "right").index(closest.side)
    outward = (-1, 1)[side]
    rise = [
        p * math.sin(angle) + offset * math.cos(angle)
        for p, angle, offset in zip(closest.contacts_m, closest.angles_rad, at.offset, strict=True)
    ]
    turned = math.asin((rise[1] - rise[0]) / at.width)
    points = np.array([complex(*point) for point in at.spec.silhouette])
    points = (points - (at.width if side else 0.0)) * np.exp(1j * turned)  # from the centre
    is_clear = closest.margin > 0
    for off, touches in ((0.999, not is_clear), (1.001, is_clear)):
        deepest = []
        for turn in (-off * closest.margin, off * closest.margin):
            along = outward * np.exp(outward * 1j * (closest.angles_rad[side] + turn))
            deepest.append(float(np.min((points * np.conj(along)).imag * outward)))
        deep = min(deepest) if is_clear else max(deepest)
        assert (deep < -at.radius[side] - 1e-9) == touches


def test_rounded_objects_are_analysed_and_designed_for() -> None:
    found = pb.analyze("paper", overrides={"object": "carton"})
    assert found.holds and "for palms of any length" in str(found)
    best = pb.design("paper", maximize="com", controller=None, overrides={"object": "carton"})
    assert best.is_certified and "not certified, because a contact vertex" in str(best)
    assert pb.analyze("paper", overrides={"object": "carton"} | best.angle_keys).holds


TOTE = {"object.box_m": [0.4, 0.22], "object.com_m": [0.185, 0.08], "object.edge_radius_m": 0.004}


def test_ranges_of_the_com_are_those_of_the_scene() -> None:
    """A COM of the scene just inside a printed range holds, and one just outside does not."""

    def holds(x: float, y: float) -> bool:
        found = pb.analyze("paper", overrides=TOTE | {"object.com_m": [x, y]})
        return all(one.holds for one in found.properties.values() if one.number)

    found = pb.analyze("paper", overrides=TOTE)
    assert found.com_x_m is not None
    (low, high), step = found.com_x_m, 1e-6
    of_each = [one.com_x_m or (1.0, -1.0) for one in found.properties.values() if one.number]
    lows, highs = zip(*of_each, strict=True)
    assert (max(lows), min(highs)) == pytest.approx((low, high), abs=1e-12)
    (margin,) = (one for one in found.ranking if one.quantity == "com")
    assert margin.allowed == pytest.approx(min(0.185 - low, high - 0.185), abs=1e-12)
    assert holds(low + step, 0.08) and not holds(low - step, 0.08)
    assert holds(high - step, 0.08) and not holds(high + step, 0.08)
    near = pb.analyze("paper", overrides=TOTE | {"object.com_m": [low + 0.002, 0.08]})
    ends = [end for piece in near.com_y_m for end in piece if 0.001 < end < 0.219]
    assert ends
    for end in ends:
        assert holds(low + 0.002, end - step) != holds(low + 0.002, end + step)


def test_a_height_of_the_com_means_the_same_in_a_design() -> None:
    same, own = (
        pb.design("paper", maximize="com", controller=None, com_y_m=com_y, overrides=TOTE)
        for com_y in ((0.08, 0.08), None)
    )
    assert same.tolerance == pytest.approx(own.tolerance, abs=1e-12)
    assert same.shallow_deg == own.shallow_deg and same.steep_deg == own.steep_deg
    for one in (same, own):
        assert one.certificate is not None
        heights = {float(height) for _, height in one.certificate.box["com_m"]}
        assert heights == {0.08}


@pytest.mark.parametrize("quantity", ["com", "friction", "region"])
def test_designs_have_a_certificate_that_contains_their_tolerance(
    quantity: str, tmp_path: Path
) -> None:
    keys = {"object.edge_radius_m": [0.02, 0.008, 0, 0]}
    best = pb.design("paper", maximize=quantity, controller=None, overrides=keys)
    assert best.certificate is not None
    path = tmp_path / "certificate.json"
    best.certificate.save(path)
    assert pb.check(path, pb.load_scene("paper", keys | best.angle_keys)).valid
    box: dict[str, Any] = {**best.certificate.box}
    key, side = {"com": ("com_m", 0), "friction": ("friction", "left")}.get(
        quantity, ("contacts_m", "left")
    )
    values = [corner[0] for corner in box["com_m"]] if side == 0 else box[key][side]
    low, high = min(map(float, values)), max(map(float, values))
    middle = {"com": 0.125, "friction": 0.3}.get(quantity, 0.0)
    for end in (middle - low, high - middle):
        assert end == pytest.approx(best.tolerance, rel=2e-6)
