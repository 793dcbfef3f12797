# SPDX-License-Identifier: Apache-2.0
"""The station as a process without a screen: the loop that talks to the robots.

Screens attach to it (`palmbots.station.station_server`), and no screen can hold it up. When the
last operator's screen is gone, nobody could stop the robots any more, so the loop stops them.
"""

import contextlib
import math
import os
import socket
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, cast

from palmbots._types import SIDES, BySide
from palmbots._util.end_signal import ended_by_signal
from palmbots._util.plain_values import plain
from palmbots.clocks.control_clock import control_clock
from palmbots.errors import PalmbotsError
from palmbots.pair.live_ends import open_pair_link
from palmbots.pair.pair_file import Pair, station_address
from palmbots.pair.stored_state import CounterInUse, held
from palmbots.station.carry_script import carry_once
from palmbots.station.station import (
    PERIOD_S,
    UNDER_WAY,
    OtherStation,
    Station,
    StationLinks,
)
from palmbots.station.station_log import StationLog
from palmbots.station.station_server import QUIT, SILENT_S, StationServer
from palmbots.wire import Operation, RobotMode

_STOP_WITHIN_S = 3.0
_MAY_MOVE: tuple[RobotMode, ...] = ("armed", *UNDER_WAY)


@dataclass(frozen=True)
class StationEnd:
    """How the station's program ended."""

    done: bool
    """With a script: both robots carried to the end. Otherwise an operator has ended it."""
    modes: BySide[str | None]
    """The newest modes of the robots; None: the robot was not heard."""
    lines: list[str]
    """Everything that was said."""
    links: StationLinks | None
    """What was sent, received and lost; None: this screen has ended before the station."""


def run_station_loop(
    pair: Pair,
    *,
    auto: bool,
    for_screen: bool = False,
    on_line: Callable[[str], None] | None = None,
) -> StationEnd:
    """Run the station until its script is over, an operator ends it, or it gets SIGTERM or SIGINT.

    Args:
        pair: the pair.
        auto: arm, start, wait until both robots are done, and end.
        for_screen: end when no operator's screen is left.
        on_line: called with each line about what happens; screens get it in any case.

    Raises:
        PalmbotsError: another station operates the pair, or a file or address cannot be used.
    """
    file = pair.state_file("station")
    facts = {
        "pair": pair.settings.pair.number,
        "controller": pair.settings.pair.controller,
        "scene": pair.settings.pair.scene,
        "auto": auto,
        "process": os.getpid(),
        "host": socket.gethostname(),
    }
    scene = pair.checked_scene()
    with contextlib.ExitStack() as stack:
        stack.enter_context(_only_station(file))
        link = stack.enter_context(contextlib.closing(open_pair_link(pair, "station")))
        server = StationServer(station_address(pair), facts)
        end: dict[str, Any] = {"error": "the station has failed"}
        stack.callback(lambda: server.close(end))
        # The robots stop first, however many signals arrive.
        ended = stack.enter_context(ended_by_signal(second_ends=False))
        clock = control_clock("station", PERIOD_S)
        station = Station(pair, clock.link(link), _to_all(server.lines.append, on_line))
        stack.callback(station.close)
        log = StationLog(pair, station.epoch, scene, server.lines.append)
        stack.callback(log.close)
        station.on_note(log)
        loop = _Loop(station, server, pair, auto=auto, for_screen=for_screen)
        wait = clock.wait if clock.is_stepped else loop.wait
        try:
            while loop.done is None:
                wait()
                if ended.is_set():
                    loop.quit("signal")
                loop.step()
        except PalmbotsError as error:
            end = {"error": str(error)}
            raise
        status = station.status
        modes = BySide.of(status[side].mode if side in status else None for side in SIDES)
        result = StationEnd(loop.done, modes, server.lines, station.links())
        end = {key: value for key, value in plain(result).items() if key != "lines"}
    return result


class _Loop:
    """One step after the other, until `done` says how it ended."""

    def __init__(
        self, station: Station, server: StationServer, pair: Pair, *, auto: bool, for_screen: bool
    ) -> None:
        self._station, self._server, self._for_screen = station, server, for_screen
        within_s = pair.settings.limits.time_limit_s
        self._script = carry_once(station, within_s) if auto else None
        self._has_script = auto
        self._quits_at_s: float | None = None
        self._is_alone = False
        self._wishes: list[str] = []
        self._next_s = -math.inf
        self.done: bool | None = None
        """Whether it ended as wanted; None: it goes on."""

    def step(self) -> None:
        """One period of the station."""
        for wish in self._wishes + self._server.wishes():
            self._obey(wish)
        self._wishes = []
        if self._server.had_operator and not self._server.has_operator:
            self._stand_alone()
        else:
            self._is_alone = False
        self._station.step()
        self._server.publish(self._station.frame())
        if self._script is not None:
            self.done = next(self._script)
        if self._quits_at_s is not None and self.done is None:
            is_over = self._station.is_done() or not self._may_move()
            if is_over or self._station.clock() > self._quits_at_s:
                self.done = not self._has_script

    def wait(self) -> None:
        """Wait for the next period; a wish that arrives meanwhile begins it at once."""
        while not self._wishes and (left_s := self._next_s - time.monotonic()) > 0:
            self._server.wait(left_s)
            self._wishes += self._server.wishes()
        self._next_s = time.monotonic() + PERIOD_S

    def quit(self, by: str = "operator") -> None:
        """End the program; robots that may move are stopped before."""
        if self._quits_at_s is not None:
            return
        self._quits_at_s = self._station.clock() + _STOP_WITHIN_S
        self._drop_script()
        if self._may_move():
            self._station.wish("stop", by)

    def _obey(self, wish: str) -> None:
        if wish == QUIT:
            self.quit()
            return
        if self._script is not None:
            # An operator who does anything has taken over. The script must not contradict.
            self._drop_script()
            self._quits_at_s = self._station.clock() + _STOP_WITHIN_S
        self._station.wish(cast(Operation, wish))

    def _stand_alone(self) -> None:
        """No operator's screen is left."""
        if not self._is_alone:
            self._is_alone = True
            if self._may_move():
                self._drop_script()
                text = f"no operator's screen is left, or it was silent for {SILENT_S:g} s"
                self._station.wish("stop", text)
        if self._for_screen or self._has_script:
            self.quit("station")

    def _may_move(self) -> bool:
        """Whether a robot may move, as far as is known."""
        statuses = self._station.status.values()
        return any(status.mode in _MAY_MOVE for status in statuses)

    def _drop_script(self) -> None:
        if self._script is not None:
            self._script = None
            self._station.keep_carrying(False)


def _to_all(
    first: Callable[[str], None], second: Callable[[str], None] | None
) -> Callable[[str], None]:
    def take(line: str) -> None:
        first(line)
        if second is not None:
            second(line)

    return take


@contextlib.contextmanager
def _only_station(file: Any) -> Iterator[None]:
    """Hold the counter of the station's boots, so that there is no second station here.

    Raises:
        OtherStation: another process of this machine is the station of this pair.
        PalmbotsError: the counter cannot be used.
    """
    with contextlib.ExitStack() as stack:
        try:
            stack.enter_context(held(file))
        except CounterInUse as error:
            raise OtherStation(
                f"station: process {error.process} on this machine is the station of this pair; "
                "allowed: one at a time; palmbots station PAIR --attach opens a screen for it"
            ) from None
        yield
