# SPDX-License-Identifier: Apache-2.0
"""The driver of a robot for commands that take the place of its program, such as `calibrate`."""

import contextlib
from collections.abc import Iterator
from typing import Any

from palmbots._types import Side
from palmbots.pair.live_ends import open_pair_driver
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import held, read_state
from palmbots.scene.scene import Scene

_WITHIN_S = 3.0  # the user has started the world before, or is just doing it


@contextlib.contextmanager
def opened_driver(pair: Pair, side: Side, scene: Scene) -> Iterator[Any]:
    """Open the driver of a robot whose program does not run; the wheels stop at the end.

    Raises:
        PalmbotsError: the program runs, or the hardware cannot be used.
    """
    file = pair.state_file(side)
    with held(file):
        epoch = read_state(file).epoch
        driver = open_pair_driver(pair, side, scene, epoch=epoch, within_s=_WITHIN_S)
        with contextlib.closing(driver):
            yield driver
            driver.stop()
