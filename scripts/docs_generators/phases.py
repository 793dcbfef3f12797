# SPDX-License-Identifier: Apache-2.0
"""The phases of a job that begins or ends on the floor, as a table."""

from palmbots.simulation.floor_job import MEANINGS


def blocks() -> dict[str, str]:
    """The generated part of the docs by name."""
    rows = ["| phase | what the robot does |", "|---|---|"]
    rows += [f"| `{name}` | {meaning} |" for name, meaning in MEANINGS.items()]
    return {"phases of a job": "\n".join(rows)}
