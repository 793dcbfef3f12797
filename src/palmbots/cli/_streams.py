# SPDX-License-Identifier: Apache-2.0
"""Handles standard streams that are closed, or whose reader has exited.

This module imports almost nothing: it is used before anything else is imported.
"""

import contextlib
import os
import sys
import textwrap
from typing import Any

from palmbots._util.end_signal import has_starter
from palmbots.cli import INTERRUPTION_LINE


def open_closed_streams() -> None:
    """Let a closed stream, as in ``palmbots contact-modes >&-``, discard what is written to it.

    Otherwise the first file that is opened would get its file descriptor, and everything that a
    library prints would go into that file.
    """
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            stream = open(os.devnull, "w" if number else "r", encoding="utf-8")  # noqa: SIM115
            os.set_inheritable(stream.fileno(), True)  # as the other streams are
            setattr(sys, name, stream)


WIDTH = 80
"""Columns of text in a pipe or a file."""
_LEAST = 20  # columns: a smaller COLUMNS is ignored


def text_width(columns: int) -> int:
    """Columns of running text where `columns` are free: fewer where COLUMNS asks for it."""
    asked = os.environ.get("COLUMNS", "")
    is_width = asked.isdecimal() and int(asked) >= _LEAST
    return min(columns, int(asked)) if is_width else columns


def wrapped(text: str, stream: Any, indent: int = 2) -> str:
    """A text as wide as reports are on this stream, its further lines indented."""
    columns = WIDTH
    if stream is not None and stream.isatty():
        with contextlib.suppress(OSError, ValueError):
            columns = max(WIDTH, os.get_terminal_size(stream.fileno()).columns)
    return textwrap.fill(
        text,
        text_width(columns),
        subsequent_indent=" " * indent,
        break_long_words=False,  # a command or the name of a file stays whole
        break_on_hyphens=False,
    )


def say_wrapped(text: str) -> None:
    """Print a text on stderr, as wide as reports are."""
    say(wrapped(text, sys.stderr))


def say(line: str) -> None:
    """Print a line on stderr; nothing happens where stderr is full or closed."""
    if sys.stderr is not None:  # print would take None for stdout
        with contextlib.suppress(OSError, ValueError):  # ValueError: closed by the user's code
            print(line, file=sys.stderr, flush=True)


def say_interrupted(line: str = INTERRUPTION_LINE) -> None:
    """Print the line about Ctrl-C, unless the program that has started this one prints one."""
    if not has_starter(os.environ):
        say(line)


def discard_unwritable(*names: str) -> None:
    """Discard the pending output of streams (``stdout``, ``stderr``) that cannot be written.

    Otherwise the interpreter would report the error at its exit, or change the exit status.
    """
    for name in names:
        stream = getattr(sys, name)
        try:
            stream.flush()
        except (AttributeError, OSError, ValueError):  # AttributeError: the stream is None
            with contextlib.suppress(AttributeError, OSError, ValueError):
                null = os.open(os.devnull, os.O_WRONLY)
                os.dup2(null, stream.fileno())
                os.close(null)
