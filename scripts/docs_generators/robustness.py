# SPDX-License-Identifier: Apache-2.0
"""Every controller under every condition, as benchmarks/bench_robustness.py measured it."""

import csv
from pathlib import Path

from palmbots._util.confidence_intervals import rate_interval

RESULT = Path(__file__).parents[2] / "benchmarks" / "results" / "robustness.csv"


SPEEDS = {"corrections": "corrections only", "stopping": "robots may stop"}


def _rows() -> list[dict[str, str]]:
    return _read(RESULT.name)


def _read(name: str) -> list[dict[str, str]]:
    with RESULT.with_name(name).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


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


def rare() -> str:
    """The drop rates at 1 cm/s: estimates, their intervals, and upper bounds."""
    rows = _read("rare_drops.csv")
    names = list(dict.fromkeys(row["controller"] for row in rows))
    lines = []
    for condition in dict.fromkeys(row["condition"] for row in rows):
        of = {row["controller"]: row for row in rows if row["condition"] == condition}
        lines.append([condition, *(_rate(of[name]) if name in of else "refused" for name in names)])
    return _table(["drop rate", *(f"`{name}`" for name in names)], lines)


def _rate(row: dict[str, str]) -> str:
    low, high = _short(row["low"]), _short(row["high"])
    return f"< {high}" if row["method"] == "bound" else f"{_short(row['rate'])} ({low}–{high})"


def _short(number: str) -> str:
    """As 0.013 or 2e-9."""
    value = float(number)
    return f"{value:.2g}" if value >= 1e-3 or value == 0 else f"{value:.1e}".replace("e-0", "e-")


def over_the_noise() -> str:
    """The drop rates of all controllers and references at some noises."""
    rows = _read("noise.csv")
    noises = ("0.02", "0.03", "0.035", "0.04", "0.045", "0.05", "0.06")
    lines = []
    curves = dict.fromkeys((row["speeds"], row["controller"]) for row in rows)
    for speeds, controller in sorted(curves, key=lambda curve: curve[0]):  # keeps the order within
        of = {
            row["noise_m_s"]: row
            for row in rows
            if (row["speeds"], row["controller"]) == (speeds, controller)
        }
        name = "bound of robots that keep driving" if controller == "bound" else f"`{controller}`"
        cells = [_at(noise, of) for noise in noises]
        lines.append([SPEEDS[speeds], name, *cells])
    head = [f"{100 * float(noise):g} cm/s" for noise in noises]
    return _table(["speeds", "dropped [%]", *head], lines)


def _at(noise: str, rows: dict[str, dict[str, str]]) -> str:
    """The drop rate at a noise [%]. A curve ends at the greatest noise at which nothing drops."""
    if noise in rows:
        return f"{100 * float(rows[noise]['rate']):.1f}"
    zeros = [float(key) for key, row in rows.items() if float(row["rate"]) < 1e-6]
    return "0.0" if float(noise) < max(zeros, default=0.0) else "–"


def curved() -> str:
    """Drops on curved paths."""
    with RESULT.with_name("curved_controllers.csv").open(newline="", encoding="utf-8") as stream:
        head, *rows = csv.reader(stream)
    return _table(head, [[path, f"`{name}`", *cells] for path, name, *cells in rows])


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
    return _table(head, [[condition, f"`{name}`", *cells] for condition, name, *cells in rows])


def recorded() -> str:
    """The drop rates with recorded robots and radios, with 95 % intervals."""
    rows = _read("recorded.csv")
    names = list(dict.fromkeys(row["controller"] for row in rows))
    lines = []
    for robots, radio in dict.fromkeys((row["robots"], row["radio"]) for row in rows):
        of = {
            row["controller"]: row
            for row in rows
            if (row["robots"], row["radio"]) == (robots, radio)
        }
        share = 100 * float(of[names[0]]["packets_lost"])
        lines.append([robots, radio, f"{share:.2g}", *(_interval(of[name]) for name in names)])
    head = ["robots", "radio", "packets lost [%]", *(f"`{name}`" for name in names)]
    return _table(head, lines)


def _interval(row: dict[str, str]) -> str:
    if not row["carries"]:
        return "refused"
    dropped, carries = int(row["dropped"]), int(row["carries"])
    low, high = rate_interval(dropped, carries)
    if dropped == 0:
        return f"< {100 * high:.2g}"
    return f"{100 * dropped / carries:.3g} ({100 * low:.2g}–{100 * high:.2g})"


def sources() -> str:
    """The files of recordings, and their hashes."""
    rows = _read("recorded-sources.csv")
    return _table(["file", "SHA-256"], [[row["file"], f"`{row['sha256']}`"] for row in rows])


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {
        "drops over the noise": over_the_noise(),
        "rates at 1 cm/s": rare(),
        "curved": curved(),
        "drops at 2 cm/s": overview("dropped_2_cm_s"),
        "drops at 3 cm/s": overview("dropped_3_cm_s"),
        "dynamic": dynamic(),
        "details": details(),
        "recorded": recorded(),
        "recorded files": sources(),
    }
