# SPDX-License-Identifier: Apache-2.0
"""One line about each fault, for the operator: what the station concludes from what arrives."""

import time
from collections import deque
from collections.abc import Callable, Mapping

from palmbots._types import SIDES, Side
from palmbots.links.packet_statistics import Kind, PacketStatistics
from palmbots.station.robot_stream import RobotStream
from palmbots.station.robot_view import phase_name
from palmbots.wire import Packet, RobotMode, Status, Verdict

_MANY = 10
_WITHIN_S = 1.0
_QUIET_S = 10.0
"""A line that goes on being true is not repeated before."""
_HANGS_S = 5.0
_JOB_HANGS_S = 30.0
"""Longer than any phase of a job on the floor lasts before and after the carry."""
_STANDING: tuple[RobotMode, ...] = ("carrying", "holding")
_CLOCK_FROM_S = 12.0
_CLOCK_ERROR = 0.01
_CLOCK_SHAKE_S = 0.06  # of arrivals
_WALL_JUMP_S = 1.0


class FaultWatch:
    """Finds faults in the packets that reach the station, and in its own clock.

    Args:
        period_s: of the robots' status.
        statistics: of the packets that arrive.
        now_s: the time.
        wall_s: the wall clock, which anybody may set, and a clock that nobody sets.
        sides: the robots that work.
    """

    def __init__(
        self,
        period_s: float,
        statistics: PacketStatistics,
        now_s: float,
        wall_s: Callable[[], float] = lambda: time.time() - time.monotonic(),
        sides: tuple[Side, ...] = SIDES,
    ) -> None:
        self._period_s, self._wall_s, self._sides = period_s, wall_s, sides
        self._wall_offset_s = wall_s()
        self._streams: dict[Side, RobotStream] = {
            side: RobotStream(statistics.ends[side]) for side in SIDES
        }
        self._refused: dict[str, deque[float]] = {}
        self._said_s: dict[str, float] = {}
        self._progress: dict[tuple[Side, str], tuple[int, RobotMode]] = {}
        self._moved_s = now_s
        self._clock_from: dict[Side, tuple[float, tuple[int, int]]] = {}
        self._clock_said: set[Side] = set()

    def take(
        self, verdict: Verdict, packet: Packet | None, kind: Kind | None, now_s: float
    ) -> list[str]:
        """A datagram has arrived; returns what there is to say.

        Args:
            verdict: of the station's endpoint.
            packet: what it says, if its tag is right; whether it is new does not matter.
            kind: how it relates to the earlier ones of its sender.
            now_s: the time.
        """
        if packet is None or kind is None:
            return self._refusal_lines(verdict, now_s)
        side = packet.sender
        if side == "station":
            return []
        stamp = (packet.epoch, packet.sequence)
        lines = [f"{side}: {text}" for text in self._streams[side].lines(kind, stamp, now_s)]
        if isinstance(packet.body, Status) and kind in ("boot", "new"):
            self._note_progress(side, packet.body, now_s)
            lines += self._clock_lines(side, stamp, now_s)
        return lines

    def claimed_twice(self, now_s: float) -> tuple[Side, ...]:
        """The robots that two programs claim to be: they must not be armed."""
        return tuple(side for side in SIDES if self._streams[side].is_claimed_twice(now_s))

    def step(self, modes: Mapping[Side, RobotMode], now_s: float) -> list[str]:
        """To be called in every period, with the modes of the robots that are heard."""
        lines = []
        jump_s = self._wall_s() - self._wall_offset_s
        if abs(jump_s) > _WALL_JUMP_S:
            self._wall_offset_s += jump_s
            way = "back" if jump_s < 0 else "forward"
            lines.append(
                f"station: the clock of this computer was set {way} by {abs(jump_s):.0f} s; "
                "nothing here depends on it"
            )
        now = set(modes.values())  # a robot may wait for one that is done
        is_under_way = len(modes) == len(self._sides) and {"done"} != now <= {*_STANDING, "done"}
        if not is_under_way:
            self._moved_s = now_s
        elif now_s - self._moved_s > self._hangs_s() and self._may_say("hangs", now_s):
            shown = ", ".join(f"{side} is {mode}" for side, mode in modes.items())
            line = f"the carry has not moved on for {self._hangs_s():g} s: it hangs ({shown})"
            if "done" in now:
                one, other = SIDES if modes["right"] == "done" else SIDES[::-1]
                line += f"; {one} waits for {other}, which is done: stop the carry"
            lines.append(line)
        return lines

    def _hangs_s(self) -> float:
        phases = {
            phase_name(value) for (_, item), (value, _) in self._progress.items() if item == "phase"
        }
        return _HANGS_S if phases <= {"carry", ""} else _JOB_HANGS_S

    def _note_progress(self, side: Side, status: Status, now_s: float) -> None:
        if status.item not in ("progress", "phase"):
            return
        of, new = (side, status.item), (status.value, status.mode)
        if self._progress.get(of) != new:
            if self._progress.get(of, (None,))[0] != status.value:
                self._moved_s = now_s
            self._progress[of] = new

    def _refusal_lines(self, verdict: Verdict, now_s: float) -> list[str]:
        reasons = {"bad_tag": "signed with another key", "wrong_pair": "of another pair"}
        if verdict not in reasons:
            return []
        times = self._refused.setdefault(verdict, deque(maxlen=_MANY))
        times.append(now_s)
        if len(times) < _MANY or now_s - times[0] > _WITHIN_S or not self._may_say(verdict, now_s):
            return []
        silent = [side for side in self._sides if not self._streams[side].is_heard]
        who = f"; not heard: {' and '.join(silent)}, which may have an old key" if silent else ""
        return [f"packets arrive that are {reasons[verdict]}{who}"]

    def _clock_lines(self, side: Side, stamp: tuple[int, int], now_s: float) -> list[str]:
        """The numbers of a robot's packets count the time of its own clock."""
        since_s, first = self._clock_from.get(side, (now_s, stamp))
        if first[0] != stamp[0] or side not in self._clock_from:
            self._clock_from[side] = (now_s, stamp)
            return []
        passed_s = now_s - since_s
        if passed_s < _CLOCK_FROM_S or side in self._clock_said:
            return []
        rate = self._period_s * (stamp[1] - first[1]) / passed_s
        if rate - 1 < _CLOCK_ERROR + _CLOCK_SHAKE_S / passed_s:
            return []
        self._clock_said.add(side)
        return [f"{side}: its clock runs {100 * (rate - 1):.0f} % fast"]

    def _may_say(self, what: str, now_s: float) -> bool:
        if now_s - self._said_s.get(what, -1e9) < _QUIET_S:
            return False
        self._said_s[what] = now_s
        return True
