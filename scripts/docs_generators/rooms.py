# SPDX-License-Identifier: Apache-2.0
"""The maps of the rooms, from tests/package/layers.toml."""

import tomllib
from pathlib import Path

LAYERS = Path(__file__).parents[2] / "tests" / "package" / "layers.toml"


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    layers = tomllib.loads(LAYERS.read_text(encoding="utf-8"))
    core = {row["room"]: row["may_include"] for row in layers["core"]}
    python = {row["room"]: row["may_import"] for row in layers["python"]}
    return {
        "core map": diagram(core),
        "core rooms": table(layers["core"], "may_include", "may include"),
        "python map": diagram(
            {room: below for room, below in python.items() if room != "__main__"}
        ),
        "python rooms": table(layers["python"], "may_import", "may import"),
    }


def table(rows: list[dict[str, str]], key: str, head: str) -> str:
    """A row for each room, the highest first."""
    lines = [f"| room | what it is about | {head} |", "|---|---|---|"]
    for row in reversed(rows):
        lines.append(f"| `{row['room']}` | {row['about']} | {', '.join(row[key]) or 'nothing'} |")
    return "\n".join(lines)


def diagram(below: dict[str, list[str]]) -> str:
    """A Mermaid diagram. An arrow that others imply is left out."""

    def reached(room: str) -> set[str]:
        return set(below[room]).union(*(reached(lower) for lower in below[room]))

    lines = ["```mermaid", "graph TD"]
    for room, lower in reversed(below.items()):
        implied = set().union(*(reached(other) for other in lower))
        lines += [f"  {room} --> {other}" for other in lower if other not in implied]
    return "\n".join([*lines, "```"])
