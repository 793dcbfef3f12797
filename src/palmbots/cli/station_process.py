# SPDX-License-Identifier: Apache-2.0
"""The station's loop as a process of its own, started and ended by a screen."""

import contextlib
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence

from palmbots.cli._streams import say
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import ConnectionLost
from palmbots.station.station_client import ScreenRole, StationClient

_STARTS_WITHIN_S = 30.0
_ENDS_WITHIN_S = 10.0
_POLL_S = 0.05


@contextlib.contextmanager
def started_station(options: Sequence[str], address: str) -> Iterator[StationClient]:
    """Start the loop with these options of ``palmbots station``, and attach to it as an operator.

    Raises:
        PalmbotsError: the loop cannot start, or has ended with a fault.
    """
    program = [sys.executable, "-P", "-m", "palmbots", "station"]  # nothing from this folder
    command = [*program, *options, "--no-screen", "--for-screen"]
    with tempfile.TemporaryFile() as errors:
        # In a session of its own: Ctrl-C reaches the screen, which informs the loop.
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,
        )
        try:
            client = _attached(process, address)
            if client is not None:
                with contextlib.closing(client):  # without an operator's screen the loop ends
                    yield client
        finally:
            _wait_for(process)
        if process.returncode < 0:
            raise PalmbotsError(
                f"station: its loop was killed (signal {-process.returncode}); the robots stop "
                "on their own if station_lost is stop"
            )
        if process.returncode > 1:
            errors.seek(0)
            *others, line = errors.read().decode(errors="replace").splitlines() or ["no reason"]
            for other in others:
                say(other)
            raise PalmbotsError(line.removeprefix("palmbots: "))


def attached(address: str, role: ScreenRole, within_s: float) -> StationClient:
    """Attach to a station that already runs.

    Raises:
        PalmbotsError: there is none.
    """
    try:
        return StationClient(address, role, within_s)
    except ConnectionLost:
        raise PalmbotsError(
            "station: none of this pair runs on this machine; start it with palmbots station PAIR"
        ) from None


def _attached(process: "subprocess.Popen[bytes]", address: str) -> StationClient | None:
    """A connection to the loop; None: it has ended before."""
    give_up = time.monotonic() + _STARTS_WITHIN_S
    while process.poll() is None:
        with contextlib.suppress(ConnectionLost):
            return StationClient(address, "operator", _POLL_S, process.pid)
        time.sleep(_POLL_S)
        if time.monotonic() > give_up:
            raise PalmbotsError(f"station: its loop does not start within {_STARTS_WITHIN_S:g} s")
    return None


def _wait_for(process: "subprocess.Popen[bytes]") -> None:
    try:
        process.wait(_ENDS_WITHIN_S)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
