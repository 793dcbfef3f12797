# SPDX-License-Identifier: Apache-2.0
"""What carries show of a change of one thing in a scene, and what it costs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from palmbots.assessment.raised_noise import differ
from palmbots.simulation.outcome_counts import OutcomeCounts

Keys = Mapping[str, float | str | list[float]]


@dataclass(frozen=True)
class NoChange:
    """Why no change was found."""

    why: str
    is_for_load: bool = False
    """Whether the object is too heavy."""


@dataclass(frozen=True)
class ChangeTrial:
    """The change after which a scene fails least often. The failures are counted on other seeds
    than those that chose it."""

    controller: str
    tried: int
    changes: Keys
    """The keys and their new values; more than one only where they belong together."""
    before: Keys
    """The values of the same keys in the scene."""
    noise_factor: float
    """Factor by which the noise of the wheels was raised, with and without the change; 1: as in the
    scene."""
    carries: int
    own_failures: int | None
    """Without the change; None: a carry cannot begin, because the object is too heavy."""
    failures: int
    own_holds: bool
    """Whether all properties hold without the change."""
    holds: bool
    """Whether they hold with it."""
    own_heaviest_kg: float
    heaviest_kg: float
    """The heaviest object that the robots hold at the start and as far out as the contacts get,
    before and after."""
    own_time_s: float | None
    time_s: float | None
    """Mean of the carries that deliver, at the scene's own noise, before and after."""
    own_messages: float | None
    messages: float | None
    own_farthest_m: float | None = None
    farthest_m: float | None = None
    """How far a contact came from its pivot in the carries that deliver, at the scene's own noise,
    before and after."""
    own_drift_m: float | None = None
    drift_m: float | None = None
    """Mean forecast drift on the curve that was tried, before and after; None: not forecast."""
    drift_permitted_m: float | None = None
    """Drift beyond which the object tips on that curve, with the change."""
    warnings: tuple[str, ...] = ()
    """Those that the change brings; only where a property fails without it."""
    deciding: tuple[str, ...] = ()
    """The keys of which another value makes carries fail measurably more or less often, violates a
    property, or brings a warning."""
    mujoco: OutcomeCounts | None = None
    """Carries with a change for the load in the MuJoCo world, where weight acts; None: not
    tried."""

    @property
    def tips_on_curve(self) -> bool:
        """Whether the object would tip on the curve only with the change."""
        if self.own_drift_m is None or self.drift_m is None or self.drift_permitted_m is None:
            return False
        return self.own_drift_m <= self.drift_permitted_m < self.drift_m

    @property
    def is_for_load(self) -> bool:
        """Whether the change makes the robots hold the object."""
        return all(key.startswith("mujoco.") for key in self.changes)

    @property
    def is_better(self) -> bool:
        """Whether the interval of its failures lies below that without the change, or the robots
        hold the object only with it."""
        if self.is_for_load or self.own_failures is None or self.holds > self.own_holds:
            return True
        fewer = self.failures < self.own_failures
        return fewer and differ(self.carries, self.own_failures, self.failures)
