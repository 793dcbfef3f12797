# SPDX-License-Identifier: Apache-2.0
"""An independent implementation of the serial frames of docs/reference/wire.md.

It works on whole messages with Python's own integers and shares no code with the package.

.venv/bin/python tests/support/serial_oracle.py   rewrites tests/fixtures/serial_frames.txt
"""

import random
import struct
from collections.abc import Iterator
from pathlib import Path

GOLDEN = Path(__file__).parent.parent / "fixtures" / "serial_frames.txt"
KINDS = {
    "packet": 0x01, "bridge_report": 0x02, "board_hello": 0x11, "board_identity": 0x12,
    "board_command": 0x13, "board_reading": 0x14,
}  # fmt: skip
# As the tables of the page number them; H, h: 16 bits, I, i: 32 bits, lower case: signed.
LAYOUTS = {
    "bridge_report": "<IIIIII",
    "board_identity": "<BBBH",
    "board_command": "<BBHhhh",
    "board_reading": "<BBHHhiiHH",
}


def crc(message: bytes) -> int:
    """The remainder of message · x¹⁶, its first 16 bits inverted, by x¹⁶ + x¹² + x⁵ + 1."""
    dividend = int.from_bytes(message, "big") << 16
    dividend ^= 0xFFFF << 8 * len(message)
    divisor = (1 << 16) + (1 << 12) + (1 << 5) + 1
    while dividend.bit_length() > 16:
        dividend ^= divisor << (dividend.bit_length() - 17)
    return dividend


def frame(kind: int, content: bytes) -> bytes:
    """A frame: the groups between zeros, each preceded by its length plus one."""
    plain = bytes([kind]) + content
    plain += crc(plain).to_bytes(2, "little")
    return b"".join(bytes([len(group) + 1]) + group for group in plain.split(b"\0")) + b"\0"


def contents() -> Iterator[tuple[str, bytes]]:
    """Contents of every kind: each number at its limits, and random ones."""
    chance = random.Random(7)
    for size in (0, 1, 32, 63, 64):
        yield "packet", bytes(size)
        if size:
            yield "packet", chance.randbytes(size)
    yield "board_hello", b""
    for kind, layout in LAYOUTS.items():
        for pick in range(12):
            yield kind, struct.pack(layout, *_fields(kind, layout[1:], pick, chance))


def _fields(kind: str, layout: str, pick: int, chance: random.Random) -> Iterator[int]:
    """Numbers for one content: the least, the greatest, or random ones."""
    for place, letter in enumerate(layout):
        bits = {"b": 8, "h": 16, "i": 32}[letter.lower()]
        least, greatest = 0, 2**bits - 1
        if letter.islower():
            least, greatest = -(2 ** (bits - 1)), 2 ** (bits - 1) - 1
        match kind, place:
            case "board_identity", 1:
                greatest = 7
            case "board_identity", 2:
                greatest = 16
            case "board_command", 1:
                greatest = 3
            case "board_command", 2:
                least = 1
            case "board_reading", 1:
                greatest = 1
        yield (least, greatest, chance.randint(least, greatest))[min(pick, 2)]


def golden() -> str:
    """One line for each content."""
    lines = [
        "# Frames of every kind on a serial line, with every number at its limits.",
        "# Written by tests/support/serial_oracle.py, which shares no code with the package:",
        "# kind | numbers, or bytes of a packet | frame",
    ]
    for kind, content in contents():
        layout = LAYOUTS.get(kind)
        said = content.hex(" ") if layout is None else " ".join(map(str, _numbers(kind, content)))
        lines.append(f"{kind} | {said} | {frame(KINDS[kind], content).hex(' ')}")
    return "\n".join(lines) + "\n"


def _numbers(kind: str, content: bytes) -> tuple[int, ...]:
    return struct.unpack(LAYOUTS[kind], content)


if __name__ == "__main__":
    GOLDEN.write_text(golden(), encoding="utf-8")
