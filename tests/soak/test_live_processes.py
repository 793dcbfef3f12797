# SPDX-License-Identifier: Apache-2.0
"""Carries in real time with real processes: they depend on the load of the machine."""

import os
import random
import re
import signal
import subprocess
import time

import pytest

from pair_programs import programs_of, started
from palmbots.control.registry import shipped_names
from waiting import wait_until

pytestmark = pytest.mark.soak
SHORT = ("--set", "task.distance_m=0.5")


def up_with(*arguments: str) -> "subprocess.Popen[str]":
    return started(["up", *SHORT, *arguments])


def kill(up: "subprocess.Popen[str]", name: str, after_s: float) -> None:
    """Kill a program of `up` a while after it was started."""
    wait_until(lambda: name in programs_of(up))
    time.sleep(after_s)
    os.kill(programs_of(up)[name], signal.SIGKILL)


@pytest.mark.parametrize("controller", shipped_names("robots"))
def test_robots_carry_in_real_time(controller: str) -> None:
    up = up_with("--controller", controller)
    printed, errors = up.communicate(timeout=120)
    assert "Traceback" not in errors
    overran = "overrun" in printed  # the machine was too slow
    assert up.returncode == 0 or overran, printed + errors
    if not overran:
        assert re.search(r"left: done\n", printed)
        assert re.search(r"^DELIVERED  0\.[45]\d m", printed, re.MULTILINE)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("who", ["left", "right", "station"])
def test_a_killed_program_starts_again_and_the_carry_ends(who: str, seed: int) -> None:
    up = up_with("--controller", "resilient")
    kill(up, who, 3 + 4 * random.Random(seed).random())
    printed, errors = up.communicate(timeout=120)
    assert "Traceback" not in errors
    assert "was killed (signal 9), and starts again" in errors or up.returncode == 0
    assert "DROPPED" not in printed
    assert re.search(r"^(DELIVERED|STOPPED) ", printed, re.MULTILINE)


def test_a_killed_world_voids_the_carry() -> None:
    up = up_with("--controller", "resilient")
    kill(up, "world", 3)
    _, errors = up.communicate(timeout=60)
    assert up.returncode == 2
    assert "palmbots: world: was killed; the carry is void\n" in errors
