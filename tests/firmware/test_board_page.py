# SPDX-License-Identifier: Apache-2.0
"""docs/reference/board.md lists the files of a board, and each function that a board offers."""

import re

from cxx import ROOT

BOARD = ROOT / "firmware" / "board"


def test_the_page_lists_each_file_and_each_function_in_the_row_of_its_file() -> None:
    page = (ROOT / "docs" / "reference" / "board.md").read_text()
    rows = [line.split("|") for line in page.splitlines() if line.startswith("| `")]
    listed = {row[1].strip(" `"): set(re.findall(r"`(\w+)`", row[2])) for row in rows}
    assert listed.keys() == {file.name for file in (BOARD / "nrf52833").glob("*.cpp")}
    declared: dict[str, set[str]] = {}
    file = ""
    for line in (BOARD / "board.hpp").read_text().splitlines():
        if title := re.match(r"// --- (\w+\.cpp)", line):
            file = title[1]
        elif function := re.match(r"[a-z].*?[ *](\w+)\(.*\);", line):
            declared.setdefault(file, set()).add(function[1])
    assert sum(map(len, declared.values())) > 30
    assert listed == declared
