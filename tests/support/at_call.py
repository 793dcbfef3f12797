# SPDX-License-Identifier: Apache-2.0
"""Runs `palmbots` and does something to it at a certain call of one of its functions.

    python at_call.py ACTION WHEN FUNCTION COUNT WORDS...

    ACTION    a signal that the process sends itself (SIGKILL, SIGINT, SIGSTOP), or the name of a
              file for which the calling thread waits
    WHEN      before or after the call
    FUNCTION  package.module:Class.method or package.module:function
    COUNT     which call, from 1
    WORDS     the command that follows `palmbots`

So a test interrupts a command at an exact moment, which no load of the machine can move. `fork`
does so in a copy of the process of the test, which starts at once.
"""

import functools
import importlib
import itertools
import os
import signal
import subprocess
import sys
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from waiting import wait_until


def act(action: str) -> None:
    if action.startswith("SIG"):
        os.kill(os.getpid(), signal.Signals[action])
    else:
        wait_until(Path(action).exists)


def wrapped(
    act: Callable[[], object], when: str, original: Callable[..., Any], count: int
) -> Callable[..., Any]:
    """The same function, which also acts before or after one of its calls."""
    calls = itertools.count(1)

    @functools.wraps(original)
    def wrapped(*arguments: Any, **options: Any) -> Any:
        is_the_call = next(calls) == count
        if is_the_call and when == "before":
            act()
        result = original(*arguments, **options)
        if is_the_call and when == "after":
            act()
        return result

    return wrapped


def wrap(action: str, when: str, function: str, count: int) -> None:
    module, _, path = function.partition(":")
    *owners, name = path.split(".")
    owner: Any = functools.reduce(getattr, owners, importlib.import_module(module))
    setattr(owner, name, wrapped(lambda: act(action), when, getattr(owner, name), count))


def name_of(function: Any) -> str:
    """FUNCTION of a function. A name is needed where a module has imported it."""
    is_name = isinstance(function, str)
    return function if is_name else f"{function.__module__}:{function.__qualname__}"


def command(action: object, when: str, function: Any, count: int, *words: object) -> list[str]:
    """The command line that does so."""
    numbered = (name_of(function), str(count))
    return [sys.executable, __file__, str(action), when, *numbered, *map(str, words)]


def fork(action: str, when: str, function: Any, count: int, run: Callable[[], object]) -> int:
    """The exit status of a copy of this process that calls `run`, and the action in it."""
    with warnings.catch_warnings():
        # The child may not wait for other threads, which it does not have; this one does not.
        warnings.simplefilter("ignore", DeprecationWarning)
        pid = os.fork()
    if pid == 0:
        try:
            wrap(action, when, name_of(function), count)
            run()
        except BaseException:
            traceback.print_exc()
        os._exit(0)
    try:
        wait_until(lambda: os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT | os.WNOHANG))
    finally:
        os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
    return os.waitstatus_to_exitcode(status)


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
