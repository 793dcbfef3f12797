# SPDX-License-Identifier: Apache-2.0
"""``--json``: one object on stdout and nothing else, with the keys of the public interface."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from typer.main import get_command

from commands import Run
from dds_loopback import dds_environment
from palmbots.cli.json_schemas import schema_of
from palmbots.cli.main import build_app

ROOT = Path(__file__).parents[2]
SHORT = ("--set", "task.distance_m=0.2")
SIDES = {"left", "right"}

# Command, arguments, exit status, keys. A key "a.b" is b in the table a; "a[].b" in each row of a.
CONTRACT: list[tuple[str, tuple[str, ...], int, set[str]]] = [
    (
        "carry",
        ("--seed", "3"),
        0,
        {
            "outcome", "reason", "time_s", "distance_m", "contact_rms_m.left",
            "contact_rms_m.right", "contact_peak_m.left", "contact_peak_m.right",
            "corrections[].label", "corrections[].robot", "corrections[].case",
            "corrections[].assistant", "corrections[].start_s", "corrections[].end_s", "messages",
            "waiting_s.left", "waiting_s.right", "warnings", "trace_hash", "scene",
        },
    ),
    (
        "modes",
        ("--theta-left-deg", "5"),
        0,
        {
            "feasible", "consistent_closing", "consistent_opening", "closing", "opening", "wedged",
            "squeeze.left", "squeeze.right", "margin_rad", "scene",
        },
    ),
    (
        "analyze",
        (),
        0,
        {
            *(
                f"properties.{number}.{side}.{key}"
                for number in "120"
                for side in ("left", "right")
                for key in ("holds", "margins.travel_m", "margins.angle_rad", "binding")
            ),
            "bands", "com_x_m", "friction", "max_slope_deg", "max_acceleration_m_s2", "scene",
        },
    ),
    (
        "design",
        ("--resolution-deg", "5", "--set", "task.distance_m=0.1"),
        0,
        {
            "shallow_deg", "steep_deg", "maximize", "sigma_star_m_s", "interval", "controller",
            "tolerance", "own.sigma_star_m_s", "own.interval", "own.tolerance", "friction",
            "friction_floor", "reaction_s", "certificate", "designed_scene.palm", "scene",
        },
    ),
    ("certify", (), 0, {"verdict", "claims", "box", "parts"}),
    (
        "drop-rate",
        ("--set", "robot.noise_m_s=0.03", "--effort", "20", "--relative-error-percent", "100"),
        0,
        {"drop_rate", "interval", "levels", "replicates", "controller", "seed", "scene"},
    ),
    (
        "noise-limit",
        ("--relative-error-percent", "10", *SHORT),
        0,
        {
            "sigma_star_m_s", "interval", "rate", "carries", "pilot_carries", "points[].noise_m_s",
            "points[].drops", "controller", "seed", "scene",
        },
    ),
    (
        "bound",
        SHORT,
        0,
        {
            "sigma_star_m_s", "grid_error", "drop_rate", "noise_m_s", "rate", "speeds", "time_s",
            "law_m_s", "opening_speed_m_s", "usable_m", "front", "scene",
        },
    ),
    (
        "compare",
        ("--values", "0,0.2", "-n", "2", *SHORT),
        0,
        {
            "rows[].controller", "rows[].key", "rows[].value", "rows[].n", "rows[].drop_rate",
            "rows[].interval", "rows[].rms_m", "scene",
        },
    ),
    (
        "study",
        ("STUDY", "--out", "DIR"),
        0,
        {"carries", "drop_rate", "interval", "output", "hash", "cells[].at", "scene"},
    ),
    ("check", ("CERTIFICATE",), 0, {"valid", "claim"}),
    ("replay", ("LOG",), 0, {"identical"}),
    ("export", ("--mjcf", "MJCF"), 0, {"mjcf", "urdf", "scene"}),
    ("derive", ("--controllers", "none"), 0, {"rules", "conflicts", "is_table_2"}),
    (
        "derive",
        ("--policy", str(ROOT / "examples" / "policies" / "table-1.toml")),
        0,
        {
            "policy", "description", "rows.+0.palms", "rows.+0.drives", "rules", "is_table_2",
            "reasons", "machines.left.states[].name", "machines.right.rows[].next",
            "verification.proved", "verification.states", "verification.worst_turns",
            "verification.counterexamples",
        },
    ),
    ("scenes", (), 0, {"scenes[].name", "scenes[].meaning"}),
    ("objects", (), 0, {"objects[].name", "objects[].meaning"}),
    (
        "controllers",
        (),
        0,
        {
            f"controllers[].{key}"
            for key in (
                "name", "meaning", "messages", "requirements", "sigma_star_m_s",
                "sigma_star_interval", "sigma_star_command",
            )
        },
    ),
    ("keys", (), 0, {"keys[].name", "keys[].meaning", "keys[].default", "keys[].unit"}),
    ("init", ("scene", "SCENE"), 0, {"file", "scene"}),
    ("init", ("pair", "PAIR"), 0, {"files"}),
    ("view", ("LOG", "--layout", "LAYOUT"), 0, {"written"}),
    ("ros2", ("PAIR", "--side", "left", "--seconds", "0.1"), 0, {"side", "published.odom"}),
    ("schema", ("log",), 0, {"$schema", "oneOf", "$defs"}),
]  # fmt: skip


# These take long and are tried once, in tests/mujoco (test_validation, test_speed_limits), or need
# other processes (tests/processes), or the files of a pair (tests/cli/test_firmware_commands.py).
ELSEWHERE = {
    "validate", "speed-limits", "up", "world", "robot", "station", "doctor", "calibrate",
    "firmware", "flash",
}  # fmt: skip


def has(table: Any, key: str) -> bool:
    name, _, rest = key.partition(".")
    if name.endswith("[]"):
        rows = table.get(name[:-2])
        return bool(rows) and all(has(row, rest) for row in rows)
    if not isinstance(table, Mapping) or name not in table:
        return False
    return not rest or has(table[name], rest)


@pytest.fixture
def files(here: Run, tmp_path: Path) -> dict[str, str]:
    """Files that commands read and write, by the word in the contract."""
    names = {
        "STUDY": "study.toml", "DIR": "results", "CERTIFICATE": "box.json", "LOG": "log/carry.mcap",
        "MJCF": "scene.xml", "SCENE": "scene.toml", "PAIR": "pair.toml", "LAYOUT": "layout.json",
    }  # fmt: skip
    return {word: str(tmp_path / name) for word, name in names.items()}


@pytest.mark.parametrize(
    ("command", "arguments", "status", "keys"), CONTRACT, ids=[row[0] for row in CONTRACT]
)
def test_json_has_the_keys_of_the_contract(
    command: str,
    arguments: tuple[str, ...],
    status: int,
    keys: set[str],
    here: Run,
    files: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if "STUDY" in arguments:
        Path(files["STUDY"]).write_text(
            'controllers = ["none"]\n[set]\n"task.distance_m" = 0.2\n[vary]\n'
            '"robot.noise_m_s" = [0.02]\n[seeds]\ncount = 2\n'
        )
    if "CERTIFICATE" in arguments:
        here("certify", "-o", files["CERTIFICATE"])
    if "LOG" in arguments:
        here("carry", *SHORT, "--animation", "none", "--out", str(Path(files["LOG"]).parent))
    if command == "ros2":
        here("init", "pair", files["PAIR"])
        for name, value in dds_environment().items():
            monkeypatch.setenv(name, value)
    result = here(command, *(files.get(word, word) for word in arguments), "--json")
    assert result.returncode == status, result
    assert result.stdout.count("\n") == 1
    table = json.loads(result.stdout)
    assert {key for key in keys if not has(table, key)} == set()
    Draft202012Validator(schema_of(command)).validate(table)


def test_every_command_is_in_the_contract() -> None:
    group: Any = get_command(build_app())
    assert {row[0] for row in CONTRACT} | ELSEWHERE == set(group.commands)
