# SPDX-License-Identifier: Apache-2.0
"""An independent implementation of docs/reference/wire.md with plain integers.

.venv/bin/python tests/support/wire_oracle.py     rewrites tests/fixtures/wire_packets.txt
"""

from pathlib import Path

GOLDEN = Path(__file__).parent.parent / "fixtures" / "wire_packets.txt"
KEY = bytes.fromhex("0f1e2d3c4b5a69788796a5b4c3d2e1f0")
PAIR = 0xC0DE
MASK = 2**64 - 1


def siphash24(key: bytes, text: bytes) -> int:
    """SipHash-2-4 after section 2 of Aumasson and Bernstein (2012)."""

    def rotl(x: int, n: int) -> int:
        return (x << n | x >> (64 - n)) & MASK

    def rounds(n: int) -> None:
        a, b, c, d = v
        for _ in range(n):
            a, c = (a + b) & MASK, (c + d) & MASK
            b, d = rotl(b, 13) ^ a, rotl(d, 16) ^ c
            a = rotl(a, 32)
            c, a = (c + b) & MASK, (a + d) & MASK
            b, d = rotl(b, 17) ^ c, rotl(d, 21) ^ a
            c = rotl(c, 32)
        v[:] = a, b, c, d

    k = [int.from_bytes(key[:8], "little"), int.from_bytes(key[8:], "little")] * 2
    start = b"somepseudorandomlygeneratedbytes"
    v = [k[i] ^ int.from_bytes(start[8 * i : 8 * i + 8], "big") for i in range(4)]
    padded = text + bytes(-(len(text) + 1) % 8) + bytes([len(text) % 256])
    for i in range(0, len(padded), 8):
        word = int.from_bytes(padded[i : i + 8], "little")
        v[3] ^= word
        rounds(2)
        v[0] ^= word
    v[2] ^= 0xFF
    rounds(4)
    return v[0] ^ v[1] ^ v[2] ^ v[3]


ROLES = {"left": 0, "right": 1, "station": 2}
MESSAGES = {"TiltUp": 1, "TiltDown": 2, "Ack": 3}
PALMS = {"steep": 0, "shallow": 1}
MOVES = {"hold": 0, "away": 1, "closer": 2}

Stamp = tuple[int, int]
"""Epoch and sequence."""
Content = tuple[str, str, str, str]
"""Sender, receiver, kind and content, in words."""


def contents() -> list[Content]:
    """Every packet that is allowed."""
    all_of: list[Content] = [(a, b, "hello", "") for a in ROLES for b in ROLES if a != b]
    for sender, receiver in (("left", "right"), ("right", "left")):
        all_of += [(sender, receiver, "message", message) for message in MESSAGES]
        all_of += [
            (sender, receiver, "beacon", f"{letter} {ready} {travel}")
            for letter in "IRGDW"
            for ready in ("unready", "ready")
            for travel in ("travels", "stopped")
        ]
    for robot in ("left", "right"):
        for palm in PALMS:
            all_of += [
                (robot, "station", "report", f"{sign} {palm} {progress}")
                for sign in ("-1", "0", "1")
                for progress in ("turning", "at-target")
            ]
            all_of += [("station", robot, "command", f"{palm} {move}") for move in MOVES]
    for sender, receiver in (("left", "right"), ("right", "left")):
        words = ("0", "-1 steep", "-1 shallow", "1 steep", "1 shallow")
        all_of += [(sender, receiver, "sign", word) for word in words]
    return all_of


def payload(kind: str, said: str) -> tuple[int, int]:
    """The bytes `kind` and `payload`."""
    words = said.split()
    match kind:
        case "hello":
            return 0, 0
        case "message":
            return 1, MESSAGES[said]
        case "beacon":
            return 2, ord(words[0]) + 32 * ("ready" in words) + 128 * ("stopped" in words)
        case "sign":
            return 5, int(words[0]) + 1 + 4 * (words[-1] == "shallow")
        case "report":
            sign, palm, progress = words
            return 3, int(sign) + 1 + 4 * PALMS[palm] + 8 * (progress == "at-target")
        case _:
            palm, move = words
            return 4, PALMS[palm] + 2 * MOVES[move]


def packet(
    content: Content, sent: Stamp, acknowledged: Stamp, key: bytes = KEY, pair: int = PAIR
) -> bytes:
    """The packet's 28 bytes."""
    sender, receiver, kind, said = content
    head = bytearray(20)
    head[0] = 1
    head[1], head[19] = payload(kind, said)
    head[2] = ROLES[sender] + 16 * ROLES[receiver]
    head[3:5] = pair % 256, pair // 256
    for place, (epoch, sequence) in ((5, sent), (12, acknowledged)):
        head[place : place + 3] = (epoch >> shift & 255 for shift in (0, 8, 16))
        head[place + 3 : place + 7] = (sequence >> shift & 255 for shift in (0, 8, 16, 24))
    tag = siphash24(key, bytes(head))
    return bytes(head) + bytes(tag >> shift & 255 for shift in range(0, 64, 8))


def golden() -> str:
    """One line for each allowed packet, with numbers at and between their limits."""
    lines = [
        "# Every allowed packet, key 0f1e2d3c4b5a69788796a5b4c3d2e1f0, pair c0de.",
        "# Written by tests/support/wire_oracle.py, which shares no code with the package:",
        "# sender > receiver kind content | sent | acknowledged | bytes",
    ]
    for i, content in enumerate(contents()):
        last = (2**24 - 1, 2**32 - 1)
        between = ((0x010203, 0x04050607), (0x08090A, 0x0B0C0D0E))
        sent, acknowledged = (((1, 1), (0, 0)), between, (last, last))[i % 3]
        sender, receiver, *what = content
        words = " ".join(word for word in what if word)
        data = packet(content, sent, acknowledged).hex(" ")
        numbers = f"{sent[0]} {sent[1]} | {acknowledged[0]} {acknowledged[1]}"
        lines.append(f"{sender} > {receiver} {words} | {numbers} | {data}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    GOLDEN.write_text(golden(), encoding="utf-8")
