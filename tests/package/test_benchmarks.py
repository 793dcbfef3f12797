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
