# SPDX-License-Identifier: Apache-2.0
"""Answers about the scene as it is: whether palms and robots hold the object, how often it arrives,
and which controllers suffice."""

from __future__ import annotations

from collections.abc import Sequence

from palmbots._util.confidence_intervals import rate_text
from palmbots._util.report import Table
from palmbots._util.text import millimetres
from palmbots.assessment.answer import (
    Answer,
    Verdict,
    arrived,
    best_of,
    failures,
    reached,
    suffices,
    swept,
)
from palmbots.assessment.friction import FrictionTrial, friction_keys
from palmbots.assessment.load import LoadTrial
from palmbots.control.dead_band import overrun_m, zero_zone_m
from palmbots.control.registry import WIDE_ZONE, describe
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.mechanics.load_limits import LoadLimits
from palmbots.mechanics.lone import on_one_palm
from palmbots.mujoco.engine import without_mujoco
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene
from palmbots.scene.sides import value_of
from palmbots.simulation.carry_ends import usual_reason
from palmbots.simulation.noise_limit import MOST_M_S, NOISE_KEY
from palmbots.simulation.outcome_counts import SMALL, OutcomeCounts
from palmbots.stability.analysis import Analysis
from palmbots.stability.tightest_margins import RankedMargin


def on_mechanics(
    analysis: Analysis,
    near: Analysis | None,
    best: OutcomeCounts | None,
    name: str,
    friction: float | None = None,
) -> Answer:
    """Whether the palms lift and hold the object, and what is tightest.

    `near` is the analysis for contacts no farther out than in the carries with the best controller;
    None: no carry delivers. A property that fails only farther out does not count against the
    scene. `friction` is that of the analyses, the worst of an interval; None: that of the scene.
    """
    question, region = "Can palms hold it?", None
    verdict, text, is_near = _held(analysis, near, best)
    if is_near and best is not None and best.farthest_m is not None:
        region = [float(f"{end:.3g}") for end in (-best.farthest_m, best.farthest_m)]
    keys = {} if friction is None else friction_keys(analysis.scene, friction)
    if friction is not None:
        text += (
            f"; all this with a friction of {friction:g}, the worst of the interval if it is the "
            "same on both palms"
        )
    return Answer(question, verdict, text, command_text("analyze", name, keys, region=region))


def _held(
    analysis: Analysis, near: Analysis | None, best: OutcomeCounts | None
) -> tuple[Verdict, str, bool]:
    """The verdict, its text, and whether they are for the contacts that occur in carries."""
    for job in (analysis.lifting, analysis.lone, analysis.hand_over):
        if job is not None and not job.works:
            return "no", job.refusals[0], False
    if (job := analysis.lone or analysis.hand_over) is not None:
        text = f"one palm at a time holds it; tightest margin: {job.tightest[1]}"
        return "partly" if job.warnings else "yes", "; ".join([text, *job.warnings]), False
    doubt = _doubt(analysis)
    if doubt is None:
        tightest = _tightest(analysis)
        text = f"tightest margin: {tightest.sentence()}"
        if tightest.quantity == "contact" and (tightest.times or 1.0) < 1.0:
            text += "; so the robots have to correct it"
        return "yes", text, False
    if near is None or best is None or best.farthest_m is None:
        return "partly" if analysis.holds else "no", doubt, False
    if (nearer := _doubt(near)) is None:
        text = f"{reached(best)}, and within this distance all properties hold"
        return "likely", f"{text}; farther out: {doubt}", False
    text = f"{reached(best)}; within this distance, {nearer}"
    return "partly" if near.holds else "no", text, True


def _doubt(analysis: Analysis) -> str | None:
    """What may go wrong with contacts in the region of an analysis; None: nothing. Warnings about
    the weight are left out, because the next question is about it."""
    failing = [one for one in analysis.properties.values() if not one.holds]
    if failing:
        return f"with the {failing[0].shallow} palm shallow, {failing[0].binding}"
    warnings = [one for one in analysis.warnings if one != analysis.load.warning()]
    tightest = _tightest(analysis)
    if not warnings and tightest.allowed <= 0:
        return tightest.sentence()
    return warnings[0] if warnings else None


def _tightest(analysis: Analysis) -> RankedMargin:
    return next(one for one in analysis.ranking if one.quantity != "mass")


def on_load(
    limits: LoadLimits,
    best: OutcomeCounts | None,
    trial: LoadTrial | None,
    name: str,
    rough: FrictionTrial | None = None,
) -> Answer:
    """Whether the robots hold the weight: by statics, and in carries of the MuJoCo world. If the
    friction is known only roughly, `limits` and `trial` are those with the highest
    friction."""
    question = "Can these robots hold it?"
    friction = limits.scene.palm_of("left").friction
    keys = {} if rough is None else friction_keys(limits.scene, friction)
    command = command_text("load", name, keys)
    if refusal := limits.refusal():
        return Answer(question, "no", refusal, command)
    verdict: Verdict = "yes"
    texts = [limits.sentence()]
    if not limits.holds:
        reach = None if best is None else best.farthest_m
        verdict, texts = "partly", [limits.zone_sentence()]
        if best is not None and reach is not None:
            texts.append(f"{reached(best)}; within this distance {limits.within_sentence(reach)}")
            verdict = "likely" if reach <= limits.held_within_m else "partly"
    if trial is None:
        texts += [_untried()] * (best is not None)
    else:
        texts.append(_arrivals(trial))
        if trial.cause == "weight":
            verdict = "no" if trial.counts.failure_rate == 1 else "partly"
            texts += filter(None, [usual_reason(trial.counts, "mujoco")])
        elif trial.cause == "unclear" or trial.remarks:
            verdict = "partly"
        texts += trial.remarks[:1]
    if rough is not None:
        texts.append(f"all with friction {friction:g}, which permits the hardest squeeze")
    return Answer(question, verdict, "; ".join(texts), command)


def _untried() -> str:
    """Why no carry was tried in MuJoCo."""
    if hint := without_mujoco():
        return f"not tried in {hint}"
    return "not tried in MuJoCo, which refuses the scene"


def _arrivals(trial: LoadTrial) -> str:
    """How many carries in MuJoCo arrive, and whether the others fail because of the weight."""
    text = f"in MuJoCo {arrived(trial.counts)} carries arrive"
    if trial.failed and trial.light_kg is None:
        text += (
            ", not measurably fewer than in the quasistatic world, where the weight has no effect"
        )
    if trial.light is not None:
        text += f", and {arrived(trial.light)} with an object of {trial.light_kg:g} kg"
    means = {
        "none": "",
        "weight": ": the weight is the reason",
        "other": ": the weight is probably not the reason",
        "unclear": ": these carries do not show whether the weight is the reason",
    }
    return text + means[trial.cause]


def on_drops(counts: Sequence[OutcomeCounts], load: LoadTrial | None, name: str) -> Answer:
    """How often the scene fails with the best controller. Failures in MuJoCo are included unless
    they are due to the weight."""
    question = "Does it arrive reliably?"
    best = best_of(counts)
    if best is None:
        return Answer(question, "no", "no controller delivers it", command_text("carry", name))
    command = command_text("drop-rate", name, controller=best.controller)
    verdict: Verdict = "yes" if suffices(best) else "no" if best.failure_rate > 0.5 else "partly"
    text = f"{best.controller} fails in {failures(best)} of carries"
    if load is not None and load.cause in ("other", "unclear"):
        if verdict != "no":
            verdict = "no" if load.counts.failure_rate > 0.5 else "partly"
        reason = usual_reason(load.counts, "mujoco")
        failed = f"in MuJoCo, with weight and wheels, in {load.failed} of {load.counts.carries}"
        text = "; ".join(filter(None, [text, failed, reason]))
    return Answer(question, verdict, text, command)


def on_controllers(counts: Sequence[OutcomeCounts], name: str, scene: Scene) -> Answer:
    """Which controllers suffice, and what each of them needs."""
    question = "Which controllers suffice?"
    key: str | None = swept(scene, NOISE_KEY)
    noise = value_of(scene, str(key))
    values = [min(factor * noise, MOST_M_S) for factor in (1, 2, 4)] if noise else None
    command = command_text("compare", name, sweep=key if noise else None, values=values)
    enough = [one.controller for one in counts if suffices(one)]
    if not enough:
        text = f"no controller is shown to fail in at most {100 * SMALL:g} % of carries"
        return Answer(question, "no", text, command)
    text = ", ".join(enough)
    return Answer(question, "yes" if RECOMMENDED in enough else "partly", text, command)


def needs_table(counts: Sequence[OutcomeCounts], scene: Scene) -> Table | None:
    """What each controller that suffices needs, and whether the zero zone is wide enough."""
    if on_one_palm(scene):  # controllers have nothing to do
        return None
    needs = {
        one.controller: describe(one.controller).requirements for one in counts if suffices(one)
    }
    if not needs:
        return None
    some = [own for own in needs.values() if own]
    common = [need for need in some[0] if all(need in own for own in some)] if some[1:] else []
    label = " but ".join(["  all", *(one for one, own in needs.items() if not own)])
    rows = [(label, need) for need in common]
    rows += [
        (f"  {one}", need.replace(WIDE_ZONE, f"{WIDE_ZONE} ({_widths(scene, one)})"))
        for one, own in needs.items()
        for need in own or ("",)
        if need not in common
    ]
    return Table(rows, ("  controller", "needs"))


def _widths(scene: Scene, controller: str) -> str:
    zone, overrun = zero_zone_m(scene), overrun_m(scene, controller)
    return f"here: {millimetres(zone)}, overrun {millimetres(overrun)}"


def counts_table(counts: Sequence[OutcomeCounts]) -> Table | None:
    """Drops and stalls by controller."""
    if not counts:
        return None
    heads = ("  controller", "drops", "stalls", "carries")
    rows = [
        (f"  {one.controller}", rate_text(one.dropped, one.carries),
         rate_text(one.stalled, one.carries), f"{one.carries:,}")
        for one in counts
    ]  # fmt: skip
    return Table(rows, heads)
