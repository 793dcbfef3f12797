#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What happened in the carries of `test_live_faults.py`, as a table: fault by controller.

    .venv/bin/python tests/soak/live_table.py [FILE]      build/soak/live_carries.jsonl by default

Runs in which the machine held up a process for more than 20 ms have a table of their own.
"""

import json
import sys
from collections import Counter, defaultdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

FILE = Path(__file__).resolve().parent.parent.parent / "build" / "soak" / "live_carries.jsonl"


def table_of(runs: list[dict], title: str) -> Table:
    """A table of these runs; a cell counts the outcomes."""
    controllers = sorted({run["controller"] for run in runs})
    table = Table("fault", *controllers, title=f"{title}: {len(runs)} carries in real time")
    cells: dict[tuple[str, str], Counter[str]] = defaultdict(Counter)
    for run in runs:
        cells[run["fault"], run["controller"]][run["outcome"]] += 1
    for fault in dict.fromkeys(run["fault"] for run in runs):
        counts = [cells[fault, controller].most_common() for controller in controllers]
        table.add_row(fault, *(", ".join(f"{n} {name}" for name, n in cell) for cell in counts))
    return table


def main() -> None:
    """Print the table."""
    file = Path(sys.argv[1]) if len(sys.argv) > 1 else FILE
    if not file.exists():
        print(f"no carries yet: {file}")
        return
    lines = file.read_text(encoding="utf-8").splitlines()
    runs = [json.loads(line) for line in lines]
    for was_held, title in ((False, "undisturbed"), (True, "the machine held up a process")):
        if chosen := [run for run in runs if run["was_held"] == was_held]:
            Console(highlight=False).print(table_of(chosen, title))


if __name__ == "__main__":
    main()
