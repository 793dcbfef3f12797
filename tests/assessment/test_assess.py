# SPDX-License-Identifier: Apache-2.0
"""`palmbots assess`: the answers are those of the functions behind the commands that they name."""

import json
import math
import re
import shlex
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots._util.confidence_intervals import rate_interval
from palmbots._util.report import as_text
from palmbots.assessment.angles import PAIRS, AngleTrial, NoPair, try_angles
from palmbots.assessment.answer import Answer
from palmbots.assessment.assess import QUESTIONS
from palmbots.assessment.assumptions import (
    DECISIVE,
    assumed,
    assumptions_table,
    deciding_keys,
    on_assumptions,
)
from palmbots.assessment.change_trial import ChangeTrial, NoChange
from palmbots.assessment.changes import _plans, try_changes
from palmbots.assessment.friction import try_friction
from palmbots.assessment.load import try_load
from palmbots.assessment.one_palm import friction_range
from palmbots.assessment.page import write_page
from palmbots.assessment.radio import try_losses
from palmbots.assessment.raised_noise import FRESH, count_failures, revealing_noise
from palmbots.assessment.side_effects import known_warnings, new_warnings
from palmbots.assessment.verdicts import on_controllers
from palmbots.assessment.what_if import on_angles, on_change, on_radio
from palmbots.cli.main import run
from palmbots.errors import SceneError
from palmbots.mechanics.lifting import check_lift
from palmbots.mujoco.curve_trial import CurveTrial
from palmbots.scene.spec import to_spec
from palmbots.simulation import count_outcomes
from palmbots.simulation.prepare import prepare
from palmbots.stability.angle_certificate import scene_at
from sampled import in_soak, sampled

pytestmark = pytest.mark.slow

CRATE: dict[str, Any] = {
    "object": {
        "vertices_m": [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]], "depth_m": 0.2, "mass_kg": 1.2,
        "com_m": [0.22, 0.10],
    },
    "palm": {"friction": 0.35, "length_m": 0.08},
    "robot": {"noise_m_s": 0.018},
    "radio": {"loss": 0.05},
}  # fmt: skip
"""A carry with seed 0 and `distributed` delivers it, and most of the others drop it."""


@pytest.fixture(autouse=True)
def few_carries(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests that do not look at the load, at changes or at other angles do not try them."""
    for name, looks_at_it in (("load", "load"), ("changes", "changes"), ("angles", "command")):
        if looks_at_it not in request.node.name:
            monkeypatch.setattr(f"palmbots.assessment.assess.try_{name}", lambda *_, **__: None)


def test_one_lucky_seed_is_not_the_answer() -> None:
    assert pb.carry(CRATE, "distributed").outcome == "delivered"
    found = pb.assess(CRATE, turn_radius_m=0.0)
    rates = {one.controller: one.drop_rate for one in found.counts}
    assert rates["distributed"] == count_outcomes(CRATE, "distributed").drop_rate > 0.5
    assert found.controller == "shared-sign" and found.verdict == "yes"
    assert "distributed" not in found.answers.controllers.text
    assert found.curve is None and found.answers.curve.verdict == "open"


def test_noise_beyond_every_controller_is_said_first() -> None:
    found = pb.assess(
        CRATE, turn_radius_m=0.0, overrides={"robot.noise_m_s": 0.15, "task.distance_m": 0.5}
    )
    assert found.verdict == "no"
    assert min(one.failure_interval[0] for one in found.counts) > 0.5
    assert found.answers.controllers.verdict == "no"


def test_scene_whose_properties_fail_is_a_no_with_the_reason() -> None:
    found = pb.assess(
        CRATE, turn_radius_m=0.0, overrides={"object.com_m": [0.05, 0.1], "task.distance_m": 0.2}
    )
    assert found.answers.carried.verdict == "no" and "slide" in found.answers.carried.text


def test_tightest_margin_is_that_of_analyze() -> None:
    found = pb.assess(turn_radius_m=0.0, overrides={"task.distance_m": 0.2})
    assert pb.analyze(found.scene).ranking[0].sentence() in found.answers.carried.text


@pytest.mark.parametrize("friction", [None, (0.2, 0.3)])
def test_object_that_tips_the_robots_is_a_no(
    friction: tuple[float, float] | None, tmp_path: Path
) -> None:
    found = pb.assess(friction=friction, overrides={"object.mass_kg": 500})
    assert found.verdict == found.answers.load.verdict == "no"
    assert "kg" in found.answers.load.text
    assert not found.counts and "  controller" not in str(found)
    for name in ("drops", "controllers", "angles", "radio", "curve"):
        answer = getattr(found.answers, name)
        assert answer.text == "no carry can begin" and answer.command == "palmbots load SCENE"
    write_page(found, tmp_path / ("page.html" if friction else "page.pdf"))


def test_seeds_that_chose_a_pair_or_a_change_do_not_judge_it() -> None:
    noisy = pb.load_scene("paper", {"robot.noise_m_s": 0.08, "task.distance_m": 0.25})
    own = prepare(noisy, "shared-sign")
    count = 1000
    fresh, used = (count_failures(own, first, count) for first in (FRESH, 0))
    assert fresh != used
    angles = try_angles(noisy, "shared-sign")
    assert isinstance(angles, AngleTrial) and angles.own_failures == fresh
    best = prepare(scene_at(noisy, angles.best_deg), "shared-sign")
    assert angles.best_failures == count_failures(best, FRESH, count)
    assert angles.best_failures != count_failures(best, 0, count)
    change = try_changes(noisy, "shared-sign", {}, None)
    assert isinstance(change, ChangeTrial) and change.own_failures == fresh
    changed = prepare(pb.load_scene(noisy, dict(change.changes)), "shared-sign")
    assert change.failures == count_failures(changed, FRESH, count)
    assert change.failures != count_failures(changed, 0, count)


def test_angles_that_cost_carries_are_found_and_judged_on_other_seeds() -> None:
    scene = pb.load_scene(
        CRATE,
        {
            "palm.shallow_deg": 8,
            "palm.steep_deg": 10,
            "robot.noise_m_s": 0.03,
            "task.distance_m": 0.4,
        },
    )
    trial = try_angles(scene, "shared-sign")
    assert isinstance(trial, AngleTrial) and trial.is_better
    assert trial.best_failures < trial.own_failures
    shallow, steep = trial.best_deg
    better = pb.load_scene(scene, {"palm.shallow_deg": shallow, "palm.steep_deg": steep})
    own = count_outcomes(scene, "shared-sign", seeds=1500).failure_interval
    assert count_outcomes(better, "shared-sign", seeds=1500).failure_interval[1] < own[0]


def test_angles_are_compared_at_raised_noise_within_the_interval_of_friction() -> None:
    """Only pairs that hold with every friction that was given, and bring no warning."""
    scene = pb.load_scene("paper", {"task.distance_m": 0.25})
    found = try_angles(scene, "shared-sign", noise=8.0)
    assert isinstance(found, AngleTrial) and found.noise_factor == 8.0
    noisy = prepare(pb.load_scene(scene, {"robot.noise_m_s": 0.08}), "shared-sign")
    assert found.own_failures == count_failures(noisy, FRESH, found.carries) > 0
    some = try_angles(scene, "shared-sign", noise=8.0, friction=(0.12, 0.3))
    assert isinstance(some, AngleTrial) and some.tried < found.tried
    shallow, steep = some.best_deg
    ends = {"palm.shallow_deg": shallow, "palm.steep_deg": steep, "palm.friction": 0.12}
    assert pb.analyze(scene, overrides=ends).holds


def test_of_angles_with_equal_failures_those_with_most_clearance_are_best() -> None:
    scene = pb.load_scene("paper", {"task.distance_m": 0.25})
    found = try_angles(scene, "shared-sign")
    assert isinstance(found, AngleTrial) and found.most_failure_rate == 0
    known = known_warnings(scene, "shared-sign", None)
    clearances = []
    for pair in PAIRS:
        turned = scene_at(scene, pair)
        analysis = pb.analyze(turned)
        if analysis.holds and not new_warnings(known, turned, "shared-sign", None):
            clearances.append(analysis.clearance_deg)
    assert len(set(clearances)) > 1
    assert (found.best_clearance_deg, found.tried) == (max(clearances), len(clearances))


def test_why_no_pair_of_angles_is_tried() -> None:
    aside = pb.load_scene("paper", {"object.com_m": [0.02, 0.1]})
    found = try_angles(aside, "silent")
    assert isinstance(found, NoPair) and found.why.startswith("each of 25 pairs")
    found = try_angles(pb.load_scene("paper"), "optimal-stopping")
    assert isinstance(found, NoPair) and found.why.startswith("carries take too long")


@pytest.mark.parametrize("scene", ["lone", "handover"])
def test_jobs_on_one_palm(scene: str) -> None:
    """Controllers have nothing to do, so one is counted. The friction may be what closed forms
    permit."""
    found = pb.assess(scene, overrides={"task.distance_m": 0.2})
    answers, (counts,) = found.answers, found.counts
    assert answers.carried.verdict == "yes" and "tightest margin" in answers.carried.text
    assert counts.failure_rate == 0 and answers.drops.verdict == "yes"
    assert answers.controllers.text.startswith("any")
    assert answers.curve.verdict == answers.angles.verdict == "open"
    assert answers.radio.verdict == "yes"
    for end, inward in zip(friction_range(found.scene), (1.001, 0.999), strict=True):
        check_lift(pb.load_scene(scene, {"palm.friction": end * inward}))
        with pytest.raises(SceneError):
            check_lift(pb.load_scene(scene, {"palm.friction": end / inward}))


def test_turn_is_tried_in_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("palmbots.assessment.counted.CURVE_CARRIES", 1)
    found = pb.assess(turn_radius_m=1.0, turn_angle_deg=45, overrides={"task.distance_m": 0.2})
    assert found.curve is not None and found.curve.counts is not None
    assert found.curve.changes["task.distance_m"] == 1.24  # the whole turn
    assert found.answers.curve.verdict == "likely"
    # Every command that the page names has these options.
    for name in QUESTIONS:
        words = shlex.split(getattr(found.answers, name).command)
        assert words[0] == "palmbots" and run([*words[1:], "--help"]) == 0


@pytest.mark.parametrize("as_json", [True, in_soak(False)])
def test_command_names_commands_that_run(
    as_json: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / ("page.pdf" if as_json else "page.html")
    words = ["assess", "paper", "--set", "task.distance_m=0.2", "--turn-radius-m", "0"]
    assert run([*words, "--out", str(page), *(["--json"] if as_json else [])]) == 0
    if as_json:
        assert page.read_bytes().startswith(b"%PDF")
    else:
        text = page.read_text()
        assert text.count("<img") == 2 and not re.search(r"(src|href)=\"(?!data:)", text)
    shown = capsys.readouterr().out
    if as_json:
        table = json.loads(shown)
        commands = [one["command"] for one in table["answers"].values()]
        assert len(commands) == len(set(commands)) == len(QUESTIONS)
        for one in commands[:1]:
            assert run(shlex.split(one)[1:]) == 0
    else:
        assert shown.startswith("YES")


def test_load_is_judged_where_the_contacts_get() -> None:
    heavy = {"object.mass_kg": 2, "task.distance_m": 0.3}
    found = pb.assess(turn_radius_m=0.0, overrides=heavy)
    assert not pb.load_limits(found.scene).holds
    best = next(one for one in found.counts if one.controller == found.controller)
    assert best.farthest_m is not None and found.load is not None
    assert best.farthest_m < pb.load_limits(found.scene).held_within_m
    assert found.answers.load.verdict == "likely" and found.load.counts.dropped == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "heavy",
    [
        {"object.mass_kg": 8},
        {"object.mass_kg": 7, "start.left_m": 0.01, "mujoco.palm_torque_n_m": 0.2},
    ],
)
def test_robots_are_made_no_stronger_than_the_object_needs(heavy: dict[str, Any]) -> None:
    """With a value one hundredth of its decade lower, no carry begins or one of five drops."""
    scene = pb.load_scene("paper", heavy | {"task.distance_m": 0.1})
    found = try_changes(scene, "shared-sign", {}, None)
    assert isinstance(found, ChangeTrial) and found.is_for_load

    def suffices(keys: dict[str, Any]) -> bool:
        changed = pb.load_scene(scene, keys)
        if pb.load_limits(changed).refusal():
            return False
        ends = (pb.carry(changed, "shared-sign", world="mujoco", seed=k) for k in range(5))
        return all(end.outcome == "delivered" for end in ends)

    keys = dict(found.changes)
    assert len(keys) == (2 if "start.left_m" in heavy else 1)
    assert suffices(keys)
    for key, value in keys.items():
        assert isinstance(value, float) and value == float(f"{value:.2g}")
        step = 10.0 ** (math.floor(math.log10(value)) - 1)
        assert not suffices(keys | {key: value - step}), key


def test_failures_in_mujoco_are_put_down_to_the_weight_only_if_a_light_object_does_better() -> None:
    short = {"task.distance_m": 0.5}
    noisy = pb.load_scene("paper", short | {"robot.noise_m_s": 0.1})
    found = try_load(noisy, count_outcomes(noisy, "distributed"), 5, lambda done: None)
    assert found is not None and found.failed >= 4
    assert (found.cause, found.light) == ("none", None)  # the quasistatic world drops as many
    # Robots that tip in MuJoCo, where statics say that they just hold the object.
    heavy = pb.load_scene("paper", short | {"object.mass_kg": 8, "mujoco.body_kg": 3.75})
    found = try_load(heavy, count_outcomes(heavy, "silent"), 5, lambda done: None)
    assert found is not None and found.failed and found.cause in ("weight", "unclear")
    assert found.light is not None and found.light.failure_rate == 0


def test_what_is_held_is_that_of_robots_that_drive_the_path(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On a curve the wheels stand below the pivots, and robots tip earlier."""
    for name in ("angles", "curve"):
        monkeypatch.setattr(f"palmbots.assessment.assess.try_{name}", lambda *_, **__: None)
    strong = {"mujoco.palm_torque_n_m": 10.0}
    curved = strong | {"task.path.kind": "arc", "task.path.radius_m": 1.0, "task.distance_m": 0.3}
    limits = pb.load_limits(overrides=curved)
    assert limits.heaviest_kg != pb.load_limits(overrides=strong).heaviest_kg
    found = pb.assess(overrides=curved)
    assert found.answers.load.text.startswith(limits.sentence())
    assert (found.answers.curve.verdict, found.verdict) == ("open", "open")  # its own path counts


def test_losses_are_those_of_every_sender() -> None:
    """Also of one with a loss of its own, which `radio.loss` does not reach."""
    senders = {f"radio.{sender}.loss": 0.0 for sender in ("left", "right", "station")}
    scenes = [pb.load_scene("paper", keys) for keys in ({}, senders)]
    counts = (count_outcomes("paper", "distributed", seeds=100),)
    all_alike, each = (
        [trial.counts[0].dropped for trial in try_losses(scene, counts, print)] for scene in scenes
    )
    assert all_alike == each and all_alike[-1] > 10 * (all_alike[0] + 1)


def test_rough_friction_is_proved_and_carried_at_both_ends() -> None:
    near = {"task.distance_m": 0.3}
    found = pb.assess(friction=(0.2, 0.5), turn_radius_m=0.0, overrides=near)
    assert found.friction is not None and found.friction.alike == "holds"
    for one, end in zip(found.friction.counts, (0.2, 0.5), strict=True):
        assert one == count_outcomes(
            "paper", one.controller, seeds=one.carries, overrides=near | {"palm.friction": end}
        )
    assert "all with friction 0.5, which permits the hardest squeeze" in found.answers.load.text
    command = found.answers.load.command.split(" --set ")[1:]
    assert command == ["palm.friction=0.5"]
    certificate = pb.certify("paper", friction=(0.2, 0.5), overrides=near)
    assert certificate.verdict == found.friction.unlike
    assert pb.assess(friction=(0.02, 0.5), turn_radius_m=0.0, overrides=near).verdict == "no"


def test_mechanics_are_judged_at_the_worst_friction_and_angles_at_a_raised_noise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given: dict[str, Any] = {}
    monkeypatch.setattr(
        "palmbots.assessment.assess.try_angles", lambda *_, **options: given.update(options)
    )
    repeated: dict[str, Any] = {}

    def answer_of(trial: Any, name: str, scene: pb.Scene, options: dict[str, Any]) -> Answer:
        repeated.update(options)
        return on_change(trial, name, scene, options)

    monkeypatch.setattr("palmbots.assessment.assess.on_change", answer_of)
    keys = {"robot.acceleration_m_s2": 0.75, "task.inertia": True, "task.distance_m": 0.2}
    found = pb.assess(friction=(0.3, 0.6), turn_radius_m=0.0, overrides=keys)
    answer = found.answers.carried
    assert "robot.acceleration_m_s2 is 0.75" in answer.text
    assert "with a friction of 0.6, the worst of the interval" in answer.text
    assert found.held is not None and found.held.word == "MAY FAIL"
    assert pb.analyze(overrides=keys).holds and not pb.analyze(overrides=keys).warnings
    assert found.controller is not None
    noise = revealing_noise(found.scene, found.controller, found.counts[0].carries)
    assert noise is not None and noise > 1
    assert given == {"noise": noise, "friction": (0.3, 0.6)}
    assert repeated == {"friction": (0.3, 0.6), "turn_radius_m": 0.0}


def test_friction_of_rounded_objects_is_proved_and_reversed_ends_are_refused_at_once() -> None:
    round_ = pb.load_scene("paper", {"object.edge_radius_m": 0.004, "task.distance_m": 0.2})
    analysis = pb.analyze(round_)
    (least, most), *_ = analysis.friction
    inside, beyond = ((least + 0.01, most - 0.01), (least + 0.01, most + 0.01))
    assert [try_friction(analysis, ends, None, 0).alike for ends in (inside, beyond)] == [
        "holds", "fails",
    ]  # fmt: skip
    differ = try_friction(analysis, inside, None, 0)
    assert differ.unlike == "undecided" and differ.failing is not None
    left, right, number = differ.failing
    mixed = pb.load_scene(round_, {"palm.left.friction": left, "palm.right.friction": right})
    assert {left, right} == set(inside)
    assert not all(
        one.holds for one in pb.analyze(mixed).properties.values() if one.number == number
    )
    near = tuple(round_.palm_of("left").friction + by for by in (-0.002, 0.002))
    unlike = try_friction(analysis, (near[0], near[1]), None, 0)
    assert (unlike.alike, unlike.unlike, unlike.failing) == ("holds", "holds", None)
    refused: Any = ((0.36, 0.28), (0.3, 0.3), ("0.2", "0.3"))
    for ends in refused:
        with pytest.raises(pb.PalmbotsError, match="the lower one first"):
            pb.assess(round_, friction=ends, on_progress=lambda done: pytest.fail("too late"))


CHANGES = [
    ({"robot.noise_m_s": 0.08, "task.distance_m": 0.4}, 1.0, "robot.correction_m_s"),
    ({"robot.noise_m_s": 0.02, "radio.loss": 0.9}, None, None),
    ({"object.mass_kg": 8, "task.distance_m": 0.5}, 1.0, "mujoco.body_kg"),
    ({"object.com_m": [0.05, 0.04]}, None, "object.com_m"),
]


@pytest.mark.parametrize(("keys", "noise", "key"), sampled(CHANGES, 2))
def test_changes_help_on_seeds_that_did_not_choose_them(
    keys: dict[str, Any], noise: float | None, key: str | None
) -> None:
    scene = pb.load_scene("paper", keys)
    trial = try_changes(scene, "shared-sign", {}, None)
    assert isinstance(trial, ChangeTrial) and trial.is_better
    assert key is None or next(iter(trial.changes)) == key
    assert noise is None or trial.noise_factor == noise
    factor = trial.noise_factor * scene.robot.noise_m_s
    changed = pb.load_scene(scene, dict(trial.changes) | {"robot.noise_m_s": factor})
    after = count_outcomes(changed, "shared-sign", seeds=1000)
    low, high = rate_interval(trial.failures, trial.carries)
    assert after.failure_interval[0] <= high and low <= after.failure_interval[1]


WHY_NOT = [
    ({"robot.noise_m_s": 0}, "none of 1,000 carries fails, and there is no noise"),
    ({"robot.noise_m_s": 1e-4}, "too few of 1,000 carries fail for a comparison of changes, even"),
    ({"object.mass_kg": 500}, "even robots up to 10 times as strong do not hold it"),
]


@pytest.mark.parametrize(("keys", "why"), WHY_NOT)
def test_why_no_change_is_found(keys: dict[str, Any], why: str) -> None:
    found = try_changes(pb.load_scene("paper", keys), "silent", {}, None)
    assert isinstance(found, NoChange) and found.why.startswith(why)


def test_changes_for_the_load_are_carried_where_weight_acts() -> None:
    """Of an object of 8 kg, statics and the quasistatic world say that a body of 3.75 kg holds it;
    most carries in MuJoCo drop it."""
    keys = {"object.mass_kg": 8, "task.distance_m": 0.5}
    scene = pb.load_scene("paper", keys)
    light = count_outcomes(
        scene, "silent", seeds=3, world="mujoco", overrides={"mujoco.body_kg": 3.75}
    )
    assert light.failure_rate > 0.5
    found = try_changes(scene, "silent", {}, None)
    assert isinstance(found, ChangeTrial) and found.mujoco is not None
    assert found.mujoco.failure_rate == 0
    assert pb.load_scene(scene, dict(found.changes)).mujoco.body_kg > 3.75


def test_changes_are_compared_where_few_carries_show_a_difference() -> None:
    """No failure of 120 says nothing about a change, so that the noise is raised; a scene without
    noise that fails in one of 40 carries is compared as it is."""
    factor = revealing_noise(pb.load_scene("paper"), "shared-sign", 120)
    assert factor is not None and factor > 1
    keys = {"robot.noise_m_s": 0, "robot.left.bias_m_s": 0.004, "radio.loss": 0.001}
    assert revealing_noise(pb.load_scene("paper", keys), "distributed", 40) == 1


@pytest.mark.parametrize(("failures", "factor"), [(0, 1.25), (3, 1.25), (12, 1.25), (30, 1.0)])
def test_noise_is_raised_unless_many_carries_fail(
    failures: int, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Many: certainly more than 1 %; 12 of 1000 may be 0.7 %."""
    monkeypatch.setattr(
        "palmbots.assessment.raised_noise.count_failures",
        lambda prepared, *_: failures if prepared.scene.robot.noise_m_s == 0.01 else 100,
    )
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.01})
    assert revealing_noise(scene, "shared-sign", 1000) == factor


OWN = {
    "palm.left.friction": 0.3, "palm.right.friction_angle_deg": 20.0,
    "robot.left.noise_m_s": 0.06, "robot.right.noise_m_s": 0.08,
    "robot.left.correction_m_s": 0.03, "robot.right.correction_m_s": 0.02,
}  # fmt: skip


def test_changes_of_what_both_robots_override_change_both() -> None:
    scene = pb.load_scene("paper", OWN)
    plans = [*_plans(scene, {})]
    assert {"robot.left.correction_m_s": 0.06, "robot.right.correction_m_s": 0.04} in plans
    own = [palm.friction for palm in to_spec(scene).palms]
    frictions = [plan for plan in plans if "palm.left.friction" in plan]
    stronger = frictions[-1]
    after = [palm.friction for palm in to_spec(pb.load_scene(scene, dict(stronger))).palms]
    assert after == pytest.approx([1.4 * mu for mu in own], rel=0.01)
    for plan in plans:
        pb.load_scene(scene, dict(plan))  # refuses what reaches no robot


def test_named_commands_vary_what_has_an_effect() -> None:
    scene = pb.load_scene("paper", OWN | {"radio.left.loss": 0.1, "radio.right.loss": 0.2})
    counts = (count_outcomes(scene, "shared-sign", seeds=20),)
    answers = [
        on_controllers(counts, "SCENE", scene), on_radio([], counts, "SCENE", scene),
        on_change(None, "SCENE", scene), on_angles(None, "SCENE", scene),
    ]  # fmt: skip
    for answer in answers:
        words = shlex.split(answer.command)
        if "--sweep" in words:
            key, value = words[words.index("--sweep") + 1], words[-1].split(",")[1]
            assert pb.load_scene(scene, {key: float(value)}) != scene
        assert words[1] in ("compare", "drop-rate", "design")  # not `noise-limit`, which refuses


def test_defaults_that_may_be_wrong_are_listed() -> None:
    """Also those that follow from the outline, and those of one side."""
    outline = [[0, 0], [0.4, 0], [0.4, 0.12], [0, 0.12]]
    own = pb.load_scene({"object": {"vertices_m": outline}}, {"palm.left.friction": 0.4})
    found = assumed(own)
    assert found["object.com_m"] == [0.2, 0.06] and "palm.right.friction" not in found
    assert "palm.friction" in found and "palm.left.friction" not in found
    both = {"palm.left.friction": 0.4, "palm.right.friction": 0.5, "object.com_m": [0.2, 0.05]}
    assert not {"palm.friction", "object.com_m"} & assumed(pb.load_scene(own, both)).keys()
    outlines = (
        {"vertices_m": [[0, 0.1], [0.15, 0], [0.3, 0.1], [0.3, 0.3], [0, 0.3]], "contacts": [0, 2]},
        {"vertices_m": [[0, 0], [0.2, 0], [0.9, 0.4], [0.7, 0.4]], "com_m": [0.19, 0.05]},
    )
    for given in outlines:  # the first has no default contacts, the second tips by its default COM
        assert "palm.friction" in assumed(pb.load_scene({"object": given}))
    given = pb.load_scene({"robot": {"noise_m_s": 0.01}, "palm": {"left": {"rate_deg_s": 50.0}}})
    keys = ("robot.noise_m_s", "palm.rate_deg_s", "tactile.zero_half_width_m")
    assert assumed(given, keys) == {"palm.rate_deg_s": 50.0, "tactile.zero_half_width_m": 0.005}
    # a scene made from another one has all keys, and does not know who gave them
    assert keys[0] in assumed(pb.load_scene(given, {"radio.loss": 0.1}), keys)
    text = as_text([assumptions_table(own)], 99)
    assert all(f"{key} " in text for key in found)
    assert "palm.friction 0.3, " in as_text([assumptions_table(pb.load_scene({}))])
    for scene in (own, pb.load_scene(own, both), pb.load_scene({})):  # --friction gives it
        text = as_text([assumptions_table(scene, (0.3, 0.4))])
        assert "palm.friction from 0.3 to 0.4 (--friction)" in text.split("  given ")[1]
        assert text.count("friction ") == 1


@pytest.mark.parametrize("keys", [{}, {"radio.latency_s": 0.03, "robot.noise_m_s": 0.012}])
def test_changes_that_are_advised_bring_no_warning(keys: dict[str, Any]) -> None:
    """Twice the correction speed needs a wider zero zone, which is advised with it; the warnings
    are those of the changed scene, and what it costs is counted."""
    scene = pb.load_scene("paper", keys)
    fast = pb.load_scene(scene, {"robot.correction_m_s": 0.06})
    known = known_warnings(scene, "shared-sign", None)
    assert len(new_warnings(known, fast, "shared-sign", None)) == 1
    trial = try_changes(scene, "shared-sign", {}, 0.01, friction=(0.28, 0.32))
    assert isinstance(trial, ChangeTrial) and trial.is_better
    assert trial.changes.keys() == {"robot.correction_m_s", "tactile.zero_half_width_m"}
    changed = pb.load_scene(scene, dict(trial.changes))
    assert not new_warnings(known, changed, "shared-sign", (0.28, 0.32))
    assert trial.farthest_m is not None and trial.own_farthest_m is not None
    assert trial.farthest_m > trial.own_farthest_m
    hardest = pb.load_limits(changed, overrides={"palm.friction": 0.32})
    assert trial.heaviest_kg == hardest.heaviest_within(trial.farthest_m)
    assert "robot.correction_m_s" in trial.deciding


ONE_CHANGE: list[tuple[dict[str, Any], dict[str, Any]]] = [
    ({}, {"palm.rate_deg_s": 100.0}),
    ({"palm.shallow_deg": 14.0, "palm.steep_deg": 16.0}, {"palm.rate_deg_s": 100.0}),
    ({"object.com_m": [0.05, 0.04]}, {"object.com_m": [0.125, 0.04]}),  # only with it all hold
]


@pytest.mark.parametrize(("keys", "advised"), ONE_CHANGE)
def test_changes_that_bring_a_warning_are_left_out_unless_a_property_holds_only_with_them(
    keys: dict[str, Any], advised: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Here every change brings one, except that of the rate."""

    def warnings(known: Any, scene: pb.Scene, *_: Any) -> tuple[str, ...]:
        return ("a warning",) if scene.palm.rate_deg_s == 50 else ()

    monkeypatch.setattr("palmbots.assessment.changes.new_warnings", warnings)
    scene = pb.load_scene("paper", keys | {"robot.noise_m_s": 0.08, "task.distance_m": 0.25})
    found = try_changes(scene, "shared-sign", {}, None)
    assert isinstance(found, ChangeTrial) and found.changes == advised
    assert found.warnings == (() if "palm.rate_deg_s" in advised else ("a warning",))


def test_a_friction_that_is_known_only_roughly_is_not_changed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def warnings(known: Any, scene: pb.Scene, *_: Any) -> tuple[str, ...]:
        return ("a warning",) if scene.palm.friction == 0.3 else ()

    monkeypatch.setattr("palmbots.assessment.changes.new_warnings", warnings)
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.08, "task.distance_m": 0.25})
    found = try_changes(scene, "shared-sign", {}, None)
    assert isinstance(found, ChangeTrial) and found.changes.keys() == {"palm.friction"}
    rough = try_changes(scene, "shared-sign", {}, None, friction=(0.28, 0.32))
    assert isinstance(rough, NoChange)


def test_values_that_decide_are_listed_if_nobody_gave_them() -> None:
    """Those of warnings and of the tightest margins, of changes that carries notice, of the needs
    of controllers, and of a curve."""
    scene = pb.load_scene({"robot": {"acceleration_m_s2": 0.8}})
    analysis = pb.analyze(scene)
    (warning,) = analysis.warnings
    assert warning.startswith("robot.acceleration_m_s2 is 0.8")
    good = (count_outcomes("paper", "shared-sign", seeds=1000),)
    keys = deciding_keys(analysis, good, None, None)
    assert "robot.acceleration_m_s2" in keys and "tactile.zero_half_width_m" in keys
    assert "palm.width_m" not in keys and "palm.rate_deg_s" not in keys
    silent = (count_outcomes("paper", "silent", seeds=1000),)
    assert "tactile.zero_half_width_m" not in deciding_keys(analysis, silent, None, None)
    missing, given = as_text([assumptions_table(scene, None, keys)]).split("  given ")
    count = f"{len(assumed(scene, (*DECISIVE, *keys)))} were not given"
    assert count in on_assumptions(scene, None, keys).text
    assert "robot.acceleration_m_s2 0.8" in given and "tactile.zero_half_width_m" in missing


def test_values_that_decide_a_curve_and_those_of_one_side() -> None:
    curve = CurveTrial("silent", {}, None, None, "")
    lips, own = (
        pb.analyze(overrides=keys)
        for keys in (
            {"palm.lip_height_m": 0.03},
            {"palm.left.length_m": 0.15, "palm.right.length_m": 0.15},
        )
    )
    assert "palm.width_m" in deciding_keys(own, (), None, curve)
    assert "palm.width_m" not in deciding_keys(own, (), None, None)
    assert "palm.width_m" not in deciding_keys(lips, (), None, curve)
    found = deciding_keys(own, (), None, None)
    assert "palm.length_m" in found and not any(".left." in key for key in found)


def test_first_lines_of_analyze_load_and_assess_agree() -> None:
    keys = {"object.mass_kg": 1.5, "task.distance_m": 0.2}
    first = [
        str(next(iter(found.lines())))
        for found in (pb.analyze(overrides=keys), pb.load_limits(overrides=keys))
    ]
    assert first[0] == first[1] and first[0].startswith("MAY FAIL  with contacts up to ")
    word, text = first[0].split("  ")
    found = pb.assess(turn_radius_m=0.0, overrides=keys)
    assert found.conclusion.endswith(
        f"; for contacts anywhere on the palms, the result is {word}: {text}"
    )


@pytest.mark.parametrize(("mass", "reach_m"), [(0.9, 0.075), (1.0, 0.05)])
def test_changes_keep_the_object_light_enough_for_how_far_contacts_then_get(
    mass: float, reach_m: float
) -> None:
    """On longer palms fewer carries fail, but contacts get to where a palm sags. The heavier object
    is too heavy farther out already, so that no warning is new."""
    keys: dict[str, Any] = {
        "object.mass_kg": mass, "robot.noise_m_s": 0.1, "robot.correction_m_s": 0.09,
        "robot.speed_m_s": 0.09, "palm.rate_deg_s": 100, "task.distance_m": 0.4,
    }  # fmt: skip
    scene = pb.load_scene("paper", keys)
    assert pb.load_limits(scene).heaviest_within(reach_m) > mass
    longer = {"palm.length_m": 0.225}
    far = count_outcomes(scene, "shared-sign", seeds=1000, overrides=longer).farthest_m
    assert far is not None
    assert pb.load_limits(scene, overrides=longer).heaviest_within(far) < mass
    found = try_changes(scene, "shared-sign", {}, reach_m)
    assert isinstance(found, ChangeTrial) and not found.is_for_load
    assert found.changes != longer and found.heaviest_kg > mass
    light = try_changes(pb.load_scene(scene, {"object.mass_kg": 0.5}), "shared-sign", {}, 0.075)
    assert isinstance(light, ChangeTrial) and light.changes == longer
