# SPDX-License-Identifier: Apache-2.0
"""MuJoCo agrees with the quasistatic world because of its contact settings."""

import math
import os
import pickle
from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

import palmbots as pb
from json_output import read_json
from palmbots._util.confidence_intervals import wilson
from palmbots.cli import main as cli
from palmbots.control.interface import StepInput, StepOutput
from palmbots.mechanics.contact_modes import contact_modes
from palmbots.mujoco.carry_runner import WORLD, run
from palmbots.mujoco.engine_settings import DEFAULT, Contact, Engine
from palmbots.mujoco.validation import trials
from palmbots.mujoco.validation.trials import State
from palmbots.mujoco.validation.validation import Validation, validate
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, run_seeds
from palmbots.simulation.prepare import prepare
from sampled import amounts
from short_validation import FEW_LINES
from waiting import locked

# MuJoCo's defaults.
PLAIN = Engine(
    palm=Contact((0.02, 1.0), (0.9, 0.95, 0.001)),
    cone="pyramidal",
    impratio=1.0,
    integrator="Euler",
)


@pytest.fixture(scope="module", params=amounts(30, 60))
def done(request: pytest.FixtureRequest) -> Validation:
    file = Path(os.environ["PALMBOTS_CACHE"]) / f"validation-{request.param}"  # of this run
    with pytest.MonkeyPatch.context() as patch, locked(file.with_suffix(".lock")):
        if not file.exists():
            patch.setattr("palmbots.mujoco.validation.validation.LINE_PLACES", (-0.04, 0.0))
            scene = load_scene("paper", {"task.distance_m": 0.4})
            file.write_bytes(pickle.dumps(validate(scene, states=request.param, carries=2)))
        return pickle.loads(file.read_bytes())


@pytest.mark.slow
def test_chosen_contacts_do_not_creep(done: Validation) -> None:
    assert 0 < max(map(abs, done.creep_m)) <= 0.25e-3


def test_default_contacts_of_mujoco_creep() -> None:
    assert max(map(abs, trials.creep(PLAIN, 5.0))) > 1e-3


def test_softer_friction_creeps_in_proportion() -> None:
    """Creep is the price of impratio: a tenth of it, ten times the creep."""
    ten = replace(DEFAULT, impratio=DEFAULT.impratio / 10)
    fast, slow = (max(map(abs, trials.creep(e, 10.0))) for e in (ten, DEFAULT))
    assert fast > 5 * slow


def test_the_contact_that_must_slide_slides(done: Validation) -> None:
    own = done.agreement[0]
    assert own.engine == "MuJoCo"
    assert own.decisive_n > 0.75 * own.n > 40
    assert own.decisive_rate == 1.0
    assert own.rate > 0.95


def test_other_engines_are_tried_in_the_same_states(done: Validation) -> None:
    alike = [one for one in done.agreement if one.contacts == "two vertices"]
    assert [one.engine for one in alike] == ["MuJoCo", "pymunk", "Box2D"] and done.missing == ()
    assert len({one.n for one in alike}) == 1
    assert alike[1].decisive_rate > 0.97
    assert 0.8 < alike[2].decisive_rate < 1.0  # the skin of its polygons


def test_rounded_corners_and_contacts_with_the_floor_agree(done: Validation) -> None:
    assert [one.contacts for one in done.own] == [
        "two vertices", "rounded corners", "floor, one palm", "floor, both palms",
    ]  # fmt: skip
    for one in done.own[1:]:
        assert one.decisive_n > 1 and one.decisive_rate > 0.9


def test_switch_lines_tilts_and_carries_agree(done: Validation) -> None:
    closing = [line for line in done.switch_lines if line.closing]
    for line in closing:
        assert line.known_m is not None and line.seen_m is not None
        assert line.seen_m == pytest.approx(line.known_m, abs=1e-3)
    assert closing[0].known_m is not None and abs(closing[0].known_m) > 3e-3
    for tilt in done.tilts:
        assert tilt.seen_m == pytest.approx(tilt.known_m, abs=0.8e-3)
    assert max(abs(t.known_m[0]) for t in done.tilts) > 1.2e-3
    for pair in done.carries:
        assert pair.outcome == ("delivered", "delivered")
        assert pair.rms_m[1] == pytest.approx(pair.rms_m[0], rel=0.4)
    assert done.holds


def test_expectations_are_those_of_the_modes() -> None:
    """`expected` asks the world; `modes` knows by itself."""
    for state in trials.grid(0.25)[::37]:
        scene = trials.scene_of(Scene(), state)
        found = contact_modes(scene, p_left_m=state.contacts[0], p_right_m=state.contacts[1])
        for closing, pair in ((True, found.closing), (False, found.opening)):
            assert pair is not None
            slides = {"left": pair[0] != "ST", "right": pair[1] != "ST"}
            moving = trials.expected(trials.spec_of(scene), closing)
            assert (
                moving
                == {(True, False): "left", (False, True): "right", (True, True): "both"}[
                    slides["left"], slides["right"]
                ]
            )


def test_state_near_a_switch_line_is_not_decisive() -> None:
    on_it = State(0.3, 0.125, (15.0, 15.0), (0.0, 0.0))
    off_it = State(0.3, 0.125, (5.0, 15.0), (0.0, 0.0))
    sure = [
        trials.is_decisive(trials.spec_of(trials.scene_of(Scene(), state)), True)
        for state in (on_it, off_it)
    ]
    assert sure == [False, True]
    spec = trials.spec_of(trials.scene_of(Scene(), off_it))
    assert not trials.is_decisive(spec, True, math.radians(15))
    assert [palm.friction for palm in spec.palms] == [0.3, 0.3]  # as it was


def test_validation_holds_only_if_all_parts_hold(done: Validation) -> None:
    """Each of the three alone spoils it, right beyond its limit; peers do not count."""
    own, *peers = done.agreement
    peers = [replace(one, decisive_rate=1.0) for one in peers]
    pair = done.carries[0]
    fine = replace(own, decisive_rate=0.99)
    held = replace(done, agreement=(fine, *peers), creep_m=(-0.25e-3, 0.25e-3))
    assert held.holds
    poor = [replace(p, decisive_rate=0.5) for p in peers]
    assert replace(held, agreement=(fine, *peers[:3], *poor[3:])).holds
    for spoilt in (
        *(replace(held, agreement=(fine, *peers[:k], poor[k], *peers[k + 1 :])) for k in range(3)),
        replace(held, agreement=(replace(own, decisive_rate=0.9899), *peers)),
        replace(held, creep_m=(0.0, -0.2501e-3)),
        replace(held, creep_m=(0.2501e-3, 0.0)),
        replace(held, carries=(*done.carries, replace(pair, outcome=("delivered", "dropped")))),
    ):
        assert not spoilt.holds
    assert replace(held, carries=(replace(pair, outcome=("dropped", "dropped")),)).holds


def test_delivery_rates_are_reported(done: Validation) -> None:
    delivery = done.delivery
    assert (delivery.n, delivery.delivered) == (2, 2) and delivery.interval[1] == 1.0
    assert delivery.known == 1.0  # at the default noise nothing is dropped


@pytest.mark.soak
@pytest.mark.parametrize(("noise", "least", "most"), [(0.04, 0.6, 0.95), (0.055, 0.3, 0.8)])
def test_at_high_noise_both_worlds_deliver_as_often(
    noise: float, least: float, most: float
) -> None:
    """Where many carries fail, MuJoCo's interval holds the quasistatic rate."""
    scene = load_scene("paper", {"robot.noise_m_s": noise, "task.distance_m": 0.2})
    known = run_seeds(to_spec(scene), "distributed", 0, 4000, "double")["outcome"]
    rate = float((known == DELIVERED).mean())
    n = 60
    prepared = prepare(scene, "distributed", WORLD)
    delivered = sum(run(prepared, seed).measured.outcome == "delivered" for seed in range(n))
    low, high = wilson(delivered, n)
    assert low <= rate <= high and high - low < 0.26
    assert least < rate < most  # neither none nor all


@pytest.mark.slow
def test_the_command_reports_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for constant, few in FEW_LINES.items():
        monkeypatch.setattr(constant, few)
    arguments = ["validate", "--states", "3", "--carries", "1", "--out", str(tmp_path)]
    status = cli.run([*arguments, "--set", "task.distance_m=0.1", "--json"])
    result = read_json("validate", capsys.readouterr().out)
    assert status == (0 if result["holds"] else 1)
    assert len(result["carries"]) == 1
    compared = [(one["engine"], one["contacts"]) for one in result["agreement"]]
    assert compared == [
        ("MuJoCo", "two vertices"), ("MuJoCo", "rounded corners"),
        ("MuJoCo", "floor, one palm"), ("MuJoCo", "floor, both palms"),
        ("pymunk", "two vertices"), ("Box2D", "two vertices"),
    ]  # fmt: skip
    picture = Image.open(tmp_path / "validation.png")
    assert picture.width > 1000 and len(picture.convert("RGB").getcolors(1 << 20) or ()) > 50


class Holding:
    """A controller that never corrects."""

    def step(self, seen: StepInput) -> StepOutput:
        return StepOutput()


def test_python_controller_is_validated(monkeypatch: pytest.MonkeyPatch) -> None:
    for constant, few in FEW_LINES.items():
        monkeypatch.setattr(constant, few)
    scene = load_scene("paper", {"task.distance_m": 0.05, "robot.noise_m_s": 0.0})
    result = validate(scene, controller=Holding, states=1, carries=1)
    assert result.controller == "Holding"
    assert result.carries[0].outcome == ("delivered", "delivered")
    assert (result.delivery.known_n, result.delivery.known) == (100, 1.0)


def test_validate_is_part_of_the_package() -> None:
    assert pb.validate is validate
