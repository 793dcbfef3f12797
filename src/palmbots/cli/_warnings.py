# SPDX-License-Identifier: Apache-2.0
"""Warnings on stderr.

A command that refuses its input prints one line and nothing else, although the fault may be found
after a warning. `run` therefore holds warnings until the work or the output begins. Python's own
warnings of a class of palmbots are printed like all others.
"""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from palmbots.cli._streams import say_wrapped
from palmbots.errors import one_line

_held: list[str] | None = None  # None: warnings are printed at once


def warn(text: str) -> None:
    """Print a warning; hold it as long as the input of the command may still be refused."""
    if _held is None:
        say_warning(text)
    else:
        _held.append(text)


def say_warning(text: str) -> None:
    """Print a warning at once."""
    say_wrapped(f"palmbots: warning: {one_line(text)}")


def print_held_warnings() -> None:
    """Print what is held, and from now on every warning at once: the input is accepted."""
    global _held
    held, _held = _held, None
    for text in held or ():
        warn(text)


@contextmanager
def hold_warnings() -> Iterator[None]:
    """Hold the warnings of the block; an exception discards those that are not printed yet."""
    global _held
    _held = []
    try:
        with warnings.catch_warnings():
            # It passes on what it is given.
            warnings.showwarning = _show_warning  # ty: ignore[invalid-assignment]
            yield
        print_held_warnings()
    finally:
        _held = None


_show_of_python = warnings.showwarning


def _show_warning(message: Warning | str, category: type[Warning], *where: Any) -> None:
    if category.__module__.startswith("palmbots."):
        warn(str(message))
    else:
        _show_of_python(message, category, *where)
