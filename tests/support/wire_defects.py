# SPDX-License-Identifier: Apache-2.0
"""Defects that a change could bring into a header of the wire, for the fuzz target to find.

python3 wire_defects.py                      lists name and header of each
python3 wire_defects.py NAME HEADER RESULT   writes the header with this defect
"""

import sys
from pathlib import Path

# Header, its right text, and the defective one.
DEFECTS = {
    "no-tag-is-compared": ("packet.hpp", "if (!same_tag(tag,", "if (false && !same_tag(tag,"),
    "half-of-the-tag-is-enough": ("packet.hpp", "difference | difference >> 32", "difference"),
    "payload-is-not-tagged": (
        "packet.hpp",
        "tagged_size = tag_field.offset;",
        "tagged_size = payload_field.offset;",
    ),
    "any-payload-has-a-meaning": (
        "packet.hpp",
        "if (!well_formed(packet)) return {",
        "if (false) return {",
    ),
    "newest-packet-is-accepted-twice": (
        "endpoint.hpp",
        "sent <= newest_",
        "sent < newest_",
    ),
    "packet-from-before-a-boot-is-accepted": (
        "endpoint.hpp",
        "heard.epoch == next_.epoch",
        "true",
    ),
    "crc-of-a-frame-is-not-compared": (
        "serial_frame.hpp",
        "if (size <= bytes_.size() && unstuff(size) && crc_is_right()) {",
        "if (size <= bytes_.size() && unstuff(size) && plain_size_ >= 3) {",
    ),
    "frame-may-end-before-its-last-zero": (
        "serial_frame.hpp",
        "return next == size;",
        "return next >= size;",
    ),
}


def plant(name: str, header: Path, result: Path) -> None:
    _, right, wrong = DEFECTS[name]
    text = header.read_text(encoding="utf-8")
    assert text.count(right) == 1, f"{header}: {right} occurs {text.count(right)} times"
    result.parent.mkdir(parents=True, exist_ok=True)
    result.write_text(text.replace(right, wrong), encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:]:
        plant(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
    else:
        for name, (header, _, _) in DEFECTS.items():
            print(name, header)
