# SPDX-License-Identifier: Apache-2.0
"""How the clocks of several programs relate, from the packets that they exchanged.

A packet is never received before it is sent. Packets in both directions therefore bound the clock
of one program by that of the other from both sides:

    t_other = offset + rate · t_own

The line with the largest distance to all bounds is taken. That distance is the uncertainty of the
offset: half the shortest round trip. Which packet was received when is known from its stamp (the
sender's epoch and number), which both logs contain.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from palmbots.logs.run_log_reader import RunLog
from palmbots.wire import Role, decode

_RATE_REACH = 0.05
"""Clocks are assumed to differ by at most this fraction."""
_STEPS = 100
Stamp = tuple[str, str, int, int]
"""Sender, receiver, epoch and number of a packet."""


@dataclass(frozen=True)
class ClockFit:
    """The clock of one log by that of the reference of its run, its first log or its station:
    t_reference = offset + rate · t."""

    file: str
    offset_s: float
    rate: float
    uncertainty_s: float
    """The offset is right to within this time, if the rates of the clocks are constant."""
    packets: int
    """Packets that both logs contain; 0: the log is the reference of its run."""
    run: int = 1
    """Logs that packets in both directions connect are of one run; the runs are numbered from 1."""

    def to_reference(self, time_s: float) -> float:
        """A time of this log on the clock of the reference of its run."""
        return self.offset_s + self.rate * time_s


@dataclass(frozen=True)
class Traffic:
    """When a program sent and received which packets, on its own clock [s]."""

    sent: dict[Stamp, float]
    received: dict[Stamp, float]


def traffic(log: RunLog) -> Traffic:
    """The packets of a log."""
    sent: dict[Stamp, float] = {}
    received: dict[Stamp, float] = {}
    for now, event in log.messages["sent"]:
        sent["station", event.receiver, event.epoch, event.sequence] = now
    for now, event in log.messages["received"]:
        received[event.sender, "station", event.epoch, event.sequence] = now
    if log.end == "station":
        return Traffic(sent, received)
    key, pair = bytes.fromhex(log.facts["key"]), log.facts["pair"]
    ends: tuple[Role, ...] = ("left", "right", "station")
    for now, tick in log.messages["ticks"]:
        arrived = [(log.end, data, received) for data in tick.received]
        said = zip(tick.receivers, tick.sent, strict=False)
        known = ((to, data) for to, data in said if to < len(ends) and to not in tick.withheld)
        left = [(ends[to], data, sent) for to, data in known]
        for receiver, data, times in [*arrived, *left]:
            packet = decode(data, key, pair, receiver).packet
            if packet is not None:
                stamp = (packet.sender, packet.receiver, packet.epoch, packet.sequence)
                times.setdefault(stamp, now)
    return Traffic(sent, received)


def align(logs: list[RunLog]) -> tuple[ClockFit, ...]:
    """How the clock of each log relates to that of the first one of its run.

    A log that shares packets only with a third one is aligned by way of that one.
    """
    packets = [traffic(log) for log in logs]
    fits: dict[int, ClockFit] = {}
    waiting = list(range(len(logs)))
    runs = 0
    while waiting:
        found: list[tuple[float, int, ClockFit]] = []
        for k in waiting:
            for known, base in fits.items():
                one = fit(packets[k], packets[known])
                if one is None:
                    continue
                offset, rate, uncertainty, count = one
                total = base.uncertainty_s + uncertainty
                start, speed = base.to_reference(offset), base.rate * rate
                via = ClockFit(str(logs[k].path), start, speed, total, count, base.run)
                found.append((total, k, via))
        if found:
            _, k, fits[k] = min(found, key=lambda entry: entry[0])
        else:
            k, runs = waiting[0], runs + 1
            fits[k] = ClockFit(str(logs[k].path), 0.0, 1.0, 0.0, 0, runs)
        waiting.remove(k)
    return tuple(fits[k] for k in range(len(logs)))


def from_station(clocks: tuple[ClockFit, ...], logs: list[RunLog]) -> tuple[ClockFit, ...]:
    """The clocks by that of the station of each run, which also counts the time that `palmbots up`
    prints; runs without a log of a station stay as they are."""
    bases = {
        clock.run: clock
        for clock, log in zip(clocks, logs, strict=True)
        if log.end == "station" and clock.packets
    }
    return tuple(_by(clock, bases[clock.run]) if clock.run in bases else clock for clock in clocks)


def _by(own: ClockFit, base: ClockFit) -> ClockFit:
    """The clock `own` by the clock `base`, both of which are given by the same third one."""
    if own is base:
        return replace(own, offset_s=0.0, rate=1.0, uncertainty_s=0.0, packets=0)
    return replace(
        own,
        offset_s=(own.offset_s - base.offset_s) / base.rate,
        rate=own.rate / base.rate,
        uncertainty_s=(own.uncertainty_s + base.uncertainty_s) / base.rate,
        packets=own.packets or base.packets,
    )


def fit(own: Traffic, other: Traffic) -> tuple[float, float, float, int] | None:
    """Offset, rate and uncertainty of `own` in terms of `other`, and the number of packets.

    None: there are no packets in both directions.
    """
    # What `own` sent was received later: an upper bound of the other clock at the time of sending.
    out = [(t, other.received[s]) for s, t in own.sent.items() if s in other.received]
    back = [(t, other.sent[s]) for s, t in own.received.items() if s in other.sent]
    if not out or not back:
        return None
    upper, lower = np.array(out), np.array(back)
    middle = float(np.concatenate([upper[:, 0], lower[:, 0]]).mean())  # where errors of the rate
    upper[:, 0] -= middle  # matter least
    lower[:, 0] -= middle
    low, high = 1 - _RATE_REACH, 1 + _RATE_REACH
    if len(out) + len(back) < 20 or np.ptp(np.concatenate([upper[:, 0], lower[:, 0]])) < 1.0:
        low = high = 1.0  # too little to find the rate
    for _ in range(_STEPS):  # the margin is concave in the rate
        third = (high - low) / 3
        if _margin(upper, lower, low + third) < _margin(upper, lower, high - third):
            low += third
        else:
            high -= third
    rate = (low + high) / 2
    top, bottom = _bounds(upper, lower, rate)
    offset = (top + bottom) / 2 - rate * middle
    return offset, rate, abs(top - bottom) / 2, len(out) + len(back)


def _bounds(
    upper: NDArray[np.float64], lower: NDArray[np.float64], rate: float
) -> tuple[float, float]:
    top = float((upper[:, 1] - rate * upper[:, 0]).min())
    return top, float((lower[:, 1] - rate * lower[:, 0]).max())


def _margin(upper: NDArray[np.float64], lower: NDArray[np.float64], rate: float) -> float:
    top, bottom = _bounds(upper, lower, rate)
    return top - bottom
