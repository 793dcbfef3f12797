# SPDX-License-Identifier: Apache-2.0
"""The rules of `silent` and `shared-sign` as their prose has them: plain conditions and instants.

A slow transcription of docs/theory/protocols.md that shares nothing with the tables in the core.
"""

import math
from dataclasses import dataclass


@dataclass
class Clock:
    """The times of the rules, in ticks."""

    beacon: int
    lease: int
    turn: int
    notice: int
    push: int
    rest: int
    patience: int
    back: int
    wait: int
    watch: int = 0


@dataclass
class SignRobot:
    """One robot. `shares`: it is `shared-sign`, else `silent`."""

    clock: Clock
    leads: bool
    brake: bool
    shares: bool
    now: int = 0
    palm: str = "shallow"
    partner_sign: int = 0
    partner_palm: str = "steep"
    heard_at: float = float("-inf")
    message: tuple[int, str] = (0, "steep")
    said_at: float = float("-inf")
    # The sign of the tie that lasts; when the leader's turn or notice began, and whether it is the
    # notice.
    tie: int | None = None
    turn_began: int = 0
    ending: bool = False
    # What the robot does on its own, and since when; None: it hears its partner.
    phase: str | None = "centred"
    phase_began: int = 0
    by_touch: bool = False

    def __post_init__(self) -> None:
        if self.by_touch:
            self.phase = "wait" if self.leads else "watch"
            self.palm = "shallow" if self.leads else "steep"

    def step(
        self, sign: int, news: tuple[int, str] | None, age: int
    ) -> tuple[str, str, bool, tuple[int, str], bool]:
        """One tick: (palm, move, stop, own message, whether it is sent)."""
        self.now += 1
        answers = news is not None and self.now - self.heard_at > self.clock.lease
        if news is not None and self.shares:
            self.partner_sign, self.partner_palm = news
            self.heard_at = self.now - age
        alone = not self.shares or self.now - self.heard_at > self.clock.lease
        if alone:
            self.tie = None
            move, stop = self._alone(sign)
        else:
            self.phase = None
            move, stop = self._together(sign, self.partner_sign)
        # Only the leader of a tie names its palm; every other sign has one message.
        names = self.tie is not None and self.leads
        says = other(self.palm) if self.ending else self.palm
        message = (sign, says if names else "shallow" if sign < 0 else "steep")
        interval = self.clock.beacon if answers else self._interval(sign, news is not None)
        due = self.shares and (message != self.message or self.now - self.said_at >= interval)
        if due:
            self.said_at = self.now
        self.message = message
        return self.palm, move, stop, message, due

    def _interval(self, sign: int, is_spoken_to: bool) -> int:
        """The time between two beacons."""
        partner_is_off = self.phase is None and self.partner_sign != 0
        if sign == 0 and self.phase != "wait" and not partner_is_off:
            return max(self.clock.watch, self.clock.beacon)
        if 0.7 * self.clock.lease <= self.now - self.heard_at <= self.clock.lease:
            return self.clock.beacon
        return math.ceil((1.5 if is_spoken_to else 2) * self.clock.beacon)

    def _alone(self, sign: int) -> tuple[str, bool]:
        phase = self._next_phase(sign)
        if phase != self.phase:
            self.phase, self.phase_began = phase, self.now
        corrects = sign > 0 and phase != "centred"
        self.palm = "steep" if corrects or phase == "watch" else "shallow"
        if phase in ("push", "patience in", "back"):
            move = "closer"
        else:
            move = "away" if phase in ("out", "patience out") else "hold"
        return move, phase in ("stop out", "stop in", "back", "wait")

    def _next_phase(self, sign: int) -> str:
        """What the robot does from now on: as before, until the sign or the time ends it."""
        was, clock = self.phase, self.clock
        lasted = self.now - self.phase_began
        if was == "watch" and not self.shares and sign >= 0:
            return "watch" if lasted < clock.watch else "centred"
        if sign > 0:
            if not self.brake or self.leads:
                return "out"
            if was == "stop out" or (was == "patience out" and lasted >= clock.patience):
                return "stop out"
            return "patience out"
        if sign == 0:
            if was == "watch" and lasted < clock.watch:
                return "watch"
            if was == "wait" and (lasted < clock.wait or not self.shares):
                return "wait"
            if was == "wait":
                return "watch"
            if was == "back" and self.shares:
                return "wait"
            return "watch" if was is None and self.leads and self.brake else "centred"
        ends = {
            "push": (clock.push, "rest"),
            "rest": (clock.rest, "push"),
            "patience in": (clock.patience, "stop in"),
            "stop in": (clock.wait, "back"),
            "back": (clock.back, "patience in"),
        }
        if was in ends:
            limit, then = ends[was]
            return was if lasted < limit else then
        if was == "wait" and self.shares and self.brake:
            return "stop in"
        return "patience in" if self.leads and self.brake else "push"

    def _together(self, a: int, b: int) -> tuple[str, bool]:
        if a != b:
            self.tie = None
            self.palm = "shallow" if a < b else "steep"
            apart = a * b < 0
            return ("away" if apart or a + b > 0 else "closer"), False
        if a == 0:
            self.tie = None
            return "hold", False
        stops = self.brake and (not self.leads if a > 0 else self.leads)
        if not self.leads:
            self.palm = other(self.partner_palm)
        elif self.tie != a:
            self.turn_began, self.ending = self.now, False
        elif self.now - self.turn_began >= (self.clock.notice if self.ending else self.clock.turn):
            if self.ending:
                self.palm = other(self.palm)
            self.turn_began, self.ending = self.now, not self.ending
        self.tie = a
        return ("hold" if stops else "away" if a > 0 else "closer"), stops


def other(palm: str) -> str:
    """The other of the two angles."""
    return "steep" if palm == "shallow" else "shallow"
