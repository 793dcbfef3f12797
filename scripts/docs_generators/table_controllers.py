# SPDX-License-Identifier: Apache-2.0
"""The controllers that are tables, as they run: their rows, their states, and what both signs lead
to."""

from typing import Any

from docs_generators.controllers import CONTACT
from palmbots.control.registry import resolve
from palmbots.control.table_timing import transition_table
from palmbots.scene.scene import Scene

CONDITION = {
    "settled": "the palm is at its target",
    "timed_out": "time is up",
    "leads": "it leads",
    "follows": "it follows",
    "may_stop": "it may stop",
}


def _table(name: str) -> dict[str, Any]:
    table = transition_table(resolve(name), Scene())
    assert table is not None
    return table


def _starts(states: list[str], table: dict[str, Any]) -> str:
    """Where a row starts, as short as it can be said."""
    every = [state["name"] for state in table["states"]]
    if states == every:
        return "any"
    for palm in ("steep", "shallow"):
        if states == [state["name"] for state in table["states"] if state["palm"] == palm]:
            return f"palm {palm}"
    others = [name for name in every if name not in states]
    if len(others) < len(states):
        return "any but " + ", ".join(f"`{name}`" for name in others)
    return ", ".join(f"`{name}`" for name in states)


def _does(state: dict[str, Any]) -> str:
    move = {"hold": "", "away": ", move away", "closer": ", move closer"}[state["move"]]
    return f"palm {state['palm']}{move}" + (", stop" if state["stop"] else "")


def states_of(name: str) -> str:
    """What a robot commands and says in each state."""
    table = _table(name)
    talks = table["talks"]
    rows = [
        "| state | case | the robot has |" + (" and says |" if talks else "") + " at most for |",
        "|---|---|---|" + ("---|" if talks else "") + "---|",
    ]
    for state in table["states"]:
        limit = f"{table['limits_s'][state['limit']]:g} s" if state["limit"] else ""
        cells = [f"`{state['name']}`", state["case"].strip(), _does(state)]
        cells += [state["word"]] if talks else []
        rows.append(f"| {' | '.join([*cells, limit])} |")
    return "\n".join(rows)


def rows_of(name: str) -> str:
    """The rows, in the order in which they are tried."""
    table = _table(name)
    talks = table["talks"]
    lines = [
        "| in state |" + (" hears |" if talks else "") + " if | goes to |",
        "|---|" + ("---|" if talks else "") + "---|---|",
    ]
    for row in table["rows"]:
        contact = "p = 0" if row["contact"] == "zero" else CONTACT[row["contact"]]
        when = ", ".join(w for w in (contact, *(CONDITION[c] for c in row["when"])) if w)
        heard = row["heard"]
        says = "" if heard is None else ", ".join(word or "nothing" for word in heard)
        cells = [_starts(row["states"], table), *([says] if talks else [])]
        lines.append(f"| {' | '.join([*cells, when, '`' + row['next'] + '`'])} |")
    return "\n".join(lines)


def diagram_of(name: str) -> str:
    """The state diagram of a table without words: each state with its output, and its edges."""
    table = _table(name)
    lines = ["```mermaid", "stateDiagram-v2", f"    [*] --> {table['initial']}"]
    lines += [f"    {state['name']} : {state['name']}, {_does(state)}" for state in table["states"]]
    for state in table["states"]:
        leaves: set[str] = set()
        for row in table["rows"]:
            if state["name"] not in row["states"]:
                continue
            contact = "p = 0" if row["contact"] == "zero" else CONTACT[row["contact"]]
            label = ", ".join(w for w in (contact, *(CONDITION[c] for c in row["when"])) if w)
            if label in leaves:
                continue
            leaves.add(label)
            if row["next"] != state["name"]:
                lines.append(f"    {state['name']} --> {row['next']} : {label}")
    return "\n".join([*lines, "```"])


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {
        "diagram of silent": diagram_of("silent"),
        "rows of silent": rows_of("silent"),
        "states of shared-sign": states_of("shared-sign"),
        "rows of shared-sign": rows_of("shared-sign"),
    }
