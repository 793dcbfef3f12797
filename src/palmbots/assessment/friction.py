# SPDX-License-Identifier: Apache-2.0
"""A friction that is known only roughly: a proof for the interval, and carries at its ends."""

from __future__ import annotations

import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES, Interval
from palmbots._util.arguments import ordered_pair, show
from palmbots.errors import PalmbotsError
from palmbots.scene.core_keys import ROWS
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes
from palmbots.stability.analysis import Analysis, analyze
from palmbots.stability.certificates.prover import Verdict, certify

LEAST, MOST = (ROWS["palm.friction"][end] for end in ("least", "most"))


@dataclass(frozen=True)
class FrictionTrial:
    """What holds if the friction is anywhere in an interval."""

    friction: Interval
    alike: Verdict
    """Whether all properties hold if both palms have the same friction: proved by `certify`, or
    refuted by `analyze`."""
    unlike: Verdict
    """Whether they hold if each palm has a friction of its own, as `certify` proves."""
    failing: tuple[float, float, int] | None
    """Friction of the left and of the right palm, at opposite ends of the interval, and a property
    that fails there; None: none does."""
    counts: tuple[OutcomeCounts, ...]
    """With the friction of both palms at the lower and at the upper end; empty: no controller
    delivers the scene."""


def interval_of_friction(scene: Scene, friction: Interval) -> Interval:
    """The interval, if the palms of the scene allow all of it.

    Raises:
        PalmbotsError: it is not an interval of friction, or an object with so much friction would
            wedge.
    """
    low, high = ordered_pair("friction", friction, LEAST, MOST, differ=True)
    palms = [scene.palm_of(side) for side in SIDES]
    steepest = max(abs(deg) for palm in palms for deg in (palm.shallow_deg, palm.steep_deg))
    most = _core.friction_limit(steepest)
    if high < most:
        return low, high
    raise PalmbotsError(
        f"friction: value is {show([low, high])}; allowed: two coefficients below {most:.4g} "
        f"(friction angle + palm angle below 90 degrees){_other_units(low, high)}"
    )


def _other_units(low: float, high: float) -> str:
    """The coefficients that may be meant by values in percent or degrees; empty: neither."""
    if low <= 1 or high >= 90:
        return ""
    tangents = " ".join(f"{math.tan(math.radians(angle)):.3g}" for angle in (low, high))
    percent = " ".join(f"{value / 100:.3g}" for value in (low, high))
    return f"; if these are in percent, write {percent}; if in degrees, {tangents}"


def try_friction(
    analysis: Analysis, friction: Interval, controller: str | None, carries: int
) -> FrictionTrial:
    """Prove the properties for an interval of friction, and carry at its ends.

    Args:
        analysis: of the scene.
        friction: from `interval_of_friction`.
        controller: which carries; None: none does.
        carries: how many, at each end.

    Raises:
        PalmbotsError: a scene refuses an end of the interval.
    """
    scene, (low, high) = analysis.scene, friction
    ends = [with_friction(scene, end) for end in (low, high)]
    proof = certify(scene, friction=(low, high))
    alike = proof.with_common_friction or proof.verdict  # what holds for all
    if alike == "undecided" and not any(a <= low and high <= b for a, b in analysis.friction):
        alike = "fails"
    counts = tuple(
        count_outcomes(end, controller, seeds=carries) for end in ends if controller is not None
    )
    return FrictionTrial((low, high), alike, proof.verdict, _failing(scene, friction), counts)


def _failing(scene: Scene, friction: Interval) -> tuple[float, float, int] | None:
    for left, right in (friction, friction[::-1]):
        own = {"palm.left.friction": left, "palm.right.friction": right}
        for report in analyze(load_scene(scene, own)).properties.values():
            if not report.holds:
                return left, right, report.number
    return None


def hardest_to_hold(scene: Scene, friction: Interval) -> Scene:
    """The scene with the highest friction of the interval. There the heaviest object that
    `load_limits` finds is lightest.

    With more friction, more squeezes are possible in every state, and the object is held in more
    states. Each limit is linear in the squeeze and must hold for all squeezes, with one exception:
    that the wheels have load is required only at the least squeeze. Wheels that do not slip have
    load, so the limit of traction implies this. No contact wedges: scenes with so much friction
    are refused.
    """
    return with_friction(scene, friction[1])


def friction_keys(scene: Scene, friction: float) -> dict[str, float]:
    """The keys that give both palms this friction, whatever else the scene says of them."""
    return on_every_side(scene, {"palm.friction": friction})


def with_friction(scene: Scene, friction: float) -> Scene:
    """The scene with this friction of both palms."""
    return load_scene(scene, friction_keys(scene, friction))
