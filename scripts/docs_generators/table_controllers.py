# SPDX-License-Identifier: Apache-2.0
"""The controllers that are tables, as they run: their rows, their states, and what both signs lead
to."""

from typing import Any

from docs_generators.controllers import condition_of, heard_by, table_of


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
    table = table_of(name)
    talks = table["mail"] == "beacons"
    rows = [
        "| state | case | the robot has |" + (" and says |" if talks else "") + " at most for |",
        "|---|---|---|" + ("---|" if talks else "") + "---|",
    ]
    for state in table["states"]:
        limit = f"{table['limits_s'][state['limit']]:g} s" if state["limit"] else ""
        cells = [f"`{state['name']}`", state["case"].strip(), _does(state)]
        cells += [state["message"]] if talks else []
        rows.append(f"| {' | '.join([*cells, limit])} |")
    return "\n".join(rows)


def rows_of(name: str) -> str:
    """The rows, in the order in which they are tried."""
    table = table_of(name)
    talks = table["mail"] == "beacons"
    lines = [
        "| in state |" + (" hears |" if talks else "") + " if | goes to |",
        "|---|" + ("---|" if talks else "") + "---|---|",
    ]
    for row in table["rows"]:
        cells = [_starts(row["states"], table), *([heard_by(row)] if talks else [])]
        lines.append(f"| {' | '.join([*cells, condition_of(row), '`' + row['next'] + '`'])} |")
    return "\n".join(lines)


def diagram_of(name: str) -> str:
    """The state diagram of a table without messages: each state with its output, and its edges."""
    table = table_of(name)
    lines = ["```mermaid", "stateDiagram-v2", f"    [*] --> {table['initial']}"]
    lines += [f"    {state['name']} : {state['name']}, {_does(state)}" for state in table["states"]]
    for state in table["states"]:
        leaves: set[str] = set()
        for row in table["rows"]:
            if state["name"] not in row["states"]:
                continue
            label = condition_of(row)
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
