# SPDX-License-Identifier: Apache-2.0
"""What `assess` says of trials that are made by hand: rows of a trial, its verdict and words.

Words after ``not: `` must not occur.
"""

import ast
import math
import re
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import rate_text
from palmbots._util.report import as_text
from palmbots.assessment.angles import AngleTrial, NoPair
from palmbots.assessment.answer import (
    Answer,
    best_of,
)
from palmbots.assessment.assess import QUESTIONS, Answers, Assessment
from palmbots.assessment.change_trial import ChangeTrial, NoChange
from palmbots.assessment.friction import FrictionTrial
from palmbots.assessment.load import LoadTrial
from palmbots.assessment.radio import RadioTrial
from palmbots.assessment.side_effects import (
    known_warnings,
    least_sound,
    near_pivots,
    new_warnings,
)
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
from palmbots.cli.declared_commands import declared_commands
from palmbots.mujoco.curve_trial import CurveTrial
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.scene.command_text import command_text, respelled
from palmbots.simulation.outcome_counts import OutcomeCounts

PAPER = pb.load_scene("paper")


def counts(
    controller: str, failed: int, of: int = 1000, *, stalled: int = 0, reach: float | None = 0.01
) -> OutcomeCounts:
    reasons = {"off-palm": failed - stalled} if failed > stalled else {}
    farthest = None if failed == of else reach
    return OutcomeCounts(controller, of, failed - stalled, stalled, farthest, reasons)


def check(answer: Answer, verdict: str, words: list[str]) -> None:
    assert answer.verdict == verdict, answer
    for word in words:
        if word.startswith("not: "):
            assert word[5:] not in answer.text, answer
        else:
            assert word in answer.text, answer


GOOD, POOR, BAD = (counts("shared-sign", n) for n in (0, 100, 700))


def test_best_controller() -> None:
    """The recommended one if it suffices, else the one that fails least, never one that always
    fails."""
    silent = counts("silent", 0)
    assert best_of([silent, GOOD]) == GOOD
    assert best_of([silent, POOR]) == silent
    assert best_of([POOR, counts("silent", 90)]) == counts("silent", 90)
    assert best_of([counts("none", 1000)]) is best_of([]) is None


NEAR = "in 1,000 carries with shared-sign no contact got farther from its pivot than 10.0 mm"
WITHIN = f"{NEAR}; within this distance"
FAST = {"task.inertia": True, "robot.acceleration_m_s2": 0.8}
LOW, TALL = {"object.box_m": [0.2, 0.1]}, {"object.box_m": [0.12, 0.4]}
ASIDE = {"object.com_m": [0.05, 0.04]}
MECHANICS: list[tuple[dict[str, Any], OutcomeCounts | None, str, list[str]]] = [
    ({}, GOOD, "yes", ["tightest margin: a contact leaves", "not: so the robots have to correct"]),
    ({"robot.noise_m_s": 0.02}, GOOD, "yes", ["tightest margin", "the robots have to correct it"]),
    ({"object.mass_kg": 3}, GOOD, "yes", ["not: kg"]),
    # what fails only where no contact gets
    (FAST, GOOD, "likely", [f"{NEAR}, and within this distance all", "farther out: robot.accel"]),
    (LOW, GOOD, "likely", [NEAR, "farther out: a palm touches the object already, by 0.57°"]),
    (TALL, GOOD, "likely", [NEAR, "farther out: with the left palm shallow, on closing"]),
    (FAST, None, "partly", ["robot.acceleration_m_s2 is 0.8", "not: no contact"]),
    (LOW, None, "partly", ["a palm touches the object already"]),
    (TALL, None, "no", ["with the left palm shallow, on closing"]),
    # what fails there, too
    (FAST | {"robot.acceleration_m_s2": 2.0}, GOOD, "partly", [f"{WITHIN}, robot."]),
    (ASIDE, GOOD, "no", [f"{WITHIN}, with the left palm shallow, "]),
]  # fmt: skip


@pytest.mark.parametrize(("keys", "best", "verdict", "words"), MECHANICS)
def test_mechanics(
    keys: dict[str, Any], best: OutcomeCounts | None, verdict: str, words: list[str]
) -> None:
    scene = pb.load_scene("paper", {"task.inertia": False} | keys)
    near = near_pivots(scene, best)
    answer = on_mechanics(pb.analyze(scene), near, best, "SCENE")
    check(answer, verdict, words)
    region = " --region -0.01,0.01" if any(f"{WITHIN}, " in word for word in words) else ""
    assert answer.command == f"palmbots analyze SCENE{region}"


def test_mechanics_are_those_of_the_worst_friction_that_was_given() -> None:
    """With a friction of 0.32 the paper's box holds at any acceleration that its robots reach."""
    keys = {"robot.acceleration_m_s2": 0.75, "task.inertia": True}
    scene = pb.load_scene("paper", keys)
    worst = least_sound(scene, (0.3, 0.6))
    assert not pb.analyze(scene).warnings and worst.warnings
    assert worst.scene.palm.friction == 0.6
    given, rough = (known_warnings(scene, "shared-sign", one) for one in (None, (0.3, 0.6)))
    assert len(rough) == len(given) + 1
    faster = pb.load_scene(scene, {"robot.acceleration_m_s2": 0.76})  # the same warning
    assert not new_warnings(rough, faster, "shared-sign", (0.3, 0.6))
    assert len(new_warnings(given, faster, "shared-sign", (0.3, 0.6))) == 1
    answer = on_mechanics(worst, near_pivots(worst.scene, GOOD), GOOD, "SCENE", 0.6)
    check(answer, "likely", ["all this with a friction of 0.6, the worst of the interval if it is"])
    assert answer.command == "palmbots analyze SCENE --set palm.friction=0.6"


def load(
    failed: int,
    light: int | None = None,
    remarks: tuple[str, ...] = (),
    stalled: int = 0,
    of: int = 5,
) -> LoadTrial:
    other = None if light is None else counts("shared-sign", light, of)
    mass = None if light is None else 0.1
    mine = counts("shared-sign", failed, of, stalled=stalled)
    return LoadTrial(mine, 0.0, 0.06, remarks, other, mass)


NOT_WEIGHT, WEIGHT = "the weight is probably not the reason", "the weight is the reason"
UNCLEAR = "do not show whether the weight"
LOADS: list[tuple[float, OutcomeCounts | None, LoadTrial | None, str, list[str]]] = [
    # light enough for contacts anywhere
    (0.5, GOOD, load(0), "yes", ["heaviest object 0.915 kg", "5 of 5 carries", "not: weight"]),
    (0.5, GOOD, None, "yes", ["not tried in MuJoCo"]),
    (0.5, None, None, "yes", ["not: MuJoCo"]),
    (0.5, BAD, load(4), "yes", ["1 of 5", "not measurably fewer", "not: off-palm"]),
    (0.5, GOOD, load(5, 5), "yes", ["0 of 5 carries arrive, and 0 of 5 with", NOT_WEIGHT]),
    (0.5, GOOD, load(4, 5), "yes", [NOT_WEIGHT]),
    (0.5, GOOD, load(5, 0), "no", ["and 5 of 5 with an object of 0.1 kg", WEIGHT, "off-palm"]),
    (0.5, GOOD, load(5, 0, stalled=5), "no", [WEIGHT]),
    (0.5, GOOD, load(18, 2, of=20), "partly", ["2 of 20 carries arrive, and 18 of 20", WEIGHT]),
    (0.5, GOOD, load(2, 0), "partly", [UNCLEAR]),
    (0.5, GOOD, replace(load(2, 0), light=None), "partly", ["3 of 5 carries arrive: ", UNCLEAR]),
    (0.5, GOOD, load(4, 3), "partly", [UNCLEAR, "not: off-palm"]),
    (0.5, GOOD, load(0, None, ("wheels slip", "more")), "partly", ["; wheels slip", "not: more"]),
    # held where the contacts get, and not there
    (2, GOOD, load(0), "likely", [f"{WITHIN} ", "above 4.75 kg", "a wheel slips above"]),
    (2, GOOD, load(5, 5), "likely", [NOT_WEIGHT]),
    (2, counts("shared-sign", 0, reach=0.07), load(0), "partly", ["than 70.0 mm"]),
    (2, counts("shared-sign", 0, reach=None), load(0), "partly", ["not: no contact"]),
    (2, None, None, "partly", ["no robot tips", "not: no contact"]),
    # beyond what a carry can begin with
    (500, None, None, "no", ["object.mass_kg: value is 500", "at most 6.42 kg"]),
]  # fmt: skip


def test_without_mujoco_the_command_that_installs_it_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    limits = pb.load_limits("paper")
    refused = on_load(limits, GOOD, None, "SCENE").text
    assert refused.endswith("; not tried in MuJoCo, which refuses the scene")
    monkeypatch.setitem(sys.modules, "mujoco", None)
    text = on_load(limits, GOOD, None, "SCENE").text
    run = f"run: {sys.executable} -m pip install 'mujoco>="
    assert f"; not tried in MuJoCo, which is not installed; {run}" in text
    said: list[str] = []
    keys = {"task.distance_m": 0.05}
    found = pb.assess(overrides=keys, on_line=said.append)
    assert said[0].startswith("nothing is tried in MuJoCo, which is not installed; ")
    assert run in found.answers.load.text and run in found.answers.curve.text


@pytest.mark.parametrize(("mass", "best", "trial", "verdict", "words"), LOADS)
def test_load(
    mass: float, best: OutcomeCounts | None, trial: LoadTrial | None, verdict: str, words: list[str]
) -> None:
    limits = pb.load_limits(overrides={"object.mass_kg": mass})
    answer = on_load(limits, best, trial, "SCENE")
    check(answer, verdict, [*words, "not: with friction"])
    assert answer.command == "palmbots load SCENE"
    rough = FrictionTrial((0.2, 0.3), "holds", "holds", None, ())
    worse = on_load(limits, best, trial, "SCENE", rough)
    assert worse.verdict == verdict
    assert (
        mass == 500
        or worse.text == f"{answer.text}; all with friction 0.3, which permits the hardest squeeze"
    )
    assert worse.command == "palmbots load SCENE --set palm.friction=0.3"


DROPS: list[tuple[list[OutcomeCounts], LoadTrial | None, str, list[str]]] = [
    ([GOOD], None, "yes", ["shared-sign fails in < 0.3 % of carries", "not: MuJoCo"]),
    ([counts("silent", 50), POOR], None, "partly", ["silent fails in 5.0 %"]),
    ([counts("silent", 500, stalled=500)], None, "partly", ["silent fails in 50.0 %"]),
    ([counts("silent", 501, stalled=501)], None, "no", ["silent fails in 50.1 %"]),
    ([counts("none", 1000)], None, "no", ["no controller delivers it"]),
    # failures in MuJoCo count here unless they are due to the weight, or as frequent as elsewhere
    ([GOOD], load(5, 0), "yes", ["not: MuJoCo"]),
    ([BAD], load(4), "no", ["not: MuJoCo"]),
    ([GOOD], load(2, 2), "partly", ["in MuJoCo, with weight and wheels, in 2 of 5", "off-palm"]),
    ([GOOD], load(3, 4), "no", ["in 3 of 5"]),
    ([GOOD], load(3, 2), "no", ["in 3 of 5"]),
    ([BAD], load(2, 2), "no", ["in 2 of 5"]),
]


@pytest.mark.parametrize(("given", "trial", "verdict", "words"), DROPS)
def test_drops(
    given: list[OutcomeCounts], trial: LoadTrial | None, verdict: str, words: list[str]
) -> None:
    answer = on_drops(given, trial, "SCENE")
    check(answer, verdict, words)
    best = best_of(given)
    command = "carry SCENE" if best is None else f"drop-rate SCENE -c {best.controller}"
    assert answer.command == f"palmbots {command}"


CONTROLLERS: list[tuple[list[OutcomeCounts], str, str]] = [
    ([counts("none", 900), counts("silent", 0), GOOD], "yes", "silent, shared-sign"),
    ([counts("silent", 3), counts("distributed", 5), POOR], "partly", "silent"),  # 5: up to 1.2 %
    (
        [counts("silent", 900), POOR],
        "no",
        "no controller is shown to fail in at most 1 % of carries",
    ),
]


@pytest.mark.parametrize(("given", "verdict", "text"), CONTROLLERS)
def test_controllers(given: list[OutcomeCounts], verdict: str, text: str) -> None:
    answer = on_controllers(given, "SCENE", PAPER)
    assert (answer.verdict, answer.text) == (verdict, text)
    assert answer.command.endswith("--sweep robot.noise_m_s --values 0.01,0.02,0.04")
    loud = on_controllers(given, "SCENE", pb.load_scene("paper", {"robot.noise_m_s": 0.3}))
    assert loud.command.endswith(" --values 0.3,0.6,1")  # at most 1 m/s is allowed
    still = pb.load_scene("paper", {"robot.noise_m_s": 0})
    assert on_controllers(given, "SCENE", still).command == "palmbots compare SCENE"
    table = needs_table(given, PAPER)
    named = [] if table is None else list(dict.fromkeys(row[0].strip() for row in table.rows))
    if table is not None and len(named) > 1:
        assert named.pop(0) == "all" and "sensor" in str(table.rows[0][1])
    assert named == ([] if verdict == "no" else text.split(", "))


def angle_trial(own: int, best: int, least: float = 0.0, most: float = 0.5) -> AngleTrial:
    return AngleTrial("silent", 9, least, most, 1000, own, (4.0, 12.0), best, 0.5, 0.25)


OWN, BEST = "silent fails in", "at 4° and 12°"
ANGLES: list[tuple[AngleTrial | NoPair | None, str, list[str]]] = [
    (None, "open", ["no carry arrives"]),
    (NoPair("none of 25"), "open", ["none of 25"]),
    (
        angle_trial(0, 0, most=0.0),
        "yes",
        [OWN, "any of the 9 pairs tried, with 1,000 carries each, so", "not: to"],
    ),
    (angle_trial(2, 1), "yes", ["0.2 % (0.1–0.7) at the scene's angles; 0 to 50 % at the 9 pairs"]),
    (angle_trial(2, 1, 0.01, 0.02), "yes", ["1 to 2 % at the 9 pairs tried, with 1,000 carries"]),
    # not better, but not good either
    (angle_trial(700, 690, 0.6, 0.9), "partly", ["no pair that was tried is better: silent fails"]),
    (angle_trial(100, 10), "partly", [f"{OWN} 1.0 % (0.5–1.8) {BEST}, and in 10.0 % (8.3–12.0)"]),
    (angle_trial(100, 10), "partly", ["the clearance becomes 0.25° (now 0.50°)"]),
]


@pytest.mark.parametrize(("trial", "verdict", "words"), ANGLES)
def test_angles(trial: AngleTrial | NoPair | None, verdict: str, words: list[str]) -> None:
    answer = on_angles(trial, "SCENE", PAPER)
    check(answer, verdict, words)
    assert answer.command == f"palmbots design SCENE{' -c silent' * isinstance(trial, AngleTrial)}"


def test_angles_are_compared_at_a_noise_that_shows_a_difference() -> None:
    """And the text says at which; better ones are not required where carries rarely fail."""
    noisy = "at 6 times the noise (robot.noise_m_s=0.06), silent fails in "
    same = replace(angle_trial(200, 190, 0.1, 0.3), noise_factor=6.0)
    check(on_angles(same, "SCENE", PAPER, counts("silent", 0)), "yes", [f"{noisy}20.0 %"])
    check(on_angles(same, "SCENE", PAPER, counts("silent", 50)), "partly", [noisy])
    better = replace(angle_trial(200, 20), noise_factor=6.0)
    reserve = f"other angles give more reserve: {noisy}2.0 %"
    check(on_angles(better, "SCENE", PAPER, counts("silent", 0)), "yes", [reserve])
    check(on_angles(better, "SCENE", PAPER, counts("silent", 50)), "partly", [noisy])


def test_few_carries_without_a_failure_do_not_speak_against_angles() -> None:
    few = AngleTrial("silent", 9, 0.0, 0.0, 50, 0, (4.0, 12.0), 0, 0.5, 0.25)
    assert on_angles(few, "SCENE", PAPER).verdict == "partly"
    assert on_angles(few, "SCENE", PAPER, counts("silent", 30)).verdict == "partly"
    assert on_angles(few, "SCENE", PAPER, counts("silent", 0)).verdict == "yes"


def friction(alike: Any, unlike: Any, *failed: int, failing: Any = None) -> FrictionTrial:
    rates = tuple(counts("silent", n) for n in failed)
    return FrictionTrial((0.2, 0.3), alike, unlike, failing, rates)


BOTH, SOME = "any friction from 0.2 to 0.3 all properties hold", "some friction from 0.2 to 0.3"
FRICTIONS: list[tuple[FrictionTrial, str, list[str]]] = [
    (friction("holds", "holds", 0, 0), "yes", [f"{BOTH} (accelerations neglected; proved)"]),
    (friction("holds", "fails", 0, 0), "likely", ["same on both", "fails for some pairs"]),
    (friction("holds", "undecided", 0, 0, failing=(0.3, 0.2, 1)), "likely",
     ["0.3 on the left and 0.2 on the right palm property 1 fails", "not: may fail"]),
    (friction("holds", "undecided", 0, 0), "likely", ["same on both", "a property may fail"]),
    (friction("undecided", "undecided", 0, 0), "partly", [f"{SOME} a property may fail ("]),
    (friction("undecided", "fails", 0, 0), "partly", [f"{SOME} a property may", "not: proved"]),
    (friction("fails", "fails", 0, 0), "no",
     [f"{SOME} a property fails", "not: proved", "properties 1 and 2 hold from 0.094 to 1.046"]),
    (friction("holds", "holds", 0, 90), "partly", ["< 0.3 % with friction 0.2 and in 9.0 %"]),
    (friction("holds", "fails", 90, 0), "partly", ["9.0 % (7.4–10.9) with friction 0.2 and in <"]),
    (friction("fails", "fails", 90, 0), "no", []),
    (friction("holds", "holds"), "yes", ["not: silent"]),
]  # fmt: skip


@pytest.mark.parametrize(("trial", "verdict", "words"), FRICTIONS)
def test_friction(trial: FrictionTrial, verdict: str, words: list[str]) -> None:
    answer = on_friction(trial, pb.analyze("paper"), "SCENE")
    check(answer, verdict, words)
    alike = " --common-friction" * (trial.alike == "holds" != trial.unlike)
    assert answer.command == f"palmbots certify SCENE --friction 0.2 0.3{alike}"


def test_friction_that_was_not_given() -> None:
    answer = on_friction(None, pb.analyze("paper"), "SCENE")
    check(answer, "open", ["hold for friction from 0.094 to 1.046", "use --friction"])
    assert answer.command == "palmbots assess SCENE --friction 0.27 0.33"


def change(**given: Any) -> ChangeTrial:
    usual: dict[str, Any] = {
        "controller": "silent", "tried": 9, "changes": {"robot.speed_m_s": 0.084},
        "before": {"robot.speed_m_s": 0.06}, "noise_factor": 1.0, "carries": 1000,
        "own_failures": 100, "failures": 10, "own_holds": True, "holds": True,
        "own_heaviest_kg": 1.0, "heaviest_kg": 2.0, "own_time_s": 25.0, "time_s": 25.0,
        "own_messages": 100.0, "messages": 100.0,
    }  # fmt: skip
    return ChangeTrial(**usual | given)


HEAVY = {"changes": {"mujoco.body_kg": 4.0}, "before": {"mujoco.body_kg": 3.0}}
CHANGES: list[tuple[ChangeTrial | NoChange | None, str, list[str]]] = [
    (None, "open", ["no carry arrives"]),
    (NoChange("no noise"), "open", ["no noise"]),
    (NoChange("weak", is_for_load=True), "no", ["weak"]),
    (change(), "yes", ["robot.speed_m_s from 0.06 to 0.084: silent fails in 1.0 %", "not: noise"]),
    (change(), "yes", ["instead of 10.0 %", "not: time of", "not: messages of", "not: reserve"]),
    (change(failures=90), "no", ["silent fails in 10.0 %", "none of the 9 changes"]),
    (change(noise_factor=2.0), "yes", ["more reserve: robot.", "(robot.noise_m_s=0.02), silent"]),
    (change(own_holds=False), "yes", ["; then all properties hold"]),
    (change(own_holds=False, holds=False), "yes", ["not: properties"]),
    (change(own_holds=False, noise_factor=2.0), "yes", ["all properties hold", "not: reserve"]),
    (change(time_s=18.0), "yes", ["time of a carry  25 s  18 s", "not: messages of"]),
    (change(time_s=24.0), "yes", ["not: time of"]),  # 4 %
    (change(time_s=26.4), "yes", ["time of a carry  25 s  26 s"]),  # 6 %
    (change(messages=50.0), "yes", ["messages of a carry  100  50", "not: time of"]),
    (change(messages=50.0), "yes", ["not: own noise"]),
    (change(messages=50.0, noise_factor=6.0), "yes",
     ["at 6 times the noise (robot.noise_m_s=0.06), silent",
      "other effects, at the scene's own noise  as it is  changed"]),
    (change(own_messages=None), "yes", ["not: messages of"]),
    (change(time_s=None), "yes", ["not: time of"]),
    (change(**HEAVY), "yes", ["up to 2 kg instead of 1 kg as far out as contacts get; silent"]),
    (change(**HEAVY, own_failures=None), "yes", ["at the start; silent then fails in 1.0 %"]),
    (change(**HEAVY, mujoco=counts("silent", 0, 5)), "yes", ["in MuJoCo 5 of 5 carries arrive"]),
    (change(**HEAVY, mujoco=counts("silent", 1, 5)), "partly", ["in MuJoCo 4 of 5 carries arrive"]),
]  # fmt: skip


MASSES = {"own_heaviest_kg": 7.85, "heaviest_kg": 4.67}
CHANGES += [
    # what a change costs
    (change(own_farthest_m=0.0121, farthest_m=0.0202), "yes",
     ["farthest contact from its pivot in 1,000 carries  12.1 mm  20.2 mm"]),
    (change(own_farthest_m=0.0121, farthest_m=0.0122), "yes", ["not: farthest"]),
    (change(**MASSES), "yes", ["no palm sags there up to  7.85 kg  4.67 kg"]),
    (change(**MASSES | {"own_heaviest_kg": math.inf}), "yes", ["there up to  any mass  4.67 kg"]),
    (change(own_drift_m=0.0283, drift_m=0.0334), "yes", ["drift on the curve  28.3 mm  33.4 mm"]),
    (change(own_drift_m=0.0283, drift_m=0.0334, drift_permitted_m=0.035), "yes", ["not: tips"]),
    (change(own_drift_m=0.0283, drift_m=0.0382, drift_permitted_m=0.035), "partly",
     ["but on the curve the object drifts by more than the 35.0 mm permitted, and tips"]),
    (change(own_drift_m=0.0363, drift_m=0.0382, drift_permitted_m=0.035), "yes", ["not: tips"]),
    (change(own_drift_m=0.0283), "yes", ["not: drift"]),
    (change(own_holds=False, warnings=("too fast",)), "yes", ["; it brings a warning: too fast"]),
]  # fmt: skip


@pytest.mark.parametrize(("trial", "verdict", "words"), CHANGES)
def test_change(trial: ChangeTrial | NoChange | None, verdict: str, words: list[str]) -> None:
    answer = on_change(trial, "SCENE", PAPER)
    table = costs_table(trial) if isinstance(trial, ChangeTrial) else None
    costs = "" if table is None else re.sub("  +", "  ", as_text([table]))
    check(replace(answer, text=f"{answer.text}\n{costs}"), verdict, words)
    command = "noise-limit SCENE -c shared-sign"
    if isinstance(trial, NoChange) and trial.is_for_load:
        command = "load SCENE"
    elif isinstance(trial, ChangeTrial):
        command = "noise-limit SCENE -c silent"
        if verdict != "no":
            command = command_text("assess", "SCENE", trial.changes).removeprefix("palmbots ")
    assert answer.command == f"palmbots {command}"


def test_printed_commands_repeat_the_options_of_the_user() -> None:
    given = {"friction": (0.35, 0.45), "turn_radius_m": 0.8, "turn_angle_deg": 60.0}
    turn = "--turn-radius-m 0.8 --turn-angle-deg 60"
    assert on_change(change(), "SCENE", PAPER, given).command == (
        f"palmbots assess SCENE --set robot.speed_m_s=0.084 --friction 0.35 0.45 {turn}"
    )
    rough = on_friction(None, pb.analyze("paper"), "SCENE", given | {"friction": None})
    assert rough.command == f"palmbots assess SCENE --friction 0.27 0.33 {turn}"
    angles = on_angles(angle_trial(0, 0), "SCENE", PAPER, None, (0.35, 0.45))
    assert angles.command == "palmbots design SCENE -c silent --friction 0.35 0.45"


def radio(**failed: tuple[int, ...]) -> list[RadioTrial]:
    losses = (0.0, 0.05, 0.2, 0.5)
    names = [name.replace("_", "-") for name in failed]
    return [
        RadioTrial(loss, tuple(map(counts, names, row)))
        for loss, row in zip(losses, zip(*failed.values(), strict=True), strict=True)
    ]


RADIOS: list[tuple[list[RadioTrial], list[OutcomeCounts], str, str]] = [
    (radio(resilient=(0, 0, 0, 900), shared_sign=(0, 0, 0, 0)), [GOOD], "yes",
     "even if 50 % are lost: shared-sign"),
    (radio(resilient=(0, 0, 0, 9), shared_sign=(0, 0, 9, 9)), [GOOD], "partly", "up to 20 % lost"),
    (radio(shared_sign=(0, 0, 50, 90)), [GOOD], "partly", "up to 5 % lost"),
    (radio(shared_sign=(0, 50, 0, 90)), [GOOD], "no", "only if none is lost"),
    (radio(shared_sign=(9, 50, 80, 90)), [POOR], "no",
     "even without losses, too many carries fail with shared-sign"),
    ([], [counts("silent", 0)], "yes", "the controllers that suffice use no radio"),
    ([], [counts("silent", 90)], "open", "no controller suffices, and silent uses no radio"),
    ([], [counts("silent", 1000)], "open", "no carry arrives even without losses"),
]  # fmt: skip


@pytest.mark.parametrize(("trials", "given", "verdict", "text"), RADIOS)
def test_radio(
    trials: list[RadioTrial], given: list[OutcomeCounts], verdict: str, text: str
) -> None:
    answer = on_radio(trials, given, "SCENE", PAPER)
    assert (answer.verdict, answer.text) == (verdict, text)
    assert answer.command.endswith("--sweep radio.loss --values 0,0.05,0.2,0.5")
    table = radio_table(trials)
    assert (table is None) == (not trials)
    if table is not None:
        assert [row[0].strip() for row in table.rows] == ["0 %", "5 %", "20 %", "50 %"]
        lost = [one.dropped for one in trials[-1].counts]
        assert list(table.rows[-1][1:]) == [rate_text(n, 1000) for n in lost]


TURN = {"task.path.kind": "arc", "task.path.radius_m": 0.6, "task.path.angle_deg": 90.0}


def curve(failed: int | None, mean: float = 0.01, *, lips: bool = False, **more: Any) -> CurveTrial:
    forecast = DriftBudget(0.035, mean, mean, 8, 8 * (mean > 0.035), 3.0, lips)
    own = None if failed is None else counts("silent", failed, 10)
    return replace(CurveTrial("silent", TURN, forecast, own, ""), **more)


CURVES: list[tuple[CurveTrial | None, str, list[str]]] = [
    (None, "open", ["no turn was requested"]),
    (curve(0), "likely", ["90° with radius 0.6 m: none of 10 carries with silent fails"]),
    (curve(0), "likely", ["not: off-palm"]),
    (curve(0), "likely", ["forecast drift 10.0 mm of the 35.0 mm permitted", "not: level"]),
    (curve(1), "partly", ["10.0 %", "; off-palm: a contact left", "not: explain"]),
    (curve(5), "partly", ["50.0 %"]),
    (curve(6), "no", ["60.0 %", "permitted, so this drift alone does not explain"]),
    (curve(6, lips=True), "no", ["60.0 %", "lips stop the drift after 35.0 mm", "not: explain"]),
    (curve(0, mean=0.1, lips=True), "likely", ["not: 100.0 mm", "not: forecast"]),
    (curve(6, mean=0.036), "no", ["not: explain"]),
    (curve(6, forecast=DriftBudget(0.035, 0.02, 0.04, 8, 1, 3.0, False)), "no", ["not: explain"]),
    (curve(None, mean=0.05), "no", ["mean 50.0 mm", "which > 68.8 % of carries reach"]),
    (curve(None, forecast=None, refusal="too tight"), "open", ["0.6 m: too tight"]),
    (curve(None, refusal="no MuJoCo"), "open", ["0.6 m: no MuJoCo"]),
    (curve(0, changes=TURN | {"task.slope_deg": 0.0}), "likely", ["0.6 m, on a level floor: "]),
    (curve(0, changes={}), "likely", ["on its path (straight): none of"]),
]


@pytest.mark.parametrize(("trial", "verdict", "words"), CURVES)
def test_curve(trial: CurveTrial | None, verdict: str, words: list[str]) -> None:
    answer = on_curve(trial, GOOD, PAPER)
    check(answer, verdict, words)
    command = "" if trial is None else " -c silent"
    if trial is not None and trial.changes:
        command += " --turn-radius-m 0.6 --turn-angle-deg 90"
    assert answer.command == f"palmbots curve SCENE{command}"
    none = on_curve(None, None, PAPER)
    assert (none.verdict, none.text) == ("open", "no carry arrives on a straight path")


def test_table_of_counts() -> None:
    table = counts_table([counts("silent", 30, stalled=10), GOOD])
    assert table is not None
    assert list(table.rows[0]) == ["  silent", rate_text(20, 1000), rate_text(10, 1000), "1,000"]
    assert counts_table([]) is None


CURVED = pb.load_scene("paper", TURN)
HEAVIER = pb.load_scene("paper", {"object.mass_kg": 5})
ROUGH = friction("holds", "holds", 0, 0)
USE = "use shared-sign: it fails in < 0.3 % of carries"
VERDICTS: list[tuple[dict[str, str], dict[str, Any], str, str]] = [
    ({}, {}, "yes", USE),
    ({"carried": "no"}, {}, "no", f"the object is not held in every state that may occur; {USE}"),
    ({"drops": "no"}, {"counts": (BAD,)}, "no",
     "use shared-sign: it fails in 70.0 % (67.1–72.8) of carries"),
    ({"drops": "partly", "carried": "likely"}, {}, "partly", USE),
    ({"load": "likely"}, {}, "likely", USE),
    ({"controllers": "no", "angles": "partly", "radio": "no", "change": "no"}, {}, "yes", USE),
    # the curve of a scene, and the friction, only where there is one
    ({"curve": "no", "friction": "open"}, {}, "yes", USE),
    ({"curve": "open"}, {"scene": CURVED}, "open",
     f"{USE} on a straight path; its curve was not tried"),
    ({"curve": "partly"}, {"scene": CURVED, "curve": curve(1)}, "partly",
     f"{USE} on a straight path, and in 10.0 % (1.8–40.4) on its curve, in MuJoCo"),
    ({"curve": "no"}, {"scene": CURVED, "curve": curve(None, mean=0.05)}, "no",
     f"on its curve the object would tip sideways; {USE} on a straight path"),
    ({"friction": "partly"}, {"friction": ROUGH}, "partly",
     f"it may fail with some friction within the interval; {USE}"),
    # what speaks against the weight, as far as the cause is known
    ({"load": "no"}, {"load": load(5, 0)}, "no",
     f"the object is too heavy for these robots; {USE}"),
    ({"load": "partly"}, {"load": load(2, 0)}, "partly",
     f"it fails more often in MuJoCo, perhaps because of its weight; {USE}"),
    ({"drops": "no"}, {"load": load(5, 5)}, "no",
     f"in MuJoCo it fails more often, also with a light object; {USE}"),
    ({"drops": "no"}, {"load": load(5), "counts": (BAD,)}, "no",
     "use shared-sign: it fails in 70.0 % (67.1–72.8) of carries"),
    ({"load": "partly"}, {"load": load(0, None, ("wheels slip",))}, "partly",
     f"in MuJoCo wheels slip, or robots drive too fast; {USE}"),
    ({"load": "partly"}, {"load": load(0)}, "partly", f"wheels may slip under the load; {USE}"),
    ({"load": "partly"}, {"load": load(0), "scene": HEAVIER}, "partly",
     f"the object may be too heavy for these robots; {USE}"),
    # no carry arrives, or none can begin
    ({"drops": "no"}, {"counts": (counts("none", 1000),)}, "no",
     "no carry arrives with any shipped controller"),
    ({"drops": "no", "load": "no"}, {"counts": ()}, "no",
     "the object is too heavy for these robots"),
]  # fmt: skip


@pytest.mark.parametrize(("verdicts", "trials", "verdict", "conclusion"), VERDICTS)
def test_verdict_and_first_line(
    verdicts: dict[str, Any], trials: dict[str, Any], verdict: str, conclusion: str
) -> None:
    """The worst of the answers that decide, and no reason that is not known. All other answers are
    yes."""
    answers = Answers(
        **{name: Answer(name, verdicts.get(name, "yes"), "", "palmbots") for name in QUESTIONS}
    )
    usual: dict[str, Any] = {
        "counts": (GOOD,), "angles": None, "load": None, "friction": None, "radio": (),
        "curve": None, "change": None, "scene": PAPER, "analysis": None,
    }  # fmt: skip
    found = Assessment(answers, **usual | trials)
    assert (found.verdict, found.conclusion) == (verdict, conclusion)


def test_commands_give_each_key_once() -> None:
    """A key that is given twice is refused."""
    name = (
        "crate.toml --set robot.noise_m_s=0.1 --set task.path.kind=arc --set task.path.radius_m=1"
    )
    assert respelled(name, {"robot.noise_m_s": 0.2}) == (
        "crate.toml --set task.path.kind=arc --set task.path.radius_m=1 --set robot.noise_m_s=0.2"
    )
    assert respelled(name, {"task.path.kind": "straight"}) == (
        "crate.toml --set robot.noise_m_s=0.1 --set task.path.kind=straight"
    )
    assert respelled(name, {}) == name
    steep = "crate.toml --set palm.friction_angle_deg=20"  # in place of which the change is
    assert respelled(steep, {"palm.friction": 0.3}) == "crate.toml --set palm.friction=0.3"
    blank = "'my crate.toml' --set object=bottle"
    assert respelled(blank, {"palm.friction": 0.3}) == f"{blank} --set palm.friction=0.3"


def test_options_of_a_command() -> None:
    text = command_text(
        "design", "'my crate.toml'", controller="silent", friction=(0.35, 0.45678),
        region=[-0.01, 0.01], force=True, view=False, seeds=None, world="mujoco",
    )  # fmt: skip
    assert text == (
        "palmbots design 'my crate.toml' -c silent --friction 0.35 0.45678 --region -0.01,0.01 "
        "--force --world mujoco"
    )


def test_one_module_makes_commands() -> None:
    """No other one puts a scene, a file or a controller into the text of a command."""
    package = Path(pb.__file__).parent
    names = "|".join(name.split()[0] for name in declared_commands())
    made = re.compile(rf"\bpalmbots ({names}) ")
    found = set()
    for path in package.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                for part, follower in pairwise(node.values):
                    text = part.value if isinstance(part, ast.Constant) else ""
                    if isinstance(follower, ast.FormattedValue) and made.search(str(text)):
                        found.add(path.relative_to(package).as_posix())
    assert not found
