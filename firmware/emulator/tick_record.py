# SPDX-License-Identifier: Apache-2.0
"""What the firmware notes for a debugger in every tick, as its headers declare it."""

import re
import struct
from pathlib import Path

_APP = Path(__file__).parents[1] / "app"
_CODES = {"8": "B", "32": "I"}
_FIELDS = re.findall(r"^  std::uint(\d+)_t (\w+);", (_APP / "tick_record.hpp").read_text(), re.M)
_RECORD = struct.Struct("<" + "".join(_CODES[bits] for bits, _ in _FIELDS))
FAULTS = re.findall(r"^  (\w+),", (_APP / "board_fault.hpp").read_text(), re.M)
"""The names of the faults of a board, in the order of their numbers."""


def read_record(raw: bytes) -> dict[str, int]:
    """The fields of a record as it stands in the memory of a board."""
    values = _RECORD.unpack_from(raw)
    return {name: value for (_, name), value in zip(_FIELDS, values, strict=True)}
