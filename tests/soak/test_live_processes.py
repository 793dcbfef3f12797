# SPDX-License-Identifier: Apache-2.0
"""Carries in real time with real processes: they depend on the load of the machine."""

import re

import pytest

from pair_programs import started
from palmbots.control.registry import shipped_names

pytestmark = pytest.mark.soak
SHORT = ("--set", "task.distance_m=0.5")


@pytest.mark.parametrize("controller", shipped_names("robots"))
def test_robots_carry_in_real_time(controller: str) -> None:
    up = started(["up", *SHORT, "--controller", controller])
    printed, errors = up.communicate(timeout=120)
    assert "Traceback" not in errors
    overran = "overrun" in printed  # the machine was too slow
    assert up.returncode == 0 or overran, printed + errors
    if not overran:
        assert re.search(r"left: done\n", printed)
        assert re.search(r"^DELIVERED  0\.[45]\d m", printed, re.MULTILINE)
