# SPDX-License-Identifier: Apache-2.0
"""Packets that the station has not sent, or has sent before: they order nothing."""

from pathlib import Path
from typing import Any

from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.wire import Endpoint, Operate, Packet, encode


def sent_by_a_stranger(pair: SimulatedPair, key: bytes, body: Any, sequence: int) -> None:
    """Packets to both robots as a station would send them, also with right acknowledgements."""
    for side in ("left", "right"):
        for ahead in (0, 5):
            packet = Packet(
                "station", side, pair.pair.settings.pair.number, 2**24 - 1, sequence + ahead,
                (pair.stored[side].epoch, 1), body,
            )  # fmt: skip
            pair.air.send("station", side, encode(packet, key))


def test_a_wrong_key_moves_nothing(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(50)
    wrong = bytes(16)
    assert wrong != pair.pair.key
    operations: tuple[Any, ...] = ("arm", "start", "e_stop", "release")
    for number, operation in enumerate(operations * 5):
        sent_by_a_stranger(pair, wrong, Operate(operation, stop=operation == "e_stop"), number + 1)
        pair.run(20)
        assert pair.modes() == ("disarmed", "disarmed")
    assert all(robot.count(6) >= 40 for robot in pair.robots.values())  # bad_tag


def test_with_the_right_key_the_same_packets_do_stop(tmp_path: Path) -> None:
    """Otherwise the test above could not fail."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(50)
    sent_by_a_stranger(pair, pair.pair.key, Operate("e_stop", stop=True), 1)
    pair.run(5)
    assert pair.modes() == ("stopped", "stopped")


def test_replayed_orders_do_nothing(tmp_path: Path) -> None:
    """Everything that the station has sent is recorded and sent again: after the carry, after a
    stop, and after a reboot of both robots. No robot arms, starts or is released by it."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.after_reboot": "disarm"})
    recorded: list[tuple[str, bytes]] = []
    before = pair.air.send

    def send(sender: str, receiver: str, data: bytes) -> None:
        if sender == "station":
            recorded.append((receiver, data))
        before(sender, receiver, data)

    pair.air.send = send
    pair.start()
    pair.wish("stop", "stopped")
    pair.wish("release", "disarmed")
    pair.start()
    pair.wish("stop", "stopped")
    pair.air.send = before

    def replay() -> set[str]:
        seen: set[str] = set()
        for receiver, data in recorded:
            pair.air.send("station", receiver, data)
            pair.run(1)
            seen |= set(pair.modes())
        return seen

    assert replay() == {"stopped"}
    for side in ("left", "right"):
        pair.boot(side)
    assert replay() == {"stopped"}
    pair.wish("release", "disarmed")
    # An emergency stop counts without a session, and can only stop.
    assert replay() <= {"disarmed", "stopped"}


def test_a_forged_release_does_not_end_an_e_stop(tmp_path: Path) -> None:
    """Bits of a release are changed in every byte, and its tag is that of other packets."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.wish("e_stop", "stopped")
    number = pair.pair.settings.pair.number
    stranger = Endpoint(bytes(range(16)), number, "station", 2**24 - 1)
    forged = stranger.send("left", Operate("release"))
    real: list[bytes] = []
    before = pair.air.send

    def send(sender: str, receiver: str, data: bytes) -> None:
        if (sender, receiver) == ("station", "left"):
            real.append(data)
        before(sender, receiver, data)

    pair.air.send = send
    pair.run(20)
    for k in range(len(forged)):
        changed = real[-1][:k] + bytes([real[-1][k] ^ 1]) + real[-1][k + 1 :]
        mixed = real[-1][:k] + forged[k:]
        for data in (forged, changed, mixed):
            pair.air.send("station", "left", data)
        pair.run(1)
        assert pair.robots["left"].mode == "stopped"
    pair.wish("release", "disarmed")  # a real one does
