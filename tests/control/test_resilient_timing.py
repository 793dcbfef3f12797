# SPDX-License-Identifier: Apache-2.0
"""The time bounds of the resilient algorithm: computed by hand, and refused where they fail."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.errors import SceneError
from palmbots.simulation.result import Carry

BOX = pb.load_scene("paper")


def carried(overrides: dict[str, Any], controller: str = "resilient") -> Carry:
    return pb.carry("paper", controller, seed=0, overrides=overrides)


def test_bounds_of_the_default_scene() -> None:
    """Computed by hand: D = 5, B = 5, W = 10, K = 6 ticks of 10 ms."""
    bounds = carried({}).bounds
    assert bounds is not None
    result = dataclasses.asdict(bounds)
    lease, alone, join = 0.22 + 6 * 0.05, 0.52 + 0.01 + 0.1, 0.05 + 0.01
    cos = np.cos(np.radians(15))
    # Reaction: a tick, two messages that each wait for a beacon, and a turn of the palm by 10°.
    off_zone = np.hypot(0.01, 0.01) * (
        0.01 + 2 * (0.05 + 0.05) + 10 / BOX.palm_of("left").rate_deg_s
    )
    off_zone /= cos
    longest = (0.07 - off_zone) / (0.06 + 0.01) * cos  # in seconds of travel alone
    by_hand = {
        "beacon_s": 0.05,
        "delay_s": 0.05,
        "shortest_lease_s": 2 * (0.05 + 0.05) + 0.02,
        "lease_s": lease,
        "longest_lease_s": np.floor(100 * (longest - 0.11 - join)) / 100,
        "losses": 6,
        "hold_s": lease + 0.01 + 0.1 + 0.06,
        "alone_s": alone,
        "skew_m": 0.06 * (alone + join) / cos,
        "noise_m": off_zone + 0.01 * (alone + join) / cos,
        "room_m": 0.075 - 0.005,
        "is_noisy": False,
    }
    assert result == pytest.approx(by_hand, abs=1e-9)


def test_unsafe_lease_is_reported() -> None:
    """At this latency even the shortest lease leaves no room for the noise: a warning, not a
    refusal. A longer one is refused."""
    slow_radio = {"radio.latency_s": 0.2, "task.distance_m": 0.3}
    carry = carried(slow_radio)
    assert carry.bounds is not None
    assert carry.bounds.is_noisy
    assert carry.bounds.lease_s == carry.bounds.shortest_lease_s
    assert [w for w in carry.warnings if "a fault may drop the object" in w]
    with pytest.raises(SceneError, match="too long"):
        carried(slow_radio | {"radio.lease_s": carry.bounds.shortest_lease_s + 0.01})
    assert not carried({"task.distance_m": 0.3}).warnings
