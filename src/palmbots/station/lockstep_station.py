# SPDX-License-Identifier: Apache-2.0
"""The station of the centralized algorithm in lockstep with a world.

Its frames are those of a robot (`palmbots.robot.lockstep_robot`); of an input it uses the
packets, and its answer is that of `_core.runtime.Station.step`.
"""

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.links.local_connection import connect
from palmbots.pair.pair_file import Pair
from palmbots.pair.stored_state import booted

_WORLD_STARTS_WITHIN_S = 20.0


def run_lockstep_station(pair: Pair) -> None:
    """Boot the station, and run it until the world ends the carry.

    Raises:
        PalmbotsError: a file is missing or damaged, or the world is lost.
    """
    address = pair.settings.driver.address
    with (
        booted(pair.state_file("station")) as state,
        connect(address, "world", _WORLD_STARTS_WITHIN_S) as world,
    ):
        station = _core.runtime.Station(pair.key, pair.settings.pair.number, state.epoch)
        world.send(["station", state.epoch, 0])  # it knows no scene
        while (frame := world.receive()) != "end":
            if frame[0] == "greet":
                world.send(station.greet(SIDES.index(frame[1])).hex())
            elif frame[0] == "hear":
                station.hear(bytes.fromhex(frame[1]))
            else:
                packets, *rest = station.step([*map(bytes.fromhex, frame[3])])
                sent = [(receiver, data.hex(), word) for receiver, data, word in packets]
                world.send([sent, *rest])
