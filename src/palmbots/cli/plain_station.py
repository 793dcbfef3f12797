# SPDX-License-Identifier: Apache-2.0
"""The station without a screen: plain lines, or one JSON object per line."""

import json
import os
import re
import select
import sys
import time
from typing import Any, Literal, cast, get_args

from palmbots._util.arguments import show
from palmbots.cli._streams import say, wrapped
from palmbots.cli.station_text import plain_status
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import ConnectionLost
from palmbots.station.station_client import StationClient
from palmbots.wire import Operation

_POLL_S = 0.1
_STATUS_S = 2.0
_TIMED = re.compile(r" *[\d.]+ s  ")
_TIME_COLUMNS = 11  # of the time, which begins most lines
_MOVING = ("ready", "carrying", "holding")


def run_plain(
    client: StationClient, *, reads_orders: bool, as_json: bool, restarts_within_s: float = 0.0
) -> dict[str, Any]:
    """Print what happens until the station ends; obey what is typed.

    Args:
        client: attached to the station.
        reads_orders: read orders from stdin.
        as_json: print JSON objects, not lines for people.
        restarts_within_s: how long to wait for a station that was killed and starts again.

    Returns:
        How the station ended.

    Raises:
        PalmbotsError: the station is gone.
    """
    orders = Orders(sys.stdin.fileno()) if reads_orders else None
    printed, shown_s, before = 0, 0.0, ""
    while True:
        is_news = client.poll()
        for line in client.lines[printed:]:
            _print({"line": line} if as_json else line)
        printed = len(client.lines)
        if client.end is not None:
            return ended(client.end)
        if not client.is_connected:
            _wait_for_restart(client, restarts_within_s)
            printed = 0
            continue
        if client.state is not None and time.monotonic() - shown_s >= _STATUS_S:
            key = _key(client.state)
            if key != before or _is_moving(client.state):
                shown_s, before = time.monotonic(), key
                for text in [client.state] if as_json else plain_status(client.state):
                    _print({"state": text} if as_json else text)
        if orders is not None and not _obey(client, orders.next()):
            orders = None
        if not is_news:
            client.wait(_POLL_S)


def ended(end: dict[str, Any]) -> dict[str, Any]:
    """How the station ended, if it has not failed.

    Raises:
        PalmbotsError: it has.
    """
    if "error" in end:
        raise PalmbotsError(end["error"])
    return end


def _wait_for_restart(client: StationClient, within_s: float) -> None:
    give_up = time.monotonic() + within_s
    while time.monotonic() < give_up:
        if client.reconnect():
            return
    raise PalmbotsError("station: its process is gone")


def _print(what: dict[str, Any] | str) -> None:
    if isinstance(what, str):
        print(wrapped(what, sys.stdout, _TIME_COLUMNS if _TIMED.match(what) else 2), flush=True)
    else:
        print(json.dumps(what, allow_nan=False), flush=True)


def _key(state: dict[str, Any]) -> str:
    """What has to change for a robot at rest to be reported again."""
    robots = state["robots"].values()
    seen = [r and (r["is_heard"], r["mode"], r["fault"], r["palm"], r["sign"]) for r in robots]
    return repr(seen)


def _is_moving(state: dict[str, Any]) -> bool:
    return any(r is not None and r["mode"] in _MOVING for r in state["robots"].values())


class Orders:
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


def _obey(client: StationClient, line: str | None) -> bool:
    """Pass on what the operator has typed; false: it was the end."""
    word = "quit" if line is None else "-".join(line.lower().replace("_", " ").split())
    operations = {name.replace("_", "-"): name for name in get_args(Operation)} | {"quit": "quit"}
    wish = operations.get("e-stop" if word == "estop" else word)
    if wish is not None:
        try:
            client.wish(cast(Operation | Literal["quit"], wish))
        except ConnectionLost:
            return False
    elif word:
        say(f"palmbots: order: value is {show(line)}; allowed: {', '.join(operations)}")
    return wish != "quit"
