# SPDX-License-Identifier: Apache-2.0
"""What a load does to the robots, tried by carries in the MuJoCo world on a straight path."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from palmbots.errors import PalmbotsError
from palmbots.mujoco.carry_runner import traction_warnings
from palmbots.scene.scene import Scene
from palmbots.simulation.outcome_counts import OutcomeCounts, reason_counts
from palmbots.simulation.single import carry


@dataclass(frozen=True)
class LoadTrial:
    """How carries in the MuJoCo world ended, and what the wheels did."""

    counts: OutcomeCounts
    wheel_slip_m: float
    """The largest difference between how far a robot moved and how far its wheels rolled."""
    speed_m_s: float
    """The highest mean speed of a carry."""
    remarks: tuple[str, ...]
    """What is wrong with the carries, in words, those of the carry with most slip first; empty:
    nothing."""


def try_load(
    scene: Scene, controller: str, carries: int, report: Callable[[float], None]
) -> LoadTrial | None:
    """Carry with the seeds 0, 1, …; None: the MuJoCo world refuses the scene."""
    found = []
    for seed in range(carries):
        try:
            found.append(carry(scene, controller, world="mujoco", seed=seed, record=False))
        except PalmbotsError:
            return None
        report((seed + 1) / carries)
    outcomes = [one.outcome for one in found]
    slips = [one.wheel_slip_m.values() for one in found if one.wheel_slip_m is not None]
    pairs = sorted(zip(found, slips, strict=True), key=lambda pair: -max(map(abs, pair[1])))
    remarks = [text for one, slip in pairs for text in traction_warnings(scene, one, slip)]
    return LoadTrial(
        counts=OutcomeCounts(
            controller,
            carries,
            outcomes.count("dropped"),
            outcomes.count("stalled"),
            max((max(one.contact_peak_m.values()) for one in found if one.outcome == "delivered"),
                default=None),
            reason_counts(one.reason for one in found),
        ),
        wheel_slip_m=max(abs(end) for slip in slips for end in slip),
        speed_m_s=max(one.distance_m / one.time_s for one in found),
        remarks=tuple(remarks),
    )  # fmt: skip
