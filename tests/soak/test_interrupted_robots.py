# SPDX-License-Identifier: Apache-2.0
"""A robot's program that gets Ctrl-C at a random instant: one line at most, and no traceback.

While Python itself starts, before it has begun the program, Python prints what it likes.
"""

import random
import signal
import time
from pathlib import Path

import pytest

from pair_programs import new_pair, running, started
from waiting import wait_until

TRIES = 40
LATEST_S = 4.0  # while it starts, waits for its world, greets its partner


@pytest.mark.parametrize("signals", [1, 2])
def test_ctrl_c_at_random_instants(tmp_path: Path, soak_seed: int, signals: int) -> None:
    rng = random.Random(soak_seed)
    pair = new_pair(tmp_path)
    with running(["world", "paper", "--serve", f"unix:{tmp_path / 'world'}"], folder=tmp_path):
        wait_until((tmp_path / "world").exists)
        for _ in range(TRIES):
            robot = started(["robot", str(pair), "--side", "left"], tmp_path)
            for _ in range(signals):
                time.sleep(rng.uniform(0, LATEST_S / signals))
                robot.send_signal(signal.SIGINT)
            _, error = robot.communicate(timeout=60)
            has_begun = "KeyboardInterrupt" not in error or "palmbots/__main__.py" in error
            if has_begun:
                # A second signal may end Python while it leaves.
                assert robot.returncode in (0, 130, -signal.SIGINT), error
                assert "Traceback" not in error
                assert error.count("interrupted") <= 1
