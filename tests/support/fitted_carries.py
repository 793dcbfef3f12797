# SPDX-License-Identifier: Apache-2.0
"""Robots and radio fitted to simulated carries with hidden values."""

from typing import Any

import palmbots as pb
from palmbots.fitting.fitted_values import Estimate, Source
from palmbots.fitting.motion_fit import fit_recorded
from palmbots.fitting.radio_fit import fit_packets
from palmbots.fitting.recorded_logs import _packets, packets_in, stretches_in

HIDDEN = {
    "robot.gain": 1.03, "robot.noise_m_s": 0.02, "robot.noise_tau_s": 0.3,
    "robot.white_noise_m_per_sqrt_s": 0.001,
}  # fmt: skip


def carries_fitted(
    controller: str, number: int, carries: int, keys: dict[str, Any] | None = None
) -> dict[str, Estimate]:
    """By key, fitted to carries with the hidden values and with other keys; without their logs."""
    source = Source("", "")
    stretches, packets = [], []
    for run in range(carries):
        hidden = HIDDEN | (keys or {})
        carry = pb.carry("paper", controller, seed=100 * number + run, overrides=hidden)
        stretches += stretches_in(carry, run)
        period_s = carry.scene.control.period_s
        packets += [one for sent in packets_in(carry) if (one := _packets(source, sent, period_s))]
    found = [*fit_recorded(stretches, (source,), carries, steps=()).estimates]
    if packets:
        found += fit_packets(packets).estimates
    return {one.key: one for one in found}


def contains(one: Estimate, value: float) -> bool:
    """Whether a value is identified and lies in the interval."""
    if not one.is_identified or one.low is None or one.high is None:
        return False
    return one.low <= value <= one.high
