# SPDX-License-Identifier: Apache-2.0
"""``--set KEY=VALUE``: what is understood, what is refused, and how."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palmbots.errors import SceneError
from palmbots.scene.overrides import merged, parse_override, parse_overrides
from palmbots.scene.scene import load_scene


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("radio.loss=0.1", "radio.loss", 0.1),
        (" radio.loss = 1 ", "radio.loss", 1),
        ("palm.left.friction=.4", "palm.left.friction", ".4"),  # no TOML: validation will say so
        ("task.direction=backward", "task.direction", "backward"),
        ('task.direction="backward"', "task.direction", "backward"),
        ("task.direction='backward'", "task.direction", "backward"),
        ("object.contacts=[0, 1]", "object.contacts", [0, 1]),
        ("object.vertices_m=[[0,0],[1,0],[1,1]]", "object.vertices_m", [[0, 0], [1, 0], [1, 1]]),
        ("palm.left={friction=0.4}", "palm.left", {"friction": 0.4}),
        ("a=b=c", "a", "b=c"),
        ("palm.friction=true", "palm.friction", True),
        ("palm.steep_deg=15deg", "palm.steep_deg", "15deg"),
    ],
)
def test_key_and_value_are_parsed(text, key, value):
    assert parse_override(text) == (key, value)


FORM = 'allowed: KEY=VALUE with a dotted key and a TOML value, as in radio.loss=0.1 or task.direction="backward"'  # noqa: E501


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("radio.loss", f"--set radio.loss: is not of the form KEY=VALUE; {FORM}"),
        ("=3", f"--set =3: is not of the form KEY=VALUE; {FORM}"),
        ("", f"--set : is not of the form KEY=VALUE; {FORM}"),
        ("radio..loss=3", f"--set radio..loss=3: is not of the form KEY=VALUE; {FORM}"),
        ("radio.loss=", f"--set radio.loss=: the value is missing; {FORM}"),
        ("a=[1, 2", f"--set a=[1, 2: the value is not TOML; {FORM}"),
        ('a="x', f'--set a="x: the value is not TOML; {FORM}'),
        ("a=[1]\nb=2", f"--set a=[1]\\nb=2: is more than one line; {FORM}"),
        ("a=1\nb=2", f"--set a=1\\nb=2: is more than one line; {FORM}"),
        ("a=" + "[" * 5000, f"--set a={'[' * 5000}: the value is nested too deeply; {FORM}"),
    ],
)
def test_malformed_override_is_refused_in_one_line(text, line):
    with pytest.raises(SceneError) as error:
        parse_override(text)
    assert str(error.value) == line


@pytest.mark.parametrize(
    "texts",
    [
        ["a.b=1", "c=2", "a.b=3"],
        ["a.b=1", " a.b = 1 "],
        ["a={b=1}", "a.b=3"],
        ["a.b=3", "a={b=1, c=2}"],
        ["a={b=1}", "a={b=1}"],
        ["a.b=1", "a.b={c=2}"],
        ["a.b={c=2}", "a.b=1"],
        ["a.b={}", "a.b=1"],
    ],
)
def test_key_given_twice_is_refused(texts):
    with pytest.raises(SceneError) as error:
        parse_overrides(texts)
    assert str(error.value) == "--set a.b: is given twice; allowed: each key once"


def test_different_keys_of_one_table_are_all_set():
    assert parse_overrides(["a.b=1", "a.c=2", "a={d=3}", "a={e=4}"]) == {
        "a.b": 1, "a.c": 2, "a": {"d": 3, "e": 4}
    }  # fmt: skip


def test_tables_are_merged_without_changing_the_arguments():
    data = {"palm": {"friction": 0.3, "left": {"friction": 0.4}}, "radio": {"loss": 0}}
    overrides = {"palm.left.steep_deg": 20, "palm": {"friction": 0.5}, "task": {"distance_m": 1}}
    assert merged(data, overrides) == {
        "palm": {"friction": 0.5, "left": {"friction": 0.4, "steep_deg": 20}},
        "radio": {"loss": 0},
        "task": {"distance_m": 1},
    }
    assert data == {"palm": {"friction": 0.3, "left": {"friction": 0.4}}, "radio": {"loss": 0}}


def test_none_removes_a_key():
    data = {"palm": {"friction": 0.3, "left": {"friction": 0.4}}}
    assert merged(data, {"palm.left.friction": None}) == {"palm": {"friction": 0.3, "left": {}}}
    assert merged(data, {"palm": {"left": None}}) == {"palm": {"friction": 0.3}}
    assert merged(data, {"radio.loss": None, "task": None}) == {**data, "radio": {}}


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        (
            {"palm.friction.x": 1},
            "overrides: palm.friction.x: palm.friction is 0.3, which holds no keys; "
            "allowed: a key inside a table",
        ),
        (
            {"palm": 3, "palm.left.friction": 1},
            "overrides: palm.left.friction: palm is 3, which holds no keys; "
            "allowed: a key inside a table",
        ),
        ({3: 1}, "overrides: 3 is not a key; allowed: a dotted key"),
    ],
)
def test_key_below_a_value_that_is_not_a_table_is_refused(overrides, line):
    with pytest.raises(SceneError) as error:
        merged({"palm": {"friction": 0.3}}, overrides)
    assert str(error.value) == line


def test_messages_begin_with_the_given_name_of_the_overrides():
    for keys in ({"palm.friction.x": 1}, {"palm.friction": -1}):
        with pytest.raises(SceneError, match=r"^overrides: palm\.friction"):
            load_scene("paper", keys)
        with pytest.raises(SceneError, match=r"^--set palm\.friction"):
            load_scene("paper", keys, called="--set")


@given(st.text())
def test_any_text_is_parsed_or_refused_in_one_line(text):
    try:
        key, _ = parse_override(text)
    except SceneError as error:
        assert str(error).isprintable()
    else:
        assert key and text.lstrip().startswith(key)
