# SPDX-License-Identifier: Apache-2.0
"""The shipped distributed algorithm, two robots at a time: all possible runs in an abstract world.

tests/paper/test_table2.py checks Table 2 itself; tests/transcripts has whole conversations.
"""

from collections.abc import Iterator
from typing import NamedTuple

import pytest

from abstract_world import (
    ACK,
    AWAY,
    CLOSER,
    IDLE,
    NONE,
    SHALLOW,
    STEEP,
    TILT_UP,
    Contacts,
    distributed_table,
    moved,
    sign,
)


class State(NamedTuple):
    """Two robots in the abstract world, between two control cycles."""

    p: Contacts
    robots: tuple[int, int]
    palms: tuple[int, int]
    turning: tuple[int, int]
    inbox: tuple[tuple[int, ...], tuple[int, ...]]


class Sighting(NamedTuple):
    """The observations of one cycle: the robots' moves, and whether an unexpected message
    arrived."""

    moves: tuple[int, int]
    confused: bool


ORDERS = ((0,), (1,)), ((1,), (0,)), ((0, 1),)


def cycles(now: State, turn: int) -> Iterator[tuple[State, Sighting]]:
    """Every control cycle from here: the robots in either order or simultaneously, a message
    delivered at once; then at most one unit of motion, with an adversary who chooses between equal
    palms."""
    for order in ORDERS:
        robots, palms, turning = list(now.robots), list(now.palms), list(now.turning)
        inbox, moves, confused = [list(box) for box in now.inbox], [0, 0], False
        for together in order:
            sent = []
            for s in together:
                message = inbox[s][0] if inbox[s] else NONE
                step = distributed_table()[robots[s], (sign(now.p[s]), message, turning[s] == 0)]
                if step.read:
                    inbox[s].pop(0)
                    stray = robots[s] == IDLE and message != TILT_UP
                    confused |= stray or step.state == robots[s]
                turning[s] = turn if step.palm != palms[s] else max(0, turning[s] - 1)
                robots[s], palms[s], moves[s] = step.state, step.palm, step.move
                sent.append((1 - s, step.send))
            for to, message in sent:
                if message != NONE:
                    inbox[to].append(message)
        seen = Sighting((moves[0], moves[1]), confused)
        places = [now.p]
        if AWAY in moves or CLOSER in moves:
            angles = [None if turning[s] else palms[s] for s in (0, 1)]
            places = list(moved(now.p, (angles[0], angles[1]), closing=CLOSER in moves))
        for p in places:
            yield (
                State(
                    p,
                    (robots[0], robots[1]),
                    (palms[0], palms[1]),
                    (turning[0], turning[1]),
                    (tuple(inbox[0]), tuple(inbox[1])),
                ),
                seen,
            )


def start(p: Contacts) -> State:
    return State(p, (IDLE, IDLE), (STEEP, STEEP), (0, 0), ((), ()))


GOAL = start((0, 0))


class Explored(NamedTuple):
    """All reachable states, and the largest number of cycles before the goal."""

    states: int
    longest: int
    rises: bool


def explore(starts: list[Contacts], turn: int) -> Explored:
    """Follows every run; AssertionError for a deadlock, a livelock, away against closer, or an
    unexpected message."""
    put_off: dict[State, int] = {GOAL: 0}
    on_the_way: set[State] = set()
    rises = False
    assert all(state == GOAL for state, _ in cycles(GOAL, turn))
    for p in starts:
        stack: list[tuple[State, Iterator[State]]] = []

        def enter(state: State) -> Iterator[State]:
            nonlocal rises
            on_the_way.add(state)
            after = []
            for then, seen in cycles(state, turn):
                assert set(seen.moves) != {AWAY, CLOSER}, f"away and closer: {state}"
                assert not seen.confused, f"confused: {state}"
                assert max(map(len, then.inbox)) <= 2, f"messages pile up: {state}"
                rises |= sum(map(abs, then.p)) > sum(map(abs, state.p))
                after.append(then)
            put_off[state] = -1
            return iter(after)

        if start(p) in put_off:
            continue
        stack.append((start(p), enter(start(p))))
        while stack:
            state, after = stack[-1]
            for then in after:
                # A cycle short of the goal is a deadlock or a livelock.
                assert then not in on_the_way, f"never ends: {state}"
                if then not in put_off:
                    stack.append((then, enter(then)))
                    break
            else:
                stack.pop()
                on_the_way.discard(state)
                put_off[state] = 1 + max(put_off[then] for then, _ in cycles(state, turn))
    return Explored(len(put_off), max(put_off.values()), rises)


NEAR = [(a, b) for a in range(-3, 4) for b in range(-3, 4)]


def test_every_run_reaches_the_goal() -> None:
    """Reliable, prompt delivery, for any order of the robots and whichever contact slides: no
    deadlock, no livelock, no unexpected message, never one robot moving away while the other moves
    closer, and |p_L| + |p_R| never rises."""
    explored = explore(NEAR, turn=0)
    assert explored.states > 200
    assert not explored.rises


@pytest.mark.parametrize("turn", [1, 3])
def test_slow_palms_reach_the_same_goal(turn: int) -> None:
    """The same except for the last property: while a palm turns, either contact may slide."""
    explored = explore(NEAR, turn)
    assert explored.longest > explore(NEAR, 0).longest


def test_exploration_sees_a_livelock(monkeypatch: pytest.MonkeyPatch) -> None:
    """A controller that never sends its Ack is detected."""
    silent = {
        key: step._replace(send=NONE) if step.send == ACK else step
        for key, step in distributed_table().items()
    }
    monkeypatch.setitem(globals(), "distributed_table", lambda: silent)
    with pytest.raises(AssertionError, match=r"never ends|pile up"):
        explore([(0, 1)], turn=0)


def case_of(state: int) -> str:
    """The case of a state."""
    return next(step.name for step in distributed_table().values() if step.state == state)


def test_both_palms_shallow_only_in_states_of_the_paper() -> None:
    """(d) with (d), and the ends of (b) with (b); never with one robot moving away."""
    seen = {GOAL}
    queue = [start(p) for p in NEAR]
    for state in queue:
        for then, sight in cycles(state, 0):
            if then.palms == (SHALLOW, SHALLOW):
                names = {case_of(robot) for robot in then.robots}
                assert names in ({"d"}, {"b"}), then
                assert AWAY not in sight.moves
            if then not in seen:
                seen.add(then)
                queue.append(then)
                assert len(seen) < 10_000, "messages pile up"
