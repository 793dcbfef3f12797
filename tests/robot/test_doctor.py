# SPDX-License-Identifier: Apache-2.0
"""`palmbots doctor` hears both robots over real sockets, and names the one that is missing."""

import json
from pathlib import Path

from pair_programs import new_pair, running, started


def test_both_robots_are_heard(tmp_path: Path) -> None:
    new_pair(tmp_path)
    world = ["world", "paper", "--serve", f"unix:{tmp_path / 'world'}"]
    robots = [["robot", "pair.toml", "--side", side] for side in ("left", "right")]
    with running(world, *robots, folder=tmp_path):
        done = started(["doctor", "pair.toml", "--seconds", "8", "--json"], tmp_path)
        printed, errors = done.communicate(timeout=60)
    assert errors == ""
    found = json.loads(printed)
    for side in ("left", "right"):
        link = found["links"][side]
        assert link["mode"] == "disarmed"
        assert link["received"] > 10
        assert 0 < link["round_trip_median_s"] < 1
    assert found["needs"]["verdicts"]["silent"] == "suffices"


def test_a_robot_that_is_not_heard_is_named(tmp_path: Path) -> None:
    new_pair(tmp_path)
    done = started(["doctor", "pair.toml", "--seconds", "1"], tmp_path)
    printed, errors = done.communicate(timeout=60)
    assert (done.returncode, errors) == (1, "")
    assert printed.startswith("left robot:\n  not heard: is its program running, with the same key")
    assert "right robot:\n" in printed
