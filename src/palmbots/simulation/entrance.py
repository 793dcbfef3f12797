# SPDX-License-Identifier: Apache-2.0
"""Where the programs of robots and station enter a world (`Entrance`)."""

import contextlib
import math
import time
from collections.abc import Callable, Collection
from socket import socket

from palmbots.errors import PalmbotsError
from palmbots.links.greeting import OTHER_SCENE, TAKEN, greeting_in, is_other_scene
from palmbots.links.local_connection import Connection, ConnectionLost

_START_WITHIN_S = 30.0
_PATIENCE_S = 3.0
_POLL_S = 0.01
_MOST_AT_ONCE = 10  # programs that connect in one tick


class Entrance:
    """Lets programs connect. Strangers, and a second program of an end, do not disturb the world.

    Args:
        door: where the programs connect.
        ends: whose programs there are.
        scene: `palmbots.links.greeting.scene_number` of the world; 0: not compared.
    """

    def __init__(self, door: socket, ends: Collection[str], scene: int) -> None:
        self._door, self._ends, self._scene = door, ends, scene
        self._unknown: list[tuple[float, Connection]] = []
        door.settimeout(0)

    def wait(
        self,
        missing: Callable[[], Collection[str]],
        plug: Callable[[str, Connection], None],
        on_line: Callable[[str], None] = lambda line: None,
    ) -> None:
        """Wait until no program is missing.

        Args:
            missing: whose programs are not there.
            plug: called with each program that has connected.
            on_line: called with a line that names the programs still missing after some seconds.

        Raises:
            PalmbotsError: one does not come.
        """
        begin, absent = time.monotonic(), missing()
        give_up, patient_until = begin + _START_WITHIN_S, begin + _PATIENCE_S
        while absent:
            for end, program in self.admit([end for end in self._ends if end not in absent]):
                plug(end, program)
            now = missing()
            if set(absent) - set(now):
                give_up = time.monotonic() + _START_WITHIN_S
            absent = now
            if time.monotonic() > give_up:
                raise PalmbotsError(
                    f"robots: {_and(absent)} did not connect within {_START_WITHIN_S:g} s"
                )
            if absent:
                if time.monotonic() > patient_until:
                    patient_until = math.inf
                    on_line(f"waits for the programs of {_and(absent)}")
                time.sleep(_POLL_S)

    def admit(self, taken: Collection[str]) -> list[tuple[str, Connection]]:
        """The programs that have connected and said who they are; never waits.

        Args:
            taken: the ends that have a program already.
        """
        with contextlib.suppress(BlockingIOError, ConnectionAbortedError):
            for _ in range(_MOST_AT_ONCE):
                stream, _ = self._door.accept()
                self._unknown.append((time.monotonic(), Connection(stream, "a program")))
        admitted: dict[str, Connection] = {}
        for entry in [*self._unknown]:
            since, program = entry
            try:
                frame = program.poll()
                if frame is None and time.monotonic() - since < _START_WITHIN_S:
                    continue
                greeting = greeting_in(frame, self._ends)
            except PalmbotsError:
                program.close()
            else:
                end = greeting.end
                is_taken = end in taken or end in admitted
                if is_taken or is_other_scene(greeting, self._scene):
                    with contextlib.suppress(ConnectionLost):
                        program.send(TAKEN if is_taken else OTHER_SCENE)
                    program.close()
                else:
                    program.name = end if end == "station" else f"{end} robot"
                    admitted[end] = program
            self._unknown.remove(entry)
        return [*admitted.items()]


def _and(ends: Collection[str]) -> str:
    return " and ".join(sorted(ends))
