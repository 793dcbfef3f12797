# SPDX-License-Identifier: Apache-2.0
"""Table 2 of the paper, transcribed in tests/support/table2_transcript.py, against the shipped
controller on every input; and one robot through each of its cases."""

import pytest

from abstract_world import (
    ACK,
    AWAY,
    CLOSER,
    HOLD,
    IDLE,
    NONE,
    SHALLOW,
    STEEP,
    STEP_INPUTS,
    TILT_DOWN,
    TILT_UP,
    StepIn,
    distributed_prefixes,
    distributed_table,
)
from table2_transcript import Deed, Robot, tick


def test_every_state_and_input() -> None:
    """Shipped states and places in the table correspond one to one, and so does all they do."""
    table = distributed_table()
    place = {IDLE: Robot()}
    for state in (queue := [IDLE]):
        for seen in STEP_INPUTS:
            robot, deed = tick(place[state], seen)
            step = table[state, seen]
            shown = Deed(step.palm, step.move, step.send, step.read, step.name, step.waits)
            assert shown == deed, f"state {state}, {place[state]}, input {seen}"
            if step.state not in place:
                place[step.state] = robot
                queue.append(step.state)
            assert place[step.state] == robot, f"state {state}, input {seen}"
    assert len(set(place.values())) == len(place)


def test_every_state_is_reached() -> None:
    assert sorted(distributed_prefixes()) == list(range(14))
    assert len(distributed_table()) == 14 * 3 * 4 * 2


# One robot through each case, tick by tick: (input, (palm, move, send)).
U, D = SHALLOW, STEEP
CASES: dict[str, list[tuple[StepIn, tuple[int, int, int]]]] = {
    "a": [
        ((1, NONE, True), (D, HOLD, TILT_UP)),
        ((1, NONE, True), (D, HOLD, NONE)),
        ((1, ACK, True), (D, AWAY, NONE)),
        ((1, NONE, True), (D, AWAY, NONE)),
        ((0, NONE, True), (D, HOLD, TILT_DOWN)),
        ((0, NONE, True), (D, HOLD, NONE)),
    ],
    "b": [
        ((1, NONE, True), (D, HOLD, TILT_UP)),
        ((1, TILT_UP, True), (D, HOLD, ACK)),
        ((1, NONE, True), (D, HOLD, NONE)),
        ((1, ACK, True), (D, AWAY, NONE)),
        ((0, NONE, True), (U, HOLD, NONE)),
        ((0, NONE, False), (U, HOLD, NONE)),
        ((0, NONE, True), (U, HOLD, TILT_DOWN)),
        ((0, TILT_DOWN, True), (D, HOLD, NONE)),
        ((0, NONE, False), (D, HOLD, NONE)),
        ((0, NONE, True), (D, HOLD, NONE)),
    ],
    "c": [
        ((0, TILT_UP, True), (U, HOLD, NONE)),
        ((0, NONE, False), (U, HOLD, NONE)),
        ((0, NONE, True), (U, HOLD, ACK)),  # the Ack says that the palm has turned
        ((-1, NONE, True), (U, HOLD, NONE)),  # first it completes its role
        ((-1, TILT_DOWN, True), (D, HOLD, NONE)),
        ((-1, NONE, False), (D, HOLD, NONE)),
        ((-1, NONE, True), (D, HOLD, NONE)),
        ((-1, NONE, True), (U, HOLD, NONE)),  # then (d)
    ],
    "d": [
        ((-1, NONE, True), (U, HOLD, NONE)),
        ((-1, NONE, False), (U, HOLD, NONE)),  # it moves only once its palm has turned
        ((-1, TILT_UP, True), (U, CLOSER, NONE)),  # and leaves the request for later
        ((-1, TILT_UP, True), (U, CLOSER, NONE)),
        ((0, TILT_UP, True), (D, HOLD, NONE)),
        ((0, TILT_UP, True), (D, HOLD, NONE)),
        ((0, TILT_UP, True), (U, HOLD, NONE)),  # then (c)
    ],
}


@pytest.mark.parametrize("case", CASES)
def test_one_robot_through_each_case(case: str) -> None:
    table = distributed_table()
    state = IDLE
    for k, (seen, expected) in enumerate(CASES[case]):
        step = table[state, seen]
        assert (step.palm, step.move, step.send) == expected, f"tick {k}"
        state = step.state


def test_request_goes_before_own_negative_contact() -> None:
    """The columns (c) and (d): the message is checked first, then p < 0."""
    table = distributed_table()
    assert table[IDLE, (-1, TILT_UP, True)].name == "c"
    assert table[IDLE, (-1, NONE, True)].name == "d"
