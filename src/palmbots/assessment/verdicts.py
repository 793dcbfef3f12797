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
    suffices,
    swept,
)
from palmbots.assessment.friction import FrictionTrial, friction_keys
from palmbots.assessment.load import LoadTrial
from palmbots.control.dead_band import overrun_m, zero_zone_m
from palmbots.control.registry import WIDE_ZONE, describe
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.mechanics.load_limits import LoadLimits
from palmbots.mujoco.curve_trial import respelled
from palmbots.mujoco.engine import without_mujoco
from palmbots.scene.scene import Scene
from palmbots.scene.sides import value_of
from palmbots.simulation.noise_limit import MOST_M_S, NOISE_KEY
from palmbots.simulation.outcome_counts import SMALL, OutcomeCounts
from palmbots.simulation.reason_words import usual_reason
from palmbots.stability.analysis import Analysis
from palmbots.stability.tightest_margins import RankedMargin


def on_mechanics(
    analysis: Analysis, near: Analysis | None, best: OutcomeCounts | None, name: str
) -> Answer:
    """Whether the palms lift and hold the object, and what is tightest.

    `near` is the analysis for contacts no farther out than in the carries with the best controller;
    None: no carry delivers. A property that fails only farther out does not count against the
    scene.
    """
    question, command = "Can palms hold it?", f"palmbots analyze {name}"
    if analysis.lifting is not None and not analysis.lifting.works:
        return Answer(question, "no", analysis.lifting.refusals[0], command)
    doubt = _doubt(analysis)
    if doubt is None:
        tightest = _tightest(analysis)
        text = f"tightest margin: {tightest.sentence()}"
        if tightest.quantity == "contact" and (tightest.times or 1.0) < 1.0:
            text += "; so the robots have to correct it"
        return Answer(question, "yes", text, command)
    if near is None or best is None or best.farthest_m is None:
        return Answer(question, "partly" if analysis.holds else "no", doubt, command)
    reach = best.farthest_m
    where = f"{best.controller} keeps the contacts within {millimetres(reach)} of the pivots"
    if (nearer := _doubt(near)) is None:
        text = f"{where}, and there all properties hold; farther out: {doubt}"
        return Answer(question, "likely", text, command)
    command += f" --region {-reach:.3g},{reach:.3g}"
    return Answer(question, "partly" if near.holds else "no", f"{where}; there, {nearer}", command)


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
    question, command = "Can these robots hold it?", f"palmbots load {name}"
    friction = limits.scene.palm_of("left").friction
    if rough is not None:
        command = f"palmbots load {respelled(name, friction_keys(limits.scene, friction))}"
    if refusal := limits.refusal():
        return Answer(question, "no", refusal, command)
    verdict: Verdict = "yes"
    texts = [limits.sentence()]
    if not limits.holds:
        reach = None if best is None else best.farthest_m
        verdict, texts = "partly", [limits.zone_sentence()]
        if best is not None and reach is not None:
            texts.append(
                f"{best.controller} keeps the contacts within {millimetres(reach)} of the "
                f"pivots; there {limits.within_sentence(reach)}"
            )
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
        return Answer(question, "no", "no controller delivers it", f"palmbots carry {name}")
    command = f"palmbots drop-rate {name} -c {best.controller}"
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
    question, command = "Which controllers suffice?", f"palmbots compare {name}"
    key = swept(scene, NOISE_KEY)
    if noise := value_of(scene, key):
        noises = ",".join(f"{min(factor * noise, MOST_M_S):g}" for factor in (1, 2, 4))
        command += f" --sweep {key} --values {noises}"
    enough = [one.controller for one in counts if suffices(one)]
    if not enough:
        text = f"no controller is shown to fail in at most {100 * SMALL:g} % of carries"
        return Answer(question, "no", text, command)
    text = ", ".join(enough)
    return Answer(question, "yes" if RECOMMENDED in enough else "partly", text, command)


def needs_table(counts: Sequence[OutcomeCounts], scene: Scene) -> Table | None:
    """What each controller that suffices needs, and whether the zero zone is wide enough."""
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
