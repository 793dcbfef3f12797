"""Scenes: what they hold, where they come from, and one clear line for everything that is wrong."""

import copy
import json
import math
import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from palmbots.carry import carry
from palmbots.complaints import dotted_keys
from palmbots.errors import SceneError
from palmbots.scene import Scene, load_scene
from palmbots.scene_files import built_in_scenes
from strategies import scene_tables, scenes

PAPER = Scene()
KEYS = sorted(dotted_keys(Scene))


def refusal(source, overrides=None) -> str:
    with pytest.raises(SceneError) as error:
        load_scene(source, overrides)
    line = str(error.value)
    assert line.isprintable(), "a message is one line"
    return line


# --- What a scene holds ---------------------------------------------------------------------------


def test_the_default_is_the_scene_paper_which_gives_every_key():
    assert load_scene("paper") == PAPER
    given_keys = {
        f"{section}.{key}" for section, keys in PAPER.model_dump().items() for key in keys
    } - {"task.path"} | {f"task.path.{key}" for key in PAPER.task.path.model_dump()}
    optional = {"palm.slip_deg", "tactile.zones", "radio.lease_s", "task.timeout_s"}
    optional |= {"dynamic.axle_m"} | {k for k in KEYS if k.startswith("task.path.")}
    assert given_keys | optional == {k for k in KEYS if ".left." not in k and ".right." not in k}


def test_the_papers_numbers():
    assert PAPER.object.vertices_m == ((0, 0), (0.25, 0), (0.25, 0.16), (0, 0.16))
    assert PAPER.object.com_m == (0.125, 0.04)
    assert (PAPER.object.mass_kg, PAPER.object.depth_m) == (0.5, 0.1)
    palm = PAPER.palm_of("left")
    assert (palm.length_m, palm.width_m, palm.shallow_deg, palm.steep_deg) == (0.15, 0.07, 5, 15)
    assert PAPER.task.distance_m == 1.5
    assert PAPER.timeout_s == 50  # twice the paper's 25 s
    assert PAPER.timeout_ticks == 5000


def test_the_other_built_in_scenes_are_the_paper_with_a_difference():
    assert built_in_scenes() == ["figure8", "paper", "paper-offset"]
    assert load_scene("paper-offset") == load_scene(PAPER, {"palm.pivot_offset_m": 0.01})
    figure8 = load_scene("figure8")
    assert figure8.robot.noise_m_s == 0
    assert figure8.bumps.script
    same = {"bumps": None, "robot.noise_m_s": None, "task.distance_m": None}
    assert load_scene(figure8, same) == PAPER


def test_a_side_may_differ():
    scene = load_scene("paper", {"palm.left": {"friction": 0.4}, "robot.right.bias_m_s": 0.002})
    assert scene.palm_of("left").friction == 0.4
    assert scene.palm_of("left").steep_deg == 15
    assert scene.palm_of("right") == PAPER.palm_of("right")
    assert scene.robot_of("right").bias_m_s == 0.002
    assert scene.robot_of("left") == PAPER.robot_of("left")


def test_the_timeout_follows_distance_and_the_slower_robot_unless_given():
    assert load_scene("paper", {"task.distance_m": 3}).timeout_s == 100
    assert load_scene("paper", {"robot.left.speed_m_s": 0.03}).timeout_s == 100
    # A millimetre is gone before nominal speed is reached: time to speed up counts as well.
    short = {"task.distance_m": 0.001}
    assert load_scene("paper", short).timeout_s == pytest.approx(0.001 / 0.06 + 2 * 0.06 / 0.5)
    assert carry(overrides=short).outcome == "delivered"
    slow = {"robot.acceleration_m_s2": 0.001}
    assert carry(overrides=slow, record=False).outcome == "delivered"
    given_one = load_scene("paper", {"task.timeout_s": 7})
    assert (given_one.timeout_s, given_one.timeout_ticks) == (7, 700)
    assert load_scene(given_one, {"task.timeout_s": None}) == PAPER


def test_a_scene_cannot_be_changed():
    with pytest.raises(ValidationError):
        PAPER.task.distance_m = 2.0
    assert hash(PAPER) == hash(load_scene("paper"))


def test_mirroring():
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
                {"kind": "reboot", "robot": "right", "at_s": 1, "for_s": 1},
                {"kind": "station", "at_s": 1, "for_s": 1},
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
def test_mirroring_twice_gives_the_scene_back(scene):
    assert scene.mirrored() != scene
    assert scene.mirrored().mirrored() == scene


@given(scenes())
def test_round_trips(scene):
    table = scene.model_dump()
    assert load_scene(table) == scene
    assert load_scene(tomllib.loads(scene.to_toml())) == scene
    assert load_scene(json.loads(json.dumps(table, allow_nan=False))) == scene
    assert load_scene(scene) is scene
    assert load_scene(scene, {}) is scene


@given(scene_tables(), st.data())
def test_an_override_is_the_same_as_a_key_in_the_file(table, data):
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


def test_files(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text("[radio]\nloss = 0.25\n", encoding="utf-8")
    assert load_scene(path).radio.loss == 0.25
    assert load_scene(str(path), {"radio.loss": 0.5}).radio.loss == 0.5
    path.write_bytes(b"\xef\xbb\xbf[radio]\r\nloss = 0.25\r\n")  # as some editors save it
    assert load_scene(path).radio.loss == 0.25
    path.write_text("")
    assert load_scene(path) == PAPER


def test_a_built_in_name_goes_before_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "paper").write_text("[radio]\nloss = 0.25\n")
    assert load_scene("paper") == PAPER
    assert load_scene("./paper").radio.loss == 0.25


def test_files_that_cannot_be_read(tmp_path):
    names = "built-in scenes: figure8, paper, paper-offset"
    assert refusal("papr") == f"papr: no such scene or file; did you mean paper? {names}"
    assert refusal("x/y.toml") == f"x/y.toml: no such scene or file; {names}"
    assert refusal(tmp_path) == f"{tmp_path}: is a folder; allowed: a scene file in TOML"
    assert refusal("a\0b") == "a\\x00b: cannot be read: embedded null byte"
    assert refusal("/dev/zero") == "/dev/zero: is larger than 1 MiB; allowed: a scene file in TOML"
    assert refusal("/proc/self/mem") == "/proc/self/mem: cannot be read: Input/output error"
    assert refusal("paper/x.toml") == f"paper/x.toml: no such scene or file; {names}"


@pytest.mark.parametrize(
    ("data", "line"),
    [
        (
            b"[radio]\nloss = \xff\n",
            "line 2 is not UTF-8 (byte 0xff); allowed: a scene file in TOML, which is UTF-8",
        ),
        (b"[radio]\nloss = \n", "line 2, column 8: not valid TOML: Invalid value"),
        (
            b"[radio]\nloss = 1\nloss = 2\n",
            "line 3, column 9: not valid TOML: Cannot overwrite a value",
        ),
        (
            b"[radio]\nloss = [1,\n",
            "line 3, end of the file: not valid TOML: Invalid value",
        ),
        (b"a = " + b"[" * 5000, "not valid TOML: lists nested too deeply"),
        (
            b"[radio]\nloss = 0" + b"x",
            "line 2, column 9: not valid TOML: Expected newline or end of document after a "
            "statement",
        ),
    ],
)
def test_files_that_are_no_toml(tmp_path, data, line):
    path = tmp_path / "bad.toml"
    path.write_bytes(data)
    assert refusal(path) == f"{path}: {line}"


@given(st.binary() | st.text().map(lambda text: text.encode("utf-8", "surrogatepass")))
def test_any_file_is_a_scene_or_refused_in_one_line(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(data)
    try:
        load_scene(path)
    except SceneError as error:
        assert str(error).startswith(f"{path}: ")
        assert str(error).isprintable()


def test_sources_that_are_none():
    allowed = "allowed: a built-in name, a path, a table or a Scene"
    assert refusal(3) == f"3: is no scene; {allowed}"
    assert refusal(None) == f"null: is no scene; {allowed}"
    assert refusal("paper", [1]) == "overrides: [1] is not a table; allowed: {key: value}"


# --- Anything at all ------------------------------------------------------------------------------

scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text()
    | st.dates()
    | st.sampled_from(["left", "right", "forward", "+", "-", "0"])
)
names = st.text() | st.sampled_from([part for key in KEYS for part in key.split(".")])
junk = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(names, inner, max_size=4),
    max_leaves=12,
)


def is_a_scene_or_refused(table, overrides=None) -> None:
    before = copy.deepcopy((table, overrides))
    try:
        scene = load_scene(table, overrides)
    except SceneError as error:
        assert str(error).isprintable()
        assert ": " in str(error)
    else:
        assert load_scene(scene.model_dump()) == scene
        assert load_scene(tomllib.loads(scene.to_toml())) == scene
        assert scene.mirrored().mirrored() == scene
    assert repr((table, overrides)) == repr(before), "the arguments stay as they are"


@given(st.dictionaries(names, junk, max_size=4))
def test_any_table(table):
    is_a_scene_or_refused(table)


@given(scene_tables(), st.sampled_from(KEYS), junk)
def test_any_value_of_any_key(table, key, value):
    is_a_scene_or_refused(table, {key: value})


@given(scene_tables(), st.dictionaries(names | st.sampled_from(KEYS), junk, max_size=3))
def test_any_overrides(table, overrides):
    is_a_scene_or_refused(table, overrides)


@settings(max_examples=300)
@given(
    st.lists(
        st.tuples(st.integers(-3, 3), st.integers(-3, 3)).map(lambda p: [p[0] / 10, p[1] / 10]),
        min_size=1,
        max_size=7,
    ),
    st.lists(st.integers(-1, 7), min_size=2, max_size=2),
    st.lists(st.integers(-3, 3).map(lambda x: x / 10), min_size=2, max_size=2),
)
def test_any_object(vertices, contacts, com):
    is_a_scene_or_refused({"object": {"vertices_m": vertices, "contacts": contacts, "com_m": com}})


def test_friction_as_a_measured_slip_angle():
    scene = load_scene("paper", {"palm.slip_deg": 20.0, "palm.left.friction": 0.4})
    assert scene.palm_of("left").friction == 0.4
    assert scene.palm_of("right").friction == pytest.approx(math.tan(math.radians(20)), rel=1e-15)
    assert load_scene(scene.model_dump()) == scene
    assert load_scene(tomllib.loads(scene.to_toml())) == scene
    assert scene.mirrored().palm_of("right").friction == 0.4
    own = load_scene("paper", {"palm.friction": 0.5, "palm.left.slip_deg": 10.0})
    assert own.palm_of("left").friction == pytest.approx(math.tan(math.radians(10)), rel=1e-15)
    assert own.palm_of("right").friction == 0.5
    with pytest.raises(SceneError, match="slip_deg"):
        load_scene("paper", {"palm.slip_deg": 95.0})
