# SPDX-License-Identifier: Apache-2.0
"""Faults occur when, how and where the scene states, with every controller."""

from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import wilson
from palmbots.simulation.result import Carry

CALM: dict[str, Any] = {"robot.noise_m_s": 0.0}
PERIOD = 0.01


def broken(controller: str, *faults: dict[str, Any], **keys: Any) -> Carry:
    overrides = CALM | {"faults.script": list(faults)} | keys
    return pb.carry("paper", controller, overrides=overrides)


def column(carry: Carry, name: str) -> np.ndarray:
    assert carry.trace is not None
    return carry.trace[name].to_numpy()[:-1]


def during(carry: Carry, start: float, end: float) -> np.ndarray:
    """The ticks in [start, end)."""
    ticks = np.round(column(carry, "time") / PERIOD)
    return (ticks >= round(start / PERIOD)) & (ticks < round(end / PERIOD))


@pytest.mark.parametrize(("reads", "sign"), [("-", -1), ("0", 0), ("+", 1)])
def test_stuck_sensor_reads_one_sign(reads: str, sign: int) -> None:
    fault = {"kind": "stuck", "robot": "right", "at_s": 1.0, "duration_s": 0.5, "stuck_at": reads}
    start = {"start.right_m": 0.02, "start.left_m": 0.02}
    carry = broken("none", fault, **start)
    signs = column(carry, "sign")
    window = during(carry, 1.0, 1.5)
    assert set(signs[window][:, 1]) == {sign}
    assert set(signs[window][:, 0]) == {1}
    assert set(signs[~window].ravel()) == {1}


def test_intermittent_sensor_fails_with_the_given_probability() -> None:
    """A random reading is one of three, so two in three of them are wrong."""
    fault = {
        "kind": "intermittent",
        "robot": "left",
        "at_s": 0.0,
        "duration_s": 100.0,
        "probability": 0.3,
    }
    carry = broken("none", fault)
    signs = column(carry, "sign")
    wrong, n = int(np.count_nonzero(signs[:, 0])), len(signs)
    low, high = wilson(wrong, n, z=4)
    assert low < 0.2 < high
    assert np.count_nonzero(signs[:, 0] == 1) == pytest.approx(wrong / 2, abs=4 * wrong**0.5)
    assert not np.any(signs[:, 1])


@pytest.mark.parametrize("controller", ["centralized", "distributed", "resilient"])
def test_rebooting_robot_stands(controller: str) -> None:
    carry = broken(
        controller, {"kind": "reboot", "robot": "left", "at_s": 2.0, "duration_s": 0.25},
        **{"start.left_m": 0.0},
    )  # fmt: skip
    commanded = column(carry, "commanded")
    off = during(carry, 2.0, 2.25)
    np.testing.assert_array_equal(commanded[off][:, 0], 0)
    assert np.all(commanded[during(carry, 1.0, 2.0)] > 0.02)
    np.testing.assert_array_equal(column(carry, "palm")[off][:, 0], np.radians(15.0))
    # It travels on afterwards: at once, or when it has heard its partner.
    assert np.all(commanded[during(carry, 3.5, 4.0)][:, 0] > 0.02)


def test_frozen_robot_keeps_its_command_until_the_watchdog_stops_it() -> None:
    """With a negative contact, the left robot is moving closer when it freezes."""
    start = {"start.left_m": -0.03, "start.right_m": 0.0}
    fault = {"kind": "freeze", "robot": "left", "at_s": 0.5, "duration_s": 0.4}
    carry = broken("distributed", fault, **start)
    commanded = column(carry, "commanded")[:, 0]
    assert np.all(column(carry, "case")[during(carry, 0.4, 0.5)][:, 0] == "d")
    np.testing.assert_allclose(commanded[during(carry, 0.4, 0.6)], 0.06 + 0.03, rtol=1e-12)
    np.testing.assert_array_equal(commanded[during(carry, 0.6, 0.9)], 0)
    assert commanded[during(carry, 0.9, 0.91)][0] > 0  # it starts anew
    short = broken("distributed", fault | {"duration_s": 0.08}, **start)
    assert np.all(column(short, "commanded")[during(short, 0.4, 0.58)][:, 0] > 0.08)


def test_station_that_is_down_sends_nothing() -> None:
    fault = {"kind": "station-down", "at_s": 3.0, "duration_s": 2.0}
    plain, lost = broken("centralized"), broken("centralized", fault)
    table = {
        name: run.links["station_to_left"].sent - round(run.time_s / PERIOD)
        for name, run in (("plain", plain), ("lost", lost))
    }
    assert table["plain"] - table["lost"] == pytest.approx(200, abs=1)
    assert lost.links["left_to_station"].sent == len(column(lost, "time"))


def test_random_reboots_are_uniform_over_robots_and_time() -> None:
    """Each robot equally often; uniform over the 25 s of the carry, with mean 12.5 s and standard
    deviation 25/√12 s."""
    keys = CALM | {"faults.random_reboots": 1, "faults.reboot_s": 0.1}
    n, sides, starts = 200, [], []
    for seed in range(n):
        carry = pb.carry("paper", "distributed", seed=seed, overrides=keys)
        ticks, columns = np.nonzero(column(carry, "commanded") == 0)
        assert len(ticks) <= 10
        assert len(set(columns)) <= 1
        if len(ticks) > 0:
            sides.append(columns[0])
            starts.append(column(carry, "time")[ticks[0]])
    assert len(sides) > 0.97 * n
    assert np.mean(sides) == pytest.approx(0.5, abs=4 * 0.5 / np.sqrt(n))
    assert np.mean(starts) == pytest.approx(12.5, abs=4 * 7.2 / np.sqrt(n))
    assert np.std(starts) == pytest.approx(7.2, abs=1.2)


def test_slow_clock_sends_fewer_beacons() -> None:
    plain = broken("resilient")
    slow = broken("resilient", **{"robot.left.clock_ppm": -50_000.0})
    per_s = {
        name: run.links[f"{side}_to_{other}"].sent / run.time_s
        for name, run, side, other in (
            ("plain", plain, "left", "right"),
            ("slow", slow, "left", "right"),
            ("partner", slow, "right", "left"),
        )
    }
    assert per_s["slow"] / per_s["plain"] == pytest.approx(0.95, abs=0.01)
    assert per_s["partner"] / per_s["plain"] == pytest.approx(1.0, abs=0.01)
