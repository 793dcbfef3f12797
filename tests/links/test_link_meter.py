# SPDX-License-Identifier: Apache-2.0
"""What the meter counts, against what a scripted link has done to real packets."""

import random

import pytest

from palmbots.links import link_meter
from palmbots.links.link_meter import LinkMeter
from palmbots.wire import Endpoint, Hello, Operate, State

KEY, PAIR = bytes(range(16)), 7


class Scripted:
    """A link whose packets are put in by the test."""

    def __init__(self) -> None:
        self.sent: list[tuple[str, bytes]] = []
        self.arrived: list[bytes] = []

    def send(self, receiver: str, data: bytes) -> None:
        self.sent.append((receiver, data))

    def receive(self) -> list[bytes]:
        arrived, self.arrived = self.arrived, []
        return arrived

    def close(self) -> None:
        pass


def metered(role: str) -> tuple[LinkMeter, Scripted]:
    link = Scripted()
    return LinkMeter(link, role, KEY, PAIR), link  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(5))
def test_losses_copies_and_overtaken_packets(seed: int) -> None:
    chance = random.Random(seed)
    meter, link = metered("left")
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
        link.arrived.append(packets[place])
        assert meter.receive() == [packets[place]]
    found = meter.ends["station"]
    assert (found.received, found.copies) == (len(arrive), len(copies))
    assert (found.lost, found.overtaken) == (len(lost), overtaken)


def test_a_reboot_begins_a_new_count() -> None:
    meter, link = metered("left")
    for epoch, skipped in ((1, 0), (2, 3)):
        station = Endpoint(KEY, PAIR, "station", epoch)
        for _ in range(10):
            link.arrived.append(station.send("left"))
        for _ in range(skipped):
            station.send("left")
        link.arrived.append(station.send("left"))
    meter.receive()
    assert (meter.ends["station"].lost, meter.ends["station"].received) == (3, 22)


def test_robots_do_not_count_losses_between_them() -> None:
    """Their packets are numbered by control ticks."""
    meter, link = metered("left")
    right = Endpoint(KEY, PAIR, "right", 1)
    for tick in (5, 90, 200):
        right.skip_to("left", tick)
        link.arrived.append(right.send("left", State("none", "")))
    meter.receive()
    assert meter.ends["right"].received == 3
    assert meter.summary()["right"]["lost"] is None


def test_what_is_no_packet_of_the_pair_is_not_counted() -> None:
    meter, link = metered("left")
    stranger = Endpoint(bytes(16), PAIR, "right", 1)
    other = Endpoint(KEY, PAIR + 1, "right", 1)
    to_station = Endpoint(KEY, PAIR, "right", 1)
    link.arrived = [
        b"", b"noise", stranger.send("left"), other.send("left"), to_station.send("station")
    ]  # fmt: skip
    data = [*link.arrived]
    assert meter.receive() == data  # passed on unchanged: the core judges them
    assert all(end.received == 0 for end in meter.ends.values())


def test_round_trips_end_with_the_first_acknowledgement(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [100.0]
    monkeypatch.setattr(link_meter, "monotonic", lambda: now_s[0])
    meter, link = metered("station")
    station, left = Endpoint(KEY, PAIR, "station", 1), Endpoint(KEY, PAIR, "left", 1)
    for trip_s in (0.01, 0.03):
        question = station.send("left", Hello())
        meter.send("left", question)
        left.receive(question)
        now_s[0] += trip_s
        link.arrived = [left.send("station"), left.send("station")]
        meter.receive()
    assert [*meter.ends["left"].round_trips_s] == pytest.approx([0.01, 0.03])
    table = meter.summary()["left"]
    assert table["sent"] == 2
    assert table["round_trip_longest_s"] == table["round_trip_p99_s"] == pytest.approx(0.03)
    assert table["round_trip_median_s"] == pytest.approx(0.01)
    assert meter.summary()["right"]["round_trip_median_s"] is None
