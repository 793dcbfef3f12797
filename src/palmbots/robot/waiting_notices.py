# SPDX-License-Identifier: Apache-2.0
"""Lines for a person at a robot, on what its program waits for: hardware, a world, another end."""

import threading
from collections.abc import Callable, Collection, Mapping
from shlex import quote

from palmbots._types import SIDES, Side
from palmbots.pair.pair_file import Pair
from palmbots.scene.command_text import command_text
from palmbots.wire import Role

PATIENCE_S = 3.0


class Waiting:
    """Prints what a program waits for, once it has waited for `PATIENCE_S`.

    Args:
        on_line: called with the line.
    """

    def __init__(self, on_line: Callable[[str], None]) -> None:
        self._on_line = on_line
        self._timer: threading.Timer | None = None

    def begin(self, text: str) -> None:
        """The program waits for this from now on, and for nothing else."""
        self.end()
        self._timer = threading.Timer(PATIENCE_S, self._on_line, (text,))
        self._timer.daemon = True
        self._timer.start()

    def end(self) -> None:
        """The program waits no longer."""
        if self._timer is not None:
            self._timer.cancel()


def hardware_text(pair: Pair, side: Side) -> str:
    """What a robot waits for until its driver is open."""
    driver = pair.settings.driver
    if driver.kind != "simulated":
        return f"{side}: waits for the hardware of driver {driver.kind}"
    place = driver.address_of(side)
    command = command_text("world", quote(pair.scene()), serve=place)
    return f"{side}: waits for a world at {place}; run: {command}"


def reading_text(pair: Pair, side: Side) -> str:
    """What a robot waits for until the first reading of its driver."""
    driver = pair.settings.driver
    if driver.kind != "simulated":
        return f"{side}: waits for the first reading of driver {driver.kind}"
    other = partner_of(side)
    command = command_text("robot", quote(str(pair.file)), side=other)
    return f"{side}: the world waits for the {other} robot; run: {command}"


def partner_of(side: Side) -> Side:
    """The other robot."""
    return SIDES[1 - SIDES.index(side)]


class Silence:
    """Prints once which other ends a robot has not heard since its start, and later each one that
    it hears.

    Args:
        side: of the robot.
        ends: the ends that it should hear, with their addresses.
        patience: steps after which the ends that are still unheard are named.
        on_line: called with each line.
    """

    def __init__(
        self,
        side: Side,
        ends: Mapping[Role, str],
        patience: int,
        on_line: Callable[[str], None],
    ) -> None:
        self._side, self._patience, self._on_line = side, patience, on_line
        self._unheard = {end: _named(end, address) for end, address in ends.items()}
        self._is_named = False

    def step(self, heard: Collection[Role]) -> None:
        """A step of the robot, which has heard these ends so far."""
        if not self._unheard:
            return
        for end in [end for end in self._unheard if end in heard]:
            name = self._unheard.pop(end)
            if self._is_named:
                self._on_line(f"{self._side}: now hears {name}")
        self._patience -= 1
        if self._patience == 0 and self._unheard:
            self._is_named = True
            names = " or ".join(self._unheard.values())
            self._on_line(f"{self._side}: has not heard {names} yet; check program and address")


def _named(end: Role, address: str) -> str:
    return f"the station ({address})" if end == "station" else f"the {end} robot ({address})"
