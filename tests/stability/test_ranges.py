# SPDX-License-Identifier: Apache-2.0
"""Bands, regions and ranges against brute force over contacts.

What happens at one state is asked of `palmbots.contact_modes_batch`, which test_contact_modes.py
checks against a linear program; nothing of the stability code takes part in it.
"""

import math
from collections.abc import Iterable
from itertools import product

import numpy as np
import pytest

import palmbots as pb
from palmbots import load_scene
from palmbots.stability.interval_sets import Interval
from palmbots.stability.linear_conditions import failing
from palmbots.stability.margins import friction_ranges
from palmbots.stability.problem import StabilityProblem, permitted, stability_problem
from sampled import amounts, sampled
from stability_oracle import (
    STEEP_CASES,
    contacts,
    happens,
    random_situation,
    uneven,
)


@pytest.mark.parametrize("seed", sampled(range(6), 3))
def test_permitted_com_against_brute_force(seed: int) -> None:
    """Just inside the interval every contact behaves; just outside one of them does not."""
    rng = np.random.default_rng(seed)
    tried = 0
    for _ in range(150):
        at = uneven(rng)
        for number, shallow in STEEP_CASES:
            low, high = permitted(at.envelope(), number, shallow, at.angles)
            angles = at.palms(shallow)
            grid = contacts(at, number, shallow)
            if low > high:
                for x in np.linspace(0.01, 0.99, 9) * at.width:
                    assert not happens(at, number, shallow, angles, grid, com_x=x).all()
                continue
            step = 1e-7
            if high - low < 4 * step:
                continue
            tried += 1
            for x in (low + step, high - step, 0.5 * (low + high)):
                assert happens(at, number, shallow, angles, grid, com_x=x).all(), (at, number)
            for x in (low - step, high + step):
                assert not happens(at, number, shallow, angles, grid, com_x=x).all(), (at, number)
    assert tried > 200


@pytest.mark.parametrize("common", [True, False])
def test_uncertain_friction_against_a_scan(common: bool) -> None:
    rng = np.random.default_rng(11)
    for _ in range(120):
        at = random_situation(rng)
        ends = np.sort(rng.uniform(0.02, 1.2, (2, 2)), axis=1)
        if common:
            ends[1] = ends[0]
        box = (tuple(ends[0]), tuple(ends[1]))
        for number, shallow in STEEP_CASES:
            low, high = permitted(
                at.envelope(friction=box, common=common), number, shallow, at.angles
            )
            scan = np.linspace(ends[0][0], ends[0][1], 400 if common else 21)
            pairs = [(m, m) for m in scan]
            if not common:
                pairs = list(product(scan, np.linspace(ends[1][0], ends[1][1], 21)))
            found = [
                permitted(at.envelope(friction=((a, a), (b, b))), number, shallow, at.angles)
                for a, b in pairs
            ]
            least = max(f[0] for f in found)
            most = min(f[1] for f in found)
            if least > most:
                # An angle at which nothing is permitted may lie between two of the scan.
                continue
            assert low <= high, (at, box)
            assert low == pytest.approx(least, abs=2e-5)
            assert high == pytest.approx(most, abs=2e-5)
            assert low >= least - 1e-12
            assert high <= most + 1e-12


def scan_holds(at: StabilityProblem, **changed: float) -> bool:
    for number, shallow in STEEP_CASES:
        grid = contacts(at, number, shallow, 2)
        if not happens(at, number, shallow, at.palms(shallow), grid, **changed).all():
            return False
    return True


def inside(pieces: Iterable[Interval | None], value: float) -> bool:
    return any(piece is not None and piece[0] <= value <= piece[1] for piece in pieces)


@pytest.mark.parametrize(
    ("setting", "friction_pieces"),
    [({}, 1), ({"palm.steep_deg": 25.0, "object.com_m": [0.125, 0.01]}, 1)],
)
def test_ranges_against_a_scan(setting: dict[str, object], friction_pieces: int) -> None:
    found = pb.analyze("paper", overrides=setting)
    at = found.problem
    assert len(found.friction) == friction_pieces
    near = 1e-6
    for mu in np.linspace(0.01, 1.8, 180):
        if any(abs(mu - end) < near for piece in found.friction for end in piece):
            continue
        holds = scan_holds(at, friction_left=mu, friction_right=mu)
        assert holds == inside(found.friction, mu), mu
    slopes = [
        (math.tan(math.radians(a)), math.tan(math.radians(b)))
        for a, b in [found.summary()["slope_deg"]]
    ]
    for s in np.linspace(-0.2, 0.2, 101):
        assert scan_holds(at, slope=s) == inside(slopes, s), s
    for y in np.linspace(-0.45, 0.3, 151):
        assert scan_holds(at, com_y=y) == inside(found.com_y_m, y), y
    for x in np.linspace(0.001, 0.249, 125):
        assert scan_holds(at, com_x=x) == inside([found.com_x_m], x), x
    for half in np.linspace(0.001, 0.2, 100):
        assert scan_holds(at.with_(contacts=((-half, half),) * 2)) == inside(
            [found.half_length_m], half
        ), half


@pytest.mark.parametrize("cases", amounts(100, 400))
def test_friction_can_be_several_intervals(cases: int) -> None:
    rng = np.random.default_rng(3)
    several = 0
    for _ in range(cases):
        at = random_situation(rng)
        pieces = friction_ranges(at)
        several += len(pieces) > 1
        for mu in rng.uniform(0.01, 1.5, 8):
            if any(abs(mu - end) < 1e-7 for piece in pieces for end in piece):
                continue
            holds = scan_holds(at, friction_left=mu, friction_right=mu)
            assert holds == inside(pieces, mu), (at, mu)
    assert several > 0


def test_margins_are_the_largest_errors() -> None:
    rng = np.random.default_rng(5)
    for scene in ("paper", "paper-offset"):
        found = pb.analyze(scene)
        at = found.problem
        for report in found.properties.values():
            number, shallow = report.number, report.shallow
            if number == 0:
                continue
            angles = at.palms(shallow)
            travel = report.margins.travel_m
            assert travel is not None
            for more, fits in ((travel - 1e-6, True), (travel + 1e-6, False)):
                grown = at.with_(
                    contacts=tuple((low - more, high + more) for low, high in at.contacts),
                    beyond=more,
                )
                if max(abs(z) for z in grown.rise(number, shallow, angles)) >= at.width:
                    continue
                grid = contacts(grown, number, shallow, 2)
                assert happens(grown, number, shallow, angles, grid).all() == fits
            grid = contacts(at, number, shallow, 2)
            for margin, kind in (
                (report.margins.friction, "mu"),
                (report.margins.angle_rad, "angle"),
            ):
                assert margin is not None
                worst = True
                for size, fits in ((margin * (1 - 1e-6), True), (margin * (1 + 1e-6), False)):
                    results = []
                    errors = [*product((-size, size), repeat=2), *rng.uniform(-size, size, (50, 2))]
                    for one, two in errors:
                        if kind == "mu":
                            mus = (max(at.friction[0] + one, 0), max(at.friction[1] + two, 0))
                            results.append(
                                happens(
                                    at,
                                    number,
                                    shallow,
                                    angles,
                                    grid,
                                    friction_left=mus[0],
                                    friction_right=mus[1],
                                ).all()
                            )
                        else:
                            turned = (angles[0] + one, angles[1] + two)
                            results.append(happens(at, number, shallow, turned, grid).all())
                    worst = all(results)
                    assert worst == fits, (number, shallow, kind)


def test_property_changes_at_k() -> None:
    rng = np.random.default_rng(9)
    crossed = 0
    for _ in range(100):
        at = random_situation(rng)
        for number, shallow in STEEP_CASES:
            angles = at.palms(shallow)
            if min(abs(math.sin(a)) for a in angles) < 0.02:
                continue
            bad = [
                f for form in at.forms(number, shallow, angles) if (f := failing(form, at.width))
            ]
            for z in rng.uniform(-0.9, 0.9, 6) * at.width:
                if any(abs(z - k) < 1e-9 for ends in bad for k in ends):
                    continue
                base = at.offset[1] * math.cos(angles[1]) - at.offset[0] * math.cos(angles[0])
                p = (np.array(0.0), np.array((z - base) / math.sin(angles[1])))
                assert happens(at, number, shallow, angles, p) == (
                    not any(low < z < high for low, high in bad)
                ), (at, z)
                crossed += 1
    assert crossed > 500


def test_mirror_and_scale_laws() -> None:
    scene = load_scene({"object": {"com_m": [0.121, 0.05]}, "palm": {"left": {"friction": 0.31}}})
    one, other = pb.analyze(scene), pb.analyze(scene.mirrored())
    width = one.problem.width
    for report in one.properties.values():
        number, shallow = report.number, report.shallow
        image = other.properties[number, "right" if shallow == "left" else "left"]
        assert image.holds == report.holds
        assert image.margins.com_m == pytest.approx(report.margins.com_m, rel=1e-9)
        assert image.margins.travel_m == pytest.approx(report.margins.travel_m, rel=1e-9)
        assert image.margins.friction == pytest.approx(report.margins.friction, rel=1e-7)
        assert image.binding_p_m == pytest.approx(report.binding_p_m[::-1])
    assert one.com_x_m is not None
    assert other.com_x_m == pytest.approx([width - x for x in one.com_x_m[::-1]])
    factor = 2.5
    table = scene.model_dump()
    table["object"]["vertices_m"] = [[factor * x for x in v] for v in table["object"]["vertices_m"]]
    table["object"]["com_m"] = [factor * x for x in table["object"]["com_m"]]
    table["palm"]["length_m"] *= factor
    large = pb.analyze(table)
    assert large.com_x_m == pytest.approx([factor * x for x in one.com_x_m])
    assert np.array(large.friction) == pytest.approx(np.array(one.friction))
    assert large.slope == pytest.approx(one.slope)
    assert large.clearance.rotation_margin.margin == pytest.approx(
        one.clearance.rotation_margin.margin
    )
    for report in one.properties.values():
        assert large.properties[report.number, report.shallow].margins.angle_rad == pytest.approx(
            report.margins.angle_rad, rel=1e-6
        )


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_slope_and_acceleration_are_those_of_scenes_on_slopes(direction: str) -> None:
    """Uphill in travel is positive, whichever way the robots go."""
    base = {"object.com_m": [0.118, 0.04], "task.direction": direction}
    found = pb.analyze("paper", overrides=base)
    assert found.slope is not None
    ends = [math.degrees(math.atan(s)) for s in found.slope]
    assert abs(ends[0] + ends[1]) > 0.1  # not symmetric, or a sign could hide
    for end, sign in zip(ends, (-1, 1), strict=True):
        for more, holds in ((-1e-6, True), (1e-6, False)):
            scene = load_scene("paper", base | {"task.slope_deg": end + sign * more})
            assert scan_holds(stability_problem(scene)) == holds
    limit = found.max_acceleration_m_s2
    assert limit == pytest.approx(9.80665 * min(-found.slope[0], found.slope[1]))


def test_lateral_support_of_different_palms() -> None:
    scene = load_scene("paper", {"palm.right.width_m": 0.03, "object.com_m": [0.1, 0.05]})
    found = pb.analyze(scene).sideways
    assert {tuple(c) for c in found.support_m} == {
        (0.0, -0.035), (0.25, -0.015), (0.25, 0.015), (0.0, 0.035)
    }  # fmt: skip
    along = np.linspace(0, 0.25, 20001)
    side = 0.035 + (0.015 - 0.035) * along / 0.25
    nearest = np.hypot(along - 0.1, side).min()
    assert found.margin_m == pytest.approx(nearest, rel=1e-6)
    assert math.tan(found.tilt_rad) == pytest.approx(nearest / 0.05, rel=1e-6)
    assert found.acceleration_g == pytest.approx(nearest / 0.05, rel=1e-6)


def test_wedging_starts_where_a_squeeze_becomes_unbounded() -> None:
    found = pb.analyze("paper", overrides={"palm.shallow_deg": 12.0, "palm.steep_deg": 30.0})
    at = found.problem
    for friction, wedged in (
        (found.wedging.friction - 1e-6, False),
        (found.wedging.friction + 1e-6, True),
    ):
        infinite = False
        ends = np.array([-0.075, 0.075])
        # The properties' own poses, and both palms steep, as most of the time.
        poses = [(at.palms(shallow), contacts(at, n, shallow, 2)) for n, shallow in STEEP_CASES]
        both_steep = (at.angles[0][1], at.angles[1][1])
        for angles, p in (*poses, (both_steep, (ends[:, None], ends[None, :]))):
            states = pb.contact_modes_batch(
                width=at.width, com_x=at.com[0], com_y=at.com[1], theta_left=angles[0],
                theta_right=angles[1], p_left=p[0], p_right=p[1], friction_left=friction,
                friction_right=friction,
            )  # fmt: skip
            infinite |= bool(np.isinf(states.squeeze[..., 1]).any())
        assert infinite == wedged


def test_turning_palm_needs_the_regions_of_both_properties() -> None:
    at = stability_problem(load_scene("paper", {"palm.shallow_deg": 7.0}))
    for pose in list(at.poses(0, "left"))[2:]:
        rises = [at.rise(number, "left", pose.angles) for number in (1, 2)]
        assert pose.rise == (min(r[0] for r in rises), max(r[1] for r in rises))
        assert rises[0] != rises[1]
