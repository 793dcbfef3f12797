# SPDX-License-Identifier: Apache-2.0
"""The addresses of the registers, read from the header that the firmware uses."""

import re
from functools import cache
from pathlib import Path

_HEADER = Path(__file__).parents[1] / "board" / "nrf52833" / "registers.hpp"
_LINE = re.compile(r"inline constexpr Registers?<(0x[0-9A-F]+)(?:, (\d+))?> (\w+)")


@cache
def addresses() -> dict[str, tuple[int, int]]:
    """The address of each register, as ``RADIO.SHORTS``, and the step to the next of its kind."""
    found = {}
    peripheral = ""
    for line in _HEADER.read_text(encoding="utf-8").splitlines():
        if line.startswith("namespace"):
            peripheral = line.split("::")[-1].split()[0]
        elif match := _LINE.match(line):
            address, step, name = match.groups()
            found[f"{peripheral}.{name}"] = (int(address, 16), int(step or 0))
    return found


def at(name: str, number: int = 0) -> int:
    """The address of a register, or of one of several of a kind."""
    address, step = addresses()[name]
    return address + step * number
