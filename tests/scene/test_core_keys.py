# SPDX-License-Identifier: Apache-2.0
"""The table of keys in the core, and the sections of a scene in Python, which take it up."""

import math
import random
from collections.abc import Iterator
from typing import Any, get_args

import pytest
from pydantic import BaseModel

import palmbots._core as _core
from palmbots.scene.core_keys import OUTSIDE_CORE, ROWS
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec
from random_keys import CARRIED_ROWS, agreeing_value, holders_of, names_in, random_keys

POINTS = {"object.vertices_m": ("[][0]", "[][1]"), "object.edge_radius_m": ("[]",)} | {
    f"object.{name}": ("[0]", "[1]") for name in ("contacts", "com_m", "box_m")
}


def models_in(kind: Any) -> Iterator[type[BaseModel]]:
    """The tables that a field holds."""
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield kind
    for part in get_args(kind):
        yield from models_in(part)


def keys_of(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """The keys of a scene by the names of the core's table."""
    for name, field in model.model_fields.items():
        path = prefix + name
        tables = list(models_in(field.annotation))
        is_in_table = any(row.startswith(path) for row in ROWS)
        if path.startswith(OUTSIDE_CORE) and not is_in_table:
            continue
        if name in ("left", "right", "station"):
            continue
        if path in POINTS:
            yield from (path + entry for entry in POINTS[path])
        elif tables:
            is_list = "tuple" in str(field.annotation)
            yield from keys_of(tables[0], f"{path}[]." if is_list else f"{path}.")
        else:
            yield path


def test_every_key_of_a_scene_is_in_the_table_or_outside_the_core() -> None:
    assert set(keys_of(Scene)) == set(ROWS)


def test_the_default_scene_is_that_of_the_core() -> None:
    assert to_spec(Scene()).to_bytes() == _core.spec_of_scene({}).to_bytes()


def test_random_scenes_have_every_key() -> None:
    draw = random.Random(1)
    found = {name for _ in range(30) for name in names_in(random_keys(draw))}
    assert found >= CARRIED_ROWS


OF_THE_LOAD = tuple(name for name in ROWS if name.startswith("mujoco.") and "[" not in name)
CHECKED_ONLY = ("object.mass_kg", "object.depth_m", *OF_THE_LOAD)
"""Keys that decide only whether the object is accepted."""

NEEDED = {
    "palm.usable_m": {"palm.length_m": 0.3},
    "palm.nose_m": {"palm.thickness_m": 0.1, "palm.bevel_m": 0.1},
}
"""Other keys without which a value is refused."""


@pytest.mark.parametrize("name", OF_THE_LOAD)
def test_every_key_of_the_load_reaches_its_limits(name: str) -> None:
    value = 1.1 * (ROWS[name]["default"] or 0.2)
    loads = [
        _core.heaviest_loads(as_given(load_scene("paper", keys)), math.inf, False)
        for keys in ({}, {name: value})
    ]
    assert loads[0] != loads[1]


@pytest.mark.parametrize("name", [n for n in ROWS if "[" not in n and n not in CHECKED_ONLY])
def test_every_key_reaches_the_spec(name: str) -> None:
    """Its value changes the bytes, for all and for each robot or sender alone."""
    draw = random.Random(2)
    needed = NEEDED.get(name, {})
    without = to_spec(load_scene("paper", needed)).to_bytes()
    seen: set[bytes] = set()
    for given in holders_of(name):
        value = None
        while value is None or value == ROWS[name]["default"]:
            value = agreeing_value(given, name, needed, draw)
        seen.add(to_spec(load_scene("paper", {given: value} | needed)).to_bytes())
    assert len(seen | {without}) == len(holders_of(name)) + 1
