# SPDX-License-Identifier: Apache-2.0
"""Packets against an independent implementation and golden packets; refusals of wrong arguments."""

import random
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import get_args

import pytest

import palmbots as pb
import wire_oracle as oracle
from cxx import ROOT
from palmbots import wire

KEY, PAIR = oracle.KEY, oracle.PAIR


def body(kind: str, said: str) -> wire.Body:
    """The body for the words of the oracle."""
    words = said.split()
    if kind == "report":
        sign, palm, progress = words
        return wire.Report(int(sign), palm, progress == "at-target")  # type: ignore[arg-type]
    if kind == "beacon":
        return wire.Beacon(words[0], "stopped" in words, "ready" in words)  # type: ignore[arg-type]
    if kind == "sign":
        return wire.SignWord(int(words[0]), words[-1] if len(words) > 1 else "steep")  # type: ignore[arg-type]
    if kind == "command":
        return wire.Command(*words)  # type: ignore[arg-type]
    return said or None  # type: ignore[return-value]


def packet(content: oracle.Content, sent: oracle.Stamp, acknowledged: oracle.Stamp) -> wire.Packet:
    sender, receiver, kind, said = content
    return wire.Packet(sender, receiver, PAIR, *sent, acknowledged, body(kind, said))  # type: ignore[arg-type]


def test_siphash_of_the_oracle_matches_the_published_vectors() -> None:
    text = (ROOT / "tests" / "cpp" / "support" / "siphash24_vectors.hpp").read_text()
    vectors = [bytes.fromhex(digits) for digits in re.findall(r"0x([0-9a-f]{16})", text)]
    assert len(vectors) == 64
    for n, vector in enumerate(vectors):
        tag = oracle.siphash24(bytes(range(16)), bytes(range(n)))
        assert tag.to_bytes(8, "little") == vector, n


def test_golden_packets() -> None:
    """A change of the format is a new version (then run tests/support/wire_oracle.py)."""
    lines = oracle.GOLDEN.read_text(encoding="utf-8").splitlines()
    lines = [line for line in lines if not line.startswith("#")]
    assert len(lines) == len(oracle.contents()) == 98
    for line, content in zip(lines, oracle.contents(), strict=True):
        who, *stamps, digits = line.split(" | ")
        sender, receiver, kind, said = content
        assert who.split() == [sender, ">", receiver, kind, *said.split()]
        sent, acknowledged = ((int(a), int(b)) for a, b in (stamp.split() for stamp in stamps))
        data = bytes.fromhex(digits)
        one = packet(content, sent, acknowledged)
        assert one.kind == kind
        assert wire.encode(one, KEY) == data
        assert wire.decode(data, KEY, PAIR, one.receiver) == wire.Decoded("accepted", one)


def test_random_packets_equal_those_of_the_oracle() -> None:
    chance = random.Random(1)
    for _ in range(2000):
        content = chance.choice(oracle.contents())
        key, pair = chance.randbytes(16), chance.randrange(2**16)
        sent, acknowledged = (
            (chance.randrange(1, 2**24), chance.randrange(1, 2**32)) for _ in "sh"
        )
        data = oracle.packet(content, sent, acknowledged, key, pair)
        one = replace(packet(content, sent, acknowledged), pair=pair)
        assert wire.encode(one, key) == data
        assert wire.decode(data, key, pair, one.receiver).packet == one


def test_tagged_bytes_decode_exactly_if_the_oracle_allows_them() -> None:
    """With a valid tag, exactly the packets of the oracle decode."""
    known = {
        data[:3] + data[19:20]
        for data in (oracle.packet(content, (1, 1), (0, 0)) for content in oracle.contents())
    }
    chance = random.Random(2)
    verdicts = set()
    for _ in range(20000):
        head = bytearray(oracle.packet(chance.choice(oracle.contents()), (1, 1), (0, 0))[:20])
        for place in chance.sample((1, 2, 19), chance.randrange(3)):
            head[place] = chance.choice((chance.randrange(256), chance.randrange(8)))
        data = bytes(head) + oracle.siphash24(KEY, bytes(head)).to_bytes(8, "little")
        # The receiver is the role that the packet names, if it names one.
        named = head[2] >> 4
        receiver = get_args(wire.Role)[named] if named < 3 else "left"
        verdict = wire.decode(data, KEY, PAIR, receiver).verdict
        legal = bytes(head[:3]) + bytes(head[19:20]) in known
        wanted = "wrong_receiver" if named >= 3 else "accepted" if legal else "malformed"
        assert verdict == wanted, data.hex()
        verdicts.add(verdict)
    assert verdicts == {"accepted", "malformed", "wrong_receiver"}


def test_endpoint_counts_every_verdict() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(left.send("right")).verdict == "no_session"
    hello = right.send("left")
    assert hello == oracle.packet(("right", "left", "hello", ""), (8, 1), (3, 1))
    assert left.receive(hello) == wire.Decoded(
        "accepted", wire.Packet("right", "left", PAIR, epoch=8, sequence=1, acknowledged=(3, 1))
    )
    ack = left.send("right", "Ack")
    assert ack == oracle.packet(("left", "right", "message", "Ack"), (3, 2), (8, 1))
    got = right.receive(ack).packet
    assert got is not None and got.body == "Ack"
    forged = ack[:-1] + bytes([ack[-1] ^ 1])
    stranger = wire.Endpoint(KEY, PAIR + 1, "left", 3)
    newer = bytes([2]) + ack
    for data in (ack, ack, forged, ack[:27], ack + b"0", b"", newer, stranger.send("right"), hello):
        assert right.receive(data).packet is None
    wanted = dict.fromkeys(right.counts, 0) | {
        "no_session": 1, "accepted": 1, "stale": 2, "bad_tag": 1, "too_short": 2, "too_long": 1,
        "wrong_version": 1, "wrong_pair": 1, "wrong_receiver": 1,
    }  # fmt: skip
    assert right.counts == wanted


def test_packets_of_an_earlier_epoch_are_stale() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    before = left.send("right", wire.Beacon("R"))
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "no_session"
    assert right.receive(before).verdict == "stale"
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "stale"


def test_used_up_sequence_numbers_are_refused() -> None:
    """tests/cpp/wire/endpoint_test.cpp uses up the real numbers."""
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    left._core = SimpleNamespace(send=lambda *_: None)  # type: ignore[assignment]
    with pytest.raises(pb.PalmbotsError, match=r"^sequence: all 4294967295 are used up; needed: "):
        left.send("right")


GOOD = wire.Packet("left", "right", PAIR, epoch=1, sequence=1)
LEGAL = 'allowed: "TiltUp", "TiltDown", "Ack", or a Beacon, Report, Command, SignWord or None'


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"epoch": 0}, "epoch: value is 0; allowed: 1 to 16777215"),
        ({"epoch": 2**24}, "epoch: value is 16777216; allowed: 1 to 16777215"),
        ({"acknowledged": (0, 1)}, "acknowledged epoch: value is 0; allowed: 1 to 16777215"),
        ({"acknowledged": (1, 0)}, "acknowledged sequence: value is 0; allowed: 1 to 4294967295"),
        (
            {"body": wire.Beacon("X")},  # type: ignore[arg-type]
            'letter of a beacon: value is "X"; allowed: "I", "R", "G", "D", "W"',
        ),
        ({"sequence": 0}, "sequence: value is 0; allowed: 1 to 4294967295"),
        ({"sequence": True}, "sequence: value is true; allowed: 1 to 4294967295"),
        ({"pair": 65536}, "pair: value is 65536; allowed: 0 to 65535"),
        ({"sender": "top"}, 'sender: value is "top"; allowed: "left", "right", "station"'),
        ({"receiver": "left"}, 'receiver: value is "left"; allowed: "right", "station"'),
        ({"body": "tiltup"}, f'body: value is "tiltup"; {LEGAL}'),
        ({"body": 1}, f"body: value is 1; {LEGAL}"),
        (
            {"body": wire.Beacon("R"), "receiver": "station"},
            'receiver: value is "station"; allowed: "right"',
        ),
        (
            {"body": wire.Command("steep", "hold")},
            'sender of a command: value is "left"; allowed: "station"',
        ),
        (
            {"body": wire.Report(0, "steep", True)},
            'receiver: value is "right"; allowed: "station"',
        ),
        (
            {"body": wire.Report(2, "steep", True), "receiver": "station"},  # type: ignore[arg-type]
            "sign: value is 2; allowed: -1, 0, 1",
        ),
        (
            {"body": wire.Command("flat", "hold"), "sender": "station"},  # type: ignore[arg-type]
            'palm: value is "flat"; allowed: "steep", "shallow"',
        ),
    ],
)
def test_packets_that_are_not_allowed_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(pb.PalmbotsError) as error:
        wire.encode(replace(GOOD, **change), KEY)  # type: ignore[arg-type]
    assert str(error.value) == message


def test_invalid_keys_and_roles_are_refused() -> None:
    for key in (b"", KEY[:15], KEY + b"0", "0123456789abcdef"):
        with pytest.raises(pb.PalmbotsError, match=r"^key: is not 16 bytes; allowed: "):
            wire.encode(GOOD, key)  # type: ignore[arg-type]
        with pytest.raises(pb.PalmbotsError, match=r"^key: "):
            wire.decode(bytes(28), key, PAIR, "left")  # type: ignore[arg-type]
        with pytest.raises(pb.PalmbotsError, match=r"^key: "):
            wire.Endpoint(key, PAIR, "left", 1)  # type: ignore[arg-type]
    with pytest.raises(pb.PalmbotsError, match=r'^role: value is "up"; allowed: "left", '):
        wire.Endpoint(KEY, PAIR, "up", 1)  # type: ignore[arg-type]
    with pytest.raises(pb.PalmbotsError, match=r"^epoch: value is 0; allowed: 1 to 16777215$"):
        wire.Endpoint(KEY, PAIR, "left", 0)
    with pytest.raises(pb.PalmbotsError, match=r'^sender of a message: value is "station"; '):
        wire.Endpoint(KEY, PAIR, "station", 1).send("left", "Ack")
