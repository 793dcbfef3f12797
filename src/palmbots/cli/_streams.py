# SPDX-License-Identifier: Apache-2.0
"""Handles standard streams that are closed, or whose reader has exited.

This module imports almost nothing: it is used before anything else is imported.
"""

import contextlib
import os
import sys

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
