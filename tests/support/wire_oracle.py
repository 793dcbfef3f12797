# SPDX-License-Identifier: Apache-2.0
"""An independent implementation of docs/reference/wire.md with plain integers.

.venv/bin/python tests/support/wire_oracle.py     rewrites tests/fixtures/wire_packets.txt
"""

import random
from pathlib import Path
from typing import Any

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
KINDS = {"hello": 0, "state": 1, "status": 2, "operate": 3, "report": 4, "command": 5,
         "phase": 6}  # fmt: skip
MESSAGES = {
    "none": [""],
    "messages": ["TiltUp", "TiltDown", "Ack"],
    "beacons": ["TiltUp", "TiltDown", "Ack", "Closing", "Raised"],
    "signs": ["Zero", "Plus", "PlusShallow", "Minus", "MinusShallow"],
}
PHASES = ["Docking", "Under", "Centring", "Ready", "Raising", "Lifted", "Carrying", "Arrived",
          "Lowering", "Down", "Leaving", "Empty", "Backing", "Holding"]  # fmt: skip
MESSAGE_NUMBERS = {
    message: n for n, message in enumerate(["", *MESSAGES["beacons"], *MESSAGES["signs"], *PHASES])
}
MODES = ["off", "disarmed", "armed", "ready", "carrying", "holding", "done", "stopped", "fault"]
FAULTS = ["none", "driver", "contact", "palm", "battery", "partner_lost", "station_lost",
          "time_limit", "overrun", "storage", "settings", "stopping", "partner",
          "stop", "arm", "job"]  # fmt: skip
OPERATIONS = ["arm", "disarm", "start", "stop", "e_stop", "release"]
PALMS = {"steep": 0, "shallow": 1}
MOVES = {"hold": 0, "away": 1, "closer": 2}
CASES = " abcd12345678"
ITEMS = ["progress", "battery", "overruns", "sent", "phase",
         "accepted", "wrong_version", "too_short", "too_long", "wrong_pair",
         "wrong_receiver", "bad_tag", "malformed", "stale", "no_session"]  # fmt: skip

Stamp = tuple[int, int]
"""Epoch and sequence."""
Content = tuple[Any, Any, str, tuple[str, ...]]
"""Sender, receiver, kind, and the values of the kind's fields, in words."""

# The fields of each kind, with the values that they may have.
NO_YES = ["no", "yes"]
FIELDS: dict[str, dict[str, list[str]]] = {
    "hello": {"settings": ["0", "1", "67305985", "4294967295"], "stop": NO_YES},
    "state": {
        "said": [f"{talk}:{message}" for talk, known in MESSAGES.items() for message in known],
        "mode": MODES, "ready": NO_YES, "at_rest": NO_YES, "stop": NO_YES,
    },
    "status": {
        "mode": MODES, "fault": FAULTS, "sign": ["-1", "0", "1"], "palm": [*PALMS],
        "palm_at_target": NO_YES, "case": [*CASES], "item": ITEMS,
        "value": ["0", "1", "513", "65535"], "ready": NO_YES, "at_rest": NO_YES, "stop": NO_YES,
    },
    "operate": {"operation": OPERATIONS, "stop": NO_YES},
    "report": {
        "sign": ["-1", "0", "1"], "palm": [*PALMS], "palm_at_target": NO_YES, "stop": NO_YES,
    },
    "command": {"palm": [*PALMS], "move": [*MOVES], "stop": NO_YES},
    "phase": {
        "message": PHASES, "mode": MODES, "steps": ["0", "1", "2", "3"], "stop": NO_YES,
    },
}  # fmt: skip
ROBOT_PAIRS = [("left", "right"), ("right", "left")]
UP = [("left", "station"), ("right", "station")]
DOWN = [("station", "left"), ("station", "right")]
DIRECTIONS = {
    "hello": ROBOT_PAIRS + UP + DOWN, "state": ROBOT_PAIRS, "status": UP,
    "operate": DOWN, "report": UP, "command": DOWN, "phase": ROBOT_PAIRS,
}  # fmt: skip


def contents() -> list[Content]:
    """For every kind and direction, each value of each field, next to changing others."""
    found: list[Content] = []
    for kind, fields in FIELDS.items():
        for direction in DIRECTIONS[kind]:
            for i in range(max(len(values) for values in fields.values()) * 2):
                said = tuple(
                    values[(i + i // len(values) * place) % len(values)]
                    for place, values in enumerate(fields.values())
                )
                found.append((*direction, kind, said))
    return list(dict.fromkeys(found))


def random_content(chance: random.Random) -> Content:
    """Any allowed content."""
    kind = chance.choice([*FIELDS])
    said = tuple(chance.choice(values) for values in FIELDS[kind].values())
    return (*chance.choice(DIRECTIONS[kind]), kind, said)


def payload(kind: str, said: tuple[str, ...]) -> bytes:
    """The five payload bytes."""
    field = dict(zip(FIELDS[kind], said, strict=True))
    stop = int(field["stop"] == "yes")
    flags = stop + 2 * (field.get("ready") == "yes") + 4 * (field.get("at_rest") == "yes")
    at_target = 8 * (field.get("palm_at_target") == "yes")
    match kind:
        case "hello":
            return int(field["settings"]).to_bytes(4, "little") + bytes([stop])
        case "state":
            language, message = field["said"].split(":")
            second = MODES.index(field["mode"]) + 16 * [*MESSAGES].index(language)
            return bytes([MESSAGE_NUMBERS[message], second, 0, 0, flags])
        case "phase":
            second = MODES.index(field["mode"]) + 16 * 4
            steps = int(field["steps"])
            last = stop + 4 * (steps % 2) + 2 * (steps // 2)
            return bytes([MESSAGE_NUMBERS[field["message"]], second, 0, 0, last])
        case "status":
            first = MODES.index(field["mode"]) + 16 * FAULTS.index(field["fault"])
            second = int(field["sign"]) + 1 + 4 * PALMS[field["palm"]] + at_target
            second += 16 * CASES.index(field["case"])
            value = int(field["value"])
            last = flags + 8 * ITEMS.index(field["item"])
            return bytes([first, second, value % 256, value // 256, last])
        case "operate":
            return bytes([OPERATIONS.index(field["operation"]), 0, 0, 0, stop])
        case "report":
            first = int(field["sign"]) + 1 + 4 * PALMS[field["palm"]] + at_target
            return bytes([first, 0, 0, 0, stop])
        case _:
            return bytes([PALMS[field["palm"]] + 2 * MOVES[field["move"]], 0, 0, 0, stop])


def is_allowed(kind: int, sender: int, receiver: int, b: bytes) -> bool:
    """Whether a packet with these numbers is allowed, by the tables of the page."""
    names = {number: name for name, number in ROLES.items()}
    if kind > 6 or (names.get(sender), names.get(receiver)) not in DIRECTIONS[[*KINDS][kind]]:
        return False
    short = b[1:4] == bytes(3) and b[4] in (0, 1)
    match kind:
        case 0:
            return b[4] in (0, 1)
        case 1:
            first, count = {0: (0, 1), 1: (1, 3), 2: (1, 5), 3: (6, 5)}.get(b[1] // 16, (0, 0))
            said = b[0] in range(first, first + count)
            return said and b[1] % 16 < 9 and b[2:4] == bytes(2) and b[4] < 8
        case 6:
            said = b[0] in range(11, 25) and b[1] // 16 == 4
            return said and b[1] % 16 < 9 and b[2:4] == bytes(2) and b[4] < 8
        case 2:
            sides = b[0] % 16 < 9 and b[0] // 16 < 16 and b[1] % 4 != 3 and b[1] // 16 < 13
            return sides and b[4] // 8 < 15
        case 3:
            return short and b[0] < 6
        case 4:
            return short and b[0] < 16 and b[0] % 4 != 3
        case _:
            return short and b[0] < 6


def packet(
    content: Content, sent: Stamp, acknowledged: Stamp, key: bytes = KEY, pair: int = PAIR
) -> bytes:
    """The packet's 32 bytes."""
    sender, receiver, kind, said = content
    head = bytearray(24)
    head[0] = 3
    head[1] = KINDS[kind]
    head[2] = ROLES[sender] + 16 * ROLES[receiver]
    head[3:5] = pair % 256, pair // 256
    for place, (epoch, sequence) in ((5, sent), (12, acknowledged)):
        head[place : place + 3] = (epoch >> shift & 255 for shift in (0, 8, 16))
        head[place + 3 : place + 7] = (sequence >> shift & 255 for shift in (0, 8, 16, 24))
    head[19:24] = payload(kind, said)
    tag = siphash24(key, bytes(head))
    return bytes(head) + bytes(tag >> shift & 255 for shift in range(0, 64, 8))


def golden() -> str:
    """One line for each content, with numbers at and between their limits."""
    lines = [
        "# Packets of every kind and direction, with every value of every field;",
        "# key 0f1e2d3c4b5a69788796a5b4c3d2e1f0, pair c0de.",
        "# Written by tests/support/wire_oracle.py, which shares no code with the package:",
        "# sender > receiver kind field=value... | sent | acknowledged | bytes",
    ]
    for i, content in enumerate(contents()):
        last = (2**24 - 1, 2**32 - 1)
        between = ((0x010203, 0x04050607), (0x08090A, 0x0B0C0D0E))
        sent, acknowledged = (((1, 1), (0, 0)), between, (last, last))[i % 3]
        sender, receiver, kind, said = content
        words = " ".join(
            f"{field}={value.replace(' ', '-')}"
            for field, value in zip(FIELDS[kind], said, strict=True)
        )
        data = packet(content, sent, acknowledged).hex(" ")
        numbers = f"{sent[0]} {sent[1]} | {acknowledged[0]} {acknowledged[1]}"
        lines.append(f"{sender} > {receiver} {kind} {words} | {numbers} | {data}")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    GOLDEN.write_text(golden(), encoding="utf-8")
