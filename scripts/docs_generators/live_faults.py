# SPDX-License-Identifier: Apache-2.0
"""Faults of running robots and the times of an e-stop, from the results of the benchmark."""

import csv
from pathlib import Path

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results"


def _table(name: str) -> str:
    with (RESULTS / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    return "\n".join(f"| {' | '.join(row)} |" for row in (head, ["---"] * len(head), *rows))


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    names = {
        "live faults": "live_faults",
        "e-stop": "e_stop",
        "e-stop of processes": "e_stop_processes",
    }
    return {marker: _table(name) for marker, name in names.items()}
