# SPDX-License-Identifier: Apache-2.0
"""A screen's side of the station: what the station publishes, and the operator's wishes."""

import contextlib
import time
from typing import Any, Literal, Self

from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import Connection, ConnectionLost, connect
from palmbots.wire import Operation

_ANSWER_S = 10.0
_ALIVE_S = 0.25
_TRY_S = 0.2
ScreenRole = Literal["operator", "viewer"]


class StationClient:
    """A connection to a running station. Nothing waits, except the start.

    Args:
        address: of the station (`palmbots.station.station_server.station_address`).
        role: an operator may say what is to happen, a viewer may not.
        within_s: how long to wait for a station that is still starting.
        process: the number of the station's process; None: any.

    Raises:
        ConnectionLost: there is no station, or only another one.
    """

    def __init__(
        self, address: str, role: ScreenRole, within_s: float, process: int | None = None
    ) -> None:
        self._address, self.role, self._process = address, role, process
        self.state: dict[str, Any] | None = None
        """The newest state (`Station.frame`); None: nothing has arrived yet."""
        self.lines: list[str] = []
        """Everything that was said so far."""
        self.end: dict[str, Any] | None = None
        """How the station ended; None: it goes on."""
        self.facts: dict[str, Any] = {}
        """Pair, controller and scene of the station, and its process."""
        self.is_connected = False
        """The station is there."""
        self._alive_s = 0.0
        self._connection = self._connect(within_s)

    def _connect(self, within_s: float) -> Connection:
        connection = connect(self._address, "station", within_s)
        self.facts = connection.receive(_ANSWER_S)["station"]
        if self._process not in (None, self.facts["process"]):
            connection.close()
            raise ConnectionLost("station: another one listens there")
        connection.send({"screen": self.role})
        self.is_connected = True
        return connection

    def wait(self, seconds: float) -> None:
        """Wait for news at most this long."""
        import select

        select.select([self._connection], [], [], seconds)

    def poll(self) -> bool:
        """Take in what has arrived, and say that this screen is alive; returns whether anything
        has changed. If the station is gone, `is_connected` is false."""
        if not self.is_connected:
            return False
        is_news = False
        try:
            now = time.monotonic()
            if now - self._alive_s >= _ALIVE_S and self.end is None:
                self._alive_s = now
                with contextlib.suppress(ConnectionLost):  # its last words are read first
                    self._connection.offer({})
            while (frame := self._connection.poll()) is not None:
                is_news = True
                self._take(frame)
        except ConnectionLost:
            self.is_connected = False
            is_news = True
        return is_news

    def _take(self, frame: Any) -> None:
        match frame:
            case {"state": state}:
                self.state = state
            case {"line": [int(number), str(text)]}:
                if number == len(self.lines):
                    self.lines.append(text)
            case {"end": end}:
                self.end = end
            case _:
                raise PalmbotsError("station: sends frames that this version does not know")

    def wish(self, operation: Operation | Literal["quit"]) -> None:
        """State what is to happen; `quit` ends the station.

        Raises:
            ConnectionLost: the station is gone.
        """
        self._connection.send({"wish": operation})

    def reconnect(self) -> bool:
        """Connect to a station that has been started again; returns whether there is one."""
        try:
            self._connection.close()
            self._connection = self._connect(_TRY_S)
        except ConnectionLost:
            return False
        self.lines, self.end = [], None
        return True

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
