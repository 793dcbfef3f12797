# SPDX-License-Identifier: Apache-2.0
"""Runs `palmbots` and does something to it at a certain call of one of its functions.

    python at_call.py ACTION WHEN FUNCTION COUNT WORDS...

    ACTION    a signal that the process sends itself (SIGKILL, SIGINT, SIGSTOP), or the name of a
              file for which the calling thread waits
    WHEN      before or after the call
    FUNCTION  package.module:Class.method or package.module:function
    COUNT     which call, from 1
    WORDS     the command that follows `palmbots`

So a test interrupts a command at an exact moment, which no load of the machine can move.
"""

import functools
import importlib
import itertools
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from waiting import wait_until


def act(action: str) -> None:
    if action.startswith("SIG"):
        os.kill(os.getpid(), signal.Signals[action])
    else:
        wait_until(Path(action).exists)


def wrap(action: str, when: str, function: str, count: int) -> None:
    module, _, path = function.partition(":")
    *owners, name = path.split(".")
    owner: Any = functools.reduce(getattr, owners, importlib.import_module(module))
    original: Callable[..., Any] = getattr(owner, name)
    calls = itertools.count(1)

    @functools.wraps(original)
    def wrapped(*arguments: Any, **options: Any) -> Any:
        is_the_call = next(calls) == count
        if is_the_call and when == "before":
            act(action)
        result = original(*arguments, **options)
        if is_the_call and when == "after":
            act(action)
        return result

    setattr(owner, name, wrapped)


def command(action: object, when: str, function: Any, count: int, *words: object) -> list[str]:
    """The command line that does so. A name is needed where a module has imported the function."""
    is_name = isinstance(function, str)
    name = function if is_name else f"{function.__module__}:{function.__qualname__}"
    return [sys.executable, __file__, str(action), when, name, str(count), *map(str, words)]


def wait_until_stopped(process: subprocess.Popen[Any]) -> None:
    """Return when a child with ACTION SIGSTOP has stopped; fail if it ends instead."""
    flags = os.WSTOPPED | os.WEXITED | os.WNOWAIT | os.WNOHANG
    wait_until(lambda: os.waitid(os.P_PID, process.pid, flags))
    state = os.waitid(os.P_PID, process.pid, flags)
    assert state is not None and state.si_code == os.CLD_STOPPED, "it ended before that call"


if __name__ == "__main__":
    action, when, function, count, *words = sys.argv[1:]
    assert when in ("before", "after")
    wrap(action, when, function, int(count))
    from palmbots.cli.main import main

    sys.argv[1:] = words
    main()
