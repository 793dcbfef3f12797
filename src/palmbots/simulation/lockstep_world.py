# SPDX-License-Identifier: Apache-2.0
"""A world whose robots are other processes, in lockstep: no robot moves before both have answered.

The world draws every random number, for noise, faults and the radio, through which it passes the
packets as bytes. So a carry has the same trace as one inside a single program.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from socket import socket
from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.control.registry import ControllerEntry, check_on_robots
from palmbots.links.local_connection import Connection, ConnectionLost
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.entrance import Entrance

_ANSWER_WITHIN_S = 30.0
ENDS = (*SIDES, "station")


class Programs:
    """The connections to the programs of robots and station, and the exchange of one tick.

    Args:
        door: where the programs connect.
        ends: whose programs there are.
        scene: `scene_number` of the world; 0: not compared.
    """

    def __init__(self, door: socket, ends: tuple[str, ...], scene: int = 0) -> None:
        self._ends, self._entrance = ends, Entrance(door, ends, scene)
        self._programs: dict[str, Connection] = {}

    def wait(self) -> None:
        """Wait until all programs have connected, and let them greet each other.

        Raises:
            PalmbotsError: a program does not connect in time.
        """
        self._enter()
        establish_sessions(self._ends, self._greet, self._hear)

    def exchange(self, tick: int, *inputs: Any) -> list[Any]:
        """Give each program its input of a tick, and return the answers."""
        given = dict(zip(ENDS, inputs, strict=True))
        for end, value in given.items():
            if value is not None:
                elapsed, sign, palm_at_target, boots, packets, senses = value
                if boots:
                    self._reboot(end)
                arrived = [data.hex() for data in packets]
                self._programs[end].send([elapsed, sign, palm_at_target, arrived, senses])
        return [None if value is None else self._answer(end) for end, value in given.items()]

    def close(self) -> None:
        """End all programs."""
        for program in self._programs.values():
            try:
                program.send("end")
            except ConnectionLost:
                continue
            finally:
                program.close()
        self._programs = {}

    def _enter(self) -> None:
        self._entrance.wait(
            lambda: set(self._ends) - set(self._programs), self._programs.__setitem__
        )

    def _greet(self, end: str, other: str) -> bytes | None:
        self._programs[end].send(["greet", other])
        hello = self._programs[end].receive(_ANSWER_WITHIN_S)
        return None if hello is None else bytes.fromhex(hello)

    def _hear(self, end: str, data: bytes) -> None:
        self._programs[end].send(["hear", data.hex()])

    def _reboot(self, end: str) -> None:
        program = self._programs.pop(end)
        program.send("reboot")
        program.close()
        self._enter()

    def _answer(self, end: str) -> Any:
        answer = self._programs[end].receive(_ANSWER_WITHIN_S)
        at = 0 if end == "station" else 3  # where the packets stand
        sent = [(receiver, bytes.fromhex(data), message) for receiver, data, message in answer[at]]
        return (*answer[:at], sent, *answer[at + 1 :])


def establish_sessions(
    ends: tuple[str, ...],
    greet: Callable[[str, str], bytes | None],
    hear: Callable[[str, bytes], None],
) -> None:
    """Pass the hellos after which all ends accept each other's packets, beside the radio.

    Args:
        ends: ``left``, ``right``, and perhaps ``station``, which then speaks with both.
        greet: makes the hello of one end to another; None if its controller has no use for it.
        hear: passes a hello to an end.
    """
    if not {*SIDES} <= {*ends}:
        return  # one that works alone talks to nobody
    if "station" in ends:
        talk = [pair for side in SIDES for pair in ((side, "station"), ("station", side))]
    else:
        talk = [SIDES, SIDES[::-1], SIDES]
    for sender, receiver in talk:
        hello = greet(sender, receiver)
        if hello is None:
            return
        hear(receiver, hello)


def ends_of(entry: ControllerEntry, scene: Scene) -> tuple[str, ...]:
    """Whose programs a carry needs. If one palm at a time holds the object, no controller acts."""
    has_station = entry.team == "station" and not to_spec(scene).on_one_palm
    return (*scene.working_sides, *(["station"] if has_station else []))


@dataclass(frozen=True)
class RemoteEntry(ControllerEntry):
    """A controller that runs in other processes."""

    exchange: Callable[..., list[Any]] | None = None

    def for_core(self, spec: _core.Spec) -> Any:
        """The argument that the compiled core takes."""
        return _core.runtime.RemoteControllers(
            self.exchange, self.uses_clock, self.team == "station"
        )


def remote(entry: ControllerEntry, exchange: Callable[..., list[Any]]) -> ControllerEntry:
    """The same controller, whose programs are reached through `exchange`.

    Raises:
        PalmbotsError: no robot runs this controller.
    """
    check_on_robots(entry)
    values = {field.name: getattr(entry, field.name) for field in fields(ControllerEntry)}
    return RemoteEntry(**values, exchange=exchange)
