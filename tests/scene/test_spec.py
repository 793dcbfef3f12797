# SPDX-License-Identifier: Apache-2.0
"""From scene to core: the right numbers, and mirror symmetry to the last bit."""

import math

import pytest

import palmbots._core as _core
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec

PALM = ("length", "offset", "friction", "shallow", "steep", "rate")
ROBOT = ("speed", "correction", "acceleration", "max_speed", "noise", "noise_tau", "bias")


def bits(value) -> object:
    """Floats by their bits, so that 0.0 and -0.0 differ; structs and tuples item by item."""
    if isinstance(value, float):
        return value.hex()
    if isinstance(value, list | tuple):
        return tuple(bits(item) for item in value)
    for kind, names in ((_core.PalmSpec, PALM), (_core.RobotSpec, ROBOT)):
        if isinstance(value, kind):
            return tuple(bits(getattr(value, name)) for name in names)
    return value


def test_spec_of_the_paper_scene():
    spec = to_spec(load_scene("paper"))
    assert (spec.width, spec.com_left, spec.com_right, spec.com_height) == (
        0.25, 0.125, 0.125, 0.04
    )  # fmt: skip
    corners = [(0, 0.25, 0), (0.25, 0, 0), (0.25, 0, 0.16), (0, 0.25, 0.16)]
    assert spec.outline == [(*corner, 0) for corner in corners]
    assert spec.contact_right == 1
    for palm in spec.palms:
        assert bits(palm) == bits(
            (0.15, 0.0, 0.3, 5 * (math.pi / 180), 15 * (math.pi / 180), 50 * (math.pi / 180))
        )
    for robot in spec.robots:
        assert bits(robot) == bits((0.06, 0.03, 0.5, 0.2, 0.01, 0.5, 0.0))
    assert spec.zones == [(-1, -math.inf, -0.005), (0, -0.005, 0.005), (1, 0.005, math.inf)]
    assert (spec.false_rate, spec.period) == (0, 0.01)
    assert (spec.latency, spec.jitter, spec.loss) == (0.05, 0, 0)
    assert (spec.distance, spec.slope, spec.direction, spec.timeout_ticks) == (1.5, 0, 1, 5000)
    assert (spec.start, spec.bumps, spec.bump_rate, spec.bump_max) == ((0, 0), [], 0, 0.004)
    assert (spec.inertia, spec.inertia_lag) == (1, 0.05)


def test_keys_set_their_fields_of_the_spec():
    spec = to_spec(
        load_scene(
            "paper",
            {
                "palm.left.friction": 0.4,
                "palm.right.pivot_offset_m": 0.01,
                "robot.right.bias_m_s": -0.002,
                "tactile.zones": [
                    {"sign": "+", "from_m": 0.01, "to_m": 0.05},
                    {"sign": "0", "from_m": -0.01, "to_m": 0.02},
                    {"sign": "-", "from_m": -0.05, "to_m": -0.01},
                ],
                "bumps.script": [
                    {"robot": "right", "at_s": 2, "shift_m": 0.01},
                    {"robot": "left", "at_m": 0.5, "shift_m": -0.02},
                    {"robot": "left", "at_m": 0, "shift_m": 0},
                ],
                "start.right_m": 0.03,
                "task.inertia": False,
                "task.inertia_tau_s": 0,
                "task.timeout_s": 7.004,
            },
        )
    )
    assert [palm.friction for palm in spec.palms] == [0.4, 0.3]
    assert [palm.offset for palm in spec.palms] == [0, 0.01]
    assert [robot.bias for robot in spec.robots] == [0, -0.002]
    assert spec.zones == [(1, 0.01, 0.05), (0, -0.01, 0.02), (-1, -0.05, -0.01)]
    assert spec.bumps == [(1, True, 2, 0.01), (0, False, 0.5, -0.02), (0, False, 0, 0)]
    assert spec.start == (0, 0.03)
    assert (spec.inertia, spec.inertia_lag, spec.timeout_ticks) == (0, 0, 700)


def test_keys_of_radio_and_faults_set_their_fields_of_the_spec():
    """No two numbers are alike, and none is the default."""
    numbers = {
        "latency": 0.06, "jitter": 0.02, "loss": 0.03, "duplicate": 0.04, "corruption": 0.07,
        "burst_fraction": 0.08, "airtime_s": 0.002, "beacon_s": 0.09, "lease_s": 0.6,
        "burst_s": 0.3,
    }  # fmt: skip
    spec = to_spec(
        load_scene(
            "paper",
            {
                "radio": {
                    **{k + "_s" * (k in ("latency", "jitter")): v for k, v in numbers.items()},
                    "reorder": True,
                    "sessions": False,
                    "outages": [
                        {"sender": "station", "start_s": 1.5, "end_s": 2.5},
                        {"sender": "right", "start_s": 0.5, "end_s": 3.5},
                    ],
                    "script": [
                        {"sender": "right", "message": 4, "effect": "delayed", "delay_s": 0.11},
                        {"sender": "left", "message": 2, "effect": "lost"},
                        {"sender": "left", "message": 3, "effect": "duplicated", "delay_s": 0.12},
                        {
                            "sender": "station",
                            "receiver": "right",
                            "message": 5,
                            "effect": "lost",
                        },
                    ],
                },
                "faults": {
                    "random_reboots": 3,
                    "reboot_s": 0.7,
                    "script": [
                        {"kind": "station-down", "at_s": 1.1, "duration_s": 0.21},
                        {
                            "kind": "stuck",
                            "robot": "right",
                            "at_s": 1.2,
                            "duration_s": 0.22,
                            "stuck_at": "-",
                        },
                        {
                            "kind": "intermittent",
                            "robot": "left",
                            "at_s": 1.3,
                            "duration_s": 0.23,
                            "probability": 0.4,
                        },
                        {"kind": "freeze", "robot": "right", "at_s": 1.4, "duration_s": 0.24},
                        {"kind": "reboot", "robot": "left", "at_s": 1.6, "duration_s": 0.25},
                    ],
                },
                "control.watchdog_s": 0.2,
                "control.brake": False,
                "control.start": "touch",
                "robot.left.clock_ppm": 150,
            },
        )
    )
    for name, number in numbers.items():
        names = {"burst_s": "burst_mean", "burst_fraction": "burst_share"}
        field = names.get(name, name.removesuffix("_s"))
        assert getattr(spec, field) == number, name
    assert spec.reorders == 1
    assert not spec.sessions
    assert spec.outages == [(2, 1.5, 2.5), (1, 0.5, 3.5)]
    faults = [(1, 4, 1, 0.11), (0, 2, 0, 0.0), (0, 3, 2, 0.12), (3, 5, 0, 0.0)]
    assert spec.message_faults == faults
    assert spec.faults == [
        (4, 0, 1.1, 0.21, 0, 0.0, 0),
        (2, 1, 1.2, 0.22, -1, 0.0, 0),
        (3, 0, 1.3, 0.23, 0, 0.4, 0),
        (1, 1, 1.4, 0.24, 0, 0.0, 0),
        (0, 0, 1.6, 0.25, 0, 0.0, 0),
    ]
    assert (spec.random_reboots, spec.reboot, spec.watchdog) == (3, 0.7, 0.2)
    assert not spec.brake
    assert spec.start_by_touch
    assert [robot.clock_drift for robot in spec.robots] == [pytest.approx(150e-6), 0]


@pytest.mark.parametrize(("direction", "sign"), [("forward", 1), ("backward", -1)])
def test_uphill_slope_pulls_against_the_direction_of_travel(direction, sign):
    scene = load_scene("paper", {"task.slope_deg": 3, "task.direction": direction})
    spec = to_spec(scene)
    assert spec.direction == sign
    uphill = math.tan(math.radians(3))  # > 0: towards −x
    assert spec.slope == pytest.approx(sign * uphill, rel=1e-15)
