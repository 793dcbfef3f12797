# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots station`."""

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE, FAILED
from palmbots.cli._run import interruption_line, print_json
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.station.station_client import StationClient

_RESTARTS_WITHIN_S = 10.0
_LAST_LINES = 10


@command(
    order=207,
    example="palmbots station pair.toml",
    results=("palmbots.station.station_loop:StationEnd",),
    for_screen=Option(is_hidden=True),
    wait_s=Option(is_hidden=True),
    lockstep=Option(help="Decide for both robots, tick by tick with the world."),
)
def station(
    pair: str,
    auto: bool = False,
    attach: bool = False,
    watch: bool = False,
    no_screen: bool = False,
    plain: bool = False,
    for_screen: bool = False,
    wait_s: float = 1.0,
    lockstep: bool = False,
    log: Path | None = None,
    no_log: bool = False,
    as_json: bool = False,
) -> int:
    """Operate two robots: arm, start, stop, release.

    With --plain, type arm, start, stop, e-stop, release, disarm or quit. On the screen, space or
    Escape is the e-stop. The station is no safety device.

    Exit status 1: with --auto, if the robots did not carry to the end.

    Args:
        auto: arm, start, wait until both robots are done, and end.
        attach: show only a screen, for a station that already runs.
        watch: as --attach, but take no orders.
        no_screen: run only the station, to which screens can attach.
        for_screen: a screen has started it.
        wait_s: how long to wait for a station that starts at the same time.
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
        what = "" if watch else "; the station stops robots that may move"
        with interruption_line(f"palmbots: interrupted{what}"):
            if attach or watch:
                client = attached(address, "viewer" if watch else "operator", wait_s)
                end = _show(client, **shown, reads_orders=not watch, within_s=_RESTARTS_WITHIN_S)
            else:
                options = [pair, *(["--auto"] if auto else [])]
                options += [] if log is None else ["--log", str(log)]
                options += ["--no-log"] if no_log else []
                with started_station(options, address) as client:
                    end = _show(client, **shown, reads_orders=not auto)
        ended = StationEnd(end["done"], end["modes"], client.lines, end.get("links"))
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
