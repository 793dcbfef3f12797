# SPDX-License-Identifier: Apache-2.0
"""Warnings that a change of a scene brings, and what is wrong with some friction or contacts."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

from palmbots._types import SIDES, Interval
from palmbots.assessment.friction import with_friction
from palmbots.control.dead_band import warnings_before
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene
from palmbots.simulation.outcome_counts import OutcomeCounts
from palmbots.stability.analysis import Analysis, analyze
from palmbots.stability.scene_limits import self_check

_NUMBER = re.compile(r"[-−]?\d[\d.]*")


def known_warnings(scene: Scene, controller: str, friction: Interval | None) -> dict[str, str]:
    """All that is known to be wrong with a scene and a controller before a carry.

    Args:
        scene: with a straight path.
        controller: of the carries.
        friction: also with the friction at the ends of this interval; None: as in the scene.

    Returns:
        The warnings, by their texts without numbers: two values of one quantity are one warning.
    """
    found = list(warnings_before(scene, controller))
    for one in scenes_within(scene, friction):
        found += self_check(one)
    return {_NUMBER.sub("#", text): text for text in found}


def new_warnings(
    known: dict[str, str], scene: Scene, controller: str, friction: Interval | None
) -> tuple[str, ...]:
    """The warnings of a changed scene that are not among those that were known."""
    found = known_warnings(scene, controller, friction)
    return tuple(text for kind, text in found.items() if kind not in known)


def scenes_within(scene: Scene, friction: Interval | None) -> Sequence[Scene]:
    """The scene, and with an interval of friction also the scene at both ends."""
    return [scene, *(with_friction(scene, end) for end in friction or ())]


def least_sound(scene: Scene, friction: Interval | None) -> Analysis:
    """The analysis with the friction of an interval, or of the scene, at which most is wrong: a
    property fails, there is a warning, or the tightest margin is least."""
    return min((analyze(one) for one in scenes_within(scene, friction)), key=_soundness)


def _soundness(analysis: Analysis) -> tuple[bool, bool, float]:
    """What is worse comes first: a property that fails, a warning, a tight margin."""
    times = [one.times for one in analysis.ranking if one.times is not None]
    return analysis.holds, not analysis.warnings, min(times, default=math.inf)


def near_pivots(scene: Scene, best: OutcomeCounts | None) -> Analysis | None:
    """The analysis for contacts no farther out than in carries with the best controller; None:
    none is delivered, or it does not apply."""
    if best is None or best.farthest_m is None:
        return None
    reach = min(best.farthest_m, *(scene.palm_of(side).reach_m for side in SIDES))
    try:
        return analyze(scene, region_m=(-reach, reach))
    except PalmbotsError:
        return None
