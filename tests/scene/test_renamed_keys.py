# SPDX-License-Identifier: Apache-2.0
"""Every old scene key and value is refused with its new name, from a file, a table or --set."""

import re
from pathlib import Path
from typing import Any

import pytest

from palmbots.errors import SceneError, UnknownSceneKey
from palmbots.scene.error_messages import dotted_keys
from palmbots.scene.overrides import parse_overrides
from palmbots.scene.renamed_keys import RENAMED_KEYS, RENAMED_VALUES
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.variations import with_values

# The keys of the first release, and theirs now: written down apart from the package's own table.
OLD_AND_NEW = """
dynamic.body_kg                 mujoco.body_kg
dynamic.arm_kg                  mujoco.arm_kg
dynamic.palm_kg                 mujoco.palm_kg
dynamic.wheel_radius_m          mujoco.wheel_radius_m
dynamic.wheel_mismatch          mujoco.wheel_radius_mismatch
dynamic.axle_m                  mujoco.axle_m
dynamic.floor_friction          mujoco.floor_friction
dynamic.ridges                  mujoco.ridges
dynamic.press_n                 mujoco.switch_force_n
dynamic.debounce_s              mujoco.switch_debounce_s
dynamic.step_s                  mujoco.step_s
mujoco.press_n                  mujoco.switch_force_n
mujoco.wheel_mismatch           mujoco.wheel_radius_mismatch
palm.slip_deg                   palm.friction_angle_deg
palm.left.slip_deg              palm.left.friction_angle_deg
palm.right.slip_deg             palm.right.friction_angle_deg
task.inertia_lag_s              task.inertia_tau_s
task.path.ease_m                task.path.transition_m
task.path.lead_m                task.path.lead_in_m
radio.burst_share               radio.burst_fraction
radio.script[1].fate            radio.script[1].effect
radio.script[1].late_s          radio.script[1].delay_s
faults.reboots                  faults.random_reboots
faults.script[1].for_s          faults.script[1].duration_s
faults.script[1].reads          faults.script[1].stuck_at
faults.script[1].rate           faults.script[1].probability
"""
ROWS = [tuple(line.split()) for line in OLD_AND_NEW.split("\n") if line]
MESSAGE = {"sender": "left", "message": 1, "effect": "lost"}
FAULT = {"kind": "reboot", "robot": "left", "at_s": 1.0, "duration_s": 1.0}
VALUES = [
    ("radio.script[1].effect", "late", "delayed"),
    ("radio.script[1].effect", "copied", "duplicated"),
    ("faults.script[1].kind", "flicker", "intermittent"),
    ("faults.script[1].kind", "station", "station-down"),
]


def overrides_with(key: str, value: object) -> dict[str, object]:
    """The override that sets a key; in the second item of a list where the key has an index."""
    name, bracket, entry = key.partition("[1].")
    if not bracket:
        return {key: value}
    item = MESSAGE if name == "radio.script" else FAULT
    return {name: [item, item | {entry: value}]}


def toml(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    return f'"{value}"' if isinstance(value, str) else str(value)


def refusals(given: dict[str, object], file: Path) -> set[str]:
    """What a file, a table, overrides and --set with these keys are refused with, their names cut
    off."""
    texts = [f"{key}={toml(value)}" for key, value in given.items()]
    file.write_text("".join(f"{key} = {toml(value)}\n" for key, value in given.items()))
    nested: dict[str, Any] = {}
    for key, value in given.items():
        table = nested
        *tables, name = key.split(".")
        for part in tables:
            table = table.setdefault(part, {})
        table[name] = value
    attempts = [
        (f"{file}: ", lambda: load_scene(file)),
        ("scene: ", lambda: load_scene(nested)),
        ("overrides: ", lambda: load_scene("paper", given)),
        ("overrides: ", lambda: load_scene("paper", nested)),
        ("--set ", lambda: load_scene("paper", parse_overrides(texts), called="--set")),
    ]
    lines = set()
    for prefix, attempt in attempts:
        with pytest.raises(SceneError) as error:
            attempt()
        assert str(error.value).startswith(prefix)
        lines.add(str(error.value).removeprefix(prefix))
    return lines


def test_every_row_of_the_table_is_tested() -> None:
    tested = {re.sub(r"\[1\]", "[]", old): re.sub(r"\[1\]", "[]", new) for old, new in ROWS}
    assert {old: new for old, new in tested.items() if not old.startswith("mujoco.")} == (
        RENAMED_KEYS
    )
    assert {(re.sub(r"\[1\]", "[]", key), old): new for key, old, new in VALUES} == {
        (key, old): new for key, names in RENAMED_VALUES.items() for old, new in names.items()
    }


def test_new_names_are_keys_of_a_scene_and_old_ones_are_not() -> None:
    keys = set(dotted_keys(Scene))
    for old, new in ROWS:
        assert old not in keys
        assert new in keys or "[1]" in new


@pytest.mark.parametrize(("old", "new"), ROWS)
def test_old_key_is_refused_with_the_new_one(old: str, new: str, tmp_path: Path) -> None:
    assert refusals(overrides_with(old, 1), tmp_path / "a.toml") == {f"{old}: renamed to {new}"}
    with pytest.raises(UnknownSceneKey) as error:
        load_scene("paper", overrides_with(old, 1))
    assert (error.value.key, error.value.suggestion) == (old, new)


@pytest.mark.parametrize(("key", "old", "new"), VALUES)
def test_old_value_is_refused_with_the_new_one(
    key: str, old: str, new: str, tmp_path: Path
) -> None:
    expected = {f'{key}: "{old}" was renamed to "{new}"'}
    assert refusals(overrides_with(key, old), tmp_path / "a.toml") == expected


def test_old_section_is_refused_even_if_empty_or_with_an_unknown_key() -> None:
    for table in ({}, 3, {"xyz": 1}):
        with pytest.raises(SceneError, match=r"^scene: dynamic: renamed to mujoco$"):
            load_scene({"dynamic": table})


def test_old_key_cannot_be_unset() -> None:
    with pytest.raises(SceneError, match=r"^overrides: palm\.slip_deg: renamed to palm\.fric"):
        load_scene("paper", {"palm.slip_deg": None})


def test_old_key_of_a_sweep_is_refused() -> None:
    with pytest.raises(SceneError, match=r"^sweep: radio\.burst_share: renamed to radio\.burst_f"):
        with_values(Scene(), ["radio.burst_share"], [0.1], called="sweep:")
