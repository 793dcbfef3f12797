# SPDX-License-Identifier: Apache-2.0
"""A robot's program in lockstep with a world: both wait for each other in every tick.

Frames (`palmbots.links.local_connection`), one JSON line each:

- robot → world: ``["left", epoch, scene]`` once, when the program has booted
  (`palmbots.links.greeting`).
- world → robot: ``["greet", end]``, answered by a hello to that end or null, and
  ``["hear", packet]``, before the carry.
- world → robot: ``[elapsed, sign, palm_at_target, [packet, …]]`` in every tick in which the program
  runs, or ``"reboot"``, or ``"end"``. Packets are hexadecimal.
- robot → world: the answer of `_core.runtime.Robot.step`, with the packets in hexadecimal.
"""

import os
from dataclasses import replace
from typing import Any

import palmbots._core as _core
from palmbots._types import Side
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import scene_number
from palmbots.links.local_connection import connect
from palmbots.pair.pair_file import Pair
from palmbots.pair.processes import REBOOTED
from palmbots.pair.stored_state import StateFile, StoredState, booted, write_state
from palmbots.robot.robot_program import robot_program
from palmbots.scene.scene import load_scene

_WORLD_STARTS_WITHIN_S = 20.0


def run_robot(pair: Pair, side: Side) -> int:
    """Boot the program of one robot, and run it until the world ends the carry.

    Returns:
        How often the robot has booted.

    Raises:
        PalmbotsError: a file is missing or damaged, or the world is lost.
    """
    file = pair.state_file(side)
    with booted(file) as state:
        return _run(pair, side, state, file)


def _run(pair: Pair, side: Side, state: StoredState, file: StateFile) -> int:
    settings = _core.runtime.RuntimeSettings.lockstep()
    scene = load_scene(pair.scene())
    robot = robot_program(pair, side, state, scene, settings, carries=True)
    address = pair.settings.driver.address
    with connect(address, "world", _WORLD_STARTS_WITHIN_S) as world:
        world.send([side, state.epoch, scene_number(scene)])
        while True:
            frame = world.receive()
            if frame == "end":
                return state.epoch
            if frame == "reboot":
                os._exit(REBOOTED)  # as after a power failure: nothing is cleaned up
            if frame[0] == "greet":
                hello = robot.greet()
                world.send(None if hello is None else hello.hex())
                continue
            if frame[0] == "hear":
                robot.hear(bytes.fromhex(frame[1]))
                continue
            if len(frame) != 4:
                raise PalmbotsError("world: does not run in lockstep; allowed: one with --lockstep")
            elapsed, sign, palm_at_target, packets = frame
            reading = _core.runtime.Reading(sign, palm_at_target)
            answer = robot.step(elapsed, reading, [*map(bytes.fromhex, packets)])
            *_, assists = answer
            if assists != state.assists:  # before the packet that grants is sent
                state = replace(state, assists=assists)
                write_state(file, state)
            world.send(_in_hexadecimal(answer))


def _in_hexadecimal(answer: Any) -> list[Any]:
    palm, move, stop, packets, *rest = answer
    sent = [(receiver, data.hex(), word) for receiver, data, word in packets]
    return [palm, move, stop, sent, *rest]
