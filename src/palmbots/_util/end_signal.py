# SPDX-License-Identifier: Apache-2.0
"""Ending a program in good order: on a signal, and when the program that started it is gone."""

import contextlib
import os
import signal
import threading
import time
from collections.abc import Iterator, Mapping

_VARIABLE = "PALMBOTS_LIFELINE"
_END_WITHIN_S = 2.0


def leave(number: int, _: object) -> None:
    """Leave on a signal in good order: what is being written is removed, and processes are ended.

    For `signal.signal`; the exit status is what shells report of a program that the signal ends.
    """
    raise SystemExit(128 + number)


@contextlib.contextmanager
def ended_by_signal(*, second_ends: bool = True) -> Iterator[threading.Event]:
    """An event that SIGTERM and Ctrl-C set.

    Args:
        second_ends: a second one of them ends the program at once.
    """
    event = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield event
        return
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGINT)}

    def end(*_: object) -> None:
        event.set()
        if second_ends:
            for number, handler in before.items():
                signal.signal(number, handler)

    for number in before:
        signal.signal(number, end)
    try:
        yield event
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def lifeline(pipe: int) -> dict[str, str]:
    """The variable that ties a program to the one that starts it.

    Args:
        pipe: the end for reading of a pipe, which the started program inherits. Only the starting
            program has the end for writing, which the system closes with it, also after SIGKILL.
    """
    return {_VARIABLE: str(pipe)}


def has_starter(variables: Mapping[str, str]) -> bool:
    """Whether a program with a lifeline has started this one, and speaks for it."""
    return _VARIABLE in variables


def end_with_starter(variables: Mapping[str, str]) -> None:
    """End this program when the one that started it is gone, if it was started with a lifeline."""
    text = variables.get(_VARIABLE, "")
    if text.isdecimal():
        threading.Thread(target=_watch, args=(int(text),), daemon=True).start()


def _watch(pipe: int) -> None:
    try:
        gone = os.read(pipe, 1) == b""
    except OSError:  # not inherited
        return
    if gone:
        os.kill(os.getpid(), signal.SIGTERM)
        time.sleep(_END_WITHIN_S)
        os._exit(1)
