# SPDX-License-Identifier: Apache-2.0
"""`--controller FILE.toml` and `derive --policy FILE.toml`."""

import json
import shutil
from pathlib import Path

import pytest

from commands import Run, assert_refused

pytestmark = pytest.mark.slow

POLICIES = Path(__file__).parents[2] / "examples" / "policies"
BOTH_DRIVE = str(POLICIES / "both-drive.toml")
MIXED = str(POLICIES / "rest-mixed.toml")
SHORT = ("--set", "task.distance_m=0.2")


def test_commands_take_a_policy(here: Run, tmp_path: Path) -> None:
    shutil.copy(BOTH_DRIVE, tmp_path / "mine.toml")
    policy = str(tmp_path / "mine.toml")
    rows = json.loads(here("compare", "--controllers", f"none,{policy}", "--values", "0.1", "-n",
                           "3", *SHORT, "--json").stdout)["rows"]  # fmt: skip
    assert [row["controller"] for row in rows] == ["none", "mine.toml"]
    found = json.loads(here("noise-limit", "-c", policy, "--relative-error-percent", "10", *SHORT,
                            "--json").stdout)  # fmt: skip
    assert found["controller"] == "mine.toml"
    (tmp_path / "study.toml").write_text(
        'controllers = ["none", "mine.toml"]\nvary = { "robot.noise_m_s" = [0.01, 0.02] }\n'
        'set = { "task.distance_m" = 0.1 }\nseeds = { first = 0, count = 5 }\n'
    )
    done = here("study", str(tmp_path / "study.toml"), "--out", str(tmp_path / "s"), "--json")
    assert done.returncode == 0, done.stderr


def test_log_names_the_file_and_its_hash(here: Run, tmp_path: Path) -> None:
    policy = tmp_path / "mine.toml"
    shutil.copy(BOTH_DRIVE, policy)
    out = tmp_path / "out"
    here("carry", "-c", str(policy), *SHORT, "--animation", "none", "--out", str(out))
    assert here("replay", f"{out}/carry.mcap").returncode == 0
    policy.write_text(policy.read_text("utf-8") + "# another version\n", "utf-8")
    assert_refused(here("replay", f"{out}/carry.mcap"), "has changed since the log was written")
    policy.unlink()
    assert_refused(here("replay", f"{out}/carry.mcap"), "is not found")


def test_a_policy_that_fails_runs_only_unproved(here: Run, tmp_path: Path) -> None:
    refused = here("carry", "-c", MIXED, *SHORT)
    assert refused.returncode == 2
    assert refused.stdout == ""
    assert "The shortest run against S1" in refused.stderr
    assert refused.stderr.splitlines()[-1].startswith("palmbots: --controller")
    out = str(tmp_path / "out")
    done = here("carry", "-c", MIXED, "--unproved", *SHORT, "--animation", "none", "--out", out)
    assert done.returncode == 0
    assert "not checked" in done.stderr
    assert here("replay", f"{out}/carry.mcap").returncode == 0  # the log says what ran


def test_study_and_design_take_an_unproved_policy(here: Run, tmp_path: Path) -> None:
    shutil.copy(MIXED, tmp_path / "mixed.toml")
    file = tmp_path / "study.toml"
    file.write_text(
        'controllers = ["none", "mixed.toml"]\nset = { "task.distance_m" = 0.1 }\n'
        "seeds = { first = 0, count = 4 }\n"
    )
    out = str(tmp_path / "s")
    assert_refused(here("study", str(file), "--out", out), "the derived algorithm fails S1")
    assert not (tmp_path / "s").exists()
    done = here("study", str(file), "--out", out, "--unproved", "--json")
    assert done.returncode == 0, done.stderr
    assert "derived from mixed.toml is not checked (--unproved)" in " ".join(done.stderr.split())
    rows = json.loads(done.stdout)["cells"]
    assert [row["controller"] for row in rows] == ["none", "mixed.toml"]
    plain = tmp_path / "plain.toml"
    plain.write_text('controllers = ["none"]\nseeds = { first = 0, count = 4 }\n')
    assert_refused(here("study", str(plain), "--unproved"), "--unproved needs a study")

    quick = ("--maximize", "com", "--resolution-deg", "5", "--set", "task.distance_m=0.1", "--json")
    refused = here("design", "-c", MIXED, *quick)
    assert refused.returncode == 2 and refused.stdout == ""
    assert "The shortest run against S1" in refused.stderr
    made = here("design", "-c", MIXED, "--unproved", *quick)
    assert made.returncode in (0, 1) and "not checked" in made.stderr, made.stderr
    assert json.loads(made.stdout)["controller"] == "rest-mixed.toml"


def test_derive_reports_a_file(here: Run) -> None:
    proved = here("derive", "--policy", BOTH_DRIVE)
    assert proved.returncode == 0
    for text in ("DERIVED", "PROVED", "left first, by its row", "(d)∥(d)"):
        assert text in " ".join(proved.stdout.split())
    rules = json.loads(here("derive", "--policy", BOTH_DRIVE, "--json").stdout)["rules"]
    assert set(rules) == {"a left", "a right", "c for a left", "c for a right", "d"}
    assert rules["c for a left"]["lines"][2] == "Move away until TiltDown"
    assert rules["c for a right"]["lines"][2] == "Move away while p ≤ 0 until TiltDown"
    failed = here("derive", "--policy", MIXED, "--json")
    assert failed.returncode == 1
    found = json.loads(failed.stdout)
    assert found["verification"]["proved"] is False
    assert set(found["verification"]["counterexamples"]) == {"S1", "S2", "S3", "S4"}
    assert found["rows"]["-+"]["drives"] == ["closer", "hold"]
    assert_refused(here("derive", "--policy", MIXED, "--controllers", "none"), "--controllers")
