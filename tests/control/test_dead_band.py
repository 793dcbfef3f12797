# SPDX-License-Identifier: Apache-2.0
"""The dead-band law: a zero zone narrower than the overrun of a contact causes endless corrections.

The scenes here have no noise, only a contact that starts off its zone.
"""

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.control.dead_band import overrun_m, warnings_before, zero_zone_m
from palmbots.errors import SceneError
from palmbots.scene.placement import placements
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from sampled import in_soak

STARTS = [(0.02, 0.0), (-0.02, 0.0), (0.02, 0.02), (-0.02, -0.02), (0.02, -0.02), (-0.02, 0.02)]


def quiet(zone_m: float, start: tuple[float, float] = (0, 0), latency_s: float = 0.05) -> Scene:
    """A noise-free scene with a zero zone of this width."""
    return load_scene(
        "paper",
        {
            "robot.noise_m_s": 0.0,
            "tactile.zero_half_width_m": zone_m / 2,
            "start.left_m": start[0],
            "start.right_m": start[1],
            "radio.latency_s": latency_s,
        },
    )


def late(carry: pb.simulation.Carry) -> int:
    """Corrections in the second half of the carry."""
    return sum(c.start_s > carry.time_s / 2 for c in carry.corrections)


def cycles(carry: pb.simulation.Carry) -> bool:
    return any("limit cycle" in warning for warning in carry.warnings)


def warned_before(carry: pb.simulation.Carry) -> bool:
    return any("zero zone" in warning for warning in carry.warnings)


def test_overrun_is_that_of_the_simulated_wheels() -> None:
    """One period until the sign is seen, then braking with 0.5 m/s² from 3 cm/s, one step per
    period."""
    speeds = [0.03, 0.025, 0.02, 0.015, 0.01, 0.005]
    along_palm = 1 / math.cos(math.radians(15))
    expected = 0.01 * sum(speeds) * along_palm
    assert overrun_m(quiet(0.01), "distributed") == pytest.approx(expected, rel=1e-12)
    # Both robots at half the speed; up and down the radio takes 5 periods each, and one to see it.
    way = 2 * (0.015 * 11 * 0.01 + 0.01 * (0.01 + 0.005))
    assert overrun_m(quiet(0.01), "centralized") == pytest.approx(way * along_palm, rel=1e-12)
    assert overrun_m(quiet(0.01), "none") == 0


KEYS: list[dict[str, float]] = [
    {},
    {"robot.acceleration_m_s2": 0.1},
    {"robot.correction_m_s": 0.06},
    {"control.period_s": 0.02},  # messages wait for the next tick
]


@pytest.mark.parametrize("keys", KEYS, ids=repr)
@pytest.mark.parametrize("latency_s", [0.05, in_soak(0.0), in_soak(0.15)])
@pytest.mark.parametrize(
    ("controller", "tightness"), [("distributed", 0.65), ("centralized", 0.65), ("shared-sign", 0)]
)
def test_no_contact_of_a_trace_overruns_the_edge_farther(
    controller: str, tightness: float, latency_s: float, keys: dict[str, float]
) -> None:
    """Each contact in turn begins outside of a zone that is wide enough, at five phases of the
    control period, and is followed from the edge until it no longer goes inward."""
    base = pb.load_scene(quiet(0.01, latency_s=latency_s), keys | {"task.distance_m": 0.25})
    bound = overrun_m(base, controller)
    half = 1.1 * bound
    farthest = 0.0
    for k, start in product(range(5), ((1, 0), (-1, 0), (0, 1), (0, -1))):
        off = half + 0.002 + base.robot.correction_m_s * base.control.period_s * k / 5
        names = ("start.left_m", "start.right_m")
        begin = {name: off * sense for name, sense in zip(names, start, strict=True)}
        trace = pb.carry(base, controller, overrides=begin | {
            "tactile.zero_half_width_m": half,
        }).trace  # fmt: skip
        assert trace is not None
        for p in trace["contact"].values.T:
            farthest = max(farthest, *(half - x for x in turns_within(p, half)), 0.0)
    assert tightness * bound <= farthest <= bound * (1 + 1e-3)


def turns_within(p: "np.ndarray[Any, Any]", half: float) -> Iterator[float]:
    """How far out a contact that has entered the zone still is when it stops going inward."""
    inside = abs(p) <= half
    for k in np.flatnonzero(~inside[:-1] & inside[1:]):
        way = math.copysign(1.0, p[k]) * p[k + 1 :]
        stays = np.flatnonzero(way[:-1] - way[1:] <= 1e-7)
        yield float(way[stays[0] if len(stays) else -1])


def test_latency_matters_only_with_a_station() -> None:
    slow, fast = quiet(0.01, latency_s=0.3), quiet(0.01, latency_s=0.01)
    assert overrun_m(slow, "distributed") == overrun_m(fast, "distributed")
    assert overrun_m(slow, "centralized") > 5 * overrun_m(fast, "centralized")


def test_zero_zone_from_the_tactile_zones() -> None:
    assert zero_zone_m(Scene()) == 0.01
    minus = {"sign": "-", "from_m": -0.075, "to_m": -0.004}
    zero = {"sign": "0", "from_m": -0.002, "to_m": 0.006}
    plus = {"sign": "+", "from_m": 0.003, "to_m": 0.075}

    def width(*zones: dict[str, Any]) -> float:
        return zero_zone_m(load_scene("paper", {"tactile.zones": list(zones)}))

    assert width(minus, zero, plus) == pytest.approx(0.010)  # zero wins over plus
    assert width(plus, minus) == pytest.approx(0.007)  # no switch between them
    assert width(minus, zero) == math.inf
    assert width() == math.inf


def test_paper_scene_gives_no_warning() -> None:
    for controller in ("none", "centralized", "distributed"):
        assert warnings_before(Scene(), controller) == ()
        assert pb.carry("paper", controller, record=False).warnings == ()


def test_sensor_without_reading_at_a_palm_end_gives_a_warning() -> None:
    """A half-width given in mm; a zone up to exactly the palm's end; switches on one side only."""

    def warned_of(keys: dict[str, Any], controller: str = "distributed") -> list[str]:
        scene = pb.load_scene("paper", keys)
        return [line.split(":")[0] for line in warnings_before(scene, controller)]

    both = [f"the sensor of the {side} palm never reads - or +" for side in ("left", "right")]
    assert warned_of({"tactile.zero_half_width_m": 5}) == both
    assert warned_of({"tactile.zero_half_width_m": 0.075}) == both
    assert warned_of({"tactile.zero_half_width_m": 0.0749}) == []
    assert warned_of({"tactile.zero_half_width_m": 5}, "none") == []
    assert warned_of({"tactile.zero_half_width_m": 0.06, "palm.left.length_m": 0.1}) == both[:1]
    only: dict[str, Any] = {"tactile.zones": [{"sign": "+", "from_m": 0.01, "to_m": 0.08}]}
    minus = [f"the sensor of the {side} palm never reads -" for side in ("left", "right")]
    assert warned_of(only) == minus


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize(
    ("controller", "latency_s", "share"),
    [
        # Distributed: strokes of unequal length sooner or later end in any zone of some width.
        ("distributed", 0.05, 0.0),
        ("distributed", 0.3, 0.0),
        ("centralized", 0.0, 0.1),
        ("centralized", 0.05, 0.1),
        ("centralized", 0.1, 0.3),
    ],
)
def test_corrections_with_a_narrow_zone_never_end(
    controller: str, latency_s: float, share: float, start: tuple[float, float]
) -> None:
    zone = share * overrun_m(quiet(0), controller)
    carry = pb.carry(quiet(zone, start, latency_s), controller, record=False)
    assert carry.outcome == "delivered"
    assert late(carry) >= 5
    assert warned_before(carry)
    assert cycles(carry)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("latency_s", [0.0, 0.05, 0.1, 0.3])
@pytest.mark.parametrize("controller", ["distributed", "centralized"])
def test_corrections_with_a_wide_zone_end(
    controller: str, latency_s: float, start: tuple[float, float]
) -> None:
    zone = 1.2 * overrun_m(quiet(0, latency_s=latency_s), controller)
    carry = pb.carry(quiet(zone, start, latency_s), controller, record=False)
    assert carry.outcome == "delivered"
    assert 1 <= len(carry.corrections) <= 4
    assert late(carry) == 0
    assert carry.warnings == ()


def test_latency_makes_the_centralized_algorithm_cycle() -> None:
    """With a zone of 5 mm both algorithms settle at 50 ms; at 150 ms only the distributed one
    does."""
    for latency_s, controller, content in [
        (0.05, "distributed", True),
        (0.15, "distributed", True),
        (0.05, "centralized", True),
        (0.15, "centralized", False),
    ]:
        carry = pb.carry(quiet(0.005, (0.02, 0.0), latency_s), controller, record=False)
        assert (late(carry) == 0) is content
        assert cycles(carry) is not content
        assert warned_before(carry) is not content


def test_noise_is_not_mistaken_for_a_cycle() -> None:
    for controller in ("centralized", "distributed"):
        for seed in range(100):
            assert not cycles(pb.carry("paper", controller, seed=seed, record=False))


def test_palms_that_overlap_cannot_carry() -> None:
    """Under an object of 50 mm, palms of 150 mm overlap in every world."""
    narrow = {
        "object.vertices_m": [[0, 0], [0.05, 0], [0.05, 0.1], [0, 0.1]],
        "object.com_m": [0.025, 0.04],
    }
    # 150 mm cos 15 degrees less 50 mm
    words = r"overlap by 94\.9 mm at the start; allowed: palms that are 0\.099 m shorter"
    for world in ("quasistatic", "mujoco"):
        with pytest.raises(SceneError, match=words):
            pb.carry(controller="none", world=world, overrides=narrow)
    allowed = narrow | {"palm.length_m": 0.15 - 0.099, "task.distance_m": 0.01}
    assert pb.carry(controller="none", overrides=allowed).outcome == "delivered"
    # Where the inner ends are, from the trace itself: at p = 14 mm each palm reaches 14 mm further.
    for length, start in ((0.05, 0.0), (0.05, -0.02), (0.03, 0.014), (0.045, 0.0)):
        keys = {"palm.length_m": length, "start.left_m": start, "robot.noise_m_s": 0}
        scene = load_scene("paper", narrow | keys | {"task.distance_m": 0.01})
        trace = pb.carry(scene, "none").trace
        assert trace is not None
        placed = placements(to_spec(scene), trace, slice(0, 1))
        past = placed.palm_inner[0, 0, 0] - placed.palm_inner[0, 1, 0]
        assert _core.palm_overlap(to_spec(scene)) == pytest.approx(past, abs=1e-12)
        assert past < 0


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("palm.steep_deg", 0.314, "palm.steep_deg is 0.314 degrees; if that is in rad, write 18"),
        ("palm.steep_deg", 1.0, None),
        ("palm.left.steep_deg", 0.314, "palm.left.steep_deg is 0.314 degrees; if that is in rad"),
        ("palm.friction_angle_deg", 0.3, "is 0.3 degrees; if that is in rad, write 17.2"),
        ("palm.friction_angle_deg", 15.0, None),
        ("palm.rate_deg_s", 0.9, "is 0.9 degrees/s; if that is in rad/s, write 51.6"),
        ("palm.rate_deg_s", 3.0, None),
        ("task.slope_deg", -0.035, "is -0.035 degrees; if that is in rad, write -2.01"),
        ("task.slope_deg", 0.2, None),
        ("task.slope_deg", 0.0, None),
        ("robot.noise_m_s", 1.0, "is 1 m/s; if that is in cm/s, write 0.01"),
        ("robot.noise_m_s", 0.2, None),
        ("mujoco.palm_torque_n_m", 600.0, "is 600 N m; if that is in mN m, write 0.6"),
        ("mujoco.palm_torque_n_m", 20.0, None),
        # the ends of what no one means
        ("palm.steep_deg", 0.04, None),
        ("palm.steep_deg", 0.05, "write 2.86"),
        ("palm.steep_deg", 0.99, "write 56.7"),
        ("palm.friction_angle_deg", 0.1, "write 5.73"),
        ("palm.friction_angle_deg", 1.49, "write 85.4"),
        ("palm.friction_angle_deg", 1.5, None),
        ("palm.rate_deg_s", 0.1, "write 5.73"),
        ("palm.rate_deg_s", 2.9, "write 166"),
        ("task.slope_deg", 0.009, None),
        ("task.slope_deg", 0.01, "write 0.573"),
        ("task.slope_deg", 0.19, "write 10.9"),
        ("robot.noise_m_s", 0.29, None),
        ("robot.noise_m_s", 0.3, "write 0.003"),
        ("mujoco.palm_torque_n_m", 49.0, None),
        ("mujoco.palm_torque_n_m", 50.0, "write 0.05"),
    ],
)
def test_a_value_that_cannot_be_meant_names_its_unit(
    key: str, value: float, says: str | None
) -> None:
    keys = {key: value, "palm.shallow_deg": 0.0}
    lines = [one for one in warnings_before(load_scene("paper", keys), "none") if "if that" in one]
    assert len(lines) == (says is not None)
    assert not lines or (says is not None and says in lines[0])
