# SPDX-License-Identifier: Apache-2.0
"""Runs code of users. Whatever it raises, SystemExit included, is reported in one line."""

import contextlib
from collections.abc import Iterator
from typing import Any

from palmbots.errors import PalmbotsError

_LONGEST_TEXT = 200


def show_error(error: BaseException) -> str:
    """The type and the text of an exception, as messages quote them; a long text is cut off."""
    name = type(error).__name__
    try:
        text = str(error).strip()
    except (Exception, SystemExit):  # its __str__ may do anything
        text = ""
    if len(text) > _LONGEST_TEXT:
        text = text[: _LONGEST_TEXT - 1] + "…"
    return f"{name}: {text}" if text else name


def name_of(maker: Any) -> str:
    """How messages call a class, or another callable that makes controllers."""
    try:
        return str(getattr(maker, "__name__", type(maker).__name__))
    except (Exception, SystemExit):  # its metaclass may do anything
        return "the class"


@contextlib.contextmanager
def own_code(what: str) -> Iterator[None]:
    """Run code of a user in the block.

    Raises:
        PalmbotsError: the code raises anything but a `PalmbotsError` or Ctrl-C; the message
            consists of `what` and the exception.
    """
    try:
        yield
    except (KeyboardInterrupt, PalmbotsError):
        raise
    except BaseException as error:  # SystemExit, too: the controller must not end the program
        raise PalmbotsError(f"{what}: {show_error(error)}") from error
