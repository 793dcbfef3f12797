# SPDX-License-Identifier: Apache-2.0
"""The proxy that makes a radio bad: rates against closed forms, and real datagrams."""

import math
import random
import socket
from typing import Any

import pytest

import palmbots as pb
from palmbots.cli.commands.up_command import _IN_PROCESSES, _radio_of, not_simulated
from palmbots.links.impairment import (
    FURTHER_DELAYS,
    ONLY_LOSSES,
    WHOLE_DELAYS,
    ImpairedPackets,
    Impairment,
    Proxy,
    RecordedFates,
)
from palmbots.scene.core_keys import ROWS

PACKETS = 20_000


def test_rates_and_delays_are_those_asked_for() -> None:
    bad = Impairment(loss=0.2, delay_ms=50, jitter_ms=30, duplicate=0.1)
    chance = random.Random(1)
    fates = [bad.delays_s(chance) for _ in range(PACKETS)]
    for share, expected in (
        (sum(not fate for fate in fates), 0.2),
        (sum(len(fate) == 2 for fate in fates), 0.8 * 0.1),
    ):
        error = 4 * math.sqrt(expected * (1 - expected) / PACKETS)
        assert share / PACKETS == pytest.approx(expected, abs=error)
    delays = [delay for fate in fates for delay in fate]
    assert 0.02 <= min(delays) < 0.021
    assert 0.079 < max(delays) <= 0.08
    mean_error = 4 * 0.06 / math.sqrt(12 * len(delays))
    assert sum(delays) / len(delays) == pytest.approx(0.05, abs=mean_error)


def test_the_same_seed_gives_the_same_fates() -> None:
    bad = Impairment(loss=0.5, delay_ms=5, jitter_ms=5)

    def fates(seed: int) -> list[list[float]]:
        chance = random.Random(seed)
        return [bad.delays_s(chance) for _ in range(50)]

    assert fates(7) == fates(7)
    assert fates(7) != fates(8)


@pytest.mark.parametrize(
    ("text", "made"),
    [
        ("", Impairment()),
        ("loss=0.2 delay_ms=50 jitter_ms=30", Impairment(0.2, 50, 30)),
        ("duplicate=1", Impairment(duplicate=1)),
    ],
)
def test_what_a_user_types_is_read(text: str, made: Impairment) -> None:
    assert Impairment.parse(text) == made


RECORDED = [0.01, -1.0, 0.03, 0.02, 0.05]


def replayed(kind: int, link: tuple[str, str], seed: int = 0) -> list[float | None]:
    """The delays of packets that are sent as often as the recorded ones [s]; None: it is lost."""
    bad = Impairment(loss=0.9, delay_ms=30, jitter_ms=10)
    air = ImpairedPackets(bad, seed, RecordedFates(0.1, kind, RECORDED))
    found: list[float | None] = []
    for k in range(20):
        air.send(0.1 * k, *link, b"")
        found.append(None)
        for late in range(100):
            if [*air.due(0.1 * k + 0.001 * late + 1e-9)]:
                found[-1] = round(0.001 * late, 3)
                break
    return found


@pytest.mark.parametrize("link", [("left", "right"), ("station", "left")])
def test_recorded_packets_are_replayed_from_a_place_that_the_seed_draws(
    link: tuple[str, str],
) -> None:
    recorded = [None if one < 0 else one for one in RECORDED]
    places = set()
    for seed in range(40):
        found = replayed(WHOLE_DELAYS, link, seed)
        (place,) = [k for k in range(5) if found[:5] == recorded[k:] + recorded[:k]]
        assert found == [recorded[(place + k) % 5] for k in range(20)]
        places.add(place)
    assert places == {0, 1, 2, 3, 4}


def test_delays_that_were_not_recorded_are_those_of_the_radio() -> None:
    whole = replayed(WHOLE_DELAYS, ("left", "right"))
    later = replayed(FURTHER_DELAYS, ("left", "right"))
    assert later == [None if one is None else round(0.02 + one, 3) for one in whole]
    losses = replayed(ONLY_LOSSES, ("left", "right"))
    assert [one is None for one in losses] == [one is None for one in whole]
    assert all(0.02 <= one <= 0.041 for one in losses if one is not None)
    assert len({*losses}) > 5


def test_a_packet_that_is_sent_later_meets_a_later_fate() -> None:
    fates = RecordedFates(0.1, ONLY_LOSSES, [0.0] * 10 + [-1.0] * 10)
    air = ImpairedPackets(Impairment(), 3, fates)
    lost = 0
    for k in range(200):  # every second recorded packet
        air.send(0.2 * k, "left", "right", b"")
        lost += not [*air.due(0.2 * k)]
    assert lost == 100


def test_datagrams_go_to_the_end_they_are_meant_for() -> None:
    ends = {end: socket.socket(type=socket.SOCK_DGRAM) for end in ("left", "right")}
    for one in ends.values():
        one.bind(("127.0.0.1", 0))
        one.settimeout(30)
    targets: dict[Any, str] = {end: "{}:{}".format(*one.getsockname()) for end, one in ends.items()}
    proxy = Proxy(targets, Impairment(duplicate=1))
    with proxy, socket.socket(type=socket.SOCK_DGRAM) as me:
        for end, address in proxy.addresses.items():
            host, port = address.split(":")
            me.sendto(end.encode(), (host, int(port)))
        for end, one in ends.items():
            assert [one.recv(100), one.recv(100)] == [end.encode()] * 2
            one.close()


@pytest.mark.parametrize("reorder", [0, 1])
def test_packets_overtake_each_other_only_where_they_may(reorder: float) -> None:
    air = ImpairedPackets(Impairment(delay_ms=50, jitter_ms=50, duplicate=0.2, reorder=reorder))
    for number in range(200):
        air.send(0.01 * number, "left", "right", bytes([number]))
        air.send(0.01 * number, "left", "station", bytes([number]))
    arrived: dict[str, list[int]] = {"right": [], "station": []}
    for receiver, data in air.due(10.0):
        arrived[receiver].append(data[0])
    for numbers in arrived.values():
        assert len(numbers) > 220
        assert (numbers == sorted(numbers)) == (not reorder)


def test_packets_between_processes_have_the_delays_of_the_scene() -> None:
    """From the shortest to the longest: a scene adds its jitter to the latency."""
    keys = {"radio.latency_s": 0.03, "radio.jitter_s": 0.04, "radio.loss": 0.1}
    radio = _radio_of(pb.load_scene("paper", keys | {"radio.duplicate": 0.3}))
    radio.check()
    chance = random.Random(0)
    fates = [radio.delays_s(chance) for _ in range(10_000)]
    delays = [one for fate in fates for one in fate]
    assert 0.03 <= min(delays) < 0.031 and 0.069 < max(delays) <= 0.07
    assert sum(not fate for fate in fates) / len(fates) == pytest.approx(0.1, abs=0.015)
    assert sum(len(fate) == 2 for fate in fates) / len(fates) == pytest.approx(0.27, abs=0.02)


OTHER_LISTS = {
    "radio.outages": [{"sender": "left", "start_s": 1.0, "end_s": 2.0}],
    "radio.script": [{"sender": "left", "message": 1, "effect": "lost"}],
    "faults.script": [{"kind": "reboot", "robot": "left", "at_s": 1.0, "duration_s": 0.5}],
}


def others() -> dict[str, Any]:
    """Every key of radio and faults with another value than its default, from the core's table."""
    found: dict[str, Any] = dict(OTHER_LISTS)
    for name, row in ROWS.items():
        if name.startswith(("radio.", "faults.")) and "[]" not in name:
            values = {"flag": not row["default"], "whole": 1, "number": 0.25}
            found[name] = values[row["kind"]]
    return found | {f"radio.{end}.loss": 0.5 for end in ("left", "right", "station")}


def test_keys_that_have_no_effect_in_real_time_are_named() -> None:
    assert not not_simulated(pb.load_scene("paper"))
    named = set()
    for key, value in others().items():
        line = not_simulated(pb.load_scene("paper", {key: value}))
        assert bool(line) == (key not in _IN_PROCESSES), key
        if line:
            assert line == f"{key} of the scene has no effect in real time, only with --lockstep"
            named.add(key)
        with_link = not_simulated(pb.load_scene("paper", {key: value}), "loss=0.1")
        assert bool(with_link) == key.startswith("faults."), key
    assert {"radio.burst_fraction", "radio.airtime_s", "radio.outages", "radio.left.loss"} <= named
    two = not_simulated(pb.load_scene("paper", {"radio.replay": 0.1, "radio.corruption": 0.1}))
    assert two.startswith("radio.corruption, radio.replay of the scene have no effect")
