# SPDX-License-Identifier: Apache-2.0
"""Policy files as controllers: the derived algorithm, checked before it runs.

The registry of controllers calls `load_policy` for every name that ends with ``.toml``, and
`load_station_policy` for every name that ends with ``.toml@station``.
"""

import hashlib
import shlex
from collections.abc import Callable
from pathlib import Path

from palmbots._util.user_paths import user_path
from palmbots.control.python_source import ControllerSource, refuse_pipe
from palmbots.control.registry import POLICY_BOARD_NUMBER, ControllerEntry, describe
from palmbots.derivation.distributed_algorithm import machines_of
from palmbots.derivation.global_policy import signs_text
from palmbots.derivation.policy_file import read_policy
from palmbots.derivation.verification import MEANINGS, Verification, verified
from palmbots.errors import PalmbotsError
from palmbots.scene.command_text import command_text

# How a robot assists depends on the policy.
_CASES = {
    **describe("distributed").cases, **describe("silent").cases, "c": "assists its partner",
}  # fmt: skip


class PolicyNotProved(PalmbotsError):
    """The algorithm that was derived from a policy fails its check."""

    def __init__(self, message: str, verification: Verification) -> None:
        super().__init__(message)
        self.verification = verification
        """What was found."""


def load_policy(
    path: str,
    *,
    called: str = "controller",
    folder: str | None = None,
    unproved: bool = False,
    on_progress: Callable[[float], None] | None = None,
) -> ControllerEntry:
    """The controller that follows from a policy file.

    The check takes some seconds for a policy that was not checked before in this process.

    Args:
        path: the file.
        called: how messages name the argument.
        folder: where a relative path is looked up; None: the working directory.
        unproved: skip the check.
        on_progress: called now and then with the completed fraction of the check.

    Raises:
        PolicyNotProved: the check found a run that breaks a property.
        PalmbotsError: the file cannot be read or is no policy, or no algorithm follows from it.
    """
    place = user_path(path, folder or "")
    refuse_pipe(place, called)
    table = read_policy(place)
    machines = machines_of(table, called=f"{called}: {path}")
    data = tuple(machine.for_core() for machine in machines)
    if not unproved:
        found = verified(machines, table.rest, on_progress)
        if not found.holds:
            name = found.fails[0]
            command = command_text("derive", policy=shlex.quote(str(path)))
            raise PolicyNotProved(
                f"{called}: {path}: the derived algorithm fails {name} ({MEANINGS[name]}); "
                "allowed: a policy that passes, or --unproved "
                f"({command} prints all runs)",
                found,
            )
    states = [state for machine in machines for state in machine.states]
    asks = any(state.name.endswith("_ask") for state in states)
    return ControllerEntry(
        Path(path).name,
        table.description or f"derived from the policy {Path(path).name}",
        board_number=POLICY_BOARD_NUMBER,
        uses_radio=asks,
        messages=("TiltUp", "TiltDown", "Ack") if asks else (),
        drives_by_both_signs=any(s.case == "c" and s.move != "hold" for s in states),
        cases={
            letter: text for letter, text in _CASES.items() if letter in {s.case for s in states}
        },
        assisted_cases=tuple(sorted({s.case for s in states if s.name.endswith("_ask")})),
        machines=data,
        is_unproved=unproved,
        source=ControllerSource(path, hashlib.sha256(place.read_bytes()).hexdigest()),
    )


def load_station_policy(
    name: str,
    *,
    called: str = "controller",
    folder: str | None = None,
    unproved: bool = False,
) -> ControllerEntry:
    """The controller in which a station runs the rows of a policy file, as it runs Table 1.

    Args:
        name: the file with the suffix ``@station``.
        called: how messages name the argument.
        folder: where a relative path is looked up; None: the working directory.
        unproved: without effect: nothing is derived, so there is nothing to check.

    Raises:
        PalmbotsError: the file cannot be read or is no policy.
    """
    path = name.removesuffix("@station")
    place = user_path(path, folder or "")
    refuse_pipe(place, called)
    table = read_policy(place)
    rows = tuple((row.palms, row.drives) for row in table.rows.values())
    numbered = enumerate(table.rows, start=1)
    return ControllerEntry(
        Path(path).name + "@station",
        table.description or f"a station that runs the policy {Path(path).name}",
        team="station",
        messages=("report", "command"),
        cases={str(k): signs_text(signs) for k, signs in numbered if signs != (0, 0)},
        station_rows=rows,
        source=ControllerSource(name, hashlib.sha256(place.read_bytes()).hexdigest()),
    )
