# SPDX-License-Identifier: Apache-2.0
"""A drop is unavoidable if, and only if, the wheels could not have stopped the contact in time."""

from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.simulation import Carry, is_unavoidable


def carried(overrides: dict[str, Any], controller: str = "resilient") -> Carry:
    return pb.carry("paper", controller, seed=0, overrides=overrides)


def column(carry: Carry, name: str) -> np.ndarray:
    assert carry.trace is not None
    return carry.trace[name].to_numpy()


def test_drop_that_wheels_could_have_prevented_is_avoidable() -> None:
    """By hand: a contact that is shifted off its palm within a tick leaves no time; one that drifts
    there for seconds does, even if the sensor flickers or reads 0 all the way."""
    bump = [{"robot": "left", "at_s": 3.0, "shift_m": 0.2}]
    assert is_unavoidable(carried({"bumps.script": bump}))
    hangs = carried({"radio.loss": 1.0, "robot.left.bias_m_s": 0.01}, "distributed")
    assert hangs.outcome == "dropped"
    assert not is_unavoidable(hangs)
    drifting = {"robot.left.bias_m_s": 0.02, "robot.noise_m_s": 0.0}
    for fault in (
        {"kind": "stuck", "stuck_at": "0"},
        {"kind": "intermittent", "probability": 0.3},
    ):
        script = [
            {**fault, "robot": side, "at_s": 0.0, "duration_s": 1000.0}
            for side in ("left", "right")
        ]
        dropped = carried(drifting | {"faults.script": script}, "none")
        assert dropped.outcome == "dropped"
        assert not is_unavoidable(dropped), fault
    with pytest.raises(PalmbotsError, match="not dropped"):
        is_unavoidable(carried({}))


@pytest.mark.parametrize(
    ("shift_m", "speed_m_s", "unavoidable"),
    [(0.06, 0.1, False), (0.067, 0.02, False), (0.07, 0.1, True)],
)
def test_drop_is_unavoidable_only_within_the_braking_distance(
    shift_m: float, speed_m_s: float, unavoidable: bool
) -> None:
    """The left robot drifts, a bump shifts its contact out of the zone: 2 × 0.5 m/s² stop it within
    v² / 2a, or they do not."""
    overrides = {
        "robot.noise_m_s": 0.0,
        "robot.acceleration_m_s2": 0.5,
        "robot.left.bias_m_s": speed_m_s,
        "palm.friction": 0.25,
        "palm.right.friction": 0.5,
        "bumps.script": [{"robot": "left", "at_s": 0.02, "shift_m": shift_m}],
    }
    carry = carried(overrides, "none")
    assert carry.outcome == "dropped"
    assert is_unavoidable(carry) == unavoidable
    contact, times = column(carry, "contact")[:, 0], column(carry, "time")
    outside = np.nonzero(contact > 0.005)[0][0]
    speed = (contact[-1] - contact[-2]) / (times[-1] - times[-2])
    braking_m = speed**2 / (2 * (0.5 + 0.5) / np.cos(np.radians(15)))
    assert (braking_m > 0.075 - contact[outside]) == unavoidable
