# SPDX-License-Identifier: Apache-2.0
"""Random bytes, tables and overrides: each loads as a scene or is refused in one line."""

import copy
import tomllib

from hypothesis import given, settings
from hypothesis import strategies as st

from palmbots.errors import SceneError
from palmbots.scene.error_messages import dotted_keys
from palmbots.scene.scene import Scene, load_scene
from strategies import scene_tables

KEYS = sorted(dotted_keys(Scene))


@given(st.binary() | st.text().map(lambda text: text.encode("utf-8", "surrogatepass")))
def test_any_bytes_load_or_are_refused_in_one_line(tmp_path_factory, data):
    path = tmp_path_factory.getbasetemp() / "any.toml"
    path.write_bytes(data)
    try:
        load_scene(path)
    except SceneError as error:
        assert str(error).startswith(f"{path}: ")
        assert str(error).isprintable()


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
def test_any_table_loads_or_is_refused_in_one_line(table):
    is_a_scene_or_refused(table)


@given(scene_tables(), st.sampled_from(KEYS), junk)
def test_any_value_of_any_key_loads_or_is_refused_in_one_line(table, key, value):
    is_a_scene_or_refused(table, {key: value})


@given(scene_tables(), st.dictionaries(names | st.sampled_from(KEYS), junk, max_size=3))
def test_any_overrides_load_or_are_refused_in_one_line(table, overrides):
    is_a_scene_or_refused(table, overrides)


@settings(max_examples=150)
@given(
    st.lists(
        st.tuples(st.integers(-3, 3), st.integers(-3, 3)).map(lambda p: [p[0] / 10, p[1] / 10]),
        min_size=1,
        max_size=7,
    ),
    st.lists(st.integers(-1, 7), min_size=2, max_size=2),
    st.lists(st.integers(-3, 3).map(lambda x: x / 10), min_size=2, max_size=2),
)
def test_any_object_loads_or_is_refused_in_one_line(vertices, contacts, com):
    is_a_scene_or_refused({"object": {"vertices_m": vertices, "contacts": contacts, "com_m": com}})
