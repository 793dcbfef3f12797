# SPDX-License-Identifier: Apache-2.0
"""The tables that the controllers run, and the measured effect of lost messages."""

import csv
from pathlib import Path

import palmbots._core as _core

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
GOT = {
    "any": "",
    "tilt_up": "TiltUp came",
    "tilt_down": "TiltDown came",
    "ack": "Ack came",
}
HEARD = {
    "any": "",
    "tilt_up": "TiltUp",
    "not_tilt_up": "no TiltUp",
    "ack": "Ack",
    "not_ack": "no Ack",
    "other": "something else",
    "steep": "TiltUp, TiltDown or Closing",
    "not_steep": "Ack, Raised or nothing",
    "silence": "nothing",
}
CONDITION = {
    "any": "",
    "settled": "at rest",
    "released": "released",
    "yields": "this robot yields",
    "held": "the palm was held long enough",
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


def table2() -> str:
    """The rows of the distributed algorithm, in the order in which they are tried."""
    doing, rows_run = _core.table2()
    does = {
        name: f"palm {palm}" + (f", move {move}" if move != "hold" else "")
        for name, _, palm, move, _ in doing
    }
    rows = [
        "| case | in state | where the robot has | if | goes to | and sends |",
        "|---|---|---|---|---|---|",
    ]
    case = {name: code for name, code, *_ in doing}
    for state, contact, got, tilt, after, send in rows_run:
        when = [
            CONTACT[contact],
            GOT[got],
            "the palm has turned" if tilt == "done" else "",
        ]
        code = case[state].strip() or case[after].strip()
        cells = [
            f"({code})",
            f"`{state}`",
            does[state],
            ", ".join(w for w in when if w),
            f"`{after}`",
            send,
        ]
        rows.append(f"| {' | '.join(cells)} |")
    return "\n".join(rows)


def resilient() -> str:
    """The states and rows of the resilient algorithm, in the order in which they are tried."""
    doing, rows_run = _core.resilient_table()
    rows = [
        "| case | in state | where the robot has | and says | hears | if | goes to |",
        "|---|---|---|---|---|---|---|",
    ]
    state_of = {name: rest for name, *rest in doing}
    for state, contact, heard, condition, after in rows_run:
        case, palm, move, sent = state_of[state]
        case = case.strip() or state_of[after][0].strip()
        does = f"palm {palm}" + (f", move {move}" if move != "hold" else "")
        when = ", ".join(w for w in (CONTACT[contact], CONDITION[condition]) if w)
        cells = [
            f"({case})", f"`{state}`", does, sent, HEARD[heard], when, f"`{after}`",
        ]  # fmt: skip
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
        "table 2": table2(),
        "table 3": resilient(),
        "losses": losses(),
        "losses by time": losses_by_time(),
    }
