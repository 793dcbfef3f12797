# SPDX-License-Identifier: Apache-2.0
"""Carries in real time with real processes: they depend on the load of the machine."""

import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from palmbots.control.registry import shipped_names
from waiting import wait_until

pytestmark = pytest.mark.soak
SHORT = ("--set", "task.distance_m=0.5")


def started(*arguments: str) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "palmbots", "up", *SHORT, *arguments]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def child(parent: int, text: str) -> int | None:
    """The process of `up` with this text in its command."""
    for folder in Path("/proc").iterdir():
        try:
            command = (folder / "cmdline").read_text().replace("\0", " ")
            if text in command and f"PPid:\t{parent}\n" in (folder / "status").read_text():
                return int(folder.name)
        except OSError:
            continue
    return None


@pytest.mark.parametrize("controller", shipped_names("robots"))
def test_robots_carry_in_real_time(controller: str) -> None:
    up = started("--controller", controller)
    printed, errors = up.communicate(timeout=120)
    assert "Traceback" not in errors
    overran = "overrun" in printed  # the machine was too slow
    assert up.returncode == 0 or overran, printed + errors
    if not overran:
        assert re.search(r"left: done\n", printed)
        assert re.search(r"^DELIVERED  0\.[45]\d m", printed, re.MULTILINE)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("who", ["--side left", "--side right", "station "])
def test_a_killed_program_starts_again_and_the_carry_ends(who: str, seed: int) -> None:
    up = started("--controller", "resilient")
    found: list[int] = []
    wait_until(lambda: (pid := child(up.pid, who)) is not None and not found.append(pid))
    time.sleep(3 + 4 * random.Random(seed).random())
    os.kill(found[0], signal.SIGKILL)
    printed, errors = up.communicate(timeout=120)
    assert "Traceback" not in errors
    assert "was killed (signal 9), and starts again" in errors or up.returncode == 0
    assert "DROPPED" not in printed
    assert re.search(r"^(DELIVERED|STOPPED) ", printed, re.MULTILINE)


def test_a_killed_world_voids_the_carry() -> None:
    up = started("--controller", "resilient")
    found: list[int] = []
    wait_until(lambda: (pid := child(up.pid, " world ")) is not None and not found.append(pid))
    time.sleep(3)
    os.kill(found[0], signal.SIGKILL)
    _, errors = up.communicate(timeout=60)
    assert up.returncode == 2
    assert "palmbots: world: was killed; the carry is void\n" in errors
