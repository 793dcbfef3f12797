# SPDX-License-Identifier: Apache-2.0
"""The driver of a robot for commands that take the place of its program, such as `calibrate`."""

import contextlib
from collections.abc import Iterator
from typing import Any

from palmbots._types import Side
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.runtime.greeting import scene_number
from palmbots.runtime.pair_file import Pair
from palmbots.runtime.stored_state import held, read_state
from palmbots.scene.scene import Scene

_WITHIN_S = 2.0  # the user has started the world before


@contextlib.contextmanager
def opened_driver(pair: Pair, side: Side, scene: Scene) -> Iterator[Any]:
    """Open the driver of a robot whose program does not run; the wheels stop at the end.

    Raises:
        PalmbotsError: the program runs, or the hardware cannot be used.
    """
    file = pair.state_file(side)
    with held(file):
        driver = SimulatedDriver(
            pair.settings.driver.address,
            side,
            read_state(file).epoch,
            scene.control.period_s,
            scene_number(scene),
            hardware=pair.settings.hardware.of(side),
            leads=(side == "right") == (scene.task.direction == "forward"),
            within_s=_WITHIN_S,
        )
        with contextlib.closing(driver):
            yield driver
            driver.stop()
