# SPDX-License-Identifier: Apache-2.0
"""Writes the state of a robot off the control thread: a memory card may take 0.1 s."""

import queue
import threading
from dataclasses import replace
from typing import Self

from palmbots.errors import PalmbotsError
from palmbots.pair.stored_state import StateFile, StoredState, write_state

_RETRY_S = 0.5


class StateWriter:
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
        self._missing: StoredState | None = None  # what is tried again
        self._lock = threading.Lock()  # of the file
        self._thread = threading.Thread(target=self._write, daemon=True)
        self.works = True
        """The newest attempt to write has not failed."""

    @property
    def is_done(self) -> bool:
        """All that the partner relies on after a boot is on the disk."""
        wanted = self._wanted
        distances = {"covered_m": wanted.covered_m, "approached_m": wanted.approached_m}
        return replace(self._stored, **distances) == wanted

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
        with self._lock:  # what could not be written before is never written after
            write_state(self._file, state)
            self._missing, self.works = None, True
            self._wanted = self._stored = state
        return state

    def settle(self) -> None:
        """Wait until everything has been tried once."""
        self._queue.join()

    def _write(self) -> None:
        while True:
            state, is_new = None, True
            try:
                state = self._queue.get(timeout=None if self._missing is None else _RETRY_S)
                if state is None:
                    return
            except queue.Empty:
                is_new = False
            with self._lock:
                state = state if is_new else self._missing  # a boot may have overtaken it
                if state is not None:
                    self._try(state)
            if is_new:
                self._queue.task_done()

    def _try(self, state: StoredState) -> None:
        try:
            write_state(self._file, state)
        except PalmbotsError:
            self.works, self._missing = False, state
        else:
            self._stored, self.works, self._missing = state, True, None

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._queue.put(None)
        self._thread.join()
