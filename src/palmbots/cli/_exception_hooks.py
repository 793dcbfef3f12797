# SPDX-License-Identifier: Apache-2.0
"""Exceptions that nothing can catch: in a thread, in ``__del__``, in a function of `atexit`.

They arise in the code of a user, such as a controller in Python. Python prints a traceback for
each and continues; the command line prints a warning with the place instead, once for each place.

Ctrl-C and SIGTERM can be such exceptions, too: Python raises them wherever the main thread happens
to be, as in the garbage collector. There they are lost, so they are sent once more. In a compiled
module they may become other exceptions, so they are also remembered. While a compiled module is
being imported, the exception could abort the process; the signal therefore waits until the import
is over.
"""

import _thread
import signal
import sys
import threading
from importlib.machinery import ExtensionFileLoader
from pathlib import Path
from types import FrameType, TracebackType
from typing import Any

from palmbots._util.end_signal import leave
from palmbots.cli._streams import say_interrupted
from palmbots.cli._warnings import warn


def install_exception_hooks() -> None:
    """Print a warning in place of the traceback, until the process ends."""
    printed: set[str] = set()

    def report(what: str, error: BaseException | None, trace: TracebackType | None) -> None:
        if isinstance(error, KeyboardInterrupt):
            _send_again(signal.SIGINT)
            return
        if isinstance(error, SystemExit) and _heard == signal.SIGTERM:
            _send_again(signal.SIGTERM)
            return
        from palmbots.control.own_code import show_error

        text = "an unknown error" if error is None else show_error(error)
        fault = text + _place(trace)
        if fault not in printed:
            printed.add(fault)
            warn(f"{what} failed: {fault}")

    def in_thread(args: Any) -> None:
        if not issubclass(args.exc_type, SystemExit):  # which ends a thread, by convention
            name = "a thread" if args.thread is None else f"thread {args.thread.name}"
            report(name, args.exc_value, args.exc_traceback)

    def unraisable(args: Any) -> None:
        name = getattr(args.object, "__qualname__", type(args.object).__name__)
        report(name, args.exc_value, args.exc_traceback)

    threading.excepthook = in_thread
    sys.unraisablehook = unraisable
    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}
    for number, handler in usual.items():
        if signal.getsignal(number) is handler:
            signal.signal(number, _end)


_heard: int | None = None


def heard_signal() -> int | None:
    """SIGINT (Ctrl-C) or SIGTERM, if the process has heard it."""
    return _heard


def _end(number: int, frame: FrameType | None) -> None:
    global _heard
    _heard = number
    if _would_be_lost(frame):
        _send_again(number)
    elif number == signal.SIGTERM:
        leave(number, frame)
    else:
        signal.default_int_handler(number, frame)


def _would_be_lost(frame: FrameType | None) -> bool:
    """Whether a compiled module is being imported, or a hook of this file runs, as when a signal is
    sent once more."""
    while frame is not None:
        if frame.f_code.co_filename == __file__:
            return True
        is_import = frame.f_code.co_name in ("create_module", "exec_module")
        if is_import and isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False


_SOON_S = 0.01


def _send_again(number: int) -> None:
    if not threading.main_thread().is_alive():  # Python waits for the last threads, and continues
        if number == signal.SIGINT:
            say_interrupted()
        return
    again = threading.Timer(_SOON_S, _thread.interrupt_main, (number,))
    again.daemon = True
    again.start()


def _place(trace: TracebackType | None) -> str:
    """The innermost file and line of a traceback, in parentheses."""
    if trace is None:
        return ""
    while trace.tb_next is not None:
        trace = trace.tb_next
    return f" ({Path(trace.tb_frame.f_code.co_filename).name}, line {trace.tb_lineno})"
