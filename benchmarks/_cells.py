# SPDX-License-Identifier: Apache-2.0
"""A table of results that is written after each row, so that a benchmark continues where it was."""

import csv
import sys
from collections.abc import Hashable, Sequence
from pathlib import Path


class Cells:
    """The rows of a CSV file; the first columns of a row are its key."""

    def __init__(self, file: Path, head: Sequence[str], keys: int) -> None:
        """Read what there is already; the argument ``new`` of the program starts from nothing."""
        self.file, self.head, self.keys = file, list(head), keys
        self.rows: list[list[str]] = []
        if file.exists() and "new" not in sys.argv[1:]:
            with file.open(newline="", encoding="utf-8") as stream:
                self.rows = list(csv.reader(stream))[1:]

    def row(self, *key: Hashable) -> list[str] | None:
        """The row with this key, None: there is none yet."""
        wanted = [str(part) for part in key]
        return next((row for row in self.rows if row[: self.keys] == wanted), None)

    def add(self, *values: Hashable) -> list[str]:
        """Print a row and append it to the file."""
        row = [str(value) for value in values]
        print(*row, sep="  ", flush=True)
        self.rows.append(row)
        part = self.file.with_suffix(".part")
        with part.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerows([self.head, *self.rows])
        part.replace(self.file)
        return row
