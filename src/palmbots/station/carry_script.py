# SPDX-License-Identifier: Apache-2.0
"""What `palmbots station --auto` does in place of an operator."""

from collections.abc import Generator, Iterator

from palmbots.station.station import GONE_AFTER_S, UNDER_WAY, Station

_SETTLE_STEPS = 10  # the robots hear each other meanwhile
_STOPS_WITHIN_S = 5.0
_MOST_TRIES = 3  # to arm robots that are heard: what prevents it does not end on its own
_BY = "script"


def carry_once(station: Station, within_s: float) -> Iterator[bool | None]:
    """Arm and start both robots, and wait until both are done.

    Yields None after every step of the station, and at last whether both robots are done. A robot
    that stops, has a fault or no longer carries stops both, and is not armed again. A station that
    is started again goes on with the carry that was under way, also if it is over by now.

    Args:
        station: the station; the caller steps it.
        within_s: time until the start at the latest.
    """
    give_up = station.clock() + within_s
    settled_steps = 0
    while settled_steps < _SETTLE_STEPS and station.clock() < give_up:
        settled_steps = settled_steps + 1 if station.hears_all() else 0
        if station.claimed_twice():
            yield from _stopped(station)
            return
        yield None
    is_resumed = station.was_carrying and set(station.modes().values()) != {"armed"}
    if not is_resumed and not (yield from _started(station, give_up)):
        yield from _stopped(station, f"{_BY} (the robots have not started)")
        return
    station.keep_carrying(True)
    while True:
        modes = station.modes()
        if gone := station.gone():
            text = f"{' and '.join(gone)} not heard for {GONE_AFTER_S:g} s"
            yield from _stopped(station, f"{_BY} ({text})")
            return
        if station.hears_all() and set(modes.values()) == {"done"}:
            station.keep_carrying(False)
            yield True
            return
        is_over = station.hears_all() and not set(UNDER_WAY) & set(modes.values())
        if is_over or {"stopped", "fault"} & set(modes.values()):
            yield from _stopped(station)
            return
        yield None


def _started(station: Station, give_up: float) -> Generator[None, None, bool]:
    """Arm and start; the value is whether both robots have started."""
    tries = 0
    for operation in ("arm", "start"):
        station.wish(operation, _BY)
        while not station.is_done():
            is_stopped = "stopped" in station.modes().values()
            if station.clock() > give_up or is_stopped or station.has_fallen_back():
                return False
            if station.claimed_twice():
                return False
            if station.has_lapsed():
                tries += station.hears_all()
                if operation == "start" or tries == _MOST_TRIES:
                    return False
                station.wish(operation, _BY)
            yield None
    return True


def _stopped(station: Station, by: str = _BY) -> Iterator[bool | None]:
    """Stop both robots, those that are heard; yields False at last."""
    station.keep_carrying(False)
    station.wish("stop", by)
    give_up = station.clock() + _STOPS_WITHIN_S
    while station.clock() < give_up:
        if station.is_done() or (station.gone() and set(station.modes().values()) <= {"stopped"}):
            break
        yield None
    yield False
