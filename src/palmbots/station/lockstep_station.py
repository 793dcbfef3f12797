# SPDX-License-Identifier: Apache-2.0
"""The station of the centralized algorithm in lockstep with a world."""

import contextlib

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.links.lockstep_line import LockstepLine
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import booted


def run_lockstep_station(pair: Pair) -> None:
    """Boot the station, and run it until the world ends the carry.

    Raises:
        PalmbotsError: a file is missing or damaged, or the world is lost.
    """
    with booted(pair.state_file("station")) as state:
        station = _core.runtime.Station(pair.key, pair.settings.pair.number, state.epoch)
        line = LockstepLine(pair.settings.driver.address, "station", state.epoch)
        with contextlib.closing(line):
            while seen := line.next(lambda end: station.greet(SIDES.index(end)), station.hear):
                packets, *rest = station.step(seen.packets)
                line.answer(*rest, packets=packets, at=0)
