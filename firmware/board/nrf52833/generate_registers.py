# SPDX-License-Identifier: Apache-2.0
"""Writes registers.hpp from Nordic's description of the chip, nrf52833.svd.

    python firmware/board/nrf52833/generate_registers.py nrf52833.svd

The crate nrf-pac ships the description: `cargo add nrf-pac` and `cargo fetch` put it under
~/.cargo/registry. The header has the notice of the description, because it is made from it.
"""

import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PERIPHERALS = {
    "APPROTECT": "APPROTECT", "CLOCK": "CLOCK", "FICR": "FICR", "NVMC": "NVMC", "P0": "P0",
    "P1": "P1", "POWER": "POWER", "PPI": "PPI", "PWM0": "PWM0", "RADIO": "RADIO", "RNG": "RNG",
    "SAADC": "SAADC", "TIMER0": "TIMER0", "TIMER1": "TIMER1", "TWIM0": "TWIM0", "UARTE0": "UARTE0",
    "UICR": "UICR", "WDT": "WDT",
}  # fmt: skip
"""The peripherals that the board uses."""
HEAD = """\
// The registers of the nRF52833 that the board uses, from Nordic's description of the chip. Written
// by generate_registers.py; do not edit.
//
{notice}
#pragma once

#include "../register.hpp"

"""


def number(text: str) -> int:
    """A number in decimal or hexadecimal notation."""
    return int(text, 0)


def text_of(element: ElementTree.Element, name: str) -> str:
    """The text of an element that has to be there."""
    found = element.findtext(name)
    if found is None:
        raise SystemExit(f"registers: an element without {name}")
    return found


def lines_of(registers: ElementTree.Element, base: int, prefix: str = "") -> list[str]:
    """The registers of a peripheral, or of a cluster of it."""
    lines = []
    for entry in registers:
        if entry.tag not in ("register", "cluster"):
            continue
        name = prefix + text_of(entry, "name").replace("[%s]", "").replace("%s", "")
        address = base + number(text_of(entry, "addressOffset"))
        count = entry.findtext("dim")
        step = number(entry.findtext("dimIncrement") or "4")
        if entry.tag == "cluster":
            for i in range(number(count) if count else 1):
                lines += lines_of(entry, address + i * step, f"{name}{i if count else ''}_")
        elif count is None:
            lines.append(f"inline constexpr Register<0x{address:08X}> {name}{{}};")
        else:
            lines.append(f"inline constexpr Registers<0x{address:08X}, {step}> {name}{{}};")
    return lines


def main() -> None:
    """Write the header."""
    root = ElementTree.parse(sys.argv[1]).getroot()
    licence = text_of(root, "licenseText").replace("\\n", "").strip().splitlines()
    notice = "\n".join(f"// {line.strip()}".rstrip() for line in licence)
    found = {text_of(p, "name"): p for p in root.iter("peripheral")}
    out = HEAD.format(notice=re.sub(r"(//\n)+", "//\n", notice))
    for name in sorted(PERIPHERALS):
        peripheral = found[name]
        base = number(text_of(peripheral, "baseAddress"))
        while (origin := peripheral.get("derivedFrom")) and peripheral.find("registers") is None:
            peripheral = found[origin]
        registers = peripheral.find("registers")
        assert registers is not None
        lines = "\n".join(lines_of(registers, base))
        out += f"namespace palmbots::board::{name} {{\n{lines}\n}}\n\n"
    target = Path(__file__).with_name("registers.hpp")
    target.write_text("// clang-format off\n" + out.rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
