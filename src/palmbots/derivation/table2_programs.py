# SPDX-License-Identifier: Apache-2.0
"""Table 2 of the paper as programs, one for each case, from the table that the controller runs.

A program is what a robot does in turn, in the words of Table 2's columns. The compiled table is a
state machine; every way through it from idle to idle is a program.
"""

from dataclasses import dataclass

import palmbots._core as _core

# The paper's messages: what every request for the partner's palm needs (section 4).
_KIND = _core.MessageKind
REQUEST, DONE, RELEASE = _KIND.TiltUp.name, _KIND.Ack.name, _KIND.TiltDown.name

_NAMES = {"tilt_up": REQUEST, "ack": DONE, "tilt_down": RELEASE}
_CONTACT = {
    "positive": "p > 0",
    "not_positive": "p ≤ 0",
    "negative": "p < 0",
    "not_negative": "p ≥ 0",
}


@dataclass(frozen=True)
class Program:
    """When an idle robot starts the program, and its actions."""

    when: str
    lines: tuple[str, ...]


def table_2() -> dict[str, Program]:
    """The cases (a) to (d) of Table 2 as the distributed controller runs it."""
    doing, rows = _core.table2()
    does = {state: (case, palm, move) for state, case, palm, move, _ in doing}
    programs: dict[str, Program] = {}

    def follow(state: str, case: str, lines: tuple[str, ...]) -> None:
        """Every continuation from a state, with the lines so far."""
        _, palm, move = does[state]
        for here, contact, got, _, after, send in rows:
            if here != state:
                continue
            begun = lines
            if state == "idle":
                fits = [_CONTACT[contact]]
                if got != "any":
                    fits.append(f"got {_NAMES[got]}")
                when = ", ".join(fits)
            else:
                if move != "hold":
                    begun += (f"Move {move} until {_CONTACT[contact]}",)
                if got != "any":
                    begun += (f"Wait for {_NAMES[got]}",)
                when = starts[0]
            if send:
                begun += (f"Send {send}",)
            if does[after][1] != palm:
                begun += ("Tilt Up" if does[after][1] == "shallow" else "Tilt Down",)
            if after == "idle":
                programs[case] = Program(when, begun)
            else:
                starts.insert(0, when)
                follow(after, does[after][0], begun)
                starts.pop(0)

    starts: list[str] = []
    follow("idle", " ", ())
    return programs
