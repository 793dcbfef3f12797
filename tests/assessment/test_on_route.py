# SPDX-License-Identifier: Apache-2.0
"""The page about a route: stages, failures of whole routes, and what limits them."""

import shlex
from dataclasses import replace

import pytest

import palmbots as pb
from palmbots.assessment import on_route
from palmbots.assessment.assess import QUESTIONS
from palmbots.cli.main import run
from palmbots.mujoco.route_carry import plan_route

CORNER = {
    "task.route.waypoints_m": [[0.0, 0.0], [1.5, 0.0], [2.5, 1.0]],
    "task.route.walls_m": None,
}
NAMES = ("silent", "shared-sign")


def test_routes_are_counted_with_each_controller(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("mujoco")
    monkeypatch.setattr("palmbots.assessment.assess.shipped_names", lambda: NAMES)
    monkeypatch.setattr("palmbots.assessment.assess.LOAD_CARRIES", 1)
    monkeypatch.setattr(on_route, "ROUTES", 4)
    found = pb.assess("around-wall", overrides=CORNER)
    answers = found.answers
    plans = {name: plan_route("around-wall", name, routes=4, overrides=CORNER) for name in NAMES}
    assert found.counts == tuple(plan.counts for plan in plans.values())
    assert found.controller in NAMES and found.verdict == "likely"
    (stage,) = plans[found.controller].stages
    assert f"takes 1 stage with {found.controller}, {stage.length_m:.2f} m" in answers.curve.text
    assert f"at most {1e3 * stage.worst_m:.1f} mm of the 35.0 mm" in answers.curve.text
    assert answers.carried.verdict == "yes" and "tightest margin" in answers.carried.text
    assert found.load is not None and "heels" in answers.friction.text
    assert answers.controllers.text == f"none of 4 routes fails with {', '.join(NAMES)}"
    failing = [
        replace(one, counts=replace(one.counts, dropped=1, reasons={"tipping": 1}))
        for one in plans.values()
        if one.counts is not None
    ]
    some = on_route.route_answers(failing, "around-wall")["controllers"]
    assert (some.verdict, some.text) == ("no", "each controller fails in some of 4 routes")
    for name in ("angles", "radio", "change"):
        assert getattr(answers, name).verdict == "open"
    for name in QUESTIONS:
        words = shlex.split(getattr(answers, name).command)
        assert words[0] == "palmbots" and run([*words[1:], "--help"]) == 0
