# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots station`."""

import os
import select
import sys
import time
from typing import Annotated

import typer

from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, FAILED, JsonOption

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 207
EXAMPLE = "palmbots station pair.toml"


def station(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    auto: Annotated[
        bool, typer.Option("--auto", help="Arm, start, wait until both robots are done, and end.")
    ] = False,
    lockstep: Annotated[
        bool,
        typer.Option("--lockstep", help="Decide for both robots, tick by tick with the world."),
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Operate two robots: arm, start, stop, release.

    Type arm, start, stop, e-stop, release, disarm or quit. The station is no safety device.

    Exit status 1: with --auto, if the robots did not carry to the end.
    """
    import contextlib

    from palmbots.runtime.live_ends import open_pair_link
    from palmbots.runtime.pair_file import load_pair
    from palmbots.runtime.station import PERIOD_S, Station, carry_once
    from palmbots.runtime.stored_state import held

    chosen = load_pair(pair)
    if lockstep:
        from palmbots.runtime.lockstep_station import run_lockstep_station

        run_lockstep_station(chosen)
        return DONE
    lines: list[str] = []

    def show(line: str) -> None:
        lines.append(line)
        if not as_json:
            print(line, flush=True)

    with (
        held(chosen.state_file("station")),
        contextlib.closing(open_pair_link(chosen, "station")) as link,
    ):
        orders = _Orders(sys.stdin.fileno())
        end = Station(chosen, link, show)
        script = carry_once(end, chosen.settings.limits.time_limit_s) if auto else None
        done = None
        while done is None:
            end.step()
            if script is not None:
                done = next(script)
            elif not _obey(end, orders.next()):
                done = True
            time.sleep(PERIOD_S)
    if as_json:
        modes = {side: status.mode for side, status in end.status.items()}
        print_json({"done": done, "modes": modes, "lines": lines, "links": end.links()})
    return DONE if done else FAILED


class _Orders:
    """What the operator types. Reading it never waits, neither for a line nor for its end."""

    def __init__(self, source: int) -> None:
        self._source, self._text, self._has_ended = source, b"", False

    def next(self) -> str | None:
        """The next line that is complete, "" if there is none, or None at the end."""
        while not self._has_ended and select.select([self._source], [], [], 0)[0]:
            typed = os.read(self._source, 4096)
            self._has_ended = not typed
            self._text += typed
        line, end, rest = self._text.partition(b"\n")
        if not end and not (self._has_ended and line):
            return None if self._has_ended else ""
        self._text = rest
        return line.decode(errors="replace").strip()


def _obey(end: object, line: str | None) -> bool:
    """Do what the operator has typed; false: the station is to end."""
    from typing import Any, get_args

    from palmbots._util.arguments import show
    from palmbots.cli._streams import say
    from palmbots.wire import Operation

    word = "quit" if line is None else "-".join(line.lower().replace("_", " ").split())
    if word == "quit":
        return False
    operations = {name.replace("_", "-"): name for name in get_args(Operation)}
    operation = operations.get("e-stop" if word == "estop" else word)
    station: Any = end
    if operation is not None:
        station.wish(operation)
    elif word:
        say(f"palmbots: order: value is {show(line)}; allowed: {', '.join(operations)}, quit")
    return True


COMMAND = station
