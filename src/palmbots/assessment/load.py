# SPDX-License-Identifier: Apache-2.0
"""What a load does to the robots, tried by carries in the MuJoCo world on a straight path.

A carry there may fail for reasons that have nothing to do with the weight. In the quasistatic world
the mass does not affect a carry. Only if more carries fail than there, the same seeds carry a light
object of the same shape. If measurably fewer of these fail, the weight is taken as the reason.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from palmbots.errors import PalmbotsError
from palmbots.mechanics.load_limits import load_limits
from palmbots.mechanics.lone import on_one_palm
from palmbots.mujoco.carry_runner import traction_warnings
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.outcome_counts import OutcomeCounts, reason_counts
from palmbots.simulation.single import carry

LOAD_CARRIES = 5
"""Carries of each scene in the MuJoCo world."""
LIGHT = 0.25
"""The mass of the light object, as a share of what the robots hold anywhere on the palms."""


@dataclass(frozen=True)
class LoadTrial:
    """How carries in the MuJoCo world ended, and what the wheels did."""

    counts: OutcomeCounts
    wheel_slip_m: float
    """The largest difference between how far a robot moved and how far its wheels rolled."""
    speed_m_s: float
    """The highest mean speed of a carry."""
    remarks: tuple[str, ...]
    """Warnings about the wheels in carries that did not drop the object, from the carry with the
    most slip on; empty: none."""
    light: OutcomeCounts | None = None
    """How carries with an object of `light_kg` ended; None: they were refused, or not needed."""
    light_kg: float | None = None
    """None: carries do not fail measurably more often than in the quasistatic world."""

    @property
    def failed(self) -> int:
        """How many carries did not deliver."""
        return self.counts.dropped + self.counts.stalled

    @property
    def cause(self) -> Literal["none", "weight", "other", "unclear"]:
        """Why more carries fail than in the quasistatic world.

        ``none``: not measurably more do. ``weight``: a light object fails measurably less often.
        ``other``: it fails at least as often. ``unclear``: the carries do not decide it.
        """
        if self.light_kg is None:
            return "none"
        if self.light is None:
            return "unclear"
        if self.light.failure_rate >= self.counts.failure_rate:
            return "other"
        lighter = self.light.failure_interval[1] < self.counts.failure_interval[0]
        return "weight" if lighter else "unclear"


def try_load(
    scene: Scene, planar: OutcomeCounts, carries: int, report: Callable[[float], None]
) -> LoadTrial | None:
    """Carry with the seeds 0, 1, …

    Args:
        scene: with a straight path.
        planar: how carries of the scene end in the quasistatic world; its controller is used.
        carries: how many.
        report: called with the completed fraction.

    Returns:
        None: the MuJoCo world refuses the scene.
    """
    controller = planar.controller
    found = _trial(scene, controller, carries, lambda done: report(0.5 * done))
    if found is None or found.counts.failure_interval[0] <= planar.failure_interval[1]:
        return found
    heaviest = load_limits(scene).heaviest_kg
    mass = scene.object.mass_kg
    light_kg = float(f"{LIGHT * (mass if heaviest is None else min(mass, heaviest)):.2g}")
    light = load_scene(scene, {"object.mass_kg": light_kg})
    other = _trial(light, controller, carries, lambda done: report(0.5 + 0.5 * done))
    return replace(found, light=None if other is None else other.counts, light_kg=light_kg)


def _trial(
    scene: Scene, controller: str, carries: int, report: Callable[[float], None]
) -> LoadTrial | None:
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
    remarks = [
        text
        for one, slip in pairs
        # A fall shakes the robots; and one that picks up alone stalls at the wall, on purpose.
        if one.outcome != "dropped" and not on_one_palm(scene)
        for text in traction_warnings(scene, one, slip)
    ]
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
