# SPDX-License-Identifier: Apache-2.0
"""Frames on a serial line against an independent implementation, byte by byte."""

import random
import re
from pathlib import Path
from typing import Any

import pytest

import serial_oracle
from palmbots.wire.serial_frames import (
    FRAME_NUMBERS,
    MAX_CONTENT,
    BoardCommand,
    BoardIdentity,
    BoardReading,
    BridgeReport,
    Content,
    FrameDecoder,
    content_of,
    encode_frame,
    frame_of,
)

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "wire.md"
LINES = [
    line.split(" | ")
    for line in serial_oracle.GOLDEN.read_text(encoding="utf-8").splitlines()
    if not line.startswith("#")
]


def made(kind: str, numbers: list[int]) -> Content:
    """The content of the package for the numbers of a golden line."""
    flags = [bool(numbers[1] & 1 << bit) for bit in range(3)]
    match kind:
        case "bridge_report":
            return BridgeReport(*numbers)
        case "board_identity":
            return BoardIdentity(numbers[0], *flags, *numbers[2:])
        case "board_command":
            return BoardCommand(numbers[0], *flags[:2], *numbers[2:])
        case _:
            return BoardReading(numbers[0], flags[0], *numbers[2:])


def test_golden_frames_are_those_of_the_oracle() -> None:
    assert serial_oracle.GOLDEN.read_text(encoding="utf-8") == serial_oracle.golden()
    assert {line[0] for line in LINES} == {*FRAME_NUMBERS}
    assert dict(FRAME_NUMBERS) == serial_oracle.KINDS


@pytest.mark.parametrize("line", LINES, ids=lambda line: line[0])
def test_frames_are_the_golden_ones(line: list[Any]) -> None:
    kind, said, golden = line
    frame = bytes.fromhex(golden)
    decoder = FrameDecoder()
    ((number, content),) = decoder.take(frame)
    assert number == FRAME_NUMBERS[kind]
    assert decoder.damaged == 0
    if kind in serial_oracle.LAYOUTS:
        expected = made(kind, [*map(int, said.split())])
        assert frame_of(expected) == frame
        assert content_of(number, content) == expected
    else:
        assert encode_frame(kind, bytes.fromhex(said)) == frame
        assert content == bytes.fromhex(said)
        assert content_of(number, content) is None


def test_random_frames_in_pieces() -> None:
    chance = random.Random(3)
    stream, sent = b"", []
    for _ in range(300):
        kind, content = chance.randrange(256), chance.randbytes(chance.randrange(MAX_CONTENT + 1))
        if chance.random() < 0.5:
            content = bytes(byte if byte > 128 else 0 for byte in content)
        stream += serial_oracle.frame(kind, content) + bytes(chance.randrange(3))
        sent.append((kind, content))
    decoder, found = FrameDecoder(), []
    while stream:
        size = chance.randrange(1, 100)
        found += decoder.take(stream[:size])
        stream = stream[size:]
    assert found == sent
    assert decoder.damaged == 0


def test_damage_is_counted_and_the_next_frame_is_found() -> None:
    chance = random.Random(4)
    decoder = FrameDecoder()
    for _ in range(500):
        frame = bytearray(serial_oracle.frame(1, chance.randbytes(32)))
        place = chance.randrange(len(frame) - 1)
        frame[place] = (frame[place] + chance.randrange(1, 255)) % 255 + 1  # never zero
        good = serial_oracle.frame(20, b"good")
        assert decoder.take(bytes(frame) + good)[-1] == (20, b"good")
    assert decoder.damaged > 490


@pytest.mark.parametrize(
    ("kind", "content"),
    [
        ("board_command", "00 04 64 00 00 00 00 00 00 00"),  # an unknown flag
        ("board_command", "00 00 00 00 00 00 00 00 00 00"),  # a watchdog of 0
        ("board_command", "00 00 64 00 00 00 00 00 00"),
        ("board_identity", "01 08 09 00 01"),
        ("board_identity", "01 00 11 00 01"),
        ("board_reading", "00 02" + " 00" * 18),
        ("bridge_report", "00" * 23),
    ],
)
def test_malformed_content_is_refused(kind: str, content: str) -> None:
    assert content_of(serial_oracle.KINDS[kind], bytes.fromhex(content)) is None


def test_the_page_has_every_kind() -> None:
    rows = re.findall(r"^\| `([0-9a-f]{2})` \| (\w[\w ]*) \|", PAGE.read_text(), re.MULTILINE)
    named = {name.replace(" ", "_"): int(number, 16) for number, name in rows}
    assert named == serial_oracle.KINDS
