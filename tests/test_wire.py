"""The wire against an implementation of its own, golden packets, and what a user may get wrong."""

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
    """What the oracle says in words, as the package says it."""
    words = said.split()
    if kind == "report":
        sign, palm, turned = words
        return wire.Report(int(sign), palm, turned == "turned")  # type: ignore[arg-type]
    if kind == "beacon":
        return wire.Beacon(words[0], "rests" in words, "ready" in words)  # type: ignore[arg-type]
    if kind == "command":
        return wire.Command(*words)  # type: ignore[arg-type]
    return said or None  # type: ignore[return-value]


def packet(saying: oracle.Saying, sent: oracle.Stamp, heard: oracle.Stamp) -> wire.Packet:
    sender, receiver, kind, said = saying
    return wire.Packet(sender, receiver, PAIR, *sent, heard, body(kind, said))  # type: ignore[arg-type]


def test_the_oracle_knows_the_vectors_of_the_authors() -> None:
    told = (ROOT / "tests" / "core" / "siphash24_vectors.hpp").read_text()
    vectors = [bytes.fromhex(digits) for digits in re.findall(r"0x([0-9a-f]{16})", told)]
    assert len(vectors) == 64
    for n, vector in enumerate(vectors):
        tag = oracle.siphash24(bytes(range(16)), bytes(range(n)))
        assert tag.to_bytes(8, "little") == vector, n


def test_golden_packets() -> None:
    """A change of the format is a new version; then: .venv/bin/python tests/wire_oracle.py."""
    lines = oracle.GOLDEN.read_text(encoding="utf-8").splitlines()
    lines = [line for line in lines if not line.startswith("#")]
    assert len(lines) == len(oracle.sayings()) == 88
    for line, saying in zip(lines, oracle.sayings(), strict=True):
        who, *stamps, told = line.split(" | ")
        sender, receiver, kind, said = saying
        assert who.split() == [sender, ">", receiver, kind, *said.split()]
        sent, heard = ((int(a), int(b)) for a, b in (stamp.split() for stamp in stamps))
        data = bytes.fromhex(told)
        one = packet(saying, sent, heard)
        assert one.kind == kind
        assert wire.encode(one, KEY) == data
        assert wire.decode(data, KEY, PAIR, one.receiver) == wire.Decoded("accepted", one)


def test_random_packets_as_the_oracle_writes_them() -> None:
    chance = random.Random(1)
    for _ in range(2000):
        saying = chance.choice(oracle.sayings())
        key, pair = chance.randbytes(16), chance.randrange(2**16)
        sent, heard = ((chance.randrange(1, 2**24), chance.randrange(1, 2**32)) for _ in "sh")
        told = oracle.packet(saying, sent, heard, key, pair)
        one = replace(packet(saying, sent, heard), pair=pair)
        assert wire.encode(one, key) == told
        assert wire.decode(told, key, pair, one.receiver).packet == one


def test_any_tagged_bytes_as_the_oracle_judges_them() -> None:
    """With a right tag, what decodes is exactly what the oracle can say."""
    known = {
        told[:3] + told[19:20]
        for told in (oracle.packet(saying, (1, 1), (0, 0)) for saying in oracle.sayings())
    }
    chance = random.Random(2)
    verdicts = set()
    for _ in range(20000):
        head = bytearray(oracle.packet(chance.choice(oracle.sayings()), (1, 1), (0, 0))[:20])
        for place in chance.sample((1, 2, 19), chance.randrange(3)):
            head[place] = chance.choice((chance.randrange(256), chance.randrange(8)))
        data = bytes(head) + oracle.siphash24(KEY, bytes(head)).to_bytes(8, "little")
        # The receiver that the packet names; what names none is for nobody.
        named = head[2] >> 4
        receiver = get_args(wire.Role)[named] if named < 3 else "left"
        verdict = wire.decode(data, KEY, PAIR, receiver).verdict
        legal = bytes(head[:3]) + bytes(head[19:20]) in known
        wanted = "misdirected" if named >= 3 else "accepted" if legal else "malformed"
        assert verdict == wanted, data.hex()
        verdicts.add(verdict)
    assert verdicts == {"accepted", "malformed", "misdirected"}


def test_a_talk_is_counted() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(left.send("right")).verdict == "unanswered"
    hello = right.send("left")
    assert hello == oracle.packet(("right", "left", "hello", ""), (8, 1), (3, 1))
    assert left.receive(hello) == wire.Decoded(
        "accepted", wire.Packet("right", "left", PAIR, epoch=8, sequence=1, heard=(3, 1))
    )
    ack = left.send("right", "Ack")
    assert ack == oracle.packet(("left", "right", "letter", "Ack"), (3, 2), (8, 1))
    got = right.receive(ack).packet
    assert got is not None and got.body == "Ack"
    forged = ack[:-1] + bytes([ack[-1] ^ 1])
    stranger = wire.Endpoint(KEY, PAIR + 1, "left", 3)
    newer = bytes([2]) + ack
    for data in (ack, ack, forged, ack[:27], ack + b"0", b"", newer, stranger.send("right"), hello):
        assert right.receive(data).packet is None
    wanted = dict.fromkeys(right.counts, 0) | {
        "unanswered": 1, "accepted": 1, "stale": 2, "forged": 1, "too_short": 2, "too_long": 1,
        "other_version": 1, "stranger": 1, "misdirected": 1,
    }  # fmt: skip
    assert right.counts == wanted


def test_epochs_of_boots() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    before = left.send("right", wire.Beacon("R"))
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "unanswered"
    assert right.receive(before).verdict == "stale"
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "stale"


def test_an_end_that_has_used_up_its_numbers_says_what_to_do() -> None:
    """In C++ they are used up in no time (tests/core/endpoint_test.cpp); here the core refuses."""
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    left._core = SimpleNamespace(send=lambda *_: None)  # type: ignore[assignment]
    with pytest.raises(pb.PalmbotsError, match=r"^sequence: all 4294967295 are used up; needed: "):
        left.send("right")


GOOD = wire.Packet("left", "right", PAIR, epoch=1, sequence=1)
LEGAL = 'allowed: "TiltUp", "TiltDown", "Ack", or a Beacon, Report, Command or None'


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"epoch": 0}, "epoch: value is 0; allowed: 1 to 16777215"),
        ({"epoch": 2**24}, "epoch: value is 16777216; allowed: 1 to 16777215"),
        ({"heard": (0, 1)}, "heard epoch: value is 0; allowed: 1 to 16777215"),
        ({"heard": (1, 0)}, "heard sequence: value is 0; allowed: 1 to 4294967295"),
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
def test_what_cannot_be_said(change: dict[str, object], message: str) -> None:
    with pytest.raises(pb.PalmbotsError) as error:
        wire.encode(replace(GOOD, **change), KEY)  # type: ignore[arg-type]
    assert str(error.value) == message


def test_keys_and_ends_that_are_none() -> None:
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
    with pytest.raises(pb.PalmbotsError, match=r'^sender of a letter: value is "station"; '):
        wire.Endpoint(KEY, PAIR, "station", 1).send("left", "Ack")
