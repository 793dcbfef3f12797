# SPDX-License-Identifier: Apache-2.0
"""The tables that the controllers run, and the measured effect of lost messages."""

import csv
from pathlib import Path
from typing import Any

import palmbots._core as _core
from palmbots.control.registry import resolve
from palmbots.control.table_timing import transition_table
from palmbots.scene.scene import Scene

LOSSES = Path(__file__).parents[2] / "benchmarks" / "results" / "loss.csv"
BY_TIME = LOSSES.with_name("loss_by_time.csv")

SIGN = {-1: "−", 0: "0", 1: "+"}
CONTACT = {
    "any": "",
    "positive": "p > 0",
    "not_positive": "p ≤ 0",
    "negative": "p < 0",
    "not_negative": "p ≥ 0",
}
CONDITION = {
    "turned": "the palm has turned",
    "timed_out": "time is up",
    "leads": "it leads",
    "follows": "it follows",
    "may_stop": "it may stop",
    "settled": "at rest",
    "released": "released",
}
MOVE = {"away": "separate", "closer": "closer"}


def table1() -> str:
    """The eight cases of the centralized algorithm."""

    def steps_of(action: tuple[str, str, str]) -> str:
        move, who, until = action
        if move == "hold":
            return ""
        sign = {"le_zero": "≤ 0", "ge_zero": "≥ 0"}[until]
        whose = ("left", "right") if who == "either" else (who,)
        return f"{MOVE[move]} until " + " or ".join(f"p_{w[0].upper()} {sign}" for w in whose)

    rows = ["| case | p_L | p_R | tilt up | then | then |", "|---|---|---|---|---|---|"]
    for number, (signs, tilt, first, second) in enumerate(_core.table1(), 1):
        cells = [*(SIGN[s] for s in signs), "" if tilt == "none" else tilt]
        rows.append(f"| {number} | {' | '.join([*cells, steps_of(first), steps_of(second)])} |")
    return "\n".join(rows)


def table_of(name: str) -> dict[str, Any]:
    """The table that a controller runs."""
    table = transition_table(resolve(name), Scene())
    assert table is not None
    return table


def condition_of(row: dict[str, Any]) -> str:
    """What a row requires besides what the robot hears."""
    contact = "p = 0" if row["contact"] == "zero" else CONTACT[row["contact"]]
    return ", ".join(w for w in (contact, *(CONDITION[c] for c in row["when"])) if w)


def heard_by(row: dict[str, Any]) -> str:
    """What the robot hears where a row applies."""
    return (
        "" if row["heard"] is None else ", ".join(message or "nothing" for message in row["heard"])
    )


def rows_by_case(name: str) -> str:
    """The rows of a table in which each row starts in one state, in the order in which they are
    tried, with what the robot does there."""
    table = table_of(name)
    says = table["mail"] == "beacons"
    rows = [
        "| case | in state | where the robot has |"
        + (" and says | hears | if | goes to |" if says else " hears | if | goes to | and sends |"),
        "|---|---|---|---|---|---|---|",
    ]
    states = {state["name"]: state for state in table["states"]}
    for row in table["rows"]:
        (start,) = row["states"]
        state, after = states[start], row["next"]
        case = state["case"].strip() or states[after]["case"].strip()
        does = f"palm {state['palm']}" + (
            f", move {state['move']}" if state["move"] != "hold" else ""
        )
        cells = [f"({case})" if case else "", f"`{start}`", does]
        cells += [state["message"]] if says else []
        cells += [heard_by(row), condition_of(row), f"`{after}`"]
        cells += [] if says else [row["send"]]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def losses() -> str:
    """The results of benchmarks/bench_loss.py."""
    rows = [
        "| loss | carries | delivered | dropped | stalled | contact rms | "
        "to Table 2 without losses | mean time | Table 2: dropped | "
        "Table 2: a message lost (95 %) | 1 − (1 − loss)^messages |",
        "|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in csv.DictReader(LOSSES.open()):
        dropped = int(row["dropped_unavoidable"]) + int(row["dropped_avoidable"])
        hit, low, high, expected = (
            f"{100 * float(row[f'table2_{name}']):.1f}"
            for name in ("affected", "affected_low", "affected_high", "expected")
        )
        cells = [
            f"{100 * float(row['loss']):g} %",
            row["carries"],
            row["delivered"],
            f"{dropped} ({row['dropped_unavoidable']} unavoidable)",
            row["stalled"],
            f"{float(row['rms_mm']):.2f} mm",
            f"{float(row['rms_ratio']):.2f}",
            f"{float(row['mean_time_s']):.1f} s",
            row["table2_dropped"],
            f"{hit} % ({low}–{high})",
            f"{expected} %",
        ]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def losses_by_time() -> str:
    """The results of benchmarks/bench_loss.py for Table 2 at 1 % loss."""
    rows = [
        "| by | messages sent | a message lost (95 %) | 1 − (1 − loss)^messages |",
        "|---|---|---|---|",
    ]
    for row in csv.DictReader(BY_TIME.open()):
        hit, low, high, expected = (
            f"{100 * float(row[name]):.1f}" for name in ("affected", "low", "high", "expected")
        )
        sent = f"{float(row['by_s']):g} s | {float(row['messages']):.1f}"
        rows.append(f"| {sent} | {hit} % ({low}–{high}) | {expected} % |")
    return "\n".join(rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {
        "table 1": table1(),
        "table 2": rows_by_case("distributed"),
        "table 3": rows_by_case("resilient"),
        "losses": losses(),
        "losses by time": losses_by_time(),
    }
