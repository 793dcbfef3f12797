# SPDX-License-Identifier: Apache-2.0
"""A robot's program while a pair probes: `palmbots probe` commands its motors.

The program serves readings and takes commands as the motor board of a simulated robot does
(`palmbots.simulation.live_world.Board`). A command of the wheels holds for one control period: they
stand while `palmbots probe` computes, and when the connection is lost. The palm keeps its angle.
"""

import contextlib
import math
import time
from collections.abc import Callable

from palmbots._types import Side
from palmbots._util.end_signal import ended_by_signal
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import scene_number
from palmbots.links.local_connection import listen
from palmbots.pair.pair_file import Pair, probe_address
from palmbots.pair.stored_state import held, read_state
from palmbots.simulation.entrance import Entrance
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.live_world import Board
from palmbots.simulation.world_stage import RawStage, raw_frame

_PROBE_WITHIN_S = 20.0
_POLL_S = 0.01


def run_probe_robot(
    pair: Pair, side: Side, on_line: Callable[[str], None], *, lockstep: bool = False
) -> None:
    """Serve one robot until `palmbots probe` or the world ends, or SIGTERM or Ctrl-C.

    Args:
        pair: the pair.
        side: which of its robots.
        on_line: called with a line when `palmbots probe` is gone.
        lockstep: the world and `palmbots probe` wait for each other.

    Raises:
        PalmbotsError: a file is missing or damaged, `palmbots probe` does not connect in time, or
            the world is lost.
    """
    file, scene = pair.state_file(side), pair.checked_scene()
    number, period_s = scene_number(scene), scene.control.period_s
    with contextlib.ExitStack() as stack:
        stack.enter_context(held(file))
        epoch = read_state(file).epoch
        driver = SimulatedDriver(pair.settings.driver.address, side, epoch, period_s, number)
        stack.enter_context(contextlib.closing(driver))
        door = stack.enter_context(listen(probe_address(pair, side)))
        ended = stack.enter_context(ended_by_signal())
        board = Board(RawStage(Imperfections()), 0, 0, math.inf if lockstep else 1.0)
        entrance = Entrance(door, [side], number)
        give_up = time.monotonic() + _PROBE_WITHIN_S
        while board.driver is None and not ended.is_set():
            for _, program in entrance.admit([]):
                board.plug(program)
            if time.monotonic() > give_up:
                raise PalmbotsError(
                    f"{side} robot: no program that probes connected within {_PROBE_WITHIN_S:g} s"
                )
            time.sleep(_POLL_S)
        seen = driver.next_raw()
        if lockstep != driver.is_in_lockstep:
            raise PalmbotsError(
                f"{side} robot: its world runs {'in real time' if lockstep else 'in lockstep'}; "
                f"allowed: {'without' if lockstep else 'with'} --lockstep"
            )
        while not ended.is_set() and board.driver is not None and seen is not None:
            board.send(raw_frame(seen), waits=lockstep)
            if lockstep:
                board.await_command()
            else:
                board.take()
            driver.write_raw(board.command)
            seen = driver.next_raw()
        if board.driver is None:
            on_line(f"{side}: palmbots probe is gone; the wheels stop, and the palm stays")
        driver.stop()
        board.send("end")
        board.unplug()
