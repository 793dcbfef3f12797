# SPDX-License-Identifier: Apache-2.0
"""Packets against an independent implementation and golden packets; refusals of wrong arguments."""

import random
import re
from collections import Counter
from dataclasses import replace
from itertools import product
from types import SimpleNamespace
from typing import Any, get_args

import pytest

import palmbots as pb
import wire_oracle as oracle
from cxx import ROOT
from palmbots import wire
from sampled import amounts

KEY, PAIR = oracle.KEY, oracle.PAIR


def body(kind: str, said: tuple[str, ...]) -> wire.Body:
    """The body for the words of the oracle."""
    field: dict[str, object] = {}
    for name, value in zip(oracle.FIELDS[kind], said, strict=True):
        if name == "said":
            field["language"], field["message"] = value.split(":")
        elif value in ("no", "yes"):
            field[name] = value == "yes"
        else:
            field[name] = int(value) if name in ("settings", "sign", "value", "steps") else value
    return getattr(wire, kind.capitalize())(**field)


def packet(content: oracle.Content, sent: oracle.Stamp, acknowledged: oracle.Stamp) -> wire.Packet:
    sender, receiver, kind, said = content
    return wire.Packet(sender, receiver, PAIR, *sent, acknowledged, body(kind, said))


def test_siphash_of_the_oracle_matches_the_published_vectors() -> None:
    text = (ROOT / "tests" / "cpp" / "support" / "siphash24_vectors.hpp").read_text()
    vectors = [bytes.fromhex(digits) for digits in re.findall(r"0x([0-9a-f]{16})", text)]
    assert len(vectors) == 64
    for n, vector in enumerate(vectors):
        tag = oracle.siphash24(bytes(range(16)), bytes(range(n)))
        assert tag.to_bytes(8, "little") == vector, n


@pytest.mark.slow
def test_golden_packets() -> None:
    """A change of the format is a new version (then run tests/support/wire_oracle.py)."""
    assert oracle.GOLDEN.read_text(encoding="utf-8") == oracle.golden()
    for i, content in enumerate(oracle.contents()):
        line = oracle.golden().splitlines()[4 + i]
        _, *stamps, digits = line.split(" | ")
        sent, acknowledged = ((int(a), int(b)) for a, b in (stamp.split() for stamp in stamps))
        data = bytes.fromhex(digits)
        one = packet(content, sent, acknowledged)
        assert one.kind == content[2]
        assert wire.encode(one, KEY) == data
        assert wire.decode(data, KEY, PAIR, one.receiver) == wire.Decoded("accepted", one)


def test_no_end_sends_what_it_may_not_say() -> None:
    """The oracle has a packet of every kind from every sender to every receiver that is allowed."""
    said = {kind: content for *_, kind, content in oracle.contents()}
    allowed = {content[:3] for content in oracle.contents()}
    for sender, receiver, kind in product(get_args(wire.Role), get_args(wire.Role), said):
        end = wire.Endpoint(KEY, PAIR, sender, 1)
        if (sender, receiver, kind) in allowed:
            end.send(receiver, body(kind, said[kind]))
            continue
        with pytest.raises(pb.PalmbotsError, match=r"; allowed: "):
            end.send(receiver, body(kind, said[kind]))


def test_golden_packets_have_every_value_of_every_field() -> None:
    for kind, fields in oracle.FIELDS.items():
        for direction in oracle.DIRECTIONS[kind]:
            said = [one[3] for one in oracle.contents() if one[:3] == (*direction, kind)]
            for place, values in enumerate(fields.values()):
                assert {words[place] for words in said} == set(values)


def test_random_packets_equal_those_of_the_oracle() -> None:
    chance = random.Random(1)
    for _ in range(2000):
        content = oracle.random_content(chance)
        key, pair = chance.randbytes(16), chance.randrange(2**16)
        sent, acknowledged = (
            (chance.randrange(1, 2**24), chance.randrange(1, 2**32)) for _ in "sh"
        )
        data = oracle.packet(content, sent, acknowledged, key, pair)
        one = replace(packet(content, sent, acknowledged), pair=pair)
        assert wire.encode(one, key) == data
        assert wire.decode(data, key, pair, one.receiver).packet == one


@pytest.mark.parametrize("cases", amounts(6000, 30000))
def test_tagged_bytes_decode_exactly_if_the_oracle_allows_them(cases: int) -> None:
    """With a valid tag, exactly the packets of the oracle decode."""
    chance = random.Random(2)
    verdicts: Counter[tuple[str, int]] = Counter()
    for _ in range(cases):
        head = bytearray(oracle.packet(oracle.random_content(chance), (1, 1), (0, 0))[:24])
        for place in chance.sample((1, 2, *range(19, 24)), chance.randrange(3)):
            head[place] = chance.choice((chance.randrange(256), chance.randrange(8)))
        data = bytes(head) + oracle.siphash24(KEY, bytes(head)).to_bytes(8, "little")
        # The receiver is the role that the packet names, if it names one.
        sender, named = head[2] % 16, head[2] >> 4
        receiver = get_args(wire.Role)[named] if named < 3 else "left"
        verdict = wire.decode(data, KEY, PAIR, receiver).verdict
        legal = oracle.is_allowed(head[1], sender, named, bytes(head[19:24]))
        wanted = "wrong_receiver" if named >= 3 else "accepted" if legal else "malformed"
        assert verdict == wanted, data.hex()
        verdicts[verdict, head[1]] += 1
    for kind in range(6):
        assert verdicts["accepted", kind] > cases / 300
        assert verdicts["malformed", kind] > cases / 300


def test_endpoint_counts_every_verdict() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(left.send("right")).verdict == "no_session"
    hello = right.send("left")
    assert hello == oracle.packet(("right", "left", "hello", ("0", "no")), (8, 1), (3, 1))
    assert left.receive(hello) == wire.Decoded(
        "accepted", wire.Packet("right", "left", PAIR, epoch=8, sequence=1, acknowledged=(3, 1))
    )
    ack = left.send("right", wire.State("messages", "Ack"))
    said = ("messages:Ack", "carrying", "no", "no", "no")
    assert ack == oracle.packet(("left", "right", "state", said), (3, 2), (8, 1))
    got = right.receive(ack).packet
    assert got is not None and got.body == wire.State("messages", "Ack")
    forged = ack[:-1] + bytes([ack[-1] ^ 1])
    stranger = wire.Endpoint(KEY, PAIR + 1, "left", 3)
    newer = bytes([4]) + ack
    for data in (ack, ack, forged, ack[:31], ack + b"0", b"", newer, stranger.send("right"), hello):
        assert right.receive(data).packet is None
    wanted = dict.fromkeys(right.counts, 0) | {
        "no_session": 1, "accepted": 1, "stale": 2, "bad_tag": 1, "too_short": 2, "too_long": 1,
        "wrong_version": 1, "wrong_pair": 1, "wrong_receiver": 1,
    }  # fmt: skip
    assert right.counts == wanted


def test_each_receiver_has_its_own_sequence_which_may_skip_numbers() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    left.skip_to("right", 500)
    assert left.send("right")[8:12] == (500).to_bytes(4, "little")
    assert left.send("station")[8:12] == (1).to_bytes(4, "little")
    left.skip_to("right", 500)  # has been used
    assert left.send("right")[8:12] == (501).to_bytes(4, "little")


def test_claimed_epoch_shows_an_end_that_its_counter_is_behind() -> None:
    robot = wire.Endpoint(KEY, PAIR, "left", 3)
    robot.receive(wire.Endpoint(KEY, PAIR, "station", 9).send("left"))
    station = wire.Endpoint(KEY, PAIR, "station", 1)
    assert station.claimed_epoch("left") == 0
    assert station.receive(robot.send("station")).verdict == "no_session"
    assert (station.claimed_epoch("left"), station.claimed_epoch("right")) == (9, 0)


def test_packets_of_an_earlier_epoch_are_stale() -> None:
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    before = left.send("right", wire.State("beacons", "TiltUp"))
    right = wire.Endpoint(KEY, PAIR, "right", 8)
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "no_session"
    assert right.receive(before).verdict == "stale"
    assert right.receive(wire.Endpoint(KEY, PAIR, "left", 4).send("right")).verdict == "stale"


def test_used_up_sequence_numbers_are_refused() -> None:
    """tests/cpp/wire/endpoint_test.cpp uses up the real numbers."""
    left = wire.Endpoint(KEY, PAIR, "left", 3)
    core: Any = SimpleNamespace(send=lambda *_: None)
    left._core = core
    with pytest.raises(pb.PalmbotsError, match=r"^sequence: all 4294967295 are used up; needed: "):
        left.send("right")
