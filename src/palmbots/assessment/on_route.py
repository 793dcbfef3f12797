# SPDX-License-Identifier: Apache-2.0
"""Answers about a route, which takes several jobs: how many, what limits them, and how often whole
routes fail with each controller."""

from __future__ import annotations

from collections.abc import Sequence

from palmbots._util.text import millimetres, plural
from palmbots._util.time_left import TimeLeft
from palmbots.assessment.answer import Answer, Verdict, best_of, failures
from palmbots.errors import SceneError
from palmbots.mujoco.route_carry import plan_route
from palmbots.mujoco.route_plan import RoutePlan
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.carry_ends import usual_reason
from palmbots.simulation.outcome_counts import OutcomeCounts
from palmbots.simulation.worlds import DEFAULT_WORLD

ROUTES = 50
"""Routes of each controller."""


def plan_each(scene: Scene, names: Sequence[str], left: TimeLeft) -> tuple[RoutePlan, ...]:
    """The route with each of these controllers that can follow it, and how often it fails.

    Raises:
        SceneError: none can.
    """
    report = left.begin("counts")
    found: list[RoutePlan] = []
    refusal = None
    for k, name in enumerate(names):
        try:
            found.append(
                plan_route(
                    scene, name, routes=ROUTES,
                    on_progress=lambda done, k=k: report((k + done) / len(names)),
                )
            )  # fmt: skip
        except SceneError as error:  # perhaps of this controller only
            refusal = error
    if not found and refusal is not None:
        raise refusal
    return tuple(found)


def counts_of(plans: Sequence[RoutePlan]) -> tuple[OutcomeCounts, ...]:
    """How whole routes end."""
    return tuple(plan.counts for plan in plans if plan.counts is not None)


def one_job(scene: Scene, plans: Sequence[RoutePlan]) -> Scene:
    """A job as long as the longest stage, on a straight path."""
    longest_m = max(stage.length_m for plan in plans for stage in plan.stages)
    return load_scene(scene, {"task.route": None, "task.distance_m": longest_m})


def route_answers(plans: Sequence[RoutePlan], name: str) -> dict[str, Answer]:
    """The answers by their names in `Answers`; none without a route."""
    if not plans:
        return {}
    counts = counts_of(plans)
    best = best_of(counts)
    plan = next((one for one in plans if best and one.controller == best.controller), plans[0])
    command = command_text("route", name, controller=plan.controller)
    worst_m = max(stage.worst_m for stage in plan.stages)
    verdict, fails = _on_failures(best)
    never = [one.controller for one in counts if one.failure_rate == 0]
    found: dict[str, tuple[str, Verdict, str]] = {
        "drops": ("Does it arrive reliably?", verdict, fails),
        "controllers": (
            "Which controllers suffice?", "likely" if never else "no",
            f"none of {ROUTES} routes fails with {', '.join(never)}" if never
            else f"each controller fails in some of {ROUTES} routes",
        ),
        "curve": (
            "Does it survive a curve?", verdict,
            f"the route takes {plural(len(plan.stages), 'stage')} with {plan.controller}, "
            f"{plan.length_m:.2f} m; in each the object is put down before it drifts off: forecast "
            f"drift at most {millimetres(worst_m)} of the {millimetres(plan.budget_m)} permitted",
        ),
    }  # fmt: skip
    found |= {
        key: (question, "open", "this is tried with single jobs only, and a route takes several")
        for key, question in (
            ("angles", "Are the palm angles right?"),
            ("radio", "Does it survive lost messages?"),
            ("change", "Does one change help?"),
        )
    }
    return {key: Answer(*words, command) for key, words in found.items()}


def _on_failures(best: OutcomeCounts | None) -> tuple[Verdict, str]:
    """Whether whole routes arrive, and how often they fail with the best controller."""
    if best is None:
        return "no", "no route arrives with any shipped controller"
    text = f"{best.controller} fails in {failures(best)} of routes"
    if reason := usual_reason(best, DEFAULT_WORLD):
        text += f"; {reason}"
    rate = best.failure_rate
    return ("likely" if rate == 0 else "no" if rate > 0.5 else "partly"), text
