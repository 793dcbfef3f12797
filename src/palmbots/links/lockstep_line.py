# SPDX-License-Identifier: Apache-2.0
"""The line from a program to its world in lockstep: both wait for each other in every tick.

Frames (`palmbots.links.local_connection`), one JSON line each:

- program → world: ``["left", epoch, scene]`` once, when the program has booted
  (`palmbots.links.greeting`).
- world → program: ``["greet", end]``, answered by a hello to that end or null, and
  ``["hear", packet]``, before the carry.
- world → program: ``[elapsed, sign, palm_at_target, [packet, …], [touches, arm_there, far_enough,
  arm_steps, beneath]]`` in every tick in which the program runs, or ``"reboot"``, or ``"end"``.
  Packets are hexadecimal.
- program → world: the answer of `_core.runtime.Robot.step`, or of `Station.step`, with the packets
  in hexadecimal.
"""

import os
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from palmbots.errors import PalmbotsError
from palmbots.links.greeting import check_admitted
from palmbots.links.local_connection import connect
from palmbots.wire import Role

REBOOTED = 3
"""The exit status of a program that its world has rebooted."""
_WORLD_STARTS_WITHIN_S = 20.0


class Input(NamedTuple):
    """What a program gets in a tick."""

    elapsed: int
    """Ticks of its clock since the last one."""
    sign: int
    palm_at_target: bool
    packets: list[bytes]
    senses: tuple[bool, bool, bool, int, bool]
    """Of a job on the floor: whether something presses the palm, whether the arm has reached the
    height last commanded, whether the distance is covered, the steps of the arm, and whether the
    robot is in its place below an object on a stand."""


class LockstepLine:
    """The program's end of the line.

    Args:
        address: of the world.
        end: ``left``, ``right`` or ``station``.
        epoch: number of the program's boots.
        scene: `palmbots.links.greeting.scene_number`; 0: the program knows no scene.

    Raises:
        ConnectionLost: there is no world.
    """

    def __init__(self, address: str, end: Role, epoch: int, scene: int = 0) -> None:
        self._world = connect(address, "world", _WORLD_STARTS_WITHIN_S)
        self._end = end
        self._world.send([end, epoch, scene])

    def next(
        self, greet: Callable[[Role], bytes | None], hear: Callable[[bytes], None]
    ) -> Input | None:
        """Wait for the next tick; None: the carry is over.

        Args:
            greet: makes the hello to an end, before the carry.
            hear: takes in the hello of another program.

        Raises:
            PalmbotsError: the world is lost, or does not run in lockstep.
        """
        while (frame := self._world.receive()) != "end":
            check_admitted(frame, self._end)
            if frame == "reboot":
                os._exit(REBOOTED)  # as after a power failure: nothing is cleaned up
            if frame[0] == "greet":
                hello = greet(frame[1])
                self._world.send(None if hello is None else hello.hex())
            elif frame[0] == "hear":
                hear(bytes.fromhex(frame[1]))
            elif len(frame) != 5:
                raise PalmbotsError("world: does not run in lockstep; allowed: one with --lockstep")
            else:
                elapsed, sign, palm_at_target, packets, senses = frame
                arrived = [*map(bytes.fromhex, packets)]
                return Input(elapsed, sign, palm_at_target, arrived, senses)
        return None

    def answer(self, *values: Any, packets: Sequence[tuple[int, bytes, int]], at: int) -> None:
        """Answer a tick: the values, with the packets (receiver, bytes, message) at this place."""
        sent = [(receiver, data.hex(), message) for receiver, data, message in packets]
        self._world.send([*values[:at], sent, *values[at:]])

    def close(self) -> None:
        """Close the line."""
        self._world.close()
