# SPDX-License-Identifier: Apache-2.0
"""A world and two robots as processes give the result of `palmbots carry`, bit for bit."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from cxx import ROOT
from json_output import read_json
from live_faults import JOB, SHORT_WAY, SIMULATED, scene_with
from pair_programs import programs_of, started
from waiting import wait_until

EVERYTHING = scene_with(*SIMULATED) | {"radio.corruption": 0.05}
OTHERS = {
    "radio.left.latency_s": 0.09, "radio.right.loss": 0.1, "radio.replay": 0.3,
    "faults.script": [
        {"kind": "clock-rate", "robot": "left", "at_s": 2.0, "duration_s": 6.0, "ppm": 20000.0},
        {"kind": "clock-jump", "robot": "right", "at_s": 5.0, "duration_s": 0.8},
        {"kind": "reboot", "robot": "left", "at_s": 9.0, "duration_s": 0.5, "limp_deg": 9.0},
        {"kind": "reboot", "robot": "right", "at_s": 14.0, "duration_s": 0.5,
         "loses_boot_counter": True},
    ],
    "task.timeout_s": 20.0,
}  # fmt: skip
SHORT = {"task.distance_m": 0.9}  # long enough for all faults
PERIODS = {"robot.left.period_s": 0.03, "robot.right.period_s": 0.02}
HARD_JOB = JOB | {
    "radio.loss": 0.1,
    "faults.script": [
        {"kind": "reboot", "robot": "left", "at_s": 2.0, "duration_s": 0.5},
        {"kind": "reboot", "robot": "right", "at_s": 14.0, "duration_s": 0.3},
        {"kind": "freeze", "robot": "left", "at_s": 17.0, "duration_s": 0.5},
    ],
}  # fmt: skip
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "resilient, a period per robot, everything": ("resilient", SHORT | EVERYTHING | PERIODS),
    "resilient, directions, replays, clocks, lost counter": ("resilient", OTHERS),
    "silent, everything": ("silent", SHORT | EVERYTHING),
    "distributed, losses": ("distributed", SHORT | {"radio.loss": 0.02}),
    "centralized, everything": ("centralized", SHORT | EVERYTHING),
    "policy": ("examples/policies/table-1.toml", SHORT),
    "shared-sign, a job on the floor, losses and reboots": ("shared-sign", HARD_JOB),
    "shared-sign, from a stand onto a stand": ("shared-sign", SHORT_WAY["stand"]),
    "shared-sign, one robot alone, which restarts": (
        "shared-sign",
        SHORT_WAY["lone"]
        | {"faults.script": [{"kind": "reboot", "robot": "right", "at_s": 5.0, "duration_s": 0.5}]},
    ),
    "centralized, from palm to palm, losses": (
        "centralized",
        SHORT_WAY["handover"] | {"radio.loss": 0.1},
    ),
    "class in Python": ("CLASS", SHORT),
}
"""Each kind of program once: tests/robot compares all controllers inside one process."""
SCENES = {
    "shared-sign, from a stand onto a stand": "stand",
    "shared-sign, one robot alone, which restarts": "lone",
    "centralized, from palm to palm, losses": "handover",
}
"""Those that are not the scene `paper`."""


def palmbots(command: Sequence[str], folder: Path) -> tuple[int, str, str]:
    done = subprocess.run(
        [sys.executable, "-m", "palmbots", *command],
        capture_output=True, text=True, timeout=120, cwd=folder,
    )  # fmt: skip
    return done.returncode, done.stdout, done.stderr


@pytest.fixture(scope="module")
def own_class(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The class of the example, without the carries that the example runs."""
    text = (ROOT / "examples" / "03_own_controller.py").read_text(encoding="utf-8")
    file = tmp_path_factory.mktemp("own") / "patient.py"
    file.write_text(text.split("\nfor ")[0], encoding="utf-8")
    return f"{file}:Patient"


@pytest.mark.parametrize("case", CASES)
def test_processes_carry_as_one_program(case: str, own_class: str, tmp_path: Path) -> None:
    controller, overrides = CASES[case]
    controller = controller.replace("CLASS", own_class)
    scene = tmp_path / "scene.toml"
    scene.write_text(pb.load_scene(SCENES.get(case, "paper"), overrides).to_toml())
    arguments = [str(scene), "--controller", controller, "--seed", "3", "--json"]
    status, expected, _ = palmbots(["carry", *arguments], ROOT)
    up_status, printed, errors = palmbots(["up", *arguments, "--lockstep"], ROOT)
    assert errors == ""
    # Only `carry` counts how often the scene fails.
    assert printed == json.dumps(json.loads(expected) | {"scene_statistics": None}) + "\n"
    assert up_status == status
    read_json("world", printed)


def test_processes_carry_in_the_dynamic_world_as_one_program() -> None:
    pytest.importorskip("mujoco")
    arguments = ["--controller", "resilient", "--world", "mujoco"]
    arguments += ["--set", "task.distance_m=0.3", "--json"]
    _, expected, _ = palmbots(["carry", *arguments], ROOT)
    _, printed, errors = palmbots(["up", *arguments, "--lockstep"], ROOT)
    assert (printed, errors) == (expected, "")


def test_a_killed_robot_ends_everything_with_one_line(tmp_path: Path) -> None:
    """The world and the other robot end, too, and nothing is left behind."""
    command = ["up", "--lockstep", "--set", "task.distance_m=50"]
    up = started(command, environment={"TMPDIR": str(tmp_path)})
    wait_until(lambda: "left" in programs_of(up))
    os.kill(programs_of(up)["left"], signal.SIGKILL)
    printed, errors = up.communicate(timeout=60)
    assert up.returncode == 2
    assert printed == ""
    assert "palmbots: left robot: its program ended with status -9\n" in errors
    assert "Traceback" not in errors
    assert [*tmp_path.iterdir()] == []
