# SPDX-License-Identifier: Apache-2.0
"""Every example runs and prints something; the program of the packet benchmark compiles."""

import csv
import importlib
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

EXAMPLES = sorted((Path(__file__).parent.parent.parent / "examples").glob("[0-9]*.py"))


def test_there_are_seven_examples() -> None:
    assert [path.name[:2] for path in EXAMPLES] == ["01", "02", "03", "04", "05", "06", "07"]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_example_runs(
    path: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In this process, where a warning is an error, too."""
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(path), run_name="__main__")
    printed = capsys.readouterr()
    assert printed.err == ""
    assert len(printed.out.splitlines()) >= 2


def test_an_example_is_a_program(tmp_path: Path) -> None:
    words = [sys.executable, "-W", "error", EXAMPLES[0]]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stderr) == (0, "") and done.stdout


ROOT = Path(__file__).resolve().parent.parent.parent
BENCHMARKS = ROOT / "benchmarks"


def test_program_of_the_packet_benchmark_compiles_and_has_the_recorded_rows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(BENCHMARKS)
    bench = importlib.import_module("bench_wire")
    assert bench.compiled("-O2", str(tmp_path)).is_file()
    counted = re.findall(r"void count_(\w+)", bench.SOURCE.read_text())
    with bench.RESULTS.open() as file:
        recorded = [row["instructions of one"] for row in csv.DictReader(file)]
    assert recorded == [name.replace("_", " ") for name in counted]
