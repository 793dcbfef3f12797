# SPDX-License-Identifier: Apache-2.0
"""A world whose robots are other processes, in lockstep: no robot moves before both have answered.

The world draws every random number, for noise, faults and the radio, through which it passes the
packets as bytes. So a carry has the same trace as one inside a single program.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from socket import socket
from typing import Any, Protocol

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.control.registry import ControllerEntry
from palmbots.errors import PalmbotsError
from palmbots.node.frames import Connection, ConnectionLost
from palmbots.node.greeting import greeted

_START_WITHIN_S = 30.0
_ANSWER_WITHIN_S = 30.0
_Input = tuple[int, int, bool, bool, list[bytes]] | None


class Robots:
    """The connections to the programs of both robots, and the exchange of one tick."""

    def __init__(self, door: socket, on_boot: Callable[[str, int], None] | None = None) -> None:
        self._door = door
        self._on_boot = on_boot
        self._programs: dict[str, Connection] = {}

    def wait_for(self, sides: set[str]) -> None:
        """Wait until the programs of these robots have connected.

        Raises:
            PalmbotsError: a program does not connect in time, or two claim one side.
        """
        while sides - set(self._programs):
            missing = " and ".join(sorted(sides - set(self._programs)))
            self._door.settimeout(_START_WITHIN_S)
            try:
                stream, _ = self._door.accept()
            except TimeoutError:
                raise PalmbotsError(
                    f"robots: {missing} did not connect within {_START_WITHIN_S:g} s"
                ) from None
            program = Connection(stream, "a program")
            side, epoch = greeted(program)
            if side in self._programs:
                program.close()
                raise PalmbotsError(f"robots: two programs claim to be the {side} robot")
            program.name = f"{side} robot"
            self._programs[side] = program
            if self._on_boot is not None:
                self._on_boot(side, epoch)

    def establish_session(self) -> None:
        """Let both robots exchange hellos before the carry, without the radio, as after arming."""
        establish_session(*(_Greeter(self._programs[side]) for side in SIDES))

    def exchange(self, tick: int, left: _Input, right: _Input, station: _Input) -> list[Any]:
        """Give each program its input of a tick, and return the answers of both and None."""
        inputs = dict(zip(SIDES, (left, right), strict=True))
        for side, given in inputs.items():
            if given is not None:
                elapsed, sign, palm_at_target, boots, packets = given
                if boots:
                    self._reboot(side)
                frame = [elapsed, sign, palm_at_target, [data.hex() for data in packets]]
                self._programs[side].send(frame)
        return [*(None if inputs[s] is None else self._answer(s) for s in SIDES), None]

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

    def _reboot(self, side: str) -> None:
        program = self._programs.pop(side)
        program.send("reboot")
        program.close()
        self.wait_for({side})

    def _answer(self, side: str) -> Any:
        palm, move, stop, packets, *rest = self._programs[side].receive(_ANSWER_WITHIN_S)
        sent = [(receiver, bytes.fromhex(data), word) for receiver, data, word in packets]
        return (palm, move, stop, sent, *rest)


class Greeter(Protocol):
    """What can open a session before a carry: a robot's program, or a connection to it."""

    def greet(self) -> bytes | None:
        """A hello to the partner; None if the controller has no use for it."""
        ...

    def hear(self, data: bytes, /) -> None:
        """Take in the partner's hello."""
        ...


def establish_session(left: Greeter, right: Greeter) -> None:
    """Pass the three hellos after which both robots accept each other's packets."""
    for sender, receiver in ((left, right), (right, left), (left, right)):
        hello = sender.greet()
        if hello is None:
            return
        receiver.hear(hello)


class _Greeter:
    def __init__(self, program: Connection) -> None:
        self._program = program

    def greet(self) -> bytes | None:
        self._program.send("greet")
        hello = self._program.receive(_ANSWER_WITHIN_S)
        return None if hello is None else bytes.fromhex(hello)

    def hear(self, data: bytes, /) -> None:
        self._program.send(["hear", data.hex()])


@dataclass(frozen=True)
class RemoteEntry(ControllerEntry):
    """A controller that runs in other processes."""

    exchange: Callable[..., list[Any]] | None = None

    def for_core(self, spec: _core.Spec) -> Any:
        """The argument that the compiled core takes."""
        uses_clock = _core.runtime.uses_clock(super().for_core(spec))
        return _core.runtime.RemoteControllers(self.exchange, uses_clock, uses_clock)


def remote(entry: ControllerEntry, exchange: Callable[..., list[Any]]) -> ControllerEntry:
    """The same controller, whose programs are reached through `exchange`.

    Raises:
        PalmbotsError: no robot runs this controller.
    """
    if entry.is_reference or entry.team != "robots":
        why = {"none": "has no programs", "station": "needs a station"}.get(
            entry.team, "reads the state of the world"
        )
        raise PalmbotsError(f"controller: {entry.name} {why}; allowed: a controller of robots")
    values = {field.name: getattr(entry, field.name) for field in fields(ControllerEntry)}
    return RemoteEntry(**values, exchange=exchange)
