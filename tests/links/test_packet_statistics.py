# SPDX-License-Identifier: Apache-2.0
"""What is counted, against what a scripted radio has done to real packets."""

import random
from typing import Any

import pytest

from palmbots._util.plain_values import plain
from palmbots.links.packet_statistics import EndStatistics, PacketStatistics, ReportedCounts
from palmbots.wire import Endpoint, Hello, Operate, State, Status

KEY, PAIR = bytes(range(16)), 7


class End:
    """One end: an endpoint, and the statistics of what it judges."""

    def __init__(self, role: Any, epoch: int = 1) -> None:
        self.endpoint = Endpoint(KEY, PAIR, role, epoch)
        self.now_s = 100.0
        self.counts = PacketStatistics(role, lambda: self.now_s)

    def receive(self, data: bytes) -> None:
        packet = self.endpoint.receive(data).authentic
        if packet is not None:
            stamp = (packet.epoch, packet.sequence)
            self.counts.take(packet.sender, stamp, data, packet.acknowledged)


@pytest.mark.parametrize("seed", range(5))
def test_losses_copies_and_overtaken_packets(seed: int) -> None:
    chance = random.Random(seed)
    left = End("left")
    station = Endpoint(KEY, PAIR, "station", 1)
    packets = [station.send("left", Operate("arm")) for _ in range(400)]
    # A hole at the end would not be noticed: the last packet arrives, undisturbed.
    lost = {place for place in range(1, 390) if chance.random() < 0.2}
    arrive = [place for place in range(400) if place not in lost]
    overtaken = 0
    for i in range(5, 300, 9):  # the next one is faster
        arrive[i], arrive[i + 1] = arrive[i + 1], arrive[i]
        overtaken += 1
    copies = [arrive[i] for i in range(2, 300, 7)]
    for place in copies:
        arrive.insert(arrive.index(place) + 1, place)
    for place in arrive:
        left.receive(packets[place])
    found = left.counts.ends["station"]
    assert (found.received, found.copies) == (len(arrive), len(copies))
    assert (found.lost, found.overtaken) == (len(lost), overtaken)
    assert found.loss(left.now_s) == pytest.approx(len(lost) / 400)


def test_a_reboot_begins_a_new_count() -> None:
    left = End("left")
    for epoch, skipped in ((1, 0), (2, 3)):
        station = Endpoint(KEY, PAIR, "station", epoch)
        for _ in range(10):
            left.receive(station.send("left"))
        for _ in range(skipped):
            station.send("left")
        left.receive(station.send("left"))
    found = left.counts.ends["station"]
    assert (found.lost, found.received) == (3, 22)


def test_robots_do_not_count_losses_between_them() -> None:
    """Their packets are numbered by control ticks."""
    left = End("left")
    right = Endpoint(KEY, PAIR, "right", 1)
    for tick in (5, 90, 200):
        right.skip_to("left", tick)
        left.receive(right.send("left", State("none", "")))
    assert left.counts.ends["right"].received == 3
    assert left.counts.ends["right"].counts().lost is None


def test_what_is_no_packet_of_the_pair_is_not_counted() -> None:
    left = End("left")
    stranger = Endpoint(bytes(16), PAIR, "right", 1)
    other = Endpoint(KEY, PAIR + 1, "right", 1)
    to_station = Endpoint(KEY, PAIR, "right", 1)
    for data in (
        b"", b"noise", stranger.send("left"), other.send("left"), to_station.send("station")
    ):  # fmt: skip
        left.receive(data)
    assert all(end.received == 0 for end in left.counts.ends.values())


def test_round_trips_end_with_the_first_acknowledgement() -> None:
    station, left = End("station"), Endpoint(KEY, PAIR, "left", 1)
    for trip_s in (0.01, 0.03):
        question = station.endpoint.send("left", Hello())
        station.counts.note_sent("left", station.endpoint.newest("left"))
        left.receive(question)
        station.now_s += trip_s
        for _ in range(2):
            station.receive(left.send("station"))
    assert station.counts.ends["left"].round_trips_s == pytest.approx([0.01, 0.03])
    counts = station.counts.ends["left"].counts()
    assert counts.sent == 2
    assert counts.round_trip_longest_s == counts.round_trip_p99_s == pytest.approx(0.03)
    assert counts.round_trip_median_s == pytest.approx(0.01)
    assert plain(station.counts.ends["right"].counts())["round_trip_median_s"] is None


def test_the_last_seconds_count_gaps_and_round_trips() -> None:
    end = EndStatistics()
    assert (end.loss(0), end.round_trip_s(0)) == (None, None)
    for number in range(1, 101):
        end.note_sent((7, number), 0.05 * number)
        if number % 4:
            end.take((2, number), b"%d" % number, (7, number), 0.05 * number + 0.03)
    assert end.loss(5.0) == pytest.approx(1 - 75 / 99)
    assert end.round_trip_s(5.0) == pytest.approx(0.03)
    assert (end.loss(100.0), end.round_trip_s(100.0)) == (None, None)
    end.take((3, 1), b"1", (7, 100), 100.0)  # the robot has booted
    end.take((3, 2), b"2", (7, 100), 100.1)
    assert end.loss(100.1) == 0


def test_totals_are_the_true_ones_beyond_the_modulus() -> None:
    chance = random.Random(1)
    true: dict[Any, int] = dict.fromkeys(("sent", "accepted", "stale"), 0)
    counts = ReportedCounts()
    for _ in range(5000):
        for name in true:
            true[name] += chance.randrange(100)
        item: Any = chance.choice([*true, "progress", "battery", "overruns"])
        counts.note(Status(item=item, value=true.get(item, 77) % 65536))
    for name in true:
        counts.note(Status(item=name, value=true[name] % 65536))
    assert true["sent"] > 3 * 65536
    assert counts.totals == true


def test_a_reboot_adds_what_was_counted_since() -> None:
    counts = ReportedCounts()
    for value in (100, 250, 3, 10):
        counts.note(Status(item="sent", value=value))
    assert counts.totals == {"sent": 260}
