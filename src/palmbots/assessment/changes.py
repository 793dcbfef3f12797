# SPDX-License-Identifier: Apache-2.0
"""Changes of one thing in a scene, each tried by carries, and which of them helps most.

If the scene fails often, a change is judged by how often the changed scene fails at its own noise.
If it rarely fails, the noise of the wheels is raised until it fails often enough to compare. A
change after which it then fails less often gives more reserve. If the object is too heavy, only
changes with which the robots hold it are tried.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from palmbots._types import SIDES, Interval
from palmbots.assessment.change_trial import ChangeTrial, Keys, NoChange
from palmbots.assessment.friction import hardest_to_hold
from palmbots.assessment.load import LOAD_CARRIES
from palmbots.assessment.raised_noise import (
    FRESH,
    NOISE_FACTORS,
    count_failures,
    differ,
    makes_noise,
    noisy,
    revealing_noise,
)
from palmbots.assessment.side_effects import known_warnings, new_warnings
from palmbots.control.dead_band import overrun_m, zero_zone_m
from palmbots.errors import PalmbotsError
from palmbots.mechanics.load_limits import DECISIVE, MEANINGS, LoadLimits, load_limits
from palmbots.mechanics.lone import on_one_palm
from palmbots.mujoco.curve_trial import CurveTrial, forecast_curve
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import multiplied, value_of
from palmbots.simulation.batch import DELIVERED, Columns
from palmbots.simulation.outcome_counts import (
    OutcomeCounts,
    carry_seeds,
    count_outcomes,
    default_carries,
    farthest_m,
)
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.stability.analysis import analyze

FACTORS: Mapping[str, tuple[float, ...]] = {
    "robot.correction_m_s": (0.5, 2.0),
    "robot.speed_m_s": (0.7, 1.4),
    "palm.rate_deg_s": (2.0,),
    "radio.latency_s": (0.5,),
    "tactile.zero_half_width_m": (0.5, 2.0),
    "palm.length_m": (0.7, 1.5),
    "palm.usable_m": (0.7, 1.5),
    "palm.friction": (0.7, 1.4),
}
"""Factors by which keys are multiplied; the cheapest changes come first. The noise is not among
them, because less noise is an obvious improvement."""
_ON_ONE_PALM = {"palm.shallow_deg": (0.7, 1.3), "palm.steep_deg": (0.8, 1.2)}
"""The same where one palm at a time holds the object."""
STRONGER = (1.25, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Factors by which the strength of a robot is multiplied if it cannot hold the object."""
MOST_IN_MUJOCO = 8
"""Changes for the load that are tried in the MuJoCo world, at most."""


def try_changes(
    scene: Scene,
    controller: str,
    angles: Keys,
    reach_m: float | None,
    report: Callable[[float], None] = lambda fraction: None,
    *,
    friction: Interval | None = None,
) -> ChangeTrial | NoChange:
    """Carry the scene with each change. Where the object is too heavy, the best changes are also
    carried in the MuJoCo world, until all carries with one arrive.

    A change that brings a warning is not advised, unless a property holds only with it.

    Args:
        scene: with a straight path.
        controller: of all carries.
        angles: a pair of palm angles that is better than the scene's own; empty: there is none.
        reach_m: how far the contacts get from the pivots; None: unknown, as no carry delivers.
        report: called with the completed fraction.
        friction: an interval, within which warnings and loads are judged; None: as in the scene.

    Returns:
        The best change, or why there is none.
    """

    def load_of(one: Scene) -> LoadLimits:
        return load_limits(one if friction is None else hardest_to_hold(one, friction))

    load = load_of(scene)
    is_heavy = not _is_held(load, reach_m)
    plans = [*(_stronger(load.scene, load, reach_m) if is_heavy else _plans(scene, angles))]
    if friction is not None:  # nobody can choose what is known only roughly
        plans = [keys for keys in plans if not any("friction" in key for key in keys)]
    own = None if load.refusal() else prepare(scene, controller)
    noise, count = 1.0, None if own is None else default_carries(own)
    if own is not None and count is not None and not is_heavy:
        found = revealing_noise(scene, controller, count)
        if found is None:
            return NoChange(_unfailing(scene, count))
        noise = found
    own_holds = analyze(scene).holds
    known = known_warnings(scene, controller, friction)
    judged: dict[int, tuple[bool, int]] = {}
    brought: dict[int, tuple[str, ...]] = {}
    harms: list[int] = []
    for k, keys in enumerate(plans):
        report((0.5 if is_heavy else 0.9) * k / len(plans))
        try:
            changed = load_scene(scene, dict(keys))
            count = default_carries(prepare(changed, controller)) if count is None else count
            if count is None:
                return NoChange(_LONG)
            holds = analyze(changed).holds
            brought[k] = new_warnings(known, changed, controller, friction)
            if brought[k] and (wider := _wider_zone(changed, controller)):
                plans.append({**keys, **wider})
            if own_holds and (brought[k] or not holds):
                harms.append(k)
            elif holds or not (own_holds or brought[k]):
                judged[k] = not holds, count_failures(noisy(changed, controller, noise), 0, count)
        except PalmbotsError:  # the palms collide, or a value is beyond its limits
            continue
    if not judged or count is None:
        why = _HARMFUL if plans else _WEAK
        return NoChange(why, is_for_load=is_heavy)
    ranked = sorted(judged, key=lambda k: judged[k])
    chosen, mujoco = ranked[0], None
    if is_heavy:
        chosen, mujoco = _carried_in_mujoco(scene, plans, ranked, controller, report)
        if mujoco is not None and mujoco.failure_rate == 1:
            return NoChange(_ALL_FAIL, is_for_load=True)
        plans[chosen], mujoco = _least(load.scene, plans[chosen], mujoco, controller, reach_m)
    for one in [chosen] if is_heavy else ranked:
        best, holds = plans[one], not judged[one][0]
        changed = load_scene(scene, dict(best))
        after = _usual(prepare(changed, controller), count)
        changed_reach_m = reach_m if is_heavy else farthest_m(after)
        if _is_held(load_of(changed), changed_reach_m):
            break
    else:
        return NoChange(_HEAVIER)
    usual = None if own is None else _usual(own, count)
    own_failures, deciding = None, []
    if own is not None:
        own_failures = count_failures(noisy(scene, controller, noise), FRESH, count)
    if own is not None and not is_heavy:
        usually = count_failures(noisy(scene, controller, noise), 0, count)
        deciding = [*harms, *(k for k in judged if differ(count, usually, judged[k][1]))]
    report(1.0)
    return ChangeTrial(
        controller=controller,
        tried=len(judged),
        changes=best,
        before={key: value_of(scene, key) for key in best},
        noise_factor=noise,
        carries=count,
        own_failures=own_failures,
        failures=count_failures(noisy(changed, controller, noise), FRESH, count),
        own_holds=own_holds,
        holds=holds,
        own_heaviest_kg=_heaviest(load, reach_m),
        heaviest_kg=_heaviest(load_of(changed), changed_reach_m),
        own_time_s=None if usual is None else _mean(usual, "time_s"),
        time_s=_mean(after, "time_s"),
        own_messages=None if usual is None else _mean(usual, "messages"),
        messages=_mean(after, "messages"),
        own_farthest_m=None if usual is None else farthest_m(usual),
        farthest_m=farthest_m(after),
        warnings=brought[one],
        deciding=tuple(dict.fromkeys(key for k in sorted(deciding) for key in plans[k])),
        mujoco=mujoco,
    )


def with_drift(change: ChangeTrial, curve: CurveTrial, scene: Scene) -> ChangeTrial:
    """The change with the drift on the curve, forecast with it and without."""
    changed = load_scene(scene, dict(change.changes))
    own, other = curve.forecast, forecast_curve(changed, curve.controller, curve.changes).forecast
    if own is None or other is None or own.lips or other.lips:
        return change
    return replace(
        change, own_drift_m=own.mean_m, drift_m=other.mean_m, drift_permitted_m=other.budget_m
    )


_LONG = "carries take too long, so no change was tried"
_WEAK = f"even robots up to {STRONGER[-1]:g} times as strong do not hold it"
_HEAVIER = "with every change that was tried the object is too heavy for the robots"
_HARMFUL = "every change that was tried is refused, violates a property, or brings a warning"
_ALL_FAIL = "in MuJoCo every carry fails with each of the stronger robots that were tried"


def _unfailing(scene: Scene, count: int) -> str:
    """Why no changes can be compared in a scene that rarely fails, even with more noise."""
    if makes_noise(scene):
        return (
            f"too few of {count:,} carries fail for a comparison of changes, even with up to "
            f"{NOISE_FACTORS[-1]:g} times the noise"
        )
    return (
        f"none of {count:,} carries fails, and there is no noise to raise, so changes cannot be "
        "compared"
    )


def _carried_in_mujoco(
    scene: Scene,
    plans: Sequence[Keys],
    ranked: Sequence[int],
    controller: str,
    report: Callable[[float], None],
) -> tuple[int, OutcomeCounts | None]:
    """The number of the first change with which all carries in the MuJoCo world arrive, else of the
    one with which most do, and how its carries end; None: that world refuses all of them."""
    found: dict[int, OutcomeCounts] = {}
    for n, k in enumerate(ranked[:MOST_IN_MUJOCO]):
        report(0.5 + 0.4 * n / MOST_IN_MUJOCO)
        changed = load_scene(scene, dict(plans[k]))
        try:
            found[k] = count_outcomes(changed, controller, seeds=LOAD_CARRIES, world="mujoco")
        except PalmbotsError:
            continue
        if found[k].failure_rate == 0:
            break
    best = min(found, key=lambda k: found[k].failure_rate, default=ranked[0])
    return best, found.get(best)


def _least(
    scene: Scene,
    keys: Keys,
    arrived: OutcomeCounts | None,
    controller: str,
    reach_m: float | None,
) -> tuple[Keys, OutcomeCounts | None]:
    """The least values of these keys that are enough: the robots hold the object, and all carries
    in the MuJoCo world arrive if they do with `keys`. Each key has two digits, and is as small as
    the others allow."""
    least, counts = dict(keys), arrived
    is_carried = arrived is not None and arrived.failure_rate == 0
    for key in keys:
        values = _between(value_of(scene, key), cast("float", keys[key]))
        low, high = -1, len(values) - 1  # the last value is enough
        while high - low > 1:
            middle = (low + high) // 2
            tried, found = least | {key: values[middle]}, counts
            is_enough = _holds(scene, tried, reach_m)
            if is_enough and is_carried:
                changed = load_scene(scene, dict(tried))
                found = count_outcomes(changed, controller, seeds=LOAD_CARRIES, world="mujoco")
                is_enough = found.failure_rate == 0
            if is_enough:
                high, counts = middle, found
            else:
                low = middle
        least[key] = values[high]
    return least, counts


def _between(low: float, high: float) -> list[float]:
    """The numbers of two digits between `low` and `high`, and `high`."""
    step = 10.0 ** (math.floor(math.log10(low)) - 1)
    values, k = [], math.floor(low / step) + 1
    while k * step < high * (1 - 1e-9):
        values.append(float(f"{k * step:.2g}"))
        k += 1
        if k >= 100:
            k, step = 10, 10 * step
    return [*values, high]


def _plans(scene: Scene, angles: Keys) -> Iterator[Keys]:
    """Changes of one thing each, the cheapest first."""
    if angles:
        yield angles
    starts = {f"start.{side}_m": value_of(scene, f"start.{side}_m") for side in SIDES}
    if any(starts.values()):
        yield dict.fromkeys(starts, 0.0)
    for key, factors in {**FACTORS, **(_ON_ONE_PALM if on_one_palm(scene) else {})}.items():
        if key != "palm.length_m" or not any(scene.palm_of(side).usable_m for side in SIDES):
            plans = [_multiplied(scene, key, factor) for factor in factors]
            yield from (plan for plan in plans if any(plan.values()))
    left, right = (scene.object.vertices_m[at][0] for at in scene.object.contacts)
    x, y = scene.object.com_m
    if abs(x - 0.5 * (left + right)) > 0.01 * abs(right - left):
        yield {"object.com_m": [round(0.5 * (left + right), 4), y]}


def _wider_zone(scene: Scene, controller: str) -> Keys:
    """The zero zone that a contact no longer overruns; empty: it is wide enough, or made of
    switches."""
    needed, half = overrun_m(scene, controller), scene.tactile.zero_half_width_m
    if scene.tactile.zones is not None or needed < zero_zone_m(scene):
        return {}
    wider = math.ceil(1e3 * needed / 2 + 1e-9) / 1e3
    return {"tactile.zero_half_width_m": wider} if wider > half else {}


def _stronger(scene: Scene, load: LoadLimits, reach_m: float | None) -> Iterator[Keys]:
    """Changes of one kind of strength with which the robots hold the object, the smallest first. If
    no kind suffices alone: of all kinds together without which no carry begins."""
    alone = [(limit.key,) for limit in load.limits]
    together = [tuple(MEANINGS[kind][1] for kind in DECISIVE)]
    for names in (alone, together):
        plans = [
            {one: v for name in some for one, v in _multiplied(scene, name, factor).items()}
            for factor in STRONGER
            for some in names
        ]
        held = [keys for keys in plans if _holds(scene, keys, reach_m)]
        yield from held
        if held:
            return


def _holds(scene: Scene, keys: Keys, reach_m: float | None) -> bool:
    """Whether the robots hold the object with these changes."""
    try:
        return bool(keys) and _is_held(load_limits(scene, overrides=dict(keys)), reach_m)
    except PalmbotsError:
        return False


def _multiplied(scene: Scene, key: str, factor: float) -> Keys:
    """A key and its overrides, multiplied and rounded to three digits."""
    return {one: float(f"{v:.3g}") for one, v in multiplied(scene, key, factor).items()}


def _heaviest(load: LoadLimits, reach_m: float | None) -> float:
    """The heaviest object that the robots hold, at the start and with contacts up to `reach_m`."""
    start = math.inf if load.at_start_kg is None else load.at_start_kg
    return start if reach_m is None else min(start, load.heaviest_within(reach_m))


def _is_held(load: LoadLimits, reach_m: float | None) -> bool:
    return load.mass_kg <= _heaviest(load, reach_m)


def _usual(prepared: Prepared, count: int) -> Columns:
    """Carries at the scene's own noise, for time and messages."""
    return carry_seeds(prepared, FRESH, count)


def _mean(columns: Columns, name: str) -> float | None:
    """Over the carries that deliver."""
    values = columns[name][columns["outcome"] == DELIVERED]
    return float(np.mean(values)) if values.size else None
