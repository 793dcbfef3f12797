# SPDX-License-Identifier: Apache-2.0
"""Table 2 of the paper as programs, one for each case, from the table that the controller runs.

A program is what a robot does in turn, in the words of Table 2's columns. The compiled table is a
state machine; every way through it from idle to idle is a program.
"""

from dataclasses import dataclass

import palmbots._core as _core
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

# The paper's messages: what every request for the partner's palm needs (section 4).
_KIND = _core.MessageKind
REQUEST, DONE, RELEASE = _KIND.TiltUp.name, _KIND.Ack.name, _KIND.TiltDown.name

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
    table = _core.transition_table("distributed", to_spec(Scene()))
    assert table is not None
    does = {state["name"]: state for state in table["states"]}
    # A row that leads back to its state drops a message, of which the paper's table says nothing.
    rows = [row for row in table["rows"] if row["states"] != [row["next"]]]
    programs: dict[str, Program] = {}

    def follow(state: str, case: str, lines: tuple[str, ...]) -> None:
        """Every continuation from a state, with the lines so far."""
        palm, move = does[state]["palm"], does[state]["move"]
        for row in rows:
            if row["states"] != [state]:
                continue
            begun = lines
            contact, after = row["contact"], row["next"]
            # A row that fits without a message, too, waits for none.
            got = "" if row["heard"] is None or "" in row["heard"] else row["heard"][0]
            if state == "idle":
                fits = [_CONTACT[contact]]
                if got:
                    fits.append(f"got {got}")
                when = ", ".join(fits)
            else:
                if move != "hold":
                    begun += (f"Move {move} until {_CONTACT[contact]}",)
                if got:
                    begun += (f"Wait for {got}",)
                when = starts[0]
            if row["send"]:
                begun += (f"Send {row['send']}",)
            if does[after]["palm"] != palm:
                begun += ("Tilt Up" if does[after]["palm"] == "shallow" else "Tilt Down",)
            if after == "idle":
                programs[case] = Program(when, begun)
            else:
                starts.insert(0, when)
                follow(after, does[after]["case"], begun)
                starts.pop(0)

    starts: list[str] = []
    follow("idle", " ", ())
    return programs
