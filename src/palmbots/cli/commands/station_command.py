# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots station`."""

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

    from palmbots.node.links import UdpLink
    from palmbots.node.pair_file import load_pair
    from palmbots.node.station import PERIOD_S, Station, carry_once

    chosen = load_pair(pair)
    if lockstep:
        from palmbots.node.lockstep_station import run_lockstep_station

        run_lockstep_station(chosen)
        return DONE
    lines: list[str] = []

    def show(line: str) -> None:
        lines.append(line)
        if not as_json:
            print(line, flush=True)

    with contextlib.closing(UdpLink("station", chosen.settings.link.addresses())) as link:
        end = Station(chosen, link, show)
        script = carry_once(end, chosen.settings.limits.time_limit_s) if auto else None
        done = None
        while done is None:
            end.step()
            if script is not None:
                done = next(script)
            elif not _obey_line(end):
                done = True
            time.sleep(PERIOD_S)
    if as_json:
        modes = {side: status.mode for side, status in end.status.items()}
        print_json({"done": done, "modes": modes, "lines": lines})
    return DONE if done else FAILED


def _obey_line(end: object) -> bool:
    """Do what the operator has typed; false: the station is to end."""
    from typing import Any, get_args

    from palmbots.cli._streams import say
    from palmbots.wire import Operation

    ready, _, _ = select.select([sys.stdin], [], [], 0)
    if not ready:
        return True
    line = sys.stdin.readline()
    word = line.strip().replace("-", "_").replace("estop", "e_stop")
    if not line or word == "quit":
        return False
    operations = get_args(Operation)
    station: Any = end
    if word in operations:
        station.wish(word)
    elif word:
        say(f"palmbots: {line.strip()}: is unknown; allowed: {', '.join(operations)}, quit")
    return True


COMMAND = station
