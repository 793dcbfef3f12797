# SPDX-License-Identifier: Apache-2.0
"""The resilient controller's step as code for a microcontroller: every branch is tested, and its
cost is measured.

`python tests/control/test_resilient_cost.py` prints the numbers that docs/theory/protocols.md
states.
"""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from cxx import program

# What the compiler works out: the rows as sets of rows, and names.
AT_COMPILE_TIME = ("TableRowMasks()", "conditions(unsigned", "is_sound", "awaited", "name_of")


@pytest.mark.slow
def test_every_branch_of_the_step_is_taken(tmp_path: Path) -> None:
    """Measured by gcov, for all functions that run after compilation, in the controller and in its
    receiver of beacons."""
    tested = program("control/resilient_test-gcov")
    (notes,) = tested.parent.glob(f"{tested.name}*.gcno")
    shutil.copy(notes, tmp_path)
    here = {"GCOV_PREFIX": str(tmp_path), "GCOV_PREFIX_STRIP": str(len(tested.parts) - 2)}
    subprocess.run([tested], check=True, env=os.environ | here, timeout=300)
    run = subprocess.run(
        ["gcov", "--json-format", "--stdout", "--branch-probabilities",
         *(path.name for path in tmp_path.glob("*.gcda"))],
        check=True, capture_output=True, cwd=tmp_path, timeout=60,
    ).stdout  # fmt: skip
    branches = 0
    files = [f for line in run.splitlines() for f in json.loads(line)["files"]]
    for header in ("table_robot.hpp", "resilient_memory.hpp", "mailbox.hpp"):
        (lines,) = [f["lines"] for f in files if f["file"].endswith(f"palmbots/control/{header}")]
        for line in lines:
            if any(name in line.get("function_name", "") for name in AT_COMPILE_TIME):
                continue
            assert line["count"] > 0, f"{header}:{line['line_number']} never runs"
            for branch in line["branches"]:
                branches += 1
                assert branch["count"] > 0, f"{header}:{line['line_number']}: a branch is not taken"
    assert branches > 40


def measured(folder: Path) -> dict[str, int]:
    """Bytes of code and tables, and instructions of a step: the median and the maximum of 1000
    random steps, on this processor at -Os, counted by callgrind."""
    stepping = program("control/resilient_cost")
    listing = ["nm", "-S", "-C", str(stepping)]
    symbols = subprocess.run(listing, check=True, capture_output=True, text=True).stdout

    def size(name: str) -> int:
        result = re.search(rf"^\S+ (\S+) \S {re.escape(name)}", symbols, re.MULTILINE)
        assert result is not None, name
        return int(result[1], 16)

    subprocess.run(
        ["valgrind", "--quiet", "--tool=callgrind", "--compress-strings=no", "--compress-pos=no",
         "--callgrind-out-file=steps", "--dump-after=resilient_step*", str(stepping), "1000"],
        check=True, cwd=folder, capture_output=True, timeout=300,
    )  # fmt: skip
    counts = sorted(instructions(path) for path in folder.glob("steps.*"))
    assert len(counts) == 1000
    return {
        "code_bytes": size("resilient_step("),
        "table_bytes": size("palmbots::TableRobot<palmbots::Resilient>::row_masks")
        + size("palmbots::Resilient::outputs"),
        "median_instructions": counts[500],
        "worst_instructions": counts[-1],
    }


def instructions(dump: Path) -> int:
    """Instructions of the step itself, which calls no function."""
    total, inside = 0, False
    for line in dump.read_text().splitlines():
        if line.startswith("fn="):
            inside = "resilient_step" in line
        elif inside and re.fullmatch(r"\d+ \d+", line):
            total += int(line.split()[1])
    return total


def test_step_has_a_small_bounded_cost(tmp_path: Path) -> None:
    result = measured(tmp_path)
    assert result["code_bytes"] < 1024
    assert result["table_bytes"] < 4096
    # No loops: the worst step costs little more than any other.
    assert 50 < result["median_instructions"] <= result["worst_instructions"] < 250


if __name__ == "__main__":
    import sys
    import tempfile

    with tempfile.TemporaryDirectory() as where:
        print(json.dumps(measured(Path(where))))
    sys.exit(0)
