# SPDX-License-Identifier: Apache-2.0
"""Recordings of other programs as arrays: tables of numbers in text files.

A file has one row in a line, with commas, semicolons or blanks between the numbers, and may be
compressed (.gz, .xz). Lines that begin with # are comments. A first line with names selects the
columns; without it the columns have the usual order. Every fault is one line that names the file.
"""

from __future__ import annotations

import gzip
import hashlib
import io
import lzma
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palmbots._util.atomic_files import read_regular
from palmbots._util.text import plural
from palmbots._util.user_paths import user_path
from palmbots.errors import PalmbotsError
from palmbots.scene.file_kinds import RECORDING, refuse_other_kind

Floats = NDArray[np.float64]

_LARGEST = 1 << 30  # bytes
_BETWEEN = re.compile(r"[,;\s]+")


@dataclass(frozen=True)
class Recording:
    """The columns of a file."""

    name: str
    sha256: str
    """Of the bytes of the file as it lies on the disk."""
    columns: dict[str, Floats]

    def __getitem__(self, column: str) -> Floats:
        return self.columns[column]

    def __contains__(self, column: str) -> bool:
        return column in self.columns

    @property
    def times_s(self) -> Floats:
        """The column of times."""
        return self.columns["time_s"]


def read_recording(
    path: str | os.PathLike[str],
    columns: Sequence[str],
    needed: int,
    *,
    instead: str = "",
    least_rows: int = 100,
    most_apart_s: float = 2.0,
    has_segments: bool = False,
) -> Recording:
    """Read a file of numbers.

    Args:
        path: the file.
        columns: names of the columns, in the usual order.
        needed: how many of them, from the first on, must be there.
        instead: a column that suffices alone.
        least_rows: fewest rows.
        most_apart_s: largest usual time between rows; a larger one is taken for another unit.
        has_segments: times begin anew with each segment.

    Raises:
        PalmbotsError: it cannot be read, or is no such recording.
    """
    name = os.fspath(path)
    expected = f"expected {_listed(columns[:needed], 'column')}"
    if len(columns) > needed:
        expected += f", and optionally {_enumerated(columns[needed:])}"
    refuse_other_kind(name, RECORDING)
    data = _bytes(name)
    text = _text(name, data, expected)
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if (bare := line.lstrip()) and bare[0] != "#"
    ]
    names, has_names = list(columns), False
    if lines and not _is_numbers(lines[0][1]):
        has_names = True
        names = _split(lines.pop(0)[1])
        missing = [one for one in columns[:needed] if one not in names]
        if missing and instead not in names:
            raise PalmbotsError(f"{name}: has the {_listed(names, 'column')}; {expected}")
        needed = max(names.index(one) + 1 for one in columns if one in names)
    if len(lines) < least_rows:
        raise PalmbotsError(
            f"{name}: has {plural(len(lines), 'row')}; expected at least {least_rows}"
        )
    number, first = lines[0]
    if (has_names and len(_split(first)) > len(names)) or {",", ";"} < {*first}:
        raise PalmbotsError(
            f"{name}: line {number} has decimal commas, or more numbers than there are names; "
            "expected decimal points, and commas, semicolons or blanks between the numbers"
        )
    table = _table(name, lines, names, needed, expected)
    found = {key: table[:, names.index(key)] for key in columns if key in names[: table.shape[1]]}
    if "time_s" in found and not has_segments:
        _check_times(name, found["time_s"], [number for number, _ in lines], most_apart_s)
    return Recording(name, hashlib.sha256(data).hexdigest(), found)


def _bytes(name: str) -> bytes:
    try:
        data = read_regular(user_path(name))
    except IsADirectoryError:
        raise PalmbotsError(f"{name}: is a folder; expected a table of numbers") from None
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = (isinstance(error, OSError) and error.strerror) or error
        raise PalmbotsError(f"{name}: cannot be read: {reason}") from None
    return data


def _text(name: str, data: bytes, expected: str) -> str:
    try:
        packing = {"xz": lzma, "gz": gzip}.get(name.rpartition(".")[2])
        if packing is not None:
            with packing.open(io.BytesIO(data)) as packed:
                data = packed.read(_LARGEST + 1)
        if len(data) > _LARGEST:
            raise PalmbotsError(f"{name}: holds more than 1 GiB; {expected}")
        return data.decode("utf-8-sig")
    except EOFError:
        raise PalmbotsError(f"{name}: is cut short; {expected}") from None
    except (UnicodeDecodeError, lzma.LZMAError, OSError):
        raise PalmbotsError(f"{name}: is not a text file; {expected}") from None


def _listed(names: Sequence[str], noun: str) -> str:
    return f"{noun if len(names) == 1 else f'{noun}s'} {', '.join(names)}"


def _enumerated(names: Sequence[str]) -> str:
    return " and ".join([one for one in (", ".join(names[:-1]), names[-1]) if one])


def _split(line: str) -> list[str]:
    return [word for word in _BETWEEN.split(line.strip()) if word]


def _is_numbers(line: str) -> bool:
    try:
        return bool([float(word) for word in _split(line)])
    except ValueError:
        return False


def _table(
    name: str, lines: list[tuple[int, str]], names: list[str], needed: int, expected: str
) -> Floats:
    width = len(_split(lines[0][1]))
    if width < needed:
        raise PalmbotsError(f"{name}: has {plural(width, 'column')}; {expected}")
    try:  # in compiled code; the loop below names the line of a fault
        plain = "\n".join(line for _, line in lines).replace(",", " ").replace(";", " ")
        rows = np.loadtxt(plain.split("\n"), comments=None, ndmin=2)
    except ValueError:
        rows = np.array(_rows(name, lines, width, expected))
    table = rows[:, : len(names)]
    bad = np.flatnonzero(~np.isfinite(table).all(axis=1))
    if bad.size:
        number = lines[int(bad[0])][0]
        raise PalmbotsError(f"{name}: line {number} has a value that is not finite; {expected}")
    return table


def _rows(name: str, lines: list[tuple[int, str]], width: int, expected: str) -> list[list[float]]:
    rows = []
    for number, line in lines:
        words = _split(line)
        try:
            row = [float(word) for word in words]
        except ValueError:
            raise PalmbotsError(
                f"{name}: line {number} is not a row of numbers; {expected}"
            ) from None
        if len(row) != width:
            raise PalmbotsError(
                f"{name}: line {number} has {plural(len(row), 'number')}; expected {width}, as in "
                "the first row"
            )
        rows.append(row)
    return rows


def _check_times(name: str, times_s: Floats, numbers: list[int], most_apart_s: float) -> None:
    steps = np.diff(times_s)
    back = np.flatnonzero(steps < 0)
    if back.size:
        place = int(back[0])
        raise PalmbotsError(
            f"{name}: the time in line {numbers[place + 1]} is {-steps[place]:.4g} s before that "
            "of the row above; expected times in s that do not decrease"
        )
    usual = float(np.median(steps))
    if not 1e-5 < usual < most_apart_s:
        raise PalmbotsError(
            f"{name}: the rows are {usual:.4g} s apart; expected times in s, with 1e-05 to "
            f"{most_apart_s:g} s between rows"
        )
