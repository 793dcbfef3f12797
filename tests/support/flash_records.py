# SPDX-License-Identifier: Apache-2.0
"""An independent reader and writer of what a board stores (docs/reference/board.md)."""

import zlib
from typing import NamedTuple

PAGE = 4096
RECORD = 12


class Record(NamedTuple):
    """What a board remembers over a boot."""

    epoch: int
    flags: int
    """Bit 0: its palm was up for the partner, bit 1: it carried, bit 2: a stop was in force."""


def flash_records(storage: bytes) -> list[Record]:
    """All complete records in both pages, the oldest first."""
    found = []
    for page in (storage[:PAGE], storage[PAGE:]):
        for at in range(0, RECORD * (PAGE // RECORD), RECORD):
            content, number, check = (
                int.from_bytes(page[at + i : at + i + 4], "little") for i in (0, 4, 8)
            )
            if check == zlib.crc32(page[at : at + 8]) and content != 0xFFFFFFFF:
                found.append((number, Record(content & 0xFFFFFF, content >> 24)))
    return [record for _, record in sorted(found)]


def flash_record(number: int, epoch: int) -> bytes:
    """A record with this number and epoch, and no flags."""
    body = epoch.to_bytes(4, "little") + number.to_bytes(4, "little")
    return body + zlib.crc32(body).to_bytes(4, "little")
