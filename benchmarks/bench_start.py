# SPDX-License-Identifier: Apache-2.0
"""How long a program waits for palmbots to start: the import, and the help text.

    .venv/bin/python benchmarks/bench_start.py

Prints a table and writes results/start.csv: the median and the best of 15 starts, with compiled
bytecode and files in memory, and the time of Python itself, which is part of both.
"""

import csv
import datetime
import statistics
import subprocess
import sys
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from _machine import processor

RESULTS = Path(__file__).parent / "results" / "start.csv"
STARTS = 15
PROGRAMS = {
    "python": ("-c", "pass"),
    "import palmbots": ("-c", "import palmbots"),
    "palmbots --help": ("-m", "palmbots", "--help"),
}


def seconds(words: tuple[str, ...]) -> list[float]:
    """Times of some starts [s], after one that does not count."""
    found = []
    for _ in range(STARTS + 1):
        began = time.perf_counter()
        subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=True)
        found.append(time.perf_counter() - began)
    return found[1:]


def main() -> None:
    """Measure, print, write."""
    rows = []
    for name, words in PROGRAMS.items():
        found = seconds(words)
        rows.append((name, f"{statistics.median(found):.3f}", f"{min(found):.3f}"))
    table = Table("program", "median [s]", "best [s]")
    for row in rows:
        table.add_row(*row)
    Console(highlight=False, soft_wrap=True).print(table)
    with RESULTS.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(("program", "median_s", "best_s", "machine", "python", "date"))
        today = datetime.date.today().isoformat()
        for row in rows:
            out.writerow((*row, processor(), sys.version.split()[0], today))


if __name__ == "__main__":
    main()
