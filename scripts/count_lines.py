#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lines of every folder, by what they are: code, comments, blank, data, generated text, prose.

    .venv/bin/python scripts/count_lines.py [--at REVISION] [--csv FILE]

Counts the files that git tracks, by default as they are in the working tree. Docstrings count as
comments. The six kinds add up to `wc -l`. Pictures and other binary files are left out.
"""

import argparse
import ast
import csv
import io
import re
import subprocess
import sys
import tarfile
import tokenize
from collections import Counter, defaultdict
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

from rich.console import Console
from rich.table import Column, Table

ROOT = Path(__file__).resolve().parent.parent
KINDS = ("code", "comments", "blank", "data", "generated", "prose")
GENERATED = (
    "requirements/*.txt", "site/package-lock.json", "src/palmbots/boards/data/*.hex",
    "docs/reference/cli.md", "docs/reference/scene-keys.md", "tests/package/api.txt",
    "benchmarks/baselines/*", "benchmarks/results/*", "firmware/board/nrf52833/registers.hpp",
    "verify/counterexamples/*",
)  # fmt: skip
"""Files that a command of this tree writes."""
PROSE = (".md", ".cff", ".bib", "LICENSE")
SLASHES = (".c", ".h", ".cpp", ".hpp", ".ts", ".tsx", ".js", ".css", ".ld", ".pml")
HASHES = (".in", ".yml", ".yaml", ".cmake", "CMakeLists.txt", "Makefile", "Dockerfile",
          ".ci/run", "scripts/lock", "scripts/setup", "ignore", ".clang-format")  # fmt: skip
SPLIT = ("src", "tests", "include")
"""Folders that are shown room by room."""


def files(revision: str | None) -> Iterator[tuple[str, str]]:
    """Name and text of every tracked text file."""
    if revision is None:
        listed = subprocess.run(["git", "ls-files"], cwd=ROOT, check=True, capture_output=True)
        names = (name for name in listed.stdout.decode().splitlines() if (ROOT / name).is_file())
        pairs = ((name, (ROOT / name).read_bytes()) for name in names)
    else:
        command = ["git", "archive", revision]
        packed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
        with tarfile.open(fileobj=io.BytesIO(packed.stdout)) as archive:
            members = [(m.name, archive.extractfile(m)) for m in archive.getmembers()]
            pairs = iter([(name, stream.read()) for name, stream in members if stream])
    for name, data in pairs:
        if b"\0" not in data[:8000]:
            yield name, data.decode(errors="replace")


def python_comments(text: str) -> set[int]:
    """Numbers of the lines that hold only a comment or belong to a docstring."""
    found = {
        token.start[0]
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT and not token.line[: token.start[1]].strip()
    }
    for node in ast.walk(ast.parse(text)):
        body = getattr(node, "body", None)
        for part in body if isinstance(body, list) else ():
            value = part.value if isinstance(part, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str) and part.end_lineno:
                found |= set(range(part.lineno, part.end_lineno + 1))
    return found


def slash_comments(text: str) -> set[int]:
    """The same for // and /* */, where a line begins with one."""
    found: set[int] = set()
    inside = False
    for number, line in enumerate(text.splitlines(), 1):
        start = line.lstrip()
        if inside or start.startswith(("//", "/*")):
            found.add(number)
            inside = (inside or start.startswith("/*")) and "*/" not in line
    return found


def kinds(name: str, text: str) -> Counter[str]:
    """How many lines of a file are of which kind."""
    lines = text.splitlines()
    if any(fnmatch(name, pattern) for pattern in GENERATED):
        return Counter(generated=len(lines))
    if name.endswith(PROSE):
        return Counter(prose=len(lines))
    if name.endswith((".py", ".pyi")):
        comments = python_comments(text)
    elif name.endswith(SLASHES):
        comments = slash_comments(text)
    elif name.endswith(HASHES):
        comments = {n for n, line in enumerate(lines, 1) if re.match(r"\s*#", line)}
    else:
        return Counter(data=len(lines))
    blank = {n for n, line in enumerate(lines, 1) if not line.strip()} - comments
    return Counter(
        code=len(lines) - len(comments) - len(blank), comments=len(comments), blank=len(blank)
    )


def folder_of(name: str) -> str:
    """The row of a file: its folder, or its room."""
    parts = Path(name).parts
    depth = {"src": 3, "include": 3}.get(parts[0], 2) if parts[0] in SPLIT else 1
    return "/".join(parts[: min(depth, len(parts) - 1)]) or "."


def main() -> int:
    """Count, print, write."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--at", metavar="REVISION", help="default: the working tree")
    parser.add_argument("--csv", type=Path, help="write the table to this file, too")
    given = parser.parse_args()
    rows: dict[str, Counter[str]] = defaultdict(Counter)
    for name, text in files(given.at):
        found = kinds(name, text)
        for row in (folder_of(name), f"{Path(name).parts[0]}, all", "all"):
            rows[row] += found
            rows[row]["files"] += 1
    tops = {row.split("/")[0] for row in rows if row.split("/")[0] in SPLIT}
    shown = {row: n for row, n in sorted(rows.items()) if row.removesuffix(", all") in tops
             or not row.endswith(", all")}  # fmt: skip
    shown["all"] = shown.pop("all")
    table = Table(Column("folder", no_wrap=True), *(header := ("files", *KINDS, "sum")))
    cells = [[row, *(n[k] for k in header[:-1]), sum(n[k] for k in KINDS)]
             for row, n in shown.items()]  # fmt: skip
    for row in cells:
        table.add_row(*map(str, row))
    Console(width=120).print(table)
    if given.csv:
        with given.csv.open("w", newline="") as stream:
            csv.writer(stream).writerows([["folder", *header], *cells])
    return 0


if __name__ == "__main__":
    sys.exit(main())
