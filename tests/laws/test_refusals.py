# SPDX-License-Identifier: Apache-2.0
"""Every refusal is one line: the tables in ``refusals/`` say which call or command has which.

A table holds rows ``[input, line]`` and

- ``call``: Python in which ``...`` stands for the input, or a command, as in ``$ palmbots carry
  ...``. A list: the input is refused by each. Without it, the input is the call. The input as a
  text is also the variable ``row``.
- ``given``: Python that runs before each row, in an empty working directory; ``...`` as above.
  That at the top of a file is for all its tables.
- ``line``: what the lines of all rows have in common, with ``...``; a list: one for each call.
  ``{here}`` is the working directory, ``{controllers}`` the list of the shipped ones,
  ``{worlds}`` that of the worlds, ``{version}`` that of palmbots. Others are texts in ``given``.
  ``{any}`` stands for words of Python, a library or the system, which differ between versions.
- ``error``: the class of the exception; PalmbotsError, if it is not stated.
- ``changes``: a folder of which the call may change files; otherwise it changes none.

A command has exit status 2 and prints nothing on stdout. Before its line stands ``palmbots: ``;
only faults of usage begin with the command, as in ``palmbots carry: No such option``.
"""

import builtins
import math
import os
import re
import shlex
import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from commands import runner
from palmbots import errors
from palmbots.control.registry import shipped_names
from palmbots.simulation import world_names
from scene_lists import of_scenes

FOLDER = Path(__file__).parent / "refusals"


@dataclass(frozen=True)
class Row:
    """A call that is refused, and how."""

    table: str
    given: str
    text: str
    call: str
    line: str
    error: str
    changes: str


def rows() -> Iterator[Row]:
    """The rows of all tables, in order."""
    for file in sorted(FOLDER.glob("*.toml")):
        tables = tomllib.loads(file.read_text("utf-8"))
        shared = tables.pop("given", "")
        for name, table in tables.items():
            calls, lines = table.get("call", "..."), table.get("line", "...")
            calls = calls if isinstance(calls, list) else [calls]
            lines = lines if isinstance(lines, list) else [lines] * len(calls)
            for text, said in table["rows"]:
                for call, line in zip(calls, lines, strict=True):
                    yield Row(
                        f"{file.stem}, {name}",
                        f"{shared}\n{table.get('given', '').replace('...', text)}",
                        text,
                        call.replace("...", text),
                        line.replace("...", said),
                        table.get("error", "PalmbotsError"),
                        table.get("changes", "nothing"),
                    )


def write(name: str, content: str | bytes) -> Path:
    """A new file, and the folders above it."""
    path = Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def edited(path: Path, old: str, new: str) -> Path:
    """The file, with a part of its text replaced once."""
    text = path.read_text("utf-8")
    assert old in text, old
    path.write_text(text.replace(old, new, 1), "utf-8")
    return path


def files(folder: Path, but: str = "nothing") -> dict[str, bytes | None]:
    """All that a folder contains, but for one of its folders."""
    found = (path for path in sorted(folder.rglob("*")) if not path.is_relative_to(folder / but))
    return {str(path): path.read_bytes() if path.is_file() else None for path in found}


def named(names: dict[str, Any], found: re.Match[str]) -> str:
    """What a name in braces stands for, if it is that of a text."""
    value = names.get(found[1])
    return value if isinstance(value, str) else found[0]


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty working directory."""
    with tempfile.TemporaryDirectory(prefix="refused-") as name:
        monkeypatch.chdir(name)
        yield Path(name)


@pytest.mark.parametrize("row", [*rows()], ids=lambda row: f"{row.table}: {row.text[:60]}")
def test_bad_input_is_refused_in_one_line(
    row: Row, here: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(os, "fsync", lambda _: None)  # disks are slow
    names: dict[str, Any] = {
        "pb": pb, "np": np, "math": math, "Path": Path, "write": write, "edited": edited,
        "monkeypatch": monkeypatch, "row": row.text, "here": str(here),
        "version": pb.__version__, "controllers": ", ".join(shipped_names()),
        "worlds": ", ".join(world_names()), **of_scenes(),
    }  # fmt: skip
    exec(row.given, names)
    before = files(here, row.changes)
    if row.call.startswith("$ "):
        result = runner(capsys)(*shlex.split(row.call)[2:])
        assert (result.returncode, result.stdout) == (2, ""), result
        said, end = result.stderr[:-1], result.stderr[-1:]
        assert end == "\n"
    else:
        with pytest.raises(getattr(errors, row.error, None) or getattr(builtins, row.error)) as no:
            eval(row.call, names)
        said = str(no.value)
    expected = re.sub(r"\{(\w+)\}", lambda found: named(names, found), row.line)
    if row.call.startswith("$ ") and not expected.startswith("palmbots "):
        expected = f"palmbots: {expected}"
    if "{any}" in expected:
        assert re.fullmatch(re.escape(expected).replace(re.escape("{any}"), ".+"), said)
    else:
        assert said == expected
    assert said.isprintable()
    assert files(here, row.changes) == before
