# SPDX-License-Identifier: Apache-2.0
"""What the numbers of a robot's packets show: losses, copies, boots, and two programs."""

import random

import pytest

from palmbots.links.packet_statistics import EndStatistics
from palmbots.station.robot_stream import RobotStream

PERIOD_S = 0.05


class Stream(RobotStream):
    """With statistics of its own."""

    def __init__(self) -> None:
        self.end = EndStatistics()
        super().__init__(self.end)

    def take(
        self, stamp: tuple[int, int], data: bytes, now_s: float, heard: tuple[int, int] = (0, 0)
    ) -> list[str]:
        return self.lines(self.end.take(stamp, data, heard, now_s), stamp, now_s)


def lines_of(fates: list[tuple[float, tuple[int, int], bytes]]) -> list[str]:
    """The lines of a stream of packets: when each arrives, its stamp, and its bytes."""
    stream = Stream()
    found = []
    for now_s, stamp, data in sorted(fates):
        found += stream.take(stamp, data, now_s)
    return found


def sent(epoch: int, first: int, count: int, start_s: float = 0.0, text: str = "") -> list:
    return [
        (start_s + PERIOD_S * k, (epoch, first + k), f"{text}{epoch} {first + k}".encode())
        for k in range(count)
    ]


def test_a_good_stream_says_nothing() -> None:
    assert lines_of(sent(1, 1, 400)) == []


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.02, 0.2])
def test_losses_and_copies_are_said_once(share: float, seed: int) -> None:
    chance = random.Random(seed)
    packets = sent(3, 1, 600)
    lost = lines_of([packet for packet in packets if chance.random() >= share])
    copied = lines_of([p for packet in packets for p in [packet] * (1 + (chance.random() < share))])
    if share < 0.05:
        assert lost == copied == []
    else:
        assert len(lost) == 1 and lost[0].endswith(" % of its packets are lost")
        assert abs(int(lost[0].split()[0]) - 20) <= 10
        assert len(copied) == 1 and copied[0].endswith(" % of its packets arrive twice")


def test_a_boot_is_said_and_old_packets_are_no_second_program() -> None:
    late = [(1.2, (1, 20), b"1 20"), (1.3, (1, 19), b"1 19")]
    assert lines_of(sent(1, 1, 18) + sent(2, 1, 200, 1.0) + late) == ["has started again (boot 2)"]


@pytest.mark.parametrize(
    ("other", "names"),
    [
        (sent(5, 1, 200, 2.0), "boot 7, packet "),  # it has booted less often
        (sent(7, 1, 200, 2.0, "x"), "boot 7, packet "),  # as often, and counts from 1
        (sent(7, 500, 200, 2.0, "x"), "boot 7, packet "),  # as often, and is ahead
        (sent(9, 1, 200, 2.0), "boot 9, packet "),  # more often
    ],
)
def test_a_second_program_is_noticed(other: list, names: str) -> None:
    found = lines_of(sent(7, 1, 300) + other)
    claims = [line for line in found if line.startswith("two programs claim to be this robot: ")]
    assert claims and names in claims[0]
    assert claims[0].count("boot") == 2


def test_a_claim_ends_when_the_other_program_does() -> None:
    stream = Stream()
    for now_s, stamp, data in sorted(sent(7, 1, 300) + sent(5, 1, 40, 2.0)):
        stream.take(stamp, data, now_s)
        if 2.5 < now_s < 3.9:
            assert stream.is_claimed_twice(now_s)
    assert not stream.is_claimed_twice(15.0)


def test_slow_answers_are_said() -> None:
    stream = Stream()
    found = []
    for k in range(1, 200):
        stream.end.note_sent((1, k), PERIOD_S * k)
        found += stream.take((1, k), b"%d" % k, (PERIOD_S * k), (1, k - 5))
    assert found == ["a packet and its answer take 0.25 s"]
