# SPDX-License-Identifier: Apache-2.0
"""``--json``: one object on stdout and nothing else, which fits the command's schema exactly."""

import json
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator
from typer.main import get_command

from commands import FUNCTIONS, Run
from dds_loopback import dds_environment
from palmbots.cli.json_schemas import schema_of
from palmbots.cli.main import build_app
from schema_refusals import assert_fits_exactly

ROOT = Path(__file__).parents[2]
SHORT = ("--set", "task.distance_m=0.2")

# Command and arguments; all succeed.
CALLS: list[tuple[str, tuple[str, ...]]] = [
    ("carry", ("--seed", "3")),
    ("carry", ("--world", "mujoco", *SHORT)),
    ("analyze", ()),
    ("design", ("--resolution-deg", "5", "--set", "task.distance_m=0.1")),
    ("certify", ()),
    (
        "drop-rate",
        ("--set", "robot.noise_m_s=0.03", "--effort", "20", "--relative-error-percent", "100"),
    ),
    ("noise-limit", ("--relative-error-percent", "10", *SHORT)),
    ("bound", SHORT),
    ("compare", ("--values", "0,0.2", "-n", "2", *SHORT)),
    ("study", ("STUDY", "--out", "DIR")),
    ("check", ("CERTIFICATE",)),
    ("replay", ("LOG",)),
    ("export", ("--mjcf", "MJCF")),
    ("derive", ("--controllers", "none")),
    ("derive", ("--policy", str(ROOT / "examples" / "policies" / "table-1.toml"))),
    ("scenes", ()),
    ("objects", ()),
    ("controllers", ()),
    ("keys", ()),
    ("init", ("scene", "SCENE")),
    ("init", ("pair", "PAIR")),
    ("view", ("LOG", "--layout", "LAYOUT")),
    ("ros2", ("PAIR", "--side", "left", "--seconds", "0.1")),
    ("schema", ("log",)),
]


# These take long and are tried once, in tests/mujoco (test_validation, test_speed_limits), or need
# other processes (tests/processes), or the files of a pair (tests/cli/test_firmware_commands.py).
ELSEWHERE = {
    "validate", "speed-limits", "up", "world", "robot", "station", "doctor", "calibrate",
    "firmware", "flash",
}  # fmt: skip
CALLS += [(one.name, ()) for one in FUNCTIONS if one.name not in {*dict(CALLS), *ELSEWHERE}]


@pytest.fixture
def files(here: Run, tmp_path: Path) -> dict[str, str]:
    """Files that commands read and write, by the word in the contract."""
    names = {
        "STUDY": "study.toml", "DIR": "results", "CERTIFICATE": "box.json", "LOG": "log/carry.mcap",
        "MJCF": "scene.xml", "SCENE": "scene.toml", "PAIR": "pair.toml", "LAYOUT": "layout.json",
    }  # fmt: skip
    return {word: str(tmp_path / name) for word, name in names.items()}


@pytest.mark.parametrize(("command", "arguments"), CALLS, ids=[row[0] for row in CALLS])
def test_json_is_one_object_that_fits_its_schema_exactly(
    command: str,
    arguments: tuple[str, ...],
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
    assert result.returncode == 0, result
    assert result.stdout.count("\n") == 1
    table = json.loads(result.stdout)
    if command == "schema":
        Draft202012Validator(schema_of(command)).validate(table)
    else:
        assert_fits_exactly(schema_of(command), table)


def test_every_command_is_in_the_contract() -> None:
    group: Any = get_command(build_app())
    assert {command for command, _ in CALLS} | ELSEWHERE == set(group.commands)
