# SPDX-License-Identifier: Apache-2.0
"""Programs of this package as processes that end with the one that started them."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Self

from palmbots._util.end_signal import leave, lifeline
from palmbots.errors import PalmbotsError

_END_WITHIN_S = 5.0
_POLL_S = 0.02
# No program of a pair multiplies large matrices: the threads of NumPy take time and memory.
_FEW_THREADS = {"OPENBLAS_NUM_THREADS": "1"}


class Processes:
    """Processes by name; a context manager that ends all of them.

    If this process is killed, they end too: the system then closes a pipe whose other end they
    watch.

    Args:
        environment: further variables for all of them.
        descriptors: open files that they get, under the same numbers.
    """

    def __init__(
        self, environment: Mapping[str, str] | None = None, descriptors: Sequence[int] = ()
    ) -> None:
        self.descriptors = descriptors
        self._running: dict[str, subprocess.Popen[bytes]] = {}
        self._started: dict[str, tuple[Sequence[str], Path | None]] = {}
        self._environment = dict(environment or {})
        self._in_main = False
        self._before: Any = None
        self._pipe: tuple[int, int] | None = None

    def start(self, name: str, arguments: Sequence[str], *, output: Path | None = None) -> None:
        """Run ``palmbots`` with these arguments.

        Args:
            name: of the process.
            arguments: of the command line.
            output: file to which it prints; None: stdout.

        Raises:
            PalmbotsError: the system starts no process.
        """
        self._started[name] = (arguments, output)
        assert self._pipe is not None
        pipe = self._pipe[0]
        try:
            with contextlib.ExitStack() as stack:
                stream = None if output is None else stack.enter_context(output.open("ab"))
                self._running[name] = subprocess.Popen(
                    [sys.executable, "-P", "-m", "palmbots", *arguments],
                    stdout=stream,
                    env=_FEW_THREADS | os.environ | self._environment | lifeline(pipe),
                    pass_fds=[pipe, *self.descriptors],
                )
        except OSError as error:
            raise PalmbotsError(f"{sys.executable}: {error.strerror or error}") from None

    def restart(self, name: str) -> None:
        """Start a process that has ended once more."""
        arguments, output = self._started[name]
        self.start(name, arguments, output=output)

    def number(self, name: str) -> int:
        """The number of the process in the system."""
        return self._running[name].pid

    def status(self, name: str) -> int | None:
        """The exit status; None: it runs. Negative: the number of the signal that killed it."""
        return self._running[name].poll()

    def ends_within(self, name: str, within_s: float) -> bool:
        """Whether the process ends in this time."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._running[name].wait(within_s)
        return self.status(name) is not None

    def wait(self, name: str, within_s: float) -> int:
        """The exit status, when the process has ended.

        Raises:
            PalmbotsError: it does not end in this time.
        """
        if not self.ends_within(name, within_s):
            raise PalmbotsError(f"{name}: does not end, although the robots have been ended")
        status = self.status(name)
        assert status is not None
        return status

    def end(self, *names: str, within_s: float = _END_WITHIN_S, ask: bool = True) -> None:
        """End these processes; those that do not end in this time are killed.

        A process that is suspended (SIGSTOP) ends only in this way.
        """
        running = [self._running[name] for name in names if self.status(name) is None]
        for process in running if ask else ():
            process.send_signal(signal.SIGTERM)
        give_up = time.monotonic() + within_s
        for process in running:
            try:
                process.wait(max(_POLL_S, give_up - time.monotonic()))
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def __enter__(self) -> Self:
        self._pipe = os.pipe()
        self._in_main = threading.current_thread() is threading.main_thread()
        if self._in_main:
            self._before = signal.signal(
                signal.SIGTERM, leave
            )  # which would leave the processes behind
        return self

    def __exit__(self, *_: object) -> None:
        if self._in_main:
            signal.signal(signal.SIGTERM, signal.SIG_IGN)
        self.end(*self._running)
        assert self._pipe is not None
        for end in self._pipe:
            os.close(end)
        if self._in_main:
            signal.signal(signal.SIGTERM, self._before)
