# SPDX-License-Identifier: Apache-2.0
"""One page on a scene: will it be carried, how often will it drop, and what should be changed?

Each answer comes from the function behind the command that it names and, where carries are
counted, from carries of this scene. Nothing is taken from the default scene.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

from palmbots._types import Interval, Overrides
from palmbots._util.command import Option, command
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table
from palmbots._util.results import Result
from palmbots._util.time_left import TimeLeft
from palmbots.assessment import counted
from palmbots.assessment.angles import AngleTrial, NoPair, try_angles
from palmbots.assessment.answer import (
    WORDS,
    Answer,
    Verdict,
    best_of,
    failures,
)
from palmbots.assessment.assumptions import assumptions_table, deciding_keys, on_assumptions
from palmbots.assessment.change_trial import ChangeTrial, NoChange
from palmbots.assessment.changes import try_changes, with_drift
from palmbots.assessment.counted import carries_of_curve, count_each
from palmbots.assessment.friction import (
    FrictionTrial,
    hardest_to_hold,
    interval_of_friction,
    try_friction,
)
from palmbots.assessment.load import LOAD_CARRIES, LoadTrial, try_load
from palmbots.assessment.on_route import counts_of, one_job, plan_each, route_answers
from palmbots.assessment.one_palm import one_palm_answers
from palmbots.assessment.radio import RadioTrial, try_losses
from palmbots.assessment.raised_noise import revealing_noise
from palmbots.assessment.side_effects import least_sound, near_pivots
from palmbots.assessment.verdicts import (
    counts_table,
    needs_table,
    on_controllers,
    on_drops,
    on_load,
    on_mechanics,
)
from palmbots.assessment.what_if import (
    costs_table,
    on_angles,
    on_change,
    on_curve,
    on_friction,
    on_radio,
    radio_table,
)
from palmbots.control.registry import shipped_names
from palmbots.control.tolerated_noise import RECOMMENDED
from palmbots.errors import PalmbotsError
from palmbots.mechanics.load_limits import load_limits
from palmbots.mechanics.lone import on_one_palm
from palmbots.mujoco.curve_trial import (
    CurveTrial,
    tried_turn,
    try_curve,
)
from palmbots.mujoco.engine import without_mujoco
from palmbots.scene.command_text import command_text, respelled
from palmbots.scene.path_section import Path
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.outcome_counts import OutcomeCounts, default_carries
from palmbots.simulation.prepare import check_palms, prepare
from palmbots.stability.analysis import Analysis, analyze
from palmbots.stability.holding import Holding, holding

QUESTIONS = (
    "carried", "load", "drops", "controllers", "angles", "friction", "radio", "curve", "change",
    "assumed",
)  # fmt: skip
"""Fields of `Answers`, in the order of the page."""
_PARTS = ("counts", "friction", "load", "angles", "radio", "curve", "change")
_USUAL_TURN = {"turn_radius_m": 1.0, "turn_angle_deg": 90.0}
_LONG_S = 60.0
_OF_CARRIES = ("drops", "controllers", "angles", "radio", "curve")


@dataclass(frozen=True)
class Answers:
    """The answers in words, in the order in which they matter."""

    carried: Answer
    load: Answer
    drops: Answer
    controllers: Answer
    angles: Answer
    friction: Answer
    radio: Answer
    curve: Answer
    change: Answer
    assumed: Answer


@dataclass(frozen=True, repr=False)
class Assessment(Result):
    """What a user needs to know about a scene, and the numbers behind it."""

    answers: Answers
    counts: tuple[OutcomeCounts, ...]
    """Of all shipped controllers that accept the scene, on the same seeds; on a straight path."""
    angles: AngleTrial | None
    """None: no carry is delivered, no other pair of angles qualifies, or carries take too long."""
    load: LoadTrial | None
    """None: no carry can begin, or the MuJoCo world refuses the scene."""
    friction: FrictionTrial | None
    """None: no interval was given."""
    radio: tuple[RadioTrial, ...]
    """By the share lost, of the controllers that use a radio and suffice, else of the best one."""
    curve: CurveTrial | None
    """None: not tried."""
    change: ChangeTrial | None
    """The best change of one thing; None: none could be tried."""
    scene: Scene
    analysis: Analysis = field(metadata=NOT_IN_JSON)
    deciding: tuple[str, ...] = ()
    """Keys on which answers depended in this scene, besides those that always matter."""
    held: Holding | None = field(default=None, metadata=NOT_IN_JSON)
    """The first line of `analyze` and `load`; with an interval of friction, where it is worst."""

    @derived
    def verdict(self) -> Verdict:
        """Whether the object will be carried: the worst of the first three answers, of the one on
        the curve if the scene has one, and of the one on friction with an interval of it."""
        order: tuple[Verdict, ...] = ("no", "partly", "open", "likely", "yes")
        first = [self.answers.carried, self.answers.load, self.answers.drops]
        first += [self.answers.curve] * self.scene.task.path.is_curved
        first += [self.answers.friction] * (self.friction is not None)
        return min([answer.verdict for answer in first], key=order.index)

    @derived
    def controller(self) -> str | None:
        """The one to use: the recommended one if it suffices, else the one that fails least often.
        None: no carry is delivered."""
        best = best_of(self.counts)
        return None if best is None else best.controller

    @property
    def conclusion(self) -> str:
        """The verdict in one sentence: what speaks against the scene, and what to use."""
        best = best_of(self.counts)
        if best is None:
            if self.scene.task.ends != ("palms", "palms") and self.answers.carried.verdict == "no":
                return "the object cannot be picked up and put down"
            if self.answers.load.verdict == "no":
                return "the object is too heavy for these robots"
            return "no carry arrives with any shipped controller"
        what = "routes" if self.scene.task.route.is_set else "carries"
        use = f"use {best.controller}: it fails in {failures(best)} of {what}"
        doubts = []
        if self.load is not None and self.load.cause == "other":
            doubts.append("in MuJoCo it fails more often, also with a light object")
        doubts += [
            words
            for answer, words in (
                (self.answers.carried, "the object is not held in every state that may occur"),
                (self.answers.load, self._doubt_of_load()),
                (self.answers.friction, "it may fail with some friction within the interval"),
            )
            if answer.verdict in ("no", "partly")
        ]
        if self.scene.task.path.is_curved:
            use += " on a straight path"
            if self.answers.curve.verdict == "open":
                use += "; its curve was not tried"
            elif self.curve is not None and self.curve.counts is not None:
                use += f", and in {failures(self.curve.counts)} on its curve, in MuJoCo"
            else:
                doubts.append("on its curve the object would tip sideways")
        if (held := self.held) is not None and held.word != "HOLDS":
            use += f"; for contacts anywhere on the palms, the result is {held.word}: {held.text}"
        return "; ".join([*doubts, use])

    def _doubt_of_load(self) -> str:
        """What speaks against the weight, no more definite than the trials show."""
        cause = "none" if self.load is None else self.load.cause
        if cause == "weight":
            return "the object is too heavy for these robots"
        if cause == "unclear":
            return "it fails more often in MuJoCo, perhaps because of its weight"
        scene = self.scene
        if self.friction is not None:
            scene = hardest_to_hold(scene, self.friction.friction)
        limits = load_limits(scene)
        if limits.held_within_m < limits.reach_m:
            return "the object may be too heavy for these robots"
        if self.load is not None and self.load.remarks:
            return "in MuJoCo wheels slip, or robots drive too fast"
        return "wheels may slip under the load"

    def paragraphs(self) -> Iterator[tuple[Answer, Table | None]]:
        """Each answer, and the numbers behind it."""
        friction = None if self.friction is None else self.friction.friction
        tables = {
            "drops": counts_table(self.counts),
            "controllers": needs_table(self.counts, self.scene),
            "radio": radio_table(self.radio),
            "change": costs_table(self.change),
            "assumed": assumptions_table(self.scene, friction, self.deciding),
        }
        for name in QUESTIONS:
            yield getattr(self.answers, name), tables.get(name)

    def lines(self) -> Iterator[Item]:
        """The verdict, then a paragraph for each question."""
        yield Line(WORDS[self.verdict], f"  {self.conclusion}")
        for answer, table in self.paragraphs():
            yield from answer.lines(table)


@command(
    order=15,
    example="palmbots assess scene.toml --out report.html",
    progress="assessing",
    friction=Option(),
    turn_radius_m=Option(least=0.0, most=100.0),
    turn_angle_deg=Option(least=7.0, most=360.0),
)
def assess(
    scene: SceneLike = "paper",
    *,
    friction: Interval | None = None,
    turn_radius_m: float = 1.0,
    turn_angle_deg: float = 90.0,
    overrides: Overrides = None,
    on_progress: Callable[[float], None] | None = None,
    on_line: Callable[[str], None] | None = None,
) -> Assessment:
    """Answer on one page whether and how often a scene fails.

    It counts how carries of this scene end with every shipped controller, with other palm angles,
    with lost messages, on a curve, and with single changes.

    Args:
        scene: as in `palmbots.carry`.
        friction: lowest and highest friction between palms and object, if you know it only roughly;
            None: as in the scene.
        turn_radius_m: radius of the turn that is tried in the MuJoCo world if the path is straight;
            0: no curve is tried.
        turn_angle_deg: angle of this turn.
        overrides: scene keys to set.
        on_progress: called with the completed fraction, which follows the time on this machine.
        on_line: called with each question and the first word of its answer as soon as it is known,
            if it takes over a minute to know all of them.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: another argument is not allowed.
    """
    chosen = load_scene(scene, overrides)
    is_on_one = on_one_palm(chosen)
    if is_on_one and friction is not None:
        raise PalmbotsError(
            "friction: an interval is tried with two palms, and one palm at a time holds this "
            "object; allowed: none, or palm.friction set to either end"
        )
    name = chosen.spelled
    planar = respelled(name, {"task.path.kind": "straight"} if chosen.task.path.is_curved else {})
    interval = None if friction is None else interval_of_friction(chosen, friction)
    path = tried_turn(chosen, turn_radius_m, turn_angle_deg)
    if on_line is not None and (hint := without_mujoco()):
        on_line(f"nothing is tried in {hint}")
    left = TimeLeft(on_progress or (lambda fraction: None), _PARTS)
    names = (RECOMMENDED,) if is_on_one else shipped_names()
    plans = plan_each(chosen, names, left) if chosen.task.route.is_set else ()
    straight = one_job(chosen, plans) if plans else _straightened(chosen)
    check_palms(to_spec(straight))
    analysis = analyze(straight)
    worst = least_sound(straight, interval)
    worst_mu = None if interval is None else worst.scene.palm_of("left").friction
    asked = {"turn_radius_m": turn_radius_m, "turn_angle_deg": turn_angle_deg}
    given = {"friction": interval, **{k: v for k, v in asked.items() if v != _USUAL_TURN[k]}}
    answers: dict[str, Answer] = {}

    def known(name: str, answer: Answer) -> None:
        answer = answers[name] = special.get(name, answer)
        if on_line is not None and left.total_s > _LONG_S:
            on_line(f"{answer.question} {answer.word}")

    counts = counts_of(plans) if plans else count_each(straight, names, left)
    best = best_of(counts)
    special = one_palm_answers(straight, planar) if is_on_one else route_answers(plans, name)
    known("carried", on_mechanics(worst, near_pivots(worst.scene, best), best, planar, worst_mu))
    known("controllers", on_controllers(counts, planar, straight))
    rough, loaded = None, chosen
    left.begin("friction")
    if interval is not None:
        rules = best.controller if best else None
        rough = try_friction(analysis, interval, rules, counts[0].carries if counts else 0)
        loaded = hardest_to_hold(chosen, interval)
    known("friction", on_friction(rough, analysis, planar, given))
    angles: AngleTrial | NoPair | None = None
    curve = load = None
    change: ChangeTrial | NoChange | None = None
    report = left.begin("load")
    if best is not None:
        heavy = one_job(loaded, plans) if plans else _straightened(loaded)
        load = try_load(heavy, best, LOAD_CARRIES, report)
        left.expect(curve=left.spent_s() / LOAD_CARRIES * carries_of_curve())
    known("load", on_load(load_limits(loaded), best, load, name, rough))
    known("drops", on_drops(counts, load, planar))
    report = left.begin("angles")
    if best is not None and "angles" not in special:
        count = default_carries(prepare(straight, best.controller))
        noise = revealing_noise(straight, best.controller, count) if count else None
        angles = try_angles(
            straight, best.controller, report, noise=noise or 1.0, friction=interval
        )
    known("angles", on_angles(angles, planar, straight, best, interval))
    report = left.begin("radio")
    radio = () if "radio" in special else tuple(try_losses(straight, counts, report))
    known("radio", on_radio(radio, counts, planar, straight))
    report = left.begin("curve")
    if best is not None and turn_radius_m > 0 and "curve" not in special:
        curve = try_curve(chosen, best.controller, path, report, carries=counted.CURVE_CARRIES)
    known("curve", on_curve(curve, best, chosen))
    report = left.begin("change")
    if "change" not in special and (best is not None or load_limits(straight).refusal()):
        change = try_changes(
            straight,
            best.controller if best else RECOMMENDED,
            angles.keys if isinstance(angles, AngleTrial) else {},
            best.farthest_m if best else None,
            report,
            friction=interval,
        )
    if isinstance(change, ChangeTrial) and change.is_better and curve is not None:
        change = with_drift(change, curve, chosen)
    known("change", on_change(change, planar, straight, given))
    trial = change if isinstance(change, ChangeTrial) else None
    deciding = deciding_keys(worst, counts, trial, curve)
    known("assumed", on_assumptions(chosen, interval, deciding))
    report(1.0)
    if not counts:
        refused = _refused(straight)
        answers |= {name: replace(answers[name], **refused) for name in _OF_CARRIES}
    pairs = angles if isinstance(angles, AngleTrial) else None
    found = Answers(**answers)
    return Assessment(
        found,
        counts,
        pairs,
        load,
        rough,
        radio,
        curve,
        trial,
        chosen,
        analysis,
        deciding,
        holding(worst),
    )


def _refused(scene: Scene) -> dict[str, str]:
    """Text and command of the answers on carries where none can begin."""
    command = "load" if load_limits(scene).refusal() else "carry"
    return {"text": "no carry can begin", "command": command_text(command, scene.spelled)}


def _straightened(scene: Scene) -> Scene:
    return scene.model_copy(update={"task": scene.task.model_copy(update={"path": Path()})})
