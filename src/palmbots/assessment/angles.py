# SPDX-License-Identifier: Apache-2.0
"""Other palm angles for a scene, tried by carries of this scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from palmbots._types import Interval
from palmbots.assessment.raised_noise import FRESH, count_failures, differ, noisy
from palmbots.assessment.side_effects import known_warnings, new_warnings
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curve_trial import Keys
from palmbots.scene.scene import Scene
from palmbots.simulation.outcome_counts import default_carries
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.stability.analysis import analyze
from palmbots.stability.angle_certificate import scene_at

SHALLOW_DEG = (2.0, 4.0, 6.0, 8.0, 10.0)
BETWEEN_DEG = (5.0, 8.0, 10.0, 12.0, 15.0)
"""Tried as the shallow angle, and as the angle by which the steep palm is steeper."""
PAIRS = tuple((shallow, shallow + more) for shallow in SHALLOW_DEG for more in BETWEEN_DEG)


@dataclass(frozen=True)
class NoPair:
    """Why no carries with other pairs of angles were tried."""

    why: str


@dataclass(frozen=True)
class AngleTrial:
    """How often the scene fails at its own palm angles, and at the best of the others."""

    controller: str
    tried: int
    """Pairs of angles at which all properties hold, and which bring no warning."""
    least_failure_rate: float
    """The lowest among these pairs, on the seeds that chose the best pair."""
    most_failure_rate: float
    carries: int
    """Of the scene's own pair and of the best pair, each on fresh seeds."""
    own_failures: int
    best_deg: Interval
    """(shallow, steep)."""
    best_failures: int
    own_clearance_deg: float
    best_clearance_deg: float
    """How far a palm may turn until the outline touches it."""
    noise_factor: float = 1.0
    """Factor by which the noise of the wheels was raised in all these carries; 1: as in the
    scene."""

    @property
    def keys(self) -> Keys:
        """The scene keys of the best pair, if it is better; empty: it is not."""
        names = ("palm.shallow_deg", "palm.steep_deg")
        return dict(zip(names, self.best_deg, strict=True)) if self.is_better else {}

    @property
    def is_better(self) -> bool:
        """Whether the interval of the best pair lies below that of the scene's own angles."""
        fewer = self.best_failures < self.own_failures
        return fewer and differ(self.carries, self.own_failures, self.best_failures)


def try_angles(
    scene: Scene,
    controller: str,
    report: Callable[[float], None] = lambda fraction: None,
    *,
    noise: float = 1.0,
    friction: Interval | None = None,
) -> AngleTrial | NoPair:
    """Carry with other pairs of angles, the same on both palms.

    Args:
        scene: with a straight path.
        controller: of all carries.
        report: called with the completed fraction.
        noise: factor of the noise in all carries, as of `revealing_noise`.
        friction: an interval, within which no pair may bring a warning; None: as in the scene.
    """
    own = prepare(scene, controller)
    count = default_carries(own)
    if count is None:
        return NoPair("carries take too long, so no other pair of angles was tried")
    known = known_warnings(scene, controller, friction)
    clearances: dict[Interval, float] = {}
    found: dict[Interval, Prepared] = {}
    for pair in PAIRS:
        try:
            candidate = scene_at(scene, pair)
            analysis = analyze(candidate)
            if analysis.holds and not new_warnings(known, candidate, controller, friction):
                found[pair] = noisy(candidate, controller, noise)
                clearances[pair] = analysis.clearance_deg
        except PalmbotsError:
            continue
    report(0.05)
    if not found:
        return NoPair(
            f"each of {len(PAIRS)} pairs of angles is refused, violates a property or brings "
            "a warning, so no carry was tried with them"
        )
    failures = {}
    for k, (pair, prepared) in enumerate(found.items()):
        failures[pair] = count_failures(prepared, 0, count)
        report(0.05 + 0.9 * (k + 1) / (len(found) + 1))
    best = min(failures, key=lambda pair: (failures[pair], -clearances[pair]))
    return AngleTrial(
        controller=controller,
        tried=len(found),
        least_failure_rate=min(failures.values()) / count,
        most_failure_rate=max(failures.values()) / count,
        carries=count,
        own_failures=count_failures(noisy(scene, controller, noise), FRESH, count),
        best_deg=best,
        best_failures=count_failures(found[best], FRESH, count),
        own_clearance_deg=analyze(scene).clearance_deg,
        best_clearance_deg=clearances[best],
        noise_factor=noise,
    )
