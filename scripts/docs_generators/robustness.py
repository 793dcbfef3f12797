# SPDX-License-Identifier: Apache-2.0
"""Every controller under every condition, as benchmarks/bench_robustness.py measured it."""

import csv
from pathlib import Path

PAGE = "docs/theory/robustness.md"
RESULT = Path(__file__).parents[2] / "benchmarks" / "results" / "robustness.csv"


def _rows() -> list[dict[str, str]]:
    return list(csv.DictReader(RESULT.open(encoding="utf-8")))


def _percent(row: dict[str, str], column: str) -> str:
    """A share of the carries; "refused" where the controller refuses the scene."""
    carries = int(row["carries"])
    return f"{100 * int(row[column]) / carries:.1f}" if carries else "refused"


def _table(head: list[str], lines: list[list[str]]) -> str:
    rows = [head, ["---"] * len(head), *lines]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in rows)


def overview(column: str) -> str:
    """The drop rates of all controllers at one noise, a line for each condition."""
    rows = _rows()
    names = list(dict.fromkeys(row["controller"] for row in rows))
    lines = []
    for condition in dict.fromkeys(row["condition"] for row in rows):
        of = {row["controller"]: row for row in rows if row["condition"] == condition}
        lines.append([condition, *(_percent(of[name], column) for name in names)])
    return _table(["dropped [%]", *(f"`{name}`" for name in names)], lines)


def details() -> str:
    """Everything else that was measured."""
    lines = [
        [
            row["condition"],
            f"`{row['controller']}`",
            _percent(row, "dropped_1_cm_s"),
            _percent(row, "stalled_2_cm_s"),
            row["rms_mm"],
            row["time_s"],
            row["messages_per_m"],
            row["palm_moves_per_m"],
            row["reversals_per_m"],
        ]
        for row in _rows()
        if int(row["carries"])
    ]
    head = ["condition", "controller", "dropped at 1 cm/s [%]", "stalled [%]", "contact rms [mm]"]
    head += ["time [s]", "messages per m", "palm moves per m", "reversals per m"]
    return _table(head, lines)


def dynamic() -> str:
    """Drops in the MuJoCo world."""
    file = RESULT.with_name("mujoco_controllers.csv")
    with file.open(newline="", encoding="utf-8") as stream:
        head, *rows = csv.reader(stream)
    return _table(head, [[f"`{name}`", *cells] for name, *cells in rows])


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {
        "drops at 2 cm/s": overview("dropped_2_cm_s"),
        "drops at 3 cm/s": overview("dropped_3_cm_s"),
        "dynamic": dynamic(),
        "details": details(),
    }
