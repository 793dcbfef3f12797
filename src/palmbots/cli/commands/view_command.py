# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots view`."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE
from palmbots.cli._run import print_result
from palmbots.errors import PalmbotsError

_RESTARTS_WITHIN_S = 10.0


@command(
    order=135,
    example="palmbots view out/carry.mcap --serve 127.0.0.1:8765",
    results=("palmbots._util.results:Files",),
    sources=Option(is_argument=True, metavar="SOURCE..."),
    serve=Option(metavar="ADDRESS"),
    rate=Option(help="Play at this multiple of real time.", least=0.01, most=100.0),
    layout=Option(metavar="FILE"),
    rerun=Option(metavar="FILE"),
    wait_s=Option(is_hidden=True),
)
def view(
    sources: Sequence[Path],
    *,
    serve: str = "127.0.0.1:8765",
    rate: float = 1.0,
    once: bool = False,
    layout: Path | None = None,
    rerun: Path | None = None,
    wait_s: float = 1.0,
    as_json: bool = False,
) -> int:
    """Show a log, or a running station, in three dimensions.

    Foxglove connects to ws://HOST:PORT (Open connection, Foxglove WebSocket) and draws it. With a
    pair.toml it shows the station of this pair, live and read-only: no key is needed.

    Args:
        sources: MCAP logs, folders with them, or a pair.toml.
        serve: serve Foxglove at this HOST:PORT.
        once: end after the last message.
        layout: only write a layout for Foxglove to this file.
        rerun: only write a recording for Rerun to this file.
        wait_s: how long to wait for a station that starts at the same time.
    """
    from palmbots._util.results import Files
    from palmbots.views.foxglove_server import place_of

    place_of(serve)
    if layout is not None or rerun is not None:
        written = _write(sources, layout, rerun)
    elif sources[0].suffix == ".toml":
        written = []
        _serve_station(sources, serve, wait_s, quiet=as_json)
    else:
        written = []
        _play(sources, serve, rate, once=once, quiet=as_json)
    print_result(Files(tuple(written)), as_json=as_json)
    return DONE


def _write(sources: Sequence[Path], layout: Path | None, rerun: Path | None) -> list[Path]:
    from palmbots._util.atomic_files import write_whole
    from palmbots.views.log_player import viewable

    written: list[Path] = []
    if layout is not None:
        from palmbots.logs.foxglove_layout import layout_text

        write_whole(layout, layout_text())
        written.append(layout)
    if rerun is not None:
        from palmbots.logs.mcap_reader import read_log
        from palmbots.logs.rerun_recording import save_recording

        with tempfile.TemporaryDirectory(prefix="palmbots-") as folder:
            save_recording(read_log(viewable(sources, Path(folder))), rerun)
        written.append(rerun)
    return written


def _play(sources: Sequence[Path], serve: str, rate: float, *, once: bool, quiet: bool) -> None:
    from palmbots.views.foxglove_server import FoxgloveServer
    from palmbots.views.log_player import announce, play, read_playable, viewable

    with tempfile.TemporaryDirectory(prefix="palmbots-") as folder:
        log = read_playable(viewable(sources, Path(folder)))
        with FoxgloveServer(serve, f"palmbots {sources[0].name}") as server:
            announce(log, server)
            _print_address(server.address, quiet=quiet)
            play(log, server, rate=rate, loops=not once)


def _serve_station(sources: Sequence[Path], serve: str, wait_s: float, *, quiet: bool) -> None:
    from palmbots.cli.station_process import attached
    from palmbots.pair.pair_file import load_pair, station_address
    from palmbots.views.foxglove_server import FoxgloveServer
    from palmbots.views.live_view import LiveView

    if len(sources) > 1:
        raise PalmbotsError("SOURCE: more than one pair.toml; allowed: one")
    pair = load_pair(sources[0], with_key=False)
    client = attached(station_address(pair), "viewer", wait_s)
    with client, FoxgloveServer(serve, "palmbots station") as server:
        live = LiveView(pair, server)
        _print_address(server.address, quiet=quiet)
        live.run(client, _RESTARTS_WITHIN_S)


def _print_address(address: str, *, quiet: bool) -> None:
    if not quiet:
        print(f"serves ws://{address}; palmbots view ... --layout FILE writes a layout", flush=True)
