# SPDX-License-Identifier: Apache-2.0
"""The operator's station: receives the status of both robots, and sends what the operator wants.

A wish is repeated in every period until the status of each robot shows that it has been carried
out. Then it is fulfilled, and this robot does not get it again: one that has a fault afterwards is
not armed or started on its own. Only a stop stays in force.
"""

import contextlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

from palmbots._types import SIDES, BySide, Side
from palmbots._util import process_clock
from palmbots.errors import PalmbotsError
from palmbots.links.link import Link
from palmbots.links.packet_statistics import LinkCounts, PacketStatistics, ReportedCounts
from palmbots.pair.fault_words import fault_line
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState, read_state, write_state
from palmbots.station.correction_watch import CorrectionWatch, longest_correction_s
from palmbots.station.fault_watch import FaultWatch
from palmbots.station.robot_view import LOST_AFTER_S, RobotView
from palmbots.station.station_epochs import StationEpochs
from palmbots.wire import Endpoint, Hello, Operate, Operation, Packet, RobotMode, Status

PERIOD_S = 0.05
UNDER_WAY: tuple[RobotMode, ...] = ("ready", "carrying", "holding")
GONE_AFTER_S = 10.0
_WISH_LASTS_S = 5.0
_STOP_CONFIRMED_S = 1.0
_MODE_KNOWN_S = 0.3  # after this time, statuses show what an earlier order has done
_UNARMED: tuple[RobotMode, ...] = ("disarmed", "done", "fault")
_STOPS: tuple[Operation, ...] = ("stop", "e_stop")
# What is not done in time is not done later either, when nobody expects it any more.
_LAPSES: tuple[Operation, ...] = ("arm", "start", "release")
# The modes in which a wish has been carried out.
_REACHED: dict[Operation, tuple[RobotMode, ...]] = {
    "arm": ("armed", *UNDER_WAY),
    "start": (*UNDER_WAY, "done"),
    "stop": ("stopped",),
    "e_stop": ("stopped",),
    "release": ("off", "disarmed", "armed", *UNDER_WAY, "done", "fault"),
    "disarm": ("disarmed",),
}


class OtherStation(PalmbotsError):
    """Another station operates the pair."""


@dataclass(frozen=True)
class StationLinks:
    """What the three ends of the wire have sent and received, as the station knows it."""

    station: LinkCounts
    """What the station has exchanged with each robot."""
    verdicts: dict[str, int]
    """Packets that the station has received, by verdict."""
    robots: BySide[dict[str, int]]
    """What each robot has reported: packets sent, and packets received by verdict."""


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
        clock: Callable[[], float] = process_clock.monotonic,
    ) -> None:
        self._pair, self._link, self._on_line, self.clock = pair, link, on_line, clock
        self._number = pair.settings.pair.number
        self._file = pair.state_file("station")
        self._storing = ThreadPoolExecutor(max_workers=1)
        self._start_s = clock()
        self._wish: Operation | None = None
        self._order = ""  # the wish, and who wants it
        self._stopped_by = dict.fromkeys(SIDES, "")  # the order after which a robot was stopped
        self._wish_s = 0.0
        self._fulfilled: set[Side] = set()
        self._lapsed: set[Side] = set()
        self._notes: list[Callable[[str, Any], None]] = []
        self.statistics = PacketStatistics("station", clock)
        """Of the packets that it sends and receives."""
        order_age_s = pair.settings.limits.order_age_s
        self._wish_sent_s = _WISH_LASTS_S - order_age_s
        self.robots: dict[Side, RobotView] = {
            side: RobotView(self.statistics.ends[side], order_age_s=order_age_s) for side in SIDES
        }
        """What is known of each robot."""
        self.reported: dict[Side, ReportedCounts] = {side: ReportedCounts() for side in SIDES}
        """What each robot has reported about its own end of the wire."""
        scene = pair.checked_scene()
        self.sides = scene.working_sides
        """The robots that work."""
        self.corrections = CorrectionWatch(longest_correction_s(scene))
        self._faults = FaultWatch(PERIOD_S, self.statistics, self._start_s, sides=self.sides)
        self._lost: set[Side] = set()
        self._late: set[Side] = set()
        self._boot(read_state(self._file))
        self.was_carrying = self._state.carries
        """A carry was under way when this station's program ended without saying so."""

    def _boot(self, before: StoredState) -> None:
        self._state = before.booted()
        self._storing.submit(write_state, self._file, self._state).result()
        self.epoch = self._state.epoch
        self._wished_at = dict.fromkeys(SIDES, 0)
        self._end = Endpoint(self._pair.key, self._number, "station", self.epoch)
        self._epochs = StationEpochs(self.epoch)

    def keep_carrying(self, carries: bool) -> None:
        """Store whether a carry is under way, for a program that goes on after this one."""
        if self._state.carries != carries:
            self._state = replace(self._state, carries=carries)
            self._storing.submit(self._store, self._state)  # a slow disk must not delay a stop

    def _store(self, state: StoredState) -> None:
        with contextlib.suppress(PalmbotsError):  # the boot counter was written before
            write_state(self._file, state)

    def close(self) -> None:
        """Wait until everything is stored."""
        self._storing.shutdown()

    @property
    def status(self) -> dict[Side, Status]:
        """The newest status of each robot that has been heard."""
        return {side: v.status for side, v in self.robots.items() if v.status is not None}

    @property
    def wished(self) -> Operation | None:
        """What the operator wants."""
        return self._wish

    def time_s(self) -> float:
        """Time since the start of this station."""
        return self.clock() - self._start_s

    def wish(self, operation: Operation, by: str = "operator") -> None:
        """Set what is wanted of both robots, and who wants it."""
        self._wish, self._wish_s = operation, self.clock()
        self._fulfilled, self._lapsed = set(), set()
        self._wished_at = {side: self._end.newest(side)[1] for side in SIDES}
        self._order = f"{by}: {operation.replace('_', '-')}"
        self._say(self._order)
        self._note("wish", (operation, by))

    def modes(self) -> dict[Side, RobotMode]:
        """The modes of the robots that are heard."""
        now = self.clock()
        return {
            side: view.status.mode
            for side, view in self.robots.items()
            if view.status is not None and view.is_heard(now)
        }

    def links(self) -> StationLinks:
        """What the link of the station has sent, received and lost, and what the robots report."""
        own = self.statistics.counts(getattr(self._link, "details", {}))
        reported = BySide.of(self.reported[side].totals for side in SIDES)
        return StationLinks(own, dict(self._end.counts), reported)

    def is_done(self) -> bool:
        """All robots have carried out the wish."""
        modes = self.modes()
        wanted = _REACHED[self._wish] if self._wish else ()
        return self.hears_all() and all(mode in wanted for mode in modes.values())

    def hears_all(self) -> bool:
        """All robots that work are heard."""
        return len(self.modes()) == len(self.sides)

    def has_fallen_back(self) -> bool:
        """A robot that had carried out the wish no longer does as wished, because of a fault."""
        wanted = _REACHED[self._wish] if self._wish else ()
        modes = self.modes()
        return any(side in modes and modes[side] not in wanted for side in self._fulfilled)

    def has_lapsed(self) -> bool:
        """The wish was not carried out in time, and is not sent any more."""
        return self._is_older(_WISH_LASTS_S)

    def _is_older(self, limit_s: float) -> bool:
        """The wish is one that lapses, and older than this."""
        return self._wish in _LAPSES and self.clock() - self._wish_s > limit_s

    def step(self) -> None:
        """Take in what has arrived, and send what is due; to be called every `PERIOD_S`.

        Raises:
            OtherStation: another station operates the pair.
        """
        for data in self._link.receive():
            self._receive(data)
        self._say_faults()
        found = self._epochs.found(self.clock())
        if found == "other":
            raise OtherStation(
                f"station: another station operates this pair (it has booted {self._epochs.newest} "
                f"times, this one {self.epoch}); allowed: one at a time"
            )
        if found == "behind":
            self._say("another station has been in use: this one takes the next epoch")
            self._boot(replace(self._state, epoch=self._epochs.newest))
        if found == "listening" and self._wish not in _STOPS:
            return
        self._note_lapse()
        self._note_unconfirmed()
        for side in self.sides:
            body = self._due(side)
            self._link.send(side, self._end.send(side, body))
            stamp = self._end.newest(side)
            self.statistics.note_sent(side, stamp)
            self._note("sent", (side, stamp, body))

    def _receive(self, data: bytes) -> None:
        decoded = self._end.receive(data)
        packet = decoded.authentic
        kind = None
        if packet is not None:
            stamp = (packet.epoch, packet.sequence)
            kind = self.statistics.take(packet.sender, stamp, data, packet.acknowledged)
        for line in self._faults.take(decoded.verdict, packet, kind, self.clock()):
            self._say(line)
        # Without a session, its sender is a robot that knows another epoch.
        if packet is None or packet.sender == "station" or decoded.verdict == "stale":
            return
        side = packet.sender
        self._epochs.take(side, packet.acknowledged, self._end.newest(side)[1], self.clock())
        if decoded.packet is not None and isinstance(packet.body, Status):
            self._take(side, packet, packet.body)
            self._note("received", packet)

    def _say_faults(self) -> None:
        modes = self.modes()
        for side in self.status.keys() - modes.keys() - self._lost:
            self._say(f"{side}: not heard for {LOST_AFTER_S:g} s")
        for side in modes.keys() & self._lost:
            self._say(f"{side}: heard again")
        self._lost = set(self.status.keys() - modes.keys())
        for line in self._faults.step(modes, self.clock()):
            self._say(line)
        if self.hears_all() and set(modes.values()) <= set(UNDER_WAY):
            for line in self.corrections.hanging(self.time_s()):
                self._say(line)

    def claimed_twice(self) -> tuple[Side, ...]:
        """The robots that two programs claim to be. None is armed meanwhile."""
        return self._faults.claimed_twice(self.clock())

    def gone(self) -> tuple[Side, ...]:
        """The robots that have not been heard for so long that a carry is over."""
        now = self.clock()
        return tuple(s for s in self.sides if now - self.robots[s].heard_s > GONE_AFTER_S)

    def _due(self, side: Side) -> Operate | Hello:
        wish = self._wish
        if wish is None or (wish in ("arm", "start") and self.claimed_twice()):
            return Hello()
        stops = wish in _STOPS
        status = self.robots[side].status
        if status is not None and status.mode in _REACHED[wish] and wish != "release":
            self._fulfilled.add(side)
        # The newest order that may still act has been sent before the station calls it void.
        is_over = side in self._fulfilled or self._is_older(self._wish_sent_s)
        if stops and status is not None:
            is_over = status.mode in _REACHED[wish]
        return Hello(stop=stops) if is_over else Operate(wish, stop=stops)

    def _note_lapse(self) -> None:
        if not self._is_older(_MODE_KNOWN_S):
            return
        modes = self.modes()
        for side in self.sides:
            is_refused = modes.get(side) == "stopped" and self._wish != "release"
            if side in self._fulfilled | self._lapsed or not (is_refused or self.has_lapsed()):
                continue
            self._lapsed.add(side)
            within = "" if is_refused else f" within {_WISH_LASTS_S:g} s"
            self._say(f"{side}: {self._wish} has no effect{within}: {self._obstacle(side)}")

    def _note_unconfirmed(self) -> None:
        """Name the robots of which a stop is not known to have taken effect."""
        if self._wish not in _STOPS or self.clock() - self._wish_s <= _STOP_CONFIRMED_S:
            return
        modes = self.modes()
        for side in self.sides:
            if modes.get(side) == "stopped" or side in self._lapsed:
                continue
            self._lapsed.add(side)
            name = self._wish.replace("_", "-")
            self._say(
                f"{side}: {name} is not confirmed within {_STOP_CONFIRMED_S:g} s: "
                f"{self._obstacle(side)}; use the switch at the robot"
            )

    def _obstacle(self, side: Side) -> str:
        """Why an order to a robot has had no effect."""
        view = self.robots[side]
        status = view.status
        if status is None or not view.is_heard(self.clock()):
            return "the robot is not heard"
        if view.is_late and self._wish in _STOPS:
            return f"a packet and its answer take {view.answer_s:.1f} s"
        if view.is_late:
            return view.late_line()
        if status.mode == "stopped":
            return "the robot is stopped; release it first"
        if self._wish == "start" and status.fault == "none" and status.mode in _UNARMED:
            return f"the robot is {status.mode}; arm it first"
        state = "has a fault" if status.mode == "fault" else f"is {status.mode}"
        why = "" if status.fault == "none" else f" ({fault_line(status.fault)})"
        return f"the robot {state}{why}"

    def _take(self, side: Side, packet: Packet, status: Status) -> None:
        view, now = self.robots[side], self.clock()
        old = view.status
        view.take(packet, status, now)
        # The station sends one packet in every period, numbered without gaps.
        epoch, number = packet.acknowledged
        behind = self._end.newest(side)[1] - number
        view.answer_s = behind * PERIOD_S if epoch == self.epoch else None
        if view.is_late and side not in self._late:
            self._say(f"{side}: {view.late_line()}")
        elif side in self._late and not view.is_late:
            self._say(f"{side}: its answers are in time again")
        self._late = {one for one, other in self.robots.items() if other.is_late}
        self.reported[side].note(status)
        if old is None or (old.mode, old.fault) != (status.mode, status.fault):
            if status.mode == "stopped" and (old is None or old.mode != "stopped"):
                self._stopped_by[side] = self._order if self._wish in _STOPS else ""
            reason = self._reason(side, status)
            why = f" ({reason})" if reason else ""
            turns = old is not None and {old.mode, status.mode} == {"carrying", "holding"}
            if not turns or (old is not None and old.fault != status.fault):
                self._say(f"{side}: {status.mode}{why}")
        line = self.corrections.take(side, status.case, self.time_s())
        if line is not None:
            self._say(line)
        # A release ends the stop that was in force, and no later one: it is not repeated once the
        # robot has heard it.
        has_heard = epoch == self.epoch and number > self._wished_at[side]
        if self._wish == "release" and has_heard and status.mode != "stopped":
            self._fulfilled.add(side)

    def _reason(self, side: Side, status: Status) -> str:
        """Why a robot is in its mode: the stop that was ordered here, or its fault."""
        if status.mode == "stopped" and self._stopped_by[side]:
            return self._stopped_by[side]
        return "" if status.fault == "none" else status.fault

    def _frame_of(self, side: Side, now: float) -> dict[str, Any] | None:
        view = self.robots[side]
        frame = view.frame(now)
        if frame is None or view.status is None:
            return None
        return frame | {"reason": self._reason(side, view.status)}

    def frame(self) -> dict[str, Any]:
        """What a screen shows."""
        now = self.clock()
        return {
            "time_s": round(self.time_s(), 3),
            "wish": self._wish,
            "wish_is_done": self.is_done(),
            "robots": {side: self._frame_of(side, now) for side in self.sides},
            "corrections": [
                [one.label, one.robot, one.case, one.assistant]
                for one in self.corrections.under_way
            ],
            "warnings": [
                f"{side}: {text}" for side in self.sides for text in self.robots[side].warnings(now)
            ],
        }

    def on_note(self, call: Callable[[str, Any], None]) -> None:
        """Call this for every packet sent and received, every wish and line: for the log."""
        self._notes.append(call)

    def _note(self, kind: str, what: Any) -> None:
        for call in self._notes:
            call(kind, what)

    def _say(self, text: str) -> None:
        self._note("line", text)
        self._on_line(f"{self.time_s():7.2f} s  {text}")
