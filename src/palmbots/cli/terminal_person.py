# SPDX-License-Identifier: Apache-2.0
"""The dialogue of `palmbots calibrate` with the person at the terminal."""

import select
import sys
from collections.abc import Callable

from palmbots.errors import PalmbotsError

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
