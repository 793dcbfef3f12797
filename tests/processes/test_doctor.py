# SPDX-License-Identifier: Apache-2.0
"""`palmbots doctor` hears both robots over real sockets, and names the one that is missing."""

import subprocess
from pathlib import Path

from json_output import read_json
from pair_programs import new_pair, operator, running, started


def test_both_robots_are_heard(tmp_path: Path) -> None:
    file = new_pair(tmp_path)
    world = ["world", "paper", "--serve", f"unix:{tmp_path / 'world'}"]
    robots = [["robot", "pair.toml", "--side", side] for side in ("left", "right")]
    with running(world, *robots, folder=tmp_path):
        with operator(file) as user:  # their programs take a while to start
            user.until(lambda: user.mode("left") and user.mode("right"))
        done = started(["doctor", "pair.toml", "--seconds", "5", "--json"], tmp_path)
        printed, errors = done.communicate(timeout=60)
    assert errors == ""
    found = read_json("doctor", printed)
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


def test_the_driver_is_checked_on_the_robot(tmp_path: Path) -> None:
    """A workbench with a servo that reports: the palm moves, and there is nothing on it."""
    new_pair(tmp_path)
    bench = ["world", "paper", "--bench", "--serve"]
    bench += [f"unix:{tmp_path / 'world'}", "--imperfect", "servo_reports=true"]
    bench += ["--imperfect", "battery_v=6.0"]
    process = started(bench, tmp_path, stdout=subprocess.DEVNULL)
    done = started(["doctor", "pair.toml", "--side", "left", "--json"], tmp_path)
    printed, errors = done.communicate(timeout=60)
    process.communicate("quit\n", timeout=60)
    assert errors == ""
    assert done.returncode == 1
    found = {check["about"]: check for check in read_json("doctor", printed)["checks"]}
    assert found["driver"]["is_well"]
    assert found["palm"]["is_well"]
    assert (found["contact"]["is_well"], found["contact"]["text"]) == (False, "not sensed")
    assert found["battery"]["text"] == "6.00 V"


def test_a_robot_without_hardware_is_one_line(tmp_path: Path) -> None:
    new_pair(tmp_path)
    text = (tmp_path / "pair.toml").read_text().replace(f"unix:{tmp_path / 'world'}", "unix:none")
    (tmp_path / "pair.toml").write_text(text)
    done = started(["doctor", "pair.toml", "--side", "left"], tmp_path)
    printed, errors = done.communicate(timeout=60)
    assert (done.returncode, errors) == (1, "")
    assert "WRONG  left driver: world: nobody listens at unix:none" in printed
