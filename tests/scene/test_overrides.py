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


@given(st.text())
def test_any_text_is_parsed_or_refused_in_one_line(text):
    try:
        key, _ = parse_override(text)
    except SceneError as error:
        assert str(error).isprintable()
    else:
        assert key and text.lstrip().startswith(key)


def test_a_straight_path_needs_no_keys_of_the_curve_below() -> None:
    """So a question about a curved scene can be asked for a straight path, too."""
    curved = {"task": {"path": {"kind": "arc", "radius_m": 3.0, "angle_deg": 45.0}}}
    assert load_scene(curved, {"task.path.kind": "straight"}) == load_scene("paper")
    assert load_scene(curved, {"task.path.kind": "s"}).task.path.radius_m == 3.0
    with pytest.raises(SceneError, match="radius_m"):
        load_scene(curved, {"task.path": {"kind": "straight", "radius_m": 2.0}})
