# SPDX-License-Identifier: Apache-2.0
"""Instructions by version, and times of starts, as the benchmarks measured them."""

import csv
from pathlib import Path

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results"


def _rows(name: str) -> list[dict[str, str]]:
    with (RESULTS / name).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def _table(rows: list[list[str]]) -> str:
    head, *lines = rows
    return "\n".join(f"| {' | '.join(cells)} |" for cells in [head, ["---"] * len(head), *lines])


def instructions() -> str:
    """A line for each benchmark, a column for each version."""
    rows = _rows("instructions.csv")
    versions = list(dict.fromkeys(row["version"] for row in rows))
    counts = {(row["benchmark"], row["version"]): int(row["instructions"]) for row in rows}
    lines = [["instructions of one", *versions]]
    for name in dict.fromkeys(row["benchmark"] for row in rows):
        cells = [counts.get((name, version)) for version in versions]
        lines.append([name, *("–" if count is None else f"{count:,}" for count in cells)])
    compilers = "; ".join(dict.fromkeys(f"{row['compiler']}, {row['processor']}" for row in rows))
    return f"{_table(lines)}\n\nCompiled by {compilers}."


def start() -> str:
    """The times of starts."""
    rows = _rows("start.csv")
    lines = [["program", "median [s]", "best [s]"]]
    lines += [[f"`{row['program']}`", row["median_s"], row["best_s"]] for row in rows]
    return f"{_table(lines)}\n\nMeasured with Python {rows[0]['python']}."


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"instructions": instructions(), "start": start()}
