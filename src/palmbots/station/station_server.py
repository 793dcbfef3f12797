# SPDX-License-Identifier: Apache-2.0
"""The station's side of its screens: takes wishes from operators, and publishes what it knows.

Screens are other processes of the same user, connected by a socket in the pair's state folder.
Nothing here waits: a screen that does not read misses states, and gets the lines later.
"""

import contextlib
import os
import select
import socket
import stat
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, get_args

from palmbots.links.local_connection import Connection, ConnectionLost, listen
from palmbots.wire import Operation

SILENT_S = 3.0
"""An operator's screen that says nothing for so long counts as gone."""
_GREETING_S = 5.0
_MOST_SCREENS = 32
_LINES_AT_ONCE = 100
QUIT = "quit"


@dataclass
class _Screen:
    """One screen."""

    connection: Connection
    heard_s: float
    role: str = ""
    """``operator`` or ``viewer``; empty: it has not said so yet."""
    next_line: int = 0
    wishes: list[str] = field(default_factory=list)

    def take(self, frame: Any) -> None:
        """Take in a frame of the screen.

        Raises:
            ConnectionLost: it is not one that this screen may send.
        """
        if not isinstance(frame, dict):
            raise ConnectionLost("a screen: sends no frames of a screen")
        role, wish = frame.get("screen"), frame.get("wish")
        if not self.role and role in ("operator", "viewer"):
            self.role = role
            return
        if wish is None and self.role:
            return  # it is alive
        if self.role != "operator" or wish not in (*get_args(Operation), QUIT):
            raise ConnectionLost("a screen: sends what only an operator may")
        self.wishes.append(str(wish))


class StationServer:
    """All screens of a station.

    Args:
        address: where screens connect; a socket in the file system belongs to its user alone.
        facts: the first frame to each screen.
        clock: the time [s].

    Raises:
        PalmbotsError: another program listens there.
    """

    def __init__(
        self, address: str, facts: dict[str, Any], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._door: socket.socket = listen(address)
        if address.startswith("unix:"):
            with contextlib.suppress(OSError):
                os.chmod(address.removeprefix("unix:"), stat.S_IRUSR | stat.S_IWUSR)
        self._door.settimeout(0)
        self._facts, self._clock = facts, clock
        self._screens: list[_Screen] = []
        self.lines: list[str] = []
        """Everything that was said, for screens that come later or are slow."""
        self.had_operator = False
        """An operator's screen has been connected."""

    @property
    def has_operator(self) -> bool:
        """An operator's screen is connected, and alive."""
        now = self._clock()
        return any(s.role == "operator" and now - s.heard_s < SILENT_S for s in self._screens)

    def wishes(self) -> list[str]:
        """What operators have wished since the last call, `QUIT` included; never waits."""
        self._admit()
        wishes: list[str] = []
        for screen in [*self._screens]:
            try:
                while (frame := screen.connection.poll()) is not None:
                    screen.heard_s = self._clock()
                    screen.take(frame)
                    self.had_operator = self.had_operator or screen.role == "operator"
                if not screen.role and self._clock() - screen.heard_s > _GREETING_S:
                    raise ConnectionLost("a screen: does not say what it is")
            except ConnectionLost:
                self._drop(screen)
            wishes += screen.wishes
            screen.wishes = []
        return wishes

    def wait(self, seconds: float) -> None:
        """Return after this time, or as soon as a screen has something to say."""
        with contextlib.suppress(OSError, ValueError):  # a screen that closes just now
            ends = [self._door, *(screen.connection for screen in self._screens)]
            select.select(ends, [], [], max(0.0, seconds))

    def publish(self, state: dict[str, Any]) -> None:
        """Offer the state, and the lines that are new, to every screen; never waits."""
        for screen in [*self._screens]:
            if screen.role:
                try:
                    self._offer_lines(screen)
                    screen.connection.offer({"state": state})
                except ConnectionLost:
                    self._drop(screen)

    def close(self, end: dict[str, Any], within_s: float = 1.0) -> None:
        """Send every screen how it ended, and close. A screen that does not read is left."""
        give_up = self._clock() + within_s
        waiting = [screen for screen in self._screens if screen.role]
        while waiting and self._clock() < give_up:
            for screen in [*waiting]:
                try:
                    has_all = self._offer_lines(screen) and screen.connection.offer({"end": end})
                    if has_all:
                        screen.connection.drain(max(0.0, give_up - self._clock()))
                except ConnectionLost:
                    has_all = True
                if has_all:
                    waiting.remove(screen)
            if waiting:
                time.sleep(0.01)
        for screen in self._screens:
            screen.connection.close()
        self._door.close()

    def _admit(self) -> None:
        with contextlib.suppress(BlockingIOError, ConnectionAbortedError):
            stream, _ = self._door.accept()
            screen = _Screen(Connection(stream, "a screen"), self._clock())
            if len(self._screens) >= _MOST_SCREENS:
                screen.connection.close()
                return
            with contextlib.suppress(ConnectionLost):
                screen.connection.offer({"station": self._facts})
                self._screens.append(screen)

    def _offer_lines(self, screen: _Screen) -> bool:
        """Offer the lines that the screen has not got; returns whether it has all now."""
        for _ in range(_LINES_AT_ONCE):
            if screen.next_line == len(self.lines):
                return True
            number = screen.next_line
            if not screen.connection.offer({"line": [number, self.lines[number]]}):
                return False
            screen.next_line += 1
        return False

    def _drop(self, screen: _Screen) -> None:
        screen.connection.close()
        self._screens.remove(screen)
