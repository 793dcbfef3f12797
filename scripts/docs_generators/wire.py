# SPDX-License-Identifier: Apache-2.0
"""The bytes of a packet, from the layout that the core uses, and what a packet costs."""

import csv
from pathlib import Path

import palmbots._core as _core
from palmbots.wire import MAX_EPOCH, MAX_SEQUENCE

COST = Path(__file__).parents[2] / "benchmarks" / "results" / "wire.csv"

MEANING = {
    "version": "version of this format: 2",
    "kind": "0 hello, 1 state, 2 status, 3 operate, 4 report, 5 command",
    "roles": "bits 0–3 sender, bits 4–7 receiver: 0 left, 1 right, 2 station",
    "pair": "number of the pair of robots; any number",
    "epoch": f"number of the sender's boots so far, 1 to {MAX_EPOCH}",
    "heard epoch": "epoch of the newest packet that the sender has received from the receiver "
    "since the sender's boot",
    "heard sequence": "sequence of that packet; both 0: the sender has received none",
    "sequence": f"number of the packet among those to this receiver in this epoch, 1 to "
    f"{MAX_SEQUENCE}; numbers may be skipped",
    "payload": "content, see below",
    "tag": "SipHash-2-4 of all bytes before it, under the key of the pair",
}


def layout() -> str:
    """The fields in order, as Markdown."""
    rows = ["| bytes | field | meaning |", "|---|---|---|"]
    for name, offset, size in _core.wire.layout():
        last = offset + size - 1
        places = f"{offset}" if size == 1 else f"{offset}–{last}"
        # Python's name for the two fields of an acknowledgement; the core calls them `heard`.
        field = name.replace("heard", "acknowledged")
        rows.append(f"| {places} | `{field}` | {MEANING[name]} |")
    return "\n".join(rows)


def cost() -> str:
    """The instructions counted, as Markdown."""
    with COST.open(newline="") as file:
        head, *counts = (row[:3] for row in csv.reader(file))
    lines = (head, ["---"] * 3, *counts)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def codes() -> str:
    """The numbers of modes, faults, operations, cases and items, as Markdown."""
    tables = {
        "mode": _core.wire.robot_modes,
        "fault": _core.wire.fault_codes,
        "operation": _core.wire.operations,
        "case": ["none", *_core.wire.cases[1:]],
        "item": [*_core.wire.status_numbers, *(f"received: {v}" for v in _core.wire.verdicts)],
    }
    rows = ["| field | numbers |", "|---|---|"]
    for field, names in tables.items():
        numbers = ", ".join(f"{n} {name}" for n, name in enumerate(names))
        rows.append(f"| {field} | {numbers} |")
    return "\n".join(rows)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"layout": layout(), "codes": codes(), "cost": cost()}
