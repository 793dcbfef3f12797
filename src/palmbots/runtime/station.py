# SPDX-License-Identifier: Apache-2.0
"""The operator's station: receives the status of both robots, and sends what the operator wants.

A wish is repeated in every period until the status of the robot shows that it has been carried out.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from palmbots._types import SIDES, Side
from palmbots.links.link import Link
from palmbots.links.link_meter import LinkMeter
from palmbots.runtime.pair_file import Pair
from palmbots.runtime.reported_counts import ReportedCounts
from palmbots.runtime.stored_state import StoredState, read_state, write_state
from palmbots.wire import Endpoint, Hello, Operate, Operation, RobotMode, Status

PERIOD_S = 0.05
_LOST_AFTER_S = 1.0
_GONE_AFTER_S = 10.0
_SETTLE_STEPS = 10  # the robots hear each other meanwhile
_UNDER_WAY: tuple[RobotMode, ...] = ("ready", "carrying", "holding")
# The modes in which a wish has been carried out.
_REACHED: dict[Operation, tuple[RobotMode, ...]] = {
    "arm": ("armed", *_UNDER_WAY),
    "start": (*_UNDER_WAY, "done"),
    "stop": ("stopped",),
    "e_stop": ("stopped",),
    "release": ("off", "disarmed", "armed", *_UNDER_WAY, "done", "fault"),
    "disarm": ("disarmed",),
}


class Station:
    """The station's end of the wire, with what it knows of both robots.

    Args:
        pair: the pair.
        link: how packets travel.
        on_line: called with each line about what happens.
        clock: the time [s].
    """

    def __init__(
        self,
        pair: Pair,
        link: Link,
        on_line: Callable[[str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._pair, self._link, self._on_line, self.clock = pair, link, on_line, clock
        self._file = pair.state_file("station")
        self._boot(read_state(self._file))
        self._wish: Operation | None = None
        self._released: set[Side] = set()
        self._heard_s: dict[Side, float] = {}
        self._start_s = clock()
        self.status: dict[Side, Status] = {}
        """The newest status of each robot that has been heard."""
        self.reported: dict[Side, ReportedCounts] = {side: ReportedCounts() for side in SIDES}
        """What each robot has reported about its own end of the wire."""

    def _boot(self, before: StoredState) -> None:
        state = before.booted()
        write_state(self._file, state)
        self._epoch = state.epoch
        self._sent = dict.fromkeys(SIDES, 0)  # packets in this epoch
        self._wished_at = dict.fromkeys(SIDES, 0)
        number = self._pair.settings.pair.number
        self._end = Endpoint(self._pair.key, number, "station", state.epoch)

    def wish(self, operation: Operation) -> None:
        """Set the wish of the operator, for both robots."""
        self._wish = operation
        self._released = set()
        self._wished_at = {**self._sent}
        self._say(f"operator: {operation}")

    def modes(self) -> dict[Side, RobotMode]:
        """The modes of the robots that are heard."""
        now = self.clock()
        return {
            side: status.mode
            for side, status in self.status.items()
            if now - self._heard_s[side] < _LOST_AFTER_S
        }

    def links(self) -> dict[str, Any]:
        """What the link of the station has sent, received and lost, and what the robots report."""
        own = self._link.summary() if isinstance(self._link, LinkMeter) else {}
        reported = {side: counts.totals for side, counts in self.reported.items()}
        return {"station": own, "verdicts": dict(self._end.counts), "robots": reported}

    def is_done(self) -> bool:
        """Both robots have carried out the wish."""
        modes = self.modes()
        wanted = _REACHED[self._wish] if self._wish else ()
        return len(modes) == len(SIDES) and all(mode in wanted for mode in modes.values())

    def step(self) -> None:
        """Take in what has arrived, and send what is due; to be called every `PERIOD_S`."""
        before = self.modes()
        for data in self._link.receive():
            decoded = self._end.receive(data)
            packet = decoded.packet
            if packet is None or not isinstance(packet.body, Status) or packet.sender == "station":
                continue
            self._take(packet.sender, packet.body)
            self._note_release(packet.sender, packet.acknowledged, packet.body)
        for side in SIDES:
            if self._end.claimed_epoch(side) > self._epoch:
                self._say("another station has been in use: this one takes the next epoch")
                self._boot(replace(StoredState(), epoch=self._end.claimed_epoch(side)))
        for side in before.keys() - self.modes().keys():
            self._say(f"{side}: not heard for {_LOST_AFTER_S:g} s")
        for side in SIDES:
            self._link.send(side, self._end.send(side, self._due(side)))
            self._sent[side] += 1

    def _due(self, side: Side) -> Operate | Hello:
        wish = self._wish
        stops = wish in ("stop", "e_stop")
        if wish is None:
            return Hello()
        if wish == "release" and side in self._released:
            return Hello()
        if side in self.status and self.status[side].mode in _REACHED[wish]:
            return Hello(stop=stops)
        return Operate(wish, stop=stops)

    def _take(self, side: Side, status: Status) -> None:
        old = self.status.get(side)
        self.status[side] = status
        self.reported[side].note(status)
        self._heard_s[side] = self.clock()
        if old is None or (old.mode, old.fault) != (status.mode, status.fault):
            why = f" ({status.fault})" if status.fault != "none" else ""
            if old is None or {old.mode, status.mode} != {"carrying", "holding"}:
                self._say(f"{side}: {status.mode}{why}")
        if status.case != " " and (old is None or old.case != status.case):
            self._say(f"{side}: correction ({status.case})")

    def _note_release(self, side: Side, heard: tuple[int, int], status: Status) -> None:
        """A release ends the stop that was in force, and no later one: it is not repeated once
        the robot has heard it."""
        epoch, number = heard
        has_heard = epoch == self._epoch and number > self._wished_at[side]
        if self._wish == "release" and has_heard and status.mode != "stopped":
            self._released.add(side)

    def _say(self, text: str) -> None:
        self._on_line(f"{self.clock() - self._start_s:7.2f} s  {text}")


def carry_once(station: Station, within_s: float) -> Iterator[bool | None]:
    """Arm and start both robots, and wait until both are done.

    Yields None after every step of the station, and at last whether both robots are done. A robot
    that stops, has a fault or no longer carries stops both.
    """
    give_up = station.clock() + within_s
    settled_steps = 0
    while settled_steps < _SETTLE_STEPS and station.clock() < give_up:
        settled_steps = settled_steps + 1 if len(station.modes()) == len(SIDES) else 0
        yield None
    for operation in ("arm", "start"):
        station.wish(operation)
        while not station.is_done():
            if station.clock() > give_up:
                yield False
                return
            yield None
    heard_s = station.clock()
    while True:
        modes = station.modes()
        heard_s = station.clock() if modes else heard_s
        if station.clock() - heard_s > _GONE_AFTER_S:
            yield False
            return
        if len(modes) == len(SIDES) and set(modes.values()) == {"done"}:
            yield True
            return
        is_over = len(modes) == len(SIDES) and not set(_UNDER_WAY) & set(modes.values())
        if is_over or {"stopped", "fault"} & set(modes.values()):
            station.wish("stop")
            give_up = station.clock() + _GONE_AFTER_S
            while not station.is_done() and station.clock() < give_up:
                yield None
            yield False
            return
        yield None
