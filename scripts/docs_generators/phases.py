# SPDX-License-Identifier: Apache-2.0
"""The phases of a job that begins or ends on the floor, and what ends a carry, as tables."""

from palmbots.simulation.carry_ends import ends
from palmbots.simulation.floor_job import MEANINGS, TASK_PHASES


def blocks() -> dict[str, str]:
    """The generated parts of the docs by name."""
    rows = ["| phase | what the robot does | phase of the task |", "|---|---|---|"]
    rows += [
        f"| `{name}` | {meaning} | `{TASK_PHASES[name]}` |" for name, meaning in MEANINGS.items()
    ]
    return {"phases of a job": "\n".join(rows), "ends": ends_table()}


def ends_table() -> str:
    """Each event by phase, the phases, and the meaning of each name."""
    found = ends()
    rows = [f"| | {' | '.join(f'`{phase}`' for phase in found.phases)} |", "|---" * 5 + "|"]
    meanings = ["| name | what happened |", "|---|---|"]
    for end in found.ends:
        if set(end.follows.values()) != {"–"}:  # otherwise it is a reason only
            rows.append(f"| `{end.name}` | {' | '.join(end.follows.values())} |")
        other = "" if end.in_mujoco == end.meaning else f"; in MuJoCo: {end.in_mujoco}"
        meanings.append(f"| `{end.name}` | {end.meaning}{other} |")
    phases = [f"- `{phase}`: {meaning}" for phase, meaning in found.phases.items()]
    return "\n".join([*rows, "", *phases, "", *meanings])
