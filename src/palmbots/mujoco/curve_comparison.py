# SPDX-License-Identifier: Apache-2.0
"""What helps a pair along a curve: lips, wider and longer palms, larger radii, another controller.

Nothing here is advice of a rule. Each change is carried in the MuJoCo world, and its drop rate
stands beside it. A turn of fixed angle keeps its angle: a larger radius makes it longer.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

import palmbots._core as _core
from palmbots._types import SIDES, Overrides
from palmbots._util.command import Option, command
from palmbots._util.confidence_intervals import rate_text
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bad, bold, good, quiet, warn_word
from palmbots._util.results import Result
from palmbots._util.text import duration, millimetres, plural
from palmbots.control.registry import ControllerLike, refuse_reference, resolve
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.errors import PalmbotsError
from palmbots.mujoco.curve_trial import (
    CurveTrial,
    Keys,
    carry_curve,
    forecast_curve,
    tried_turn,
    whole_turn_keys,
)
from palmbots.mujoco.drift_forecast import lip_clearance
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.path_curve import RADIUS_M
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.scene.spec import to_spec
from palmbots.simulation.carry_ends import usual_reason
from palmbots.simulation.outcome_counts import SMALL

LIP_HEIGHT_M = 0.03
LONGER, RADII = 1.5, (1.5, 2.0)
_SIDE = re.compile(r"\.(left|right)\.")
_FORECASTS = 0.1  # of the work
_LEGEND = (
    "drift: sideways, as forecast; at the limit the object tips over the side of the palm, or "
    "meets the lips"
)
_SLACK = 0.05  # by which forecast and carries may differ beyond the interval of the carries
_Plan: TypeAlias = tuple[ControllerLike, Scene, Keys]


@dataclass(frozen=True, repr=False)
class CurveComparison(Result):
    """A curve with a scene as it is, and with one change each."""

    own: CurveTrial
    others: tuple[CurveTrial, ...]
    """The one that fails least often first; those that were not carried last."""
    scene: Scene
    words: str = field(default="", metadata=NOT_IN_JSON)
    """Those that name the controller of the scene as it is on a command line."""

    @derived
    def best(self) -> CurveTrial | None:
        """The change whose interval of failures lies below that of the scene as it is, or that can
        be carried where the scene cannot; None: none does."""
        tried = [one for one in self.others if one.counts is not None]
        if not tried or tried[0].counts is None or tried[0].counts.failure_rate == 1:
            return None
        own = self.own.counts
        if own is None or tried[0].counts.failure_interval[1] < own.failure_interval[0]:
            return tried[0]
        return None

    def _label(self, one: CurveTrial) -> str:
        return "as it is" if one is self.own else _name(self.own, one)

    def lines(self) -> Iterator[Item]:
        """What helps, and what each change does."""
        best, own = self.best, self.own
        if best is not None:
            yield Line(good("BETTER"), bold(f"  {self._label(best)}: {_failures(best)}"))
        elif own.counts is None:
            yield Line(bad("NO"), bold("  nothing that was tried gets around this curve"))
        elif own.counts.failure_rate == 0:
            is_sure = own.counts.failure_interval[1] <= SMALL
            word = good("YES" if is_sure else "LIKELY")
            yield Line(word, bold(f"  as it is: {_failures(own)}"))
        else:
            word = bad("NO") if own.counts.failure_rate == 1 else warn_word("PARTLY")
            yield Line(word, bold(f"  as it is: {_failures(own)}"))
            if reason := usual_reason(own.counts, "mujoco"):
                yield Line(f"most often {reason}", indent=2)
            yield "no change that was tried helps measurably"
        yield Table(
            [_row(one, self._label(one)) for one in (own, *self.others)],
            ("  change", "drops", "stalls", "drift", "limit"),
            gap=2,  # the keys need the room
        )
        yield quiet(_LEGEND)
        for one in (own, *self.others):
            if doubt := _contradiction(one):
                yield Line(f"{self._label(one)}: {doubt}", indent=2)
        shown = best or own
        carries = ""
        if shown.counts is not None:
            carries = f"{plural(shown.counts.carries, 'carry')} each, seeds "
        yield quiet(f"{own.controller}; MuJoCo; {carries}from 0; 95 % intervals")
        is_beyond = shown.counts is None
        controller = shown.controller
        if controller == own.controller and self.words:
            controller = self.words
        command = command_text(
            "carry", self.scene.spelled, {**self.own.changes, **shown.changes}, world="mujoco",
            controller=controller,
            allow_drift_beyond_budget=is_beyond, seeds=None if is_beyond else 100,
        )  # fmt: skip
        yield Line(f"run: {command}", indent=2, is_whole=True)


def _name(own: CurveTrial, one: CurveTrial) -> str:
    """What differs from the scene as it is. A change of both sides alike has no side."""
    keys: dict[str, float | str] = {}
    for key, value in one.changes.items():
        common = _SIDE.sub(".", key)
        is_alike = all(v == value for k, v in one.changes.items() if _SIDE.sub(".", k) == common)
        keys[common if is_alike else key] = value
    words = [f"{key}={value}" for key, value in keys.items()]
    return " ".join([*words, *[one.controller] * (one.controller != own.controller)])


def _failures(one: CurveTrial) -> str:
    assert one.counts is not None
    failed = one.counts.dropped + one.counts.stalled
    return f"fails in {rate_text(failed, one.counts.carries)} of carries"


def _drift(one: CurveTrial) -> tuple[str, str]:
    """The forecast drift, and the drift that is permitted. Lips stop it, and there is no forecast
    of what happens then."""
    if one.forecast is None:
        return "–", "–"
    limit = millimetres(one.forecast.budget_m)
    if one.forecast.lips:
        return "lips", limit
    return millimetres(one.forecast.mean_m), limit


def _contradiction(one: CurveTrial) -> str | None:
    """How drops in carries contradict the forecast; None: they agree with it."""
    if one.forecast is None or one.counts is None:
        return None
    expected = one.forecast.tips / one.forecast.seeds
    low, high = one.counts.drop_interval
    if low - _SLACK <= expected <= high + _SLACK:
        return None
    tips = f"the forecast expects drops in {rate_text(one.forecast.tips, one.forecast.seeds)}"
    if one.forecast.lips:
        tips = "lips stop the drift"
    reason = usual_reason(one.counts, "mujoco")
    most = f", most often {reason}" if reason else ""
    return f"{tips}, but {one.counts.dropped} of {one.counts.carries} carries drop{most}"


def _row(one: CurveTrial, name: str) -> tuple[str, ...]:
    counts, drift = one.counts, _drift(one)
    if counts is None:
        return f"  {name}", "refused" if one.refusal else "not carried", "", *drift
    return (
        f"  {name}", rate_text(counts.dropped, counts.carries),
        rate_text(counts.stalled, counts.carries), *drift,
    )  # fmt: skip


@command(
    "curve",
    order=75,
    example="palmbots curve scene.toml -c shared-sign --turn-radius-m 0.6",
    progress="carrying along the curve",
    turn_radius_m=Option(least=0.01, most=100.0),
    turn_angle_deg=Option(least=7.0, most=360.0),
    carries=Option("--carries -n", least=1, most=10_000),
)
def compare_on_curve(
    scene: SceneLike = "paper",
    controller: ControllerLike = "distributed",
    *,
    turn_radius_m: float = 1.0,
    turn_angle_deg: float = 90.0,
    carries: int = 20,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
    on_line: Callable[[str], None] | None = None,
) -> CurveComparison:
    """Compare changes of a scene on a curve in MuJoCo.

    The scene is carried as it is, and with lips, wider palms, longer palms, larger radii and the
    recommended controller. Where the forecast drift exceeds the budget, nothing is carried.

    Args:
        scene: as in `palmbots.carry`. A turn on a level floor replaces a straight path.
        controller: as in `palmbots.carry`.
        turn_radius_m: radius of the turn that replaces a straight path.
        turn_angle_deg: angle of this turn.
        carries: carries with each change, all with the seeds 0, 1, …
        overrides: scene keys to set.
        on_progress: called with the completed fraction.
        on_line: called with a line for each forecast, and for each change that was carried.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: another argument is not allowed, or MuJoCo is not installed.
    """
    entry = resolve(controller)
    words = entry.spelled
    refuse_reference(entry, "carries in MuJoCo")
    mujoco()  # refuses at once if it is not installed
    chosen, report = load_scene(scene, overrides), on_progress or (lambda fraction: None)
    path = tried_turn(chosen, turn_radius_m, turn_angle_deg)
    curved = load_scene(chosen, dict(path)) if path else chosen
    say = on_line or (lambda text: None)
    plans: list[_Plan] = [(entry, chosen, path)]
    own = forecast_curve(chosen, entry, path)
    plans += [(name or entry, curved, changes) for name, changes in _plans(curved, own)]
    trials = [own]
    for k, plan in enumerate(plans):
        if k > 0:
            trials.append(forecast_curve(plan[1], plan[0], plan[2]))
        drift, limit = _drift(trials[k])
        what = "lips stop the drift after" if drift == "lips" else f"forecast drift {drift} of"
        say(f"{_title(trials, k)}: {what} {limit}")
        report(_FORECASTS * (k + 1) / len(plans))
    # The time of a carry is about proportional to its distance.
    metres = [
        load_scene(plan[1], dict(plan[2])).task.distance_m if trial.can_be_carried else 0.0
        for plan, trial in zip(plans, trials, strict=True)
    ]
    begun, done_m, total_m = time.monotonic(), 0.0, max(sum(metres), 1e-9)
    for k, (entry, base, _) in enumerate(plans):

        def part(done: float, before: float = done_m, here: float = metres[k]) -> None:
            report(_FORECASTS + (1 - _FORECASTS) * (before + done * here) / total_m)

        trials[k] = carry_curve(base, entry, trials[k], part, carries=carries)
        done_m += metres[k]
        if trials[k].counts is not None:
            left_s = (time.monotonic() - begun) * (total_m / done_m - 1)
            left = f"; about {duration(left_s)} left" if done_m < total_m else ""
            say(f"{_title(trials, k)}: {_failures(trials[k])}{left}")
    own, *others = trials
    others.sort(key=lambda one: 2.0 if one.counts is None else one.counts.failure_rate)
    report(1.0)
    return CurveComparison(own, tuple(others), chosen, words)


def _title(trials: list[CurveTrial], k: int) -> str:
    return _name(trials[0], trials[k]) if k > 0 else "as it is"


def _plans(scene: Scene, own: CurveTrial) -> Iterator[tuple[str | None, Keys]]:
    """Controllers (None: that of the scene as it is) and changed keys to try."""
    palms = [scene.palm_of(side) for side in SIDES]
    if own.controller != RECOMMENDED:
        yield RECOMMENDED, {}
    length = _up(LONGER * max(palm.length_m for palm in palms))
    longer = on_every_side(scene, {"palm.length_m": length})
    has_usable = any(palm.usable_m for palm in palms)
    can_be_longer = not has_usable and not _overlaps(scene, longer)
    if can_be_longer:
        yield None, longer
    if any(palm.lip_height_m > 0 for palm in palms):
        most = max(palm.lip_clearance_m for palm in palms)
        clearance = max(_clearance(scene), math.ceil(1.5e3 * most) / 1e3)
        yield None, on_every_side(scene, {"palm.lip_clearance_m": clearance})
    else:
        yield None, _lips(scene)
        if can_be_longer:
            yield None, {**longer, **_lips(load_scene(scene, dict(longer)))}
        # The drift grows with the width; beyond the depth of the object no width helps.
        enough = _up(2 * (1.25 * own.forecast.most_m if own.forecast else 0.0))
        widest = _up(scene.object.depth_m)
        for width in dict.fromkeys((min(enough, widest), widest)):
            if width > max(palm.width_m for palm in palms):
                yield None, on_every_side(scene, {"palm.width_m": width})
    if scene.task.path.kind not in ("arc", "s"):
        return
    for factor in RADII:
        radius = round(factor * (scene.task.path.radius_m or RADIUS_M), 6)
        keys: Keys = {"task.path.radius_m": radius}
        wider = {**keys, **whole_turn_keys(load_scene(scene, dict(keys)))}
        yield None, wider
        if factor == RADII[-1] and can_be_longer:
            yield None, {**wider, **longer, **_lips(load_scene(scene, {**wider, **longer}))}


def _lips(scene: Scene) -> Keys:
    lips = {"palm.lip_height_m": LIP_HEIGHT_M, "palm.lip_clearance_m": _clearance(scene)}
    return on_every_side(scene, lips)


def _clearance(scene: Scene) -> float:
    """The clearance that lips need, plus a quarter of it and 2 mm [m]."""
    try:
        room = lip_clearance(scene)
    except PalmbotsError:  # no path for this pair; the trial says so
        room = 0.0
    return math.ceil(1e3 * (1.25 * room + 2e-3)) / 1e3


def _overlaps(scene: Scene, longer: Keys) -> bool:
    """Whether longer palms would collide under the object, or are refused."""
    try:
        changed = load_scene(scene, dict(longer))
        return _core.palm_overlap(to_spec(changed, unrolled=True)) > 0
    except PalmbotsError:
        return True


def _up(metres: float) -> float:
    """A length in whole multiples of 5 mm, rounded up."""
    return round(math.ceil(metres / 5e-3 - 1e-9) * 5e-3, 6)
