# SPDX-License-Identifier: Apache-2.0
"""Scenes: what they hold and where they come from."""

import json
import math
import tomllib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from commands import unwrapped
from palmbots.errors import SceneError
from palmbots.scene.error_messages import dotted_keys
from palmbots.scene.files import built_in_scenes
from palmbots.scene.scene import Scene, load_scene
from palmbots.simulation.single import carry
from strategies import scene_tables, scenes

PAPER = Scene()

KEYS = sorted(dotted_keys(Scene))


# --- What a scene holds ---------------------------------------------------------------------------


def test_default_scene_is_paper_which_gives_every_key():
    assert load_scene("paper") == PAPER
    given_keys = {
        f"{section}.{key}" for section, keys in PAPER.model_dump().items() for key in keys
    } - {"task.path"} | {f"task.path.{key}" for key in PAPER.task.path.model_dump()}
    optional = {"palm.friction_angle_deg", "tactile.zones", "radio.lease_s", "task.timeout_s"}
    optional |= {
        "palm.usable_m",
        "palm.nose_m",
        "object.box_m",
        "robot.motor_force_n",
        "robot.traction_n",
    }
    optional |= {"mujoco.axle_m", "robot.period_s", "robot.error_trace", "radio.trace"} | {
        k for k in KEYS if k.startswith(("task.path.", "task.route."))
    }
    optional |= {k for k in KEYS if k.startswith("radio.station.")}
    assert given_keys | optional == {k for k in KEYS if ".left." not in k and ".right." not in k}


def test_numbers_of_the_paper():
    assert PAPER.object.vertices_m == ((0, 0), (0.25, 0), (0.25, 0.16), (0, 0.16))
    assert PAPER.object.com_m == (0.125, 0.04)
    assert (PAPER.object.mass_kg, PAPER.object.depth_m) == (0.5, 0.1)
    palm = PAPER.palm_of("left")
    assert (palm.length_m, palm.width_m, palm.shallow_deg, palm.steep_deg) == (0.15, 0.07, 5, 15)
    assert PAPER.task.distance_m == 1.5
    assert PAPER.timeout_s == 50  # twice the paper's 25 s


def test_other_built_in_scenes_differ_from_paper_in_few_keys():
    own = [
        *(
            "around-wall",
            "figure8",
            "handover",
            "lift",
            "lone",
            "paper",
            "paper-offset",
            "pipe",
            "plate",
            "stand",
        )
    ]
    assert built_in_scenes() == own
    route = {"task.route": None}
    assert load_scene("around-wall", route) == load_scene("lift")
    assert load_scene("paper-offset") == load_scene(PAPER, {"palm.pivot_offset_m": 0.01})
    figure8 = load_scene("figure8")
    assert figure8.robot.noise_m_s == 0
    assert figure8.bumps.script
    same = {"bumps": None, "robot.noise_m_s": None, "task.distance_m": None}
    assert load_scene(figure8, same) == PAPER


def test_side_override_changes_one_side_only():
    scene = load_scene("paper", {"palm.left": {"friction": 0.4}, "robot.right.bias_m_s": 0.002})
    assert scene.palm_of("left").friction == 0.4
    assert scene.palm_of("left").steep_deg == 15
    assert scene.palm_of("right") == PAPER.palm_of("right")
    assert scene.robot_of("right").bias_m_s == 0.002
    assert scene.robot_of("left") == PAPER.robot_of("left")


def test_default_timeout_depends_on_distance_and_slower_robot():
    assert load_scene("paper", {"task.distance_m": 3}).timeout_s == 100
    assert load_scene("paper", {"robot.left.speed_m_s": 0.03}).timeout_s == 100
    # A millimetre is gone before nominal speed is reached: time to speed up counts as well.
    short = {"task.distance_m": 0.001}
    assert load_scene("paper", short).timeout_s == pytest.approx(0.001 / 0.06 + 2 * 0.06 / 0.5)
    assert carry(overrides=short).outcome == "delivered"
    slow = {"robot.acceleration_m_s2": 0.001}
    assert carry(overrides=slow, record=False).outcome == "delivered"
    given_one = load_scene("paper", {"task.timeout_s": 7})
    assert given_one.timeout_s == 7
    assert load_scene(given_one, {"task.timeout_s": None}) == PAPER


def test_scene_is_immutable_and_hashable():
    with pytest.raises(ValidationError):
        PAPER.task.distance_m = 2.0  # ty: ignore[invalid-assignment]  # is refused
    assert hash(PAPER) == hash(load_scene("paper"))


def test_mirrored_scene_exchanges_the_sides():
    scene = load_scene(
        "paper",
        {
            "object.com_m": [0.1, 0.05],
            "palm.left.friction": 0.4,
            "robot.right.bias_m_s": 0.002,
            "start.left_m": 0.01,
            "bumps.script": [{"robot": "left", "at_s": 1, "shift_m": 0.01}],
            "radio.outages": [
                {"sender": sender, "start_s": 1, "end_s": 2} for sender in ("left", "station")
            ],
            "faults.script": [
                {"kind": "reboot", "robot": "right", "at_s": 1, "duration_s": 1},
                {"kind": "station-down", "at_s": 1, "duration_s": 1},
            ],
            "task.slope_deg": 2,
        },
    )
    mirror = scene.mirrored()
    assert [outage.sender for outage in mirror.radio.outages] == ["right", "station"]
    assert [fault.robot for fault in mirror.faults.script] == ["left", None]
    assert mirror.object.com_m == (-0.1, 0.05)
    assert mirror.object.contacts == (1, 0)
    assert mirror.palm_of("right").friction == 0.4
    assert mirror.palm_of("left") == scene.palm_of("right")
    assert mirror.robot_of("left").bias_m_s == 0.002
    assert (mirror.start.left_m, mirror.start.right_m) == (0, 0.01)
    assert mirror.bumps.script[0].robot == "right"
    assert mirror.task.direction == "backward"
    assert mirror.task.slope_deg == 2  # uphill in travel stays uphill in travel


@given(scenes())
def test_dump_toml_and_json_load_as_the_same_scene(scene):
    table = scene.model_dump()
    assert load_scene(table) == scene
    assert load_scene(tomllib.loads(scene.to_toml())) == scene
    assert load_scene(json.loads(json.dumps(table, allow_nan=False))) == scene
    assert load_scene(scene) is scene
    assert load_scene(scene, {}) is scene


@given(scene_tables(), st.data())
def test_override_equals_key_in_the_file(table, data):
    section = data.draw(st.sampled_from(sorted(table)))
    partial = {k: v for k, v in table.items() if k != section}
    try:
        base = load_scene(partial)
    except SceneError:  # what is left need not fit together
        return
    flat = {f"{section}.{key}": value for key, value in table[section].items()}
    assert load_scene(base, flat) == load_scene(base, {section: table[section]})
    assert load_scene(base, flat) == load_scene(table)


# --- Where scenes come from -----------------------------------------------------------------------


def test_scene_files_are_read_with_bom_and_crlf(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("[radio]\nloss = 0.25\n", encoding="utf-8")
    assert load_scene(path).radio.loss == 0.25
    assert load_scene(str(path), {"radio.loss": 0.5}).radio.loss == 0.5
    path.write_bytes(b"\xef\xbb\xbf[radio]\r\nloss = 0.25\r\n")  # as some editors save it
    assert load_scene(path).radio.loss == 0.25


def test_built_in_name_takes_precedence_over_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper").write_text("[radio]\nloss = 0.25\n")
    assert load_scene("paper") == PAPER
    assert load_scene("./paper").radio.loss == 0.25


# --- Friction, as a coefficient or as an angle ----------------------------------------------------


def test_friction_angle_sets_the_coefficient():
    scene = load_scene("paper", {"palm.friction_angle_deg": 20.0, "palm.left.friction": 0.4})
    assert scene.palm_of("left").friction == 0.4
    assert scene.palm_of("right").friction == pytest.approx(math.tan(math.radians(20)), rel=1e-15)
    assert load_scene(scene.model_dump()) == scene
    assert load_scene(tomllib.loads(scene.to_toml())) == scene
    assert scene.mirrored().palm_of("right").friction == 0.4
    own = load_scene("paper", {"palm.friction": 0.5, "palm.left.friction_angle_deg": 10.0})
    assert own.palm_of("left").friction == pytest.approx(math.tan(math.radians(10)), rel=1e-15)
    assert own.palm_of("right").friction == 0.5


def test_override_of_one_way_to_give_friction_replaces_the_other():
    tangent = pytest.approx(math.tan(math.radians(20)), rel=1e-15)
    angled = load_scene({"palm": {"friction": 0.4}}, {"palm.friction_angle_deg": 20.0})
    assert angled.palm_of("left").friction == tangent
    assert "friction" not in angled.model_dump()["palm"]
    again = load_scene(angled, {"palm.friction": 0.25})
    assert again.palm_of("left").friction == 0.25
    assert again == load_scene("paper", {"palm.friction": 0.25})
    side = load_scene(angled, {"palm": {"left": {"friction": 0.5}}})
    assert (side.palm_of("left").friction, side.palm_of("right").friction) == (0.5, tangent)
    back = load_scene(side, {"palm.left.friction_angle_deg": 20.0})
    assert back.palm_of("left").friction == tangent


# --- Warnings -------------------------------------------------------------------------------------


def warnings_of(source) -> list[str]:
    lines: list[str] = []
    load_scene(source, on_warning=lines.append)
    return lines


def test_empty_table_is_reported():
    assert warnings_of({}) == ["scene: nothing is set; this is the scene paper"]


def test_empty_section_is_reported_and_others_are_not(tmp_path):
    file = tmp_path / "some.toml"
    file.write_text("[object]\n[radio]\nloss = 0.1\n")
    expected = f"{file}: [object] sets nothing; it has the values of the scene paper"
    assert warnings_of(file) == [expected]
    file.write_text("[radio]\nloss = 0.1\n")
    for source in (file, "paper", "figure8", PAPER, {"object": "tray"}):
        assert warnings_of(source) == []


def test_commands_print_a_warning_for_an_empty_section(tmp_path, capsys, monkeypatch):
    from palmbots.cli import main as cli

    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text("[radio]\n[task]\ndistance_m = 0.05\n")
    (tmp_path / "s.toml").write_text('scene = "a.toml"\n[seeds]\ncount = 1\n')
    (tmp_path / "empty.toml").write_text("")
    line = "a.toml: [radio] sets nothing; it has the values of the scene paper\n"
    for arguments in (
        ["carry", "a.toml"],
        ["compare", "a.toml", "-n", "1", "--values", "0.05"],
        ["study", "s.toml", "--estimate-cost"],
    ):
        assert cli.run(arguments) == 0
        assert f"palmbots: warning: {line}" in unwrapped(capsys.readouterr().err)
    assert cli.run(["study", "empty.toml", "--estimate-cost"]) == 0
    line = "empty.toml: nothing is set; this study runs the scene paper\n"
    assert capsys.readouterr().err == f"palmbots: warning: {line}"


def test_numpy_numbers_are_accepted():
    for number in (np.float64(0.5), np.float32(0.5)):
        assert load_scene("paper", {"radio.loss": number}).radio.loss == 0.5
    one = load_scene("paper", {"radio.loss": np.int64(1), "object.contacts": [np.int8(0), 1]})
    assert type(one.radio.loss) is float
    assert type(one.object.contacts[0]) is int
