# SPDX-License-Identifier: Apache-2.0
"""Text of `palmbots calibrate`: the dialogue with the person, and what was found."""

import select
import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots.cli.console import plain_table, report_console
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.pair.calibration_run import CalibrationRun

_POLL_S = 0.01


class TerminalPerson:
    """The person at the terminal. Instructions go to stderr; stdout has only the result."""

    def show(self, text: str) -> None:
        """Print a line."""
        print(text, file=sys.stderr, flush=True)

    def ready(self, text: str) -> None:
        """Print what is to be done, and wait for the Enter key."""
        self._line(f"\n{text}\nPress Enter when that is done: ")

    def number(self, text: str, unit: str, least: float, most: float) -> float:
        """Ask for a number until one within the limits is typed."""
        while True:
            typed = self._line(f"{text}\n[{unit}] ").replace(",", ".").strip()
            try:
                value = float(typed)
            except ValueError:
                self.show(f"{typed!r} is not a number.")
                continue
            if least <= value <= most:
                return value
            self.show(f"{value:g} {unit} cannot be; allowed: from {least:g} to {most:g}.")

    def watch(self, text: str, changed: Callable[[], bool]) -> bool:
        """Wait until something has changed, or the Enter key says that there is no more to come."""
        self.show(f"{text} Press Enter at the end of the palm.")
        while not changed():
            if select.select([sys.stdin], [], [], _POLL_S)[0]:
                self._line("")
                return False
        self.show("\aStop: a switch has changed.")
        return True

    def _line(self, prompt: str) -> str:
        print(prompt, end="", file=sys.stderr, flush=True)
        line = sys.stdin.readline()
        if not line:
            raise PalmbotsError("calibrate: the terminal was closed before the last answer")
        return line


def summary(run: "CalibrationRun") -> dict[str, Any]:
    """The findings as a table for ``--json``."""
    from palmbots.pair.calibration import values_of

    intervals = {
        one.key: [one.estimate.low, one.estimate.high]
        for one in run.findings
        if one.estimate is not None
    }
    return {"hardware": values_of(run.findings), "intervals": intervals, "warnings": run.warnings}


def calibrate_report(run: "CalibrationRun", side: str, file: Path) -> None:
    """Print each value with its interval, and where it was written."""
    console = report_console()
    table = plain_table("key", "value", "from", "to", right=("value", "from", "to"))
    for one in run.findings:
        if one.estimate is None:
            continue
        value = one.estimate.value if one.value is None else one.value
        row = (value, one.estimate.low, one.estimate.high)
        table.add_row(f"hardware.{side}.{one.key}", *(f"{v:.5g}" for v in row))
    console.print(table)
    console.print(f"Written to {file}; as it was before: {run.backup}")
