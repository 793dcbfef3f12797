# SPDX-License-Identifier: Apache-2.0
"""Answers about other values than the scene's: angles, friction, lost messages, a curve, and
changes of one thing each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

from palmbots._types import SIDES, Interval
from palmbots._util.confidence_intervals import rate_interval, rate_text
from palmbots._util.report import Table
from palmbots._util.text import format_number, millimetres, plural
from palmbots.assessment.angles import AngleTrial, NoPair
from palmbots.assessment.answer import (
    Answer,
    Verdict,
    arrived,
    best_of,
    failures,
    suffices,
    swept,
)
from palmbots.assessment.change_trial import ChangeTrial, NoChange
from palmbots.assessment.friction import FrictionTrial
from palmbots.assessment.radio import LOSSES, RadioTrial
from palmbots.assessment.raised_noise import noise_words
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.mechanics.load_limits import mass_text
from palmbots.mujoco.curve_trial import CurveTrial
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene
from palmbots.simulation.carry_ends import usual_reason
from palmbots.simulation.noise_limit import NOISE_KEY
from palmbots.simulation.outcome_counts import SMALL, OutcomeCounts
from palmbots.stability.analysis import Analysis

_SAME = 0.05  # relative difference of a time or a number of messages that is not reported


def on_angles(
    trial: AngleTrial | NoPair | None,
    name: str,
    scene: Scene,
    counted: OutcomeCounts | None = None,
    friction: Interval | None = None,
) -> Answer:
    """Whether other palm angles are better. If none are but the scene still fails, the verdict is
    ``partly``. `counted` may have more carries with the scene's own angles than the trial. If these
    rarely fail, carries with more noise compare the angles, and better ones are not required."""
    question = "Are the palm angles right?"
    # Where each robot has its own noise, there is no common one to maximize.
    maximize = None if swept(scene, NOISE_KEY) == NOISE_KEY else "angle"
    controller = trial.controller if isinstance(trial, AngleTrial) else None
    command = command_text(
        "design", name, maximize=maximize, controller=controller, friction=friction
    )
    if not isinstance(trial, AngleTrial):
        why = "no carry arrives, so pairs of angles cannot be compared"
        return Answer(question, "open", why if trial is None else trial.why, command)
    noise = noise_words(scene, trial.noise_factor)
    least, most = 100 * trial.least_failure_rate, 100 * trial.most_failure_rate
    tried = f"{trial.tried} pairs tried, with {trial.carries:,} carries each"
    spread = f"{least:.3g} to {most:.3g} % at the {tried}"
    if most == 0:
        spread = (
            f"no failures at any of the {tried}, so these carries show no difference between them"
        )
    own, best = (rate_text(n, trial.carries) for n in (trial.own_failures, trial.best_failures))
    if not trial.is_better:
        text = f"{noise}{trial.controller} fails in {own} at the scene's angles; {spread}"
        of_trial = not noise and rate_interval(trial.own_failures, trial.carries)[1] <= SMALL
        if of_trial or (counted is not None and suffices(counted)):
            return Answer(question, "yes", text, command)
        return Answer(question, "partly", f"no pair that was tried is better: {text}", command)
    shallow, steep = trial.best_deg
    text = (
        f"{noise}{trial.controller} fails in {best} at {shallow:g}° and {steep:g}°, and in {own} "
        f"at the scene's angles; the clearance becomes {trial.best_clearance_deg:.2f}° "
        f"(now {trial.own_clearance_deg:.2f}°)"
    )
    if noise and counted is not None and suffices(counted):
        return Answer(question, "yes", f"other angles give more reserve: {text}", command)
    return Answer(question, "partly", text, command)


def on_friction(
    trial: FrictionTrial | None,
    analysis: Analysis,
    name: str,
    given: Mapping[str, Any] | None = None,
) -> Answer:
    """What holds for a friction that is known only roughly. `given` are the options of the user."""
    question = "Is the friction right?"
    if trial is None:
        ranges = ", or ".join(f"from {low:.3f} to {high:.3f}" for low, high in analysis.friction)
        hold = f"hold for friction {ranges}" if ranges else "fail for every friction"
        text = f"properties 1 and 2 {hold} (accelerations neglected)"
        if any(analysis.scene.palm_of(side).heel_m > 0 for side in SIDES):
            text += "; no certificate covers heels, so no interval is tried"
            return Answer(question, "open", text, command_text("analyze", name))
        text += "; to try an interval of your own, use --friction"
        middle = min(analysis.problem.friction)
        near = (float(f"{0.9 * middle:.3g}"), float(f"{1.1 * middle:.3g}"))
        options: dict[str, Any] = {**(given or {}), "friction": near}
        command = command_text("assess", name, **options)
        return Answer(question, "open", text, command)
    low, high = trial.friction
    is_common = trial.unlike != "holds" and trial.alike == "holds"
    command = command_text("certify", name, friction=trial.friction, common_friction=is_common)
    proofs = [f"with any friction from {low:g} to {high:g} all properties hold"]
    verdict: Verdict = "yes"
    if is_common:
        proofs[0] += ", if it is the same on both palms"
        verdict = "likely"
    elif trial.unlike != "holds":
        verdict = "no" if trial.alike == "fails" else "partly"
        word = "fails" if trial.alike == "fails" else "may fail"
        proofs = [f"with some friction from {low:g} to {high:g} a property {word}"]
    proofs[0] += f" (accelerations neglected{'; proved' * (trial.alike == 'holds')})"
    if trial.alike == "fails":
        ranges = " and ".join(f"from {a:.3f} to {b:.3f}" for a, b in analysis.friction)
        same = "if it is the same on both palms, properties 1 and 2"
        proofs.append(f"{same} hold {ranges}" if ranges else f"{same} fail for every friction")
    if trial.failing is not None:
        left, right, number = trial.failing
        proofs.append(
            f"with {left:g} on the left and {right:g} on the right palm property {number} fails"
        )
    elif is_common:
        word = "fails for some pairs of values" if trial.unlike == "fails" else "may fail"
        proofs.append(f"if the palms differ within the interval, a property {word}")
    if trial.counts:
        ends = zip(trial.counts, trial.friction, strict=True)
        rates = [f"{failures(one)} with friction {end:g}" for one, end in ends]
        proofs.append(f"{trial.counts[0].controller} fails in {' and in '.join(rates)}")
        if not all(map(suffices, trial.counts)):
            verdict = "no" if verdict == "no" else "partly"
    return Answer(question, verdict, "; ".join(proofs), command)


def on_change(
    trial: ChangeTrial | NoChange | None,
    name: str,
    scene: Scene,
    given: Mapping[str, Any] | None = None,
) -> Answer:
    """Which change helps most. `given` are the options of the user."""
    question = "Does one change help?"
    if trial is None or isinstance(trial, NoChange):
        text = "no carry arrives, so changes cannot be compared"
        if trial is not None:
            text = trial.why
        if trial is not None and trial.is_for_load:
            return Answer(question, "no", text, command_text("load", name))
        return Answer(question, "open", text, _failure_command(scene, name, RECOMMENDED))
    controller, own = trial.controller, "refused"
    if trial.own_failures is not None:
        own = rate_text(trial.own_failures, trial.carries)
    setting = command_text("assess", name, trial.changes, **(given or {}))
    noise = noise_words(scene, trial.noise_factor)
    if not trial.is_better:
        text = (
            f"{noise}{controller} fails in {own} of carries; none of the {trial.tried} changes "
            "that were tried makes it fail less often"
        )
        return Answer(question, "no", text, _failure_command(scene, name, controller))
    changed = ", ".join(
        f"{key} from {format_number(trial.before[key])} to {format_number(value)}"
        for key, value in trial.changes.items()
    )
    verdict: Verdict = "yes"
    after = rate_text(trial.failures, trial.carries)
    rates = f"{after} instead of {own}"
    text = f"{changed}: {noise}{controller} fails in {rates}"
    if trial.holds and not trial.own_holds:
        text = f"{text}; then all properties hold"
    elif noise:
        text = f"more reserve: {text}"
    if trial.is_for_load:
        place = "at the start" if trial.own_failures is None else "as far out as contacts get"
        masses = " instead of ".join(
            f"{mass_text(mass)} kg" for mass in (trial.heaviest_kg, trial.own_heaviest_kg)
        )
        text = (
            f"{changed}: no robot tips and no palm sags up to {masses} {place}; {controller} then "
            f"fails in {after} of carries"
        )
        if trial.mujoco is not None:
            text += f", and in MuJoCo {arrived(trial.mujoco)} carries arrive"
            verdict = "yes" if trial.mujoco.failure_rate == 0 else "partly"
    if trial.tips_on_curve and trial.drift_permitted_m is not None:
        verdict = "partly"
        limit = millimetres(trial.drift_permitted_m)
        text += f"; but on the curve the object drifts by more than the {limit} permitted, and tips"
    warnings = (f"it brings a warning: {one}" for one in trial.warnings)
    return Answer(question, verdict, "; ".join([text, *warnings]), setting)


def _failure_command(scene: Scene, name: str, controller: str) -> str:
    """The command for the noise that the scene tolerates or, if each robot has its own noise, for
    the drop rate."""
    is_one = swept(scene, NOISE_KEY) == NOISE_KEY
    return command_text("noise-limit" if is_one else "drop-rate", name, controller=controller)


def costs_table(trial: ChangeTrial | None) -> Table | None:
    """What else the best change alters measurably, for better or worse. These carries have the
    noise of the scene, even if more noise was needed to compare failures."""
    if trial is None or not trial.is_better:
        return None
    pairs = (
        ("time of a carry", "{:.0f} s", 1.0, trial.own_time_s, trial.time_s),
        ("messages of a carry", "{:.0f}", 1.0, trial.own_messages, trial.messages),
        (f"farthest contact from its pivot in {trial.carries:,} carries",
         "{:.1f} mm", 1e3, trial.own_farthest_m, trial.farthest_m),
        ("forecast drift on the curve", "{:.1f} mm", 1e3, trial.own_drift_m, trial.drift_m),
    )  # fmt: skip
    rows = [
        (f"  {words}", form.format(factor * before), form.format(factor * after))
        for words, form, factor, before, after in pairs
        if before and after and abs(after / before - 1) > _SAME
    ]
    masses = (trial.own_heaviest_kg, trial.heaviest_kg)
    if not trial.is_for_load and masses[1] < (1 - _SAME) * masses[0]:
        own, changed = (f"{mass_text(kg)} kg" if math.isfinite(kg) else "any mass" for kg in masses)
        words = "  no robot tips and no palm sags there up to"
        rows.append((words, own, changed))
    rows = [row for row in rows if row[1] != row[2]]
    noise = "" if trial.noise_factor == 1 else ", at the scene's own noise"
    return Table(rows, (f"  other effects{noise}", "as it is", "changed")) if rows else None


def on_radio(
    trials: Sequence[RadioTrial], counts: Sequence[OutcomeCounts], name: str, scene: Scene
) -> Answer:
    """What lost messages do."""
    question = "Does it survive lost messages?"
    key = swept(scene, "radio.loss")
    command = command_text("compare", name, sweep=key, values=[*LOSSES])
    if not trials:
        best = best_of(counts)
        if best is None:
            return Answer(question, "open", "no carry arrives even without losses", command)
        if suffices(best):
            return Answer(question, "yes", "the controllers that suffice use no radio", command)
        text = f"no controller suffices, and {best.controller} uses no radio"
        return Answer(question, "open", text, command)
    worst = trials[-1]
    kept = [one.controller for one in worst.counts if suffices(one)]
    if kept:
        text = f"even if {100 * worst.loss:g} % are lost: {', '.join(kept)}"
        return Answer(question, "yes", text, command)
    held = [row.loss for row in takewhile(lambda row: any(map(suffices, row.counts)), trials)]
    names = ", ".join(one.controller for one in worst.counts)
    text = f"even without losses, too many carries fail with {names}"
    if held:
        text = f"up to {100 * held[-1]:g} % lost" if held[-1] else "only if none is lost"
    return Answer(question, "partly" if len(held) > 1 else "no", text, command)


def on_curve(trial: CurveTrial | None, best: OutcomeCounts | None, scene: Scene) -> Answer:
    """What a curve does."""
    question, name = "Does it survive a curve?", scene.spelled
    if trial is None:
        why = "no turn was requested" if best else "no carry arrives on a straight path"
        return Answer(question, "open", why, command_text("curve", name))
    turn: dict[str, Any] = {}
    where, radius = f"on its path ({scene.task.path.kind})", trial.changes.get("task.path.radius_m")
    if isinstance(radius, float):
        angle = trial.changes["task.path.angle_deg"]
        where = f"{format_number(angle)}° with radius {radius:g} m"
        if "task.slope_deg" in trial.changes:
            where += ", on a level floor"
        turn = {"turn_radius_m": radius, "turn_angle_deg": angle}
    command = command_text("curve", name, controller=trial.controller, **turn)
    forecast, counts = trial.forecast, trial.counts
    if forecast is None or trial.refusal:
        return Answer(question, "open", f"{where}: {trial.refusal}", command)
    if counts is None:
        return Answer(question, "no", f"{where}: {forecast.text()}", command)
    room = millimetres(forecast.budget_m)
    drift = f"forecast drift {millimetres(forecast.mean_m)} of the {room} permitted"
    if forecast.lips:
        drift = f"lips stop the drift after {room}"
    verdict: Verdict = "likely" if counts.failure_rate == 0 else "partly"
    if counts.failure_rate > 0.5:
        verdict = "no"
    fails = f"{counts.controller} fails in {failures(counts)} of carries in MuJoCo"
    if counts.failure_rate == 0:
        carries = plural(counts.carries, "carry")
        fails = f"none of {carries} with {counts.controller} fails in MuJoCo"
    doubt = ""
    if verdict == "no" and not forecast.lips and forecast.tips == 0:
        doubt = ", so this drift alone does not explain the failures"
    reason = usual_reason(counts, "mujoco")
    text = "; ".join(filter(None, [f"{where}: {fails}", reason, f"{drift}{doubt}"]))
    return Answer(question, verdict, text, command)


def radio_table(trials: Sequence[RadioTrial]) -> Table | None:
    """Failures by the share of lost messages."""
    if not trials:
        return None
    heads = ("  messages lost", *(one.controller for one in trials[0].counts))
    rows = [(f"  {100 * row.loss:g} %", *map(failures, row.counts)) for row in trials]
    return Table(rows, heads)
