#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Report the words of docs/style/vocabulary.txt in sources, tests and docs; 1 if there are any."""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VOCABULARY = ROOT / "docs" / "style" / "vocabulary.txt"
SUFFIXES = {".cpp", ".hpp", ".h", ".md", ".pml", ".py", ".toml", ".txt", ""}
# Locks and records are not prose.
EXCEPT = ("docs/style/vocabulary.txt", "LICENSE", "requirements/", "verify/counter")


def vocabulary() -> dict[str, str]:
    """The words and their replacements."""
    lines = VOCABULARY.read_text(encoding="utf-8").splitlines()
    rows = [line for line in lines if line.strip() and not line.startswith("#")]
    return {word.strip(): text.strip() for word, text in (row.split("->") for row in rows)}


def prose(name: str, text: str) -> list[tuple[int, str]]:
    """The numbered lines to check. Of the changelog, those of the unreleased version: what was
    released stays as it was, and the rows of its table quote old names."""
    lines = list(enumerate(text.splitlines(), 1))
    if name != "CHANGELOG.md":
        return lines
    heads = [number for number, line in lines if line.startswith("## ")]
    unreleased = [n for n, line in lines if n in heads and line.lower().endswith("unreleased")]
    ends = dict(zip(heads, [*heads[1:], len(lines) + 1], strict=True))
    wanted = {n for first in unreleased for n in range(first, ends[first])}
    return [(n, line) for n, line in lines if n in wanted and not line.startswith("|")]


def main() -> int:
    """Print a line for each place; return the exit status."""
    words = vocabulary()
    pattern = re.compile(rf"(?<![a-zA-Z])({'|'.join(words)})(?![a-zA-Z])", re.IGNORECASE)
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )  # fmt: skip
    places = 0
    for name in listed.stdout.splitlines():
        path = ROOT / name
        if name.startswith(EXCEPT) or path.suffix not in SUFFIXES or not path.is_file():
            continue
        for number, line in prose(name, path.read_text(encoding="utf-8")):
            for match in pattern.finditer(line):
                places += 1
                print(f"{name}:{number}: {match[1]}: write {words[match[1].lower()]}")
    return min(places, 1)


if __name__ == "__main__":
    sys.exit(main())
