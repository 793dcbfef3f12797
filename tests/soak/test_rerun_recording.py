# SPDX-License-Identifier: Apache-2.0
"""Recordings for Rerun, checked with Rerun's own program: they are whole, and hold every shape."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

import palmbots as pb

pytest.importorskip("rerun")

from palmbots.logs.rerun_recording import BLUEPRINT, save_blueprint, save_recording

pytestmark = pytest.mark.soak


def rerun(*words: str) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "rerun", *words], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module", params=["quasistatic", "mujoco"])
def printed(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> str:
    if request.param == "mujoco":
        pytest.importorskip("mujoco")
    carry = pb.carry(
        "paper", "distributed", world=request.param, record=True,
        overrides={"task.distance_m": 0.1},
    )  # fmt: skip
    file = tmp_path_factory.mktemp("rerun") / "carry.rrd"
    save_recording(carry, file)
    rerun("rrd", "verify", str(file))
    return request.param + "\n" + rerun("rrd", "print", "-v", str(file))


def test_shapes_contacts_and_forces_are_there(printed: str) -> None:
    for entity in ("world/object", "world/left_palm", "world/right_robot", "world/contacts",
                   "plots/contact_mm/left", "plots/sign/right"):  # fmt: skip
        assert entity in printed
    assert ("world/forces" in printed) == printed.startswith("mujoco")


def test_the_layout_loads_and_is_the_one_that_the_program_makes(tmp_path: Path) -> None:
    rerun("rrd", "verify", str(BLUEPRINT))
    save_blueprint(tmp_path / "new.rbl")
    # Both have random identifiers.
    kinds = [
        sorted(
            re.sub(r"[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", "ID", word)
            for word in rerun("rrd", "print", "-v", str(file)).split()
            if "View" in word
        )
        for file in (BLUEPRINT, tmp_path / "new.rbl")
    ]
    assert len(kinds[0]) > 10
    assert kinds[0] == kinds[1]
    assert kinds[0]
