# SPDX-License-Identifier: Apache-2.0
"""Studies that are killed at random instants, again and again, end with the same results."""

import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest

from study_fixtures import LONG, command, marks, said_here
from waiting import wait_until

KILLS = 30
LATEST_S = 0.3  # after a chunk is kept, or after the folder is locked


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("long") / "long.toml"
    file.write_text(LONG.replace("count = 40", "count = 400"))
    return file


@pytest.fixture(scope="module")
def whole(long: Path) -> str:
    """The hash of a run that nothing interrupts, on one thread with other chunks."""
    return said_here(long, "--out", long.parent / "whole", "--chunk-size", 1500, "--threads", 1)[
        "hash"
    ]


def assert_ended(process: "subprocess.Popen[str]", sent: signal.Signals, error: str) -> None:
    """It has ended in good order, or Python had not yet begun the program."""
    has_begun = "KeyboardInterrupt" not in error or "palmbots/__main__.py" in error
    assert process.returncode in (-sent, 130, 0) or not has_begun, error


@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGINT], ids=["kill", "Ctrl-C"])
def test_killed_at_random_instants_the_result_is_the_same(
    long: Path, whole: str, tmp_path: Path, soak_seed: int, sent: signal.Signals
) -> None:
    rng = random.Random(soak_seed)
    root = tmp_path / "study"
    arguments = (long, "--out", root, "--chunk-size", 100)
    for _ in range(KILLS):
        before = marks(root)
        at_chunk = len(before) + rng.choice((0, 1))
        process = subprocess.Popen(command(*arguments), stderr=subprocess.PIPE, text=True)
        wait_until(lambda n=at_chunk, p=process: len(marks(root)) >= n or p.poll() is not None)
        time.sleep(rng.uniform(0, LATEST_S))
        process.send_signal(sent)
        _, error = process.communicate(timeout=120)
        assert_ended(process, sent, error)
        assert before <= marks(root)
        if process.returncode == 0 or (len(marks(root)) > 60 and rng.random() < 0.3):
            shutil.rmtree(root)
    result = said_here(*arguments)
    assert result["hash"] == whole
    assert result["carries"] == 9600
    assert not [path for path in root.rglob("*") if path.suffix in (".part", ".partial")]


@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGINT], ids=["kill", "Ctrl-C"])
def test_killed_while_it_begins(
    long: Path, whole: str, tmp_path: Path, soak_seed: int, sent: signal.Signals
) -> None:
    rng = random.Random(soak_seed)
    root = tmp_path / "study"
    for _ in range(KILLS):
        process = subprocess.Popen(command(long, "--out", root), stderr=subprocess.PIPE, text=True)
        wait_until(lambda p=process: (root / "lock").exists() or p.poll() is not None)
        time.sleep(rng.uniform(0, LATEST_S))
        process.send_signal(sent)
        _, error = process.communicate(timeout=120)
        assert_ended(process, sent, error)
        if marks(root) or rng.random() < 0.5:
            shutil.rmtree(root, ignore_errors=True)
    assert said_here(long, "--out", root)["hash"] == whole
