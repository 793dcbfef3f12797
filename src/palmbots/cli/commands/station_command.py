# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots station`."""

import sys
from functools import partial
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, FAILED, JsonOption, LogOption, NoLogOption
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.station.station_client import StationClient

_RESTARTS_WITHIN_S = 10.0
_LAST_LINES = 10


@command(
    order=207,
    example="palmbots station pair.toml",
    results=("palmbots.station.station_loop:StationEnd",),
)
def station(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    auto: Annotated[
        bool, typer.Option("--auto", help="Arm, start, wait until both robots are done, and end.")
    ] = False,
    attach: Annotated[
        bool, typer.Option("--attach", help="Only a screen, for a station that already runs.")
    ] = False,
    watch: Annotated[
        bool, typer.Option("--watch", help="As --attach, but only to look: no orders are taken.")
    ] = False,
    no_screen: Annotated[
        bool, typer.Option("--no-screen", help="Only the station; screens attach to it.")
    ] = False,
    plain: Annotated[
        bool,
        typer.Option("--plain", help="Lines, not a screen; the default if stdout is no terminal."),
    ] = False,
    for_screen: Annotated[bool, typer.Option("--for-screen", hidden=True)] = False,
    wait_s: Annotated[float, typer.Option("--wait-s", hidden=True)] = 1.0,
    lockstep: Annotated[
        bool,
        typer.Option("--lockstep", help="Decide for both robots, tick by tick with the world."),
    ] = False,
    log: LogOption = None,
    no_log: NoLogOption = False,
    as_json: JsonOption = False,
) -> int:
    """Operate two robots: arm, start, stop, release.

    With --plain, type arm, start, stop, e-stop, release, disarm or quit. On the screen, space or
    Escape is the e-stop. The station is no safety device.

    Exit status 1: with --auto, if the robots did not carry to the end.
    """
    from palmbots.pair.pair_file import load_pair, station_address

    if no_screen and (attach or watch):
        raise PalmbotsError("--no-screen starts a station; allowed: without --attach and --watch")
    from palmbots.station.station_loop import StationEnd

    chosen = load_pair(pair)
    if lockstep:
        from palmbots.station.lockstep_station import run_lockstep_station

        run_lockstep_station(chosen)
        return DONE
    if no_screen:
        from palmbots.station.station_loop import run_station_loop

        on_line = None if as_json else partial(print, flush=True)
        logged = chosen.with_logs(log, is_off=no_log)
        ended = run_station_loop(logged, auto=auto, for_screen=for_screen, on_line=on_line)
    else:
        from palmbots.cli.station_process import attached, started_station

        address = station_address(chosen)
        shown = {"plain": plain or as_json or not sys.stdout.isatty(), "as_json": as_json}
        if attach or watch:
            client = attached(address, "viewer" if watch else "operator", wait_s)
            end = _show(client, **shown, reads_orders=not watch, within_s=_RESTARTS_WITHIN_S)
        else:
            options = [pair, *(["--auto"] if auto else [])]
            options += [] if log is None else ["--log", str(log)]
            options += ["--no-log"] if no_log else []
            with started_station(options, address) as client:
                end = _show(client, **shown, reads_orders=not auto)
        ended = StationEnd(end["done"], end["modes"], client.lines, end.get("links", {}))
    if as_json:
        print_json(ended)
    return DONE if ended.done else FAILED


def _show(
    client: "StationClient",
    *,
    plain: bool,
    as_json: bool,
    reads_orders: bool,
    within_s: float = 0.0,
) -> dict[str, Any]:
    """Show a station until it ends; returns how it ended."""
    if plain:
        from palmbots.cli.plain_station import run_plain

        return run_plain(
            client, reads_orders=reads_orders, as_json=as_json, restarts_within_s=within_s
        )
    from palmbots.cli.station_screen import run_screen

    end = run_screen(client, restarts_within_s=within_s)
    for line in client.lines[-_LAST_LINES:]:  # the screen is gone, and its lines with it
        print(line)
    return end
