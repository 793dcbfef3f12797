# SPDX-License-Identifier: Apache-2.0
"""Measuring the radio between a station and two robots, and what it means for the controllers.

The station greets both robots in every period. Their status packets are numbered without gaps, so
missing numbers are losses, and they acknowledge the newest greeting, so an acknowledgement gives a
round trip. A robot answers with its next status, up to 0.05 s later, which counts as part of it.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from palmbots._types import SIDES, MaybeNaN, Side
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots.control.dead_band import warnings_before
from palmbots.control.registry import refusal, resolve, shipped_names
from palmbots.control.resilient_timing import bounds_of
from palmbots.links.link import Link
from palmbots.links.packet_statistics import PacketStatistics, quantile
from palmbots.pair.pair_file import Pair
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.wire import Endpoint, FaultCode, Hello, Status, Verdict

PERIOD_S = 0.05
_ANSWER_S = 0.05
NEWS_LEASE_S = 0.5
"""For controllers without a lease of their own: how long the partner's news counts."""
_FALSE_SILENCE_S = 3600.0
"""The lease should run out without need at most once in this time."""


@dataclass
class LinkFigures:
    """What was measured between the station and one robot."""

    received: int = 0
    """Different packets of the robot that arrived."""
    lost: int = 0
    """Packets that did not."""
    round_trips_s: list[float] = field(default_factory=list, metadata=NOT_IN_JSON)
    mode: str = ""
    """The robot's mode; empty: it was not heard."""
    fault: FaultCode = "none"
    status: Status | None = field(default=None, metadata=NOT_IN_JSON)
    """The newest one."""
    items: dict[str, int] = field(default_factory=dict, metadata=NOT_IN_JSON)
    """The newest value of each number that a status can have."""
    arrivals: list[tuple[float, int]] = field(default_factory=list, metadata=NOT_IN_JSON)
    """Time at which each status packet arrived [s], and its number."""

    @derived
    def loss(self) -> float:
        """Fraction of the packets that were lost."""
        sent = self.received + self.lost
        return self.lost / sent if sent else 0.0

    @derived
    def round_trip_median_s(self) -> MaybeNaN:
        """The median of the round trips."""
        return self.round_trip_s(0.5)

    @derived
    def round_trip_p99_s(self) -> MaybeNaN:
        """What 99 % of the round trips keep."""
        return self.round_trip_s(0.99)

    @derived
    def round_trip_longest_s(self) -> MaybeNaN:
        """The longest round trip."""
        return self.round_trip_s(1.0)

    def round_trip_s(self, fraction: float) -> float:
        """A quantile of the round trips [s]; NaN: there was none."""
        return quantile(self.round_trips_s, fraction)

    @property
    def delay_s(self) -> float:
        """Delay in one direction that 99 % of the packets keep, estimated as half of the round trip
        without the time until the robot answers [s]."""
        return max(0.0, self.round_trip_s(0.99) - _ANSWER_S) / 2

    def note(self, number: int, status: Status, now_s: float = 0.0) -> None:
        """A status with this number has arrived."""
        self.status = status
        self.items[status.item] = status.value
        self.arrivals.append((now_s, number))
        self.mode, self.fault = status.mode, status.fault


def measure(
    pair: Pair,
    link: Link,
    epoch: int,
    seconds: float,
    clock: Callable[[], float],
    wait: Callable[[], None],
    verdicts: dict[Verdict, int] | None = None,
) -> dict[Side, LinkFigures]:
    """Measure for some seconds.

    Args:
        pair: the pair.
        link: how packets travel.
        epoch: number of the station's boots, this one included.
        seconds: duration.
        clock: the time [s].
        wait: returns after `PERIOD_S`.
        verdicts: gets the number of received packets by verdict.
    """
    end = Endpoint(pair.key, pair.settings.pair.number, "station", epoch)
    figures: dict[Side, LinkFigures] = {side: LinkFigures() for side in SIDES}
    statistics = PacketStatistics("station", clock)
    stop_s = clock() + seconds
    while clock() < stop_s:
        for data in link.receive():
            got = end.receive(data)
            packet = got.authentic
            if packet is None or packet.sender == "station":
                continue
            stamp = (packet.epoch, packet.sequence)
            statistics.take(packet.sender, stamp, data, packet.acknowledged)
            if got.verdict == "accepted" and isinstance(packet.body, Status):
                figures[packet.sender].note(packet.sequence, packet.body, clock())
        for side in SIDES:
            link.send(side, end.send(side, Hello()))
            statistics.note_sent(side, end.newest(side))
        wait()
    for side, one in figures.items():
        counts = statistics.ends[side]
        one.received, one.lost = counts.received - counts.copies, counts.lost or 0
        one.round_trips_s = counts.round_trips_s
    if verdicts is not None:
        verdicts.update(end.counts)
    return figures


@dataclass(frozen=True)
class Needs:
    """What a radio means for the controllers."""

    delay_s: float
    """Delay in one direction [s]."""
    loss: float
    """Fraction of lost packets."""
    lease_s: float
    """A lease that runs out without need at most once per hour [s]."""
    verdicts: dict[str, str]
    """For each controller: ``suffices``, or why not."""


def needs_of(
    scene: Scene, delay_s: float, loss: float, *, stops_without_partner: bool = False
) -> Needs:
    """What a radio with this delay and loss means for each controller of robots.

    The robots' own link is assumed to be as good as those to the station, and to lose packets
    independently: where it loses several in a row, longer silences are more frequent.

    Args:
        scene: of the pair.
        delay_s: in one direction [s].
        loss: fraction of lost packets.
        stops_without_partner: a robot ends the carry when it does not hear its partner
            (``limits.partner_lost = "stop"``).
    """
    tick_s, beacon_s = scene.control.period_s, scene.radio.beacon_s
    shortest_s = 2 * (max(delay_s, tick_s) + beacon_s + tick_s)
    in_a_row = math.ceil(math.log(beacon_s / _FALSE_SILENCE_S) / math.log(loss)) if loss > 0 else 0
    lease_s = shortest_s + in_a_row * beacon_s
    keys = {"radio.latency_s": delay_s, "radio.jitter_s": 0.0}
    measured = load_scene(scene, on_every_side(scene, keys))
    verdicts = {
        name: _verdict(name, measured, loss, lease_s, stops_without_partner)
        for name in shipped_names("robots")
    }
    return Needs(delay_s, loss, lease_s, verdicts)


def _verdict(
    name: str, scene: Scene, loss: float, lease_s: float, stops_without_partner: bool
) -> str:
    entry = resolve(name)
    why = refusal(entry, scene)
    if why is not None:
        return why
    if entry.has_time_bounds:
        own_s = bounds_of(scene).lease_s
        if own_s < lease_s:
            return f"its lease of {own_s:.2f} s is shorter than {lease_s:.2f} s: it will stop often"
    if entry.assisted_cases and loss > 0:
        return "a lost message can make it hang"
    is_bound = entry.uses_radio and not entry.has_time_bounds
    if is_bound and stops_without_partner and lease_s > NEWS_LEASE_S:
        return (
            f"robots stop after {NEWS_LEASE_S:g} s without their partner, and this radio needs "
            f'{lease_s:.2f} s: set limits.partner_lost = "controller"'
        )
    warnings = warnings_before(scene, entry)
    return warnings[0] if warnings else "suffices"
