# SPDX-License-Identifier: Apache-2.0
"""The shipped controllers as plain tables, and an abstract world to run them in.

In the abstract world contact coordinates are whole numbers of units, and the object obeys the two
properties that the paper's section 2 asks of the palm angles: on closing the contact on the
shallow palm slides up, on opening the one on the steep palm slides down. Where both palms are
alike, or one is turning, an adversary chooses. No friction, no geometry.
"""

import functools
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import palmbots._core as _core

SIGNS = (-1, 0, 1)
MESSAGES = NONE, TILT_UP, TILT_DOWN, ACK = range(4)
STEEP, SHALLOW = range(2)
HOLD, AWAY, CLOSER = range(3)
IDLE = 0

StepIn = tuple[int, int, bool]
"""Sign, message, turned."""


def sign(p: int) -> int:
    return (p > 0) - (p < 0)


class Step(NamedTuple):
    """What the distributed controller does on an input."""

    state: int
    palm: int
    move: int
    send: int
    read: bool
    name: str
    waits: bool


STEP_INPUTS: tuple[StepIn, ...] = tuple(product(SIGNS, MESSAGES, (False, True)))


def _replayed(prefix: tuple[StepIn, ...]) -> _core.Distributed:
    robot = _core.Distributed()
    for seen in prefix:
        robot.step(*seen)
    return robot


@functools.cache
def distributed_prefixes() -> dict[int, tuple[StepIn, ...]]:
    """Shortest inputs that bring the shipped controller into each of its states."""
    prefixes: dict[int, tuple[StepIn, ...]] = {IDLE: ()}
    for state in (queue := [IDLE]):
        for seen in STEP_INPUTS:
            prefix = (*prefixes[state], seen)
            reached = _replayed(prefix).state
            if reached not in prefixes:
                prefixes[reached] = prefix
                queue.append(reached)
    return prefixes


@functools.cache
def distributed_table() -> dict[tuple[int, StepIn], Step]:
    """The shipped controller's step, from every state on every input."""
    table = {}
    for state, prefix in distributed_prefixes().items():
        for seen in STEP_INPUTS:
            robot = _replayed(prefix)
            out = robot.step(*seen)
            table[state, seen] = Step(robot.state, *out, robot.name, robot.waits)
    return table


Report = tuple[int, int, bool]
"""Sign, palm last commanded, turned."""
StationState = tuple[int, int]
"""Case in progress and stage."""
REPORTS: tuple[Report, ...] = tuple(product(SIGNS, (STEEP, SHALLOW), (False, True)))
START: StationState = (0, 0)


class Orders(NamedTuple):
    """What the station does on two reports."""

    state: StationState
    palms: tuple[int, int]
    moves: tuple[int, int]


def _station(prefix: tuple[tuple[Report, Report], ...]) -> _core.Centralized:
    station = _core.Centralized()
    for reports in prefix:
        station.step(*reports)
    return station


@functools.cache
def station_table() -> dict[tuple[StationState, Report, Report], Orders]:
    """The shipped station's step, from every state that it can reach on every pair of reports."""
    prefixes: dict[StationState, tuple[tuple[Report, Report], ...]] = {START: ()}
    table = {}
    for state in (queue := [START]):
        for reports in product(REPORTS, REPORTS):
            station = _station(prefixes[state])
            palm_l, move_l, palm_r, move_r = station.step(*reports)
            reached = station.case_number, station.stage
            table[(state, *reports)] = Orders(reached, (palm_l, palm_r), (move_l, move_r))
            if reached not in prefixes:
                prefixes[reached] = (*prefixes[state], reports)
                queue.append(reached)
    return table


Contacts = tuple[int, int]


def moved(p: Contacts, palms: tuple[int | None, int | None], closing: bool) -> Iterator[Contacts]:
    """Every way in which one unit of closing or opening can move the contacts.

    `palms`: STEEP, SHALLOW, or None for one that is turning.
    """
    if None in palms or palms[0] == palms[1]:
        sliders = (0, 1)
    else:
        sliders = (palms.index(SHALLOW if closing else STEEP),)
    for slider in sliders:
        step = 1 if closing else -1
        yield (p[0] + step, p[1]) if slider == 0 else (p[0], p[1] + step)
