# SPDX-License-Identifier: Apache-2.0
"""Writes the state of a robot off the control thread: a memory card may take 0.1 s."""

import queue
import threading
from dataclasses import replace
from typing import Self

from palmbots.errors import PalmbotsError
from palmbots.pair.stored_state import StateFile, StoredState, write_state

_RETRY_S = 0.5


class StateKeeper:
    """Keeps the file of a robot up to date; a context manager.

    What cannot be written is tried again until it can be.

    Args:
        file: where the state is stored.
        state: what it contains.
    """

    def __init__(self, file: StateFile, state: StoredState) -> None:
        self._file = file
        self._wanted = self._stored = state
        self._queue: queue.Queue[StoredState | None] = queue.Queue()
        self._thread = threading.Thread(target=self._write, daemon=True)
        self.works = True
        """The newest attempt to write has not failed."""

    @property
    def is_done(self) -> bool:
        """All that the partner relies on after a boot is on the disk."""
        return replace(self._stored, covered_m=self._wanted.covered_m) == self._wanted

    def keep(self, state: StoredState) -> None:
        """Write the state, if it has changed; returns at once."""
        if state != self._wanted:
            self._wanted = state
            self._queue.put(state)

    def boot(self) -> StoredState:
        """Count a boot, and return the state after it, which is on the disk.

        Raises:
            PalmbotsError: it cannot be written.
        """
        self.settle()
        state = self._wanted.booted()
        write_state(self._file, state)
        self._wanted = self._stored = state
        return state

    def settle(self) -> None:
        """Wait until everything has been tried once."""
        self._queue.join()

    def _write(self) -> None:
        missing: StoredState | None = None
        while True:
            try:
                state = self._queue.get(timeout=None if missing is None else _RETRY_S)
                if state is None:
                    return
                is_new = True
            except queue.Empty:
                state, is_new = missing, False
            assert state is not None
            try:
                write_state(self._file, state)
            except PalmbotsError:
                self.works, missing = False, state
            else:
                self._stored, self.works, missing = state, True, None
            if is_new:
                self._queue.task_done()

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._queue.put(None)
        self._thread.join()
