# SPDX-License-Identifier: Apache-2.0
"""The program of one robot in the compiled core, as it starts after a boot."""

from typing import Any

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.control.registry import ControllerEntry, check_on_robots, resolve
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import StoredState
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec


def controller_of(pair: Pair) -> ControllerEntry:
    """The controller of a pair.

    Raises:
        PalmbotsError: there is no such controller, or no robot can run it.
    """
    entry = resolve(pair.settings.pair.controller, folder=str(pair.file.parent))
    check_on_robots(entry)
    return entry


def check_works(scene: Scene, side: Side) -> None:
    """Raise `PalmbotsError` for a robot that stands aside."""
    if side not in scene.working_sides:
        raise PalmbotsError(
            f'--side: value is {side}, and with task.dock = "alone" this robot stands aside; '
            f"allowed: {scene.working_sides[0]}"
        )


def robot_program(
    pair: Pair,
    side: Side,
    state: StoredState,
    scene: Scene,
    settings: Any,
    *,
    carries: bool = False,
) -> Any:
    """The core's program of one robot.

    Args:
        pair: the pair.
        side: which of its robots.
        state: what it has stored, this boot included.
        scene: the scene of the pair.
        settings: `_core.runtime.RuntimeSettings`.
        carries: the carry is under way from the first tick on, as in lockstep.
    """
    spec = to_spec(scene)
    return _core.runtime.Robot(
        spec,
        controller_of(pair).for_core(spec),
        SIDES.index(side),
        pair.key,
        pair.settings.pair.number,
        epoch=state.epoch,
        assists=state.assists,
        settings=settings,
        carries=carries,
        stored_carries=state.carries,
        stored_stop=state.stop,
        holds=state.holds,
    )
