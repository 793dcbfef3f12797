# SPDX-License-Identifier: Apache-2.0
"""Replay of logs of Python controllers."""

import hashlib
import importlib.util
import sys

import pytest

import palmbots as pb
from palmbots import read_log, replay, write_log
from palmbots.errors import PalmbotsError

SOURCE = """
from palmbots.control.interface import StepOutput

class Mine:
    def step(self, seen):
        moves = {1: "away", -1: "closer", 0: "hold"}
        return StepOutput(palm="steep", move=moves[seen.sign])
"""


def load(path, name="mine"):
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Mine


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(SOURCE)
    return path


@pytest.fixture
def log(file, tmp_path):
    carry = pb.carry("paper", f"{file}:Mine", overrides={"task.distance_m": 0.1})
    write_log(carry, tmp_path / "carry.mcap")
    return tmp_path / "carry.mcap"


def test_replay_with_the_same_source_is_identical(log, file):
    assert replay(log).identical
    assert replay(log, controller=f"{file}:Mine").identical
    result = replay(log, controller=load(file))
    assert result.identical
    assert result.summary()["controller"] == "Mine"


def test_log_states_the_controller_and_its_hash(log, file):
    source = read_log(log).controller_source
    assert source is not None
    assert source.reference == f"{file}:Mine"
    assert source.sha256 == hashlib.sha256(SOURCE.encode()).hexdigest()


def test_changed_source_is_refused_without_running_it(log, file):
    file.write_text("raise SystemExit('the changed source was run')")
    with pytest.raises(PalmbotsError, match=r"mine\.py:Mine has changed since the log was written"):
        replay(log)
    file.unlink()
    with pytest.raises(PalmbotsError, match=r"mine\.py:Mine is not found; pass controller=Mine"):
        replay(log)


def test_passed_controller_with_another_source_is_compared(log, file):
    file.write_text(SOURCE + "# a comment that changes nothing")
    assert replay(log, controller=f"{file}:Mine").identical
    file.write_text(SOURCE.replace('"steep"', '"shallow"'))
    result = replay(log, controller=f"{file}:Mine")
    assert not result.identical
    assert str(result.difference).endswith("(the source of the controller is not that of the log)")


def test_shipped_controller_for_a_python_one_is_compared(log):
    assert not replay(log, controller="distributed").identical
