# SPDX-License-Identifier: Apache-2.0
"""`palmbots schema`: the schemas accept what the package writes, and refuse what it refuses."""

import copy
import json
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from typer.main import get_command

import palmbots as pb
from commands import Run
from json_output import records
from palmbots.cli.json_schemas import schema_names, schema_of
from palmbots.cli.main import build_app
from palmbots.errors import SceneError
from palmbots.logs.mcap_writer import write_log
from palmbots.scene.files import built_in_scenes, read_scene
from palmbots.scene.scene import load_scene
from strategies import scene_tables

SCENES = Draft202012Validator(schema_of("scene"))
REFUSALS = Path(__file__).parents[1] / "laws" / "refusals" / "scenes.toml"


def plain(value: Any) -> Any:
    """As after a file: lists in place of tuples."""
    return json.loads(json.dumps(value))


@pytest.mark.parametrize("name", schema_names())
def test_schema_is_one(name: str) -> None:
    """With what it says of a scene, which is the same everywhere, once."""
    schema = schema_of(name)
    if name != "scene":
        tables: Any = SCENES.schema
        known = {"Scene": {"properties": tables["properties"]}, **tables["$defs"]}
        for table in known.keys() & schema.get("$defs", {}).keys():
            assert schema["$defs"].pop(table).items() >= known[table].items()
    Draft202012Validator.check_schema(schema)


def test_every_command_has_a_schema() -> None:
    group: Any = get_command(build_app())
    assert set(schema_names()) - {"scene", "log"} == set(group.commands)


def test_schema_is_printed(here: Run) -> None:
    shown, short = here("schema", "scene"), here("schema", "scene", "--json")
    assert json.loads(shown.stdout) == json.loads(short.stdout) == schema_of("scene")
    assert short.stdout.count("\n") == 1


@pytest.mark.parametrize(
    "options", [{"friction": (0.05, 0.5)}, {"claims": ["clearance"], "shallow_deg": (0.0, 5.0)}]
)
def test_schema_of_certify_describes_every_witness(options: Any) -> None:
    schema = Draft202012Validator(schema_of("certify"))
    table = plain(pb.certify("paper", **options).summary())
    assert table["verdict"] == "fails"
    schema.validate(table)
    for key in table["witness"]:
        damaged = copy.deepcopy(table)
        del damaged["witness"][key]
        assert not schema.is_valid(damaged)


@pytest.mark.parametrize("name", built_in_scenes())
def test_built_in_scenes_and_their_dumps_validate(name: str) -> None:
    SCENES.validate(read_scene(name)[1])
    SCENES.validate(plain(load_scene(name).model_dump()))


@given(scene_tables())
def test_random_scenes_validate(table: dict[str, Any]) -> None:
    SCENES.validate(plain(table))
    SCENES.validate(plain(load_scene(table).model_dump()))


def leaves(table: Mapping[str, Any], path: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    for key, value in table.items():
        if isinstance(value, Mapping):
            yield from leaves(value, (*path, key))
        else:
            yield (*path, key)


def with_value(table: dict[str, Any], path: tuple[str, ...], value: Any) -> dict[str, Any]:
    changed = copy.deepcopy(table)
    inner = changed
    for key in path[:-1]:
        inner = inner[key]
    inner[path[-1]] = value
    return changed


WRONG = st.sampled_from(
    ["word", True, -1, 0, 1e9, -1e9, [], [1], {}, {"x": 1}, [[0.0, 0.0]], -0.5, 3, 200000]
)


@given(scene_tables(), st.data())
def test_what_the_schema_refuses_the_package_refuses(
    table: dict[str, Any], data: st.DataObject
) -> None:
    path = data.draw(st.sampled_from(sorted(leaves(table))))
    changed = plain(with_value(table, path, data.draw(WRONG)))
    if not SCENES.is_valid(changed):
        with pytest.raises(SceneError):
            load_scene(changed)


ALONE = sorted(leaves(plain(load_scene("paper").model_dump())))


@pytest.mark.parametrize("value", ["word", {"x": 1}, [[[]]], 1e300, -1e300], ids=repr)
def test_a_wrong_value_of_a_key_is_refused_by_both_with_its_name(value: Any) -> None:
    for path in ALONE:
        table: dict[str, Any] = {}
        inner = table
        for key in path[:-1]:
            inner = inner.setdefault(key, {})
        inner[path[-1]] = value
        with pytest.raises(SceneError) as refusal:
            load_scene(table)
        faults = list(SCENES.iter_errors(table))
        assert faults, refusal.value
        assert str(refusal.value).startswith(f"scene: {'.'.join(path)}"), refusal.value
        # An object may also be given by name: then the fault is that of the whole object.
        depth = 1 if path[0] == "object" else len(path)
        assert all(tuple(fault.absolute_path)[:depth] == path[:depth] for fault in faults)


def test_misspelt_keys_are_refused_by_both() -> None:
    found = 0
    for scene, line in tomllib.loads(REFUSALS.read_text())["scenes"]["rows"]:
        if "unknown key" in line:
            found += 1
            assert not SCENES.is_valid(plain(tomllib.loads(scene))), line
    assert found > 3


@pytest.mark.parametrize("world", ["quasistatic", "mujoco"])
def test_every_record_of_a_log_validates(world: str, tmp_path: Path) -> None:
    validator = Draft202012Validator(schema_of("log"))
    changes = {"task.distance_m": 0.05, "robot.noise_m_s": 0.03, "start.left_m": 0.02}
    carry = pb.carry("paper", world=world, seed=3, overrides=changes, record=True)
    write_log(carry, tmp_path / "carry.mcap")
    topics = set()
    for record in records(tmp_path / "carry.mcap"):
        if record["topic"] in topics and record["topic"] in ("/left", "/right", "/pair", "/tf"):
            continue  # all of these come from one type
        topics.add(record["topic"])
        validator.validate(record)
    assert {"/left", "/right", "/pair", "/tf", "/solids", "/contacts", "/messages"} <= topics
    assert ("/left/dynamics" in topics) == (world == "mujoco")


def test_wrong_records_do_not_validate() -> None:
    validator = Draft202012Validator(schema_of("log"))
    assert validator.is_valid({"topic": "/pair", "message": {"time_s": 1.0}})
    assert validator.is_valid({"topic": "/pair", "message": {"time_s": "NaN"}})
    assert not validator.is_valid({"topic": "/pair", "message": {"time_s": "soon"}})
    assert not validator.is_valid({"topic": "/pair", "message": {"hour": 1.0}})
    assert not validator.is_valid({"topic": "/paar", "message": {}})
