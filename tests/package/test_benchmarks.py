# SPDX-License-Identifier: Apache-2.0
"""Benchmarks do not run in `make test`; what would break them unnoticed is tested here."""

import csv
import importlib
import re
from pathlib import Path

import pytest

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


@pytest.mark.parametrize("path", sorted(BENCHMARKS.glob("bench_*.py")), ids=lambda path: path.stem)
def test_benchmark_names_itself_in_its_command(path: Path) -> None:
    """The command in the docstring is the one that runs it; results lie where they are read."""
    text = path.read_text()
    commands = re.findall(r"^    \.venv/bin/python (\S+)", text, re.MULTILINE)
    assert commands == [f"benchmarks/{path.name}"]
    for name in re.findall(r'"results" / "([\w.]+)"', text):
        assert (BENCHMARKS / "results" / name).is_file()
