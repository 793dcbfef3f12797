# SPDX-License-Identifier: Apache-2.0
"""The check of derived algorithms: against an independent search, and on ones with a defect."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from machine_search import MachineSearch
from palmbots.derivation.distributed_algorithm import Machine, MachineRow, machines_of
from palmbots.derivation.policy_file import PolicyTable, read_policy
from palmbots.derivation.run_chart import chart
from palmbots.derivation.verification import DELAY, REACH, SPAN, TURNING, Verification, verify

pytestmark = pytest.mark.slow

POLICIES = Path(__file__).parents[2] / "examples" / "policies"
Machines = tuple[Machine, Machine]


def policy(name: str) -> PolicyTable:
    return read_policy(POLICIES / f"{name}.toml")


Defect = Callable[[MachineRow], MachineRow | None]


def machines_with(name: str, defect: Defect | None) -> Machines:
    """The machines of an example, with every row replaced by what `defect` makes of it."""
    left, right = machines_of(policy(name))
    if defect is None:
        return left, right
    return with_defect(left, defect), with_defect(right, defect)


@cache
def check(name: str, defect: Defect | None = None) -> Verification:
    """The check of `machines_with`: several tests look at each."""
    return verify(machines_with(name, defect), policy(name).rest)


def with_defect(machine: Machine, defect: Defect) -> Machine:
    rows = [row for before in machine.rows if (row := defect(before)) is not None]
    return Machine(machine.states, rows)


# States and the longest way to the goal are pinned: a silent change of the algorithm or of the
# world shows.
@pytest.mark.parametrize(
    ("name", "states", "turns"),
    [("table-1", 17190, 90), ("both-drive", 28527, 152), ("rest-shallow", 17490, 90)],
)
def test_examples_hold(name: str, states: int, turns: int) -> None:
    found = check(name)
    assert found.holds
    assert (found.states, found.worst_turns) == (states, turns)
    assert found.peak <= SPAN


@pytest.mark.parametrize("name", ["table-1", "rest-mixed"])
def test_independent_search_finds_the_same(name: str) -> None:
    """As many states, the same longest way to the goal, and S1 by hand."""
    table = policy(name)
    search = MachineSearch(machines_of(table), reach=REACH, delay=DELAY, turning=TURNING)
    graph = search.all_states(SPAN)
    found = check(name)
    assert found.states == len(graph)
    turns = [turn for some in graph.values() for turn in some]
    fights = any({move, others} == {"away", "closer"} for _, move, others, *_ in turns)
    assert fights == ("S1" in found.counterexamples)
    falls = any(max(map(abs, after[0])) > SPAN for *_, after in turns)
    assert falls == ("S4" in found.counterexamples)
    if found.holds:
        followers = {state: [after for *_, after in some] for state, some in graph.items()}
        assert longest_way(followers, table.rest) == found.worst_turns


def longest_way(graph: dict[Any, list[Any]], rest: tuple[str, str]) -> int:
    """The longest path to the goal, by repeated relaxation; fails if a state never reaches it."""
    at_rest = tuple((angle, 0) for angle in rest)
    goal = {
        s for s in graph
        if s[:5] == ((0, 0), at_rest, ("hold", "hold"), ("idle", "idle"), ((), ()))
    }  # fmt: skip
    assert goal
    assert all(after in goal for state in goal for after in graph[state])
    number = {state: k for k, state in enumerate(graph)}  # a state takes long to compare
    done, rounds = [state in goal for state in graph], 0
    left = {
        number[state]: [number[after] for after in some]
        for state, some in graph.items()
        if state not in goal
    }
    while left:
        ready = [state for state, some in left.items() if all(done[after] for after in some)]
        assert ready, "a run never reaches the goal"
        for state in ready:
            done[state] = True
            del left[state]
        rounds += 1
    return rounds


def no_confirmation(row: MachineRow) -> MachineRow | None:
    """The robot does not wait until its partner's palm is back."""
    if row.next == "a_wait":
        return row._replace(next="idle")
    return row._replace(send="") if row.state == "c_a_back" else row


def both_wait(row: MachineRow) -> MachineRow:
    """Where requests cross, both robots ignore the other's."""
    return row._replace(next="a_ask") if (row.state, row.heard) == ("a_ask", "TiltUp") else row


def both_serve(row: MachineRow) -> MachineRow:
    """Where requests cross, both robots serve."""
    return row._replace(next="c_a_turn") if (row.state, row.heard) == ("a_ask", "TiltUp") else row


def acknowledges_early(row: MachineRow) -> MachineRow:
    return row._replace(turned=False) if row.state == "c_a_turn" else row


def moves_early(row: MachineRow) -> MachineRow:
    return row._replace(turned=False) if row.state == "d_turn" else row


def never_stops(row: MachineRow) -> MachineRow | None:
    return None if row.state == "d_move" else row


@pytest.mark.parametrize(
    ("defect", "fails"),
    [
        (no_confirmation, ["S3", "S4"]),
        (both_wait, ["progress"]),
        (both_serve, ["progress"]),
        (acknowledges_early, ["S2"]),
        (moves_early, ["S3", "S4"]),
        (never_stops, ["S4"]),
    ],
)
def test_defects_are_found(defect: Defect, fails: list[str]) -> None:
    assert check("table-1", defect).fails == fails


@pytest.mark.parametrize("defect", [None, both_wait, acknowledges_early, moves_early])
def test_counterexamples_are_runs(defect: Defect | None) -> None:
    """Each step follows from the one before by the independent search, and the last one breaks the
    property; a loop ends where it began."""
    name = "rest-mixed" if defect is None else "table-1"
    found = check(name, defect)
    assert found.fails
    search = MachineSearch(machines_with(name, defect), reach=REACH, delay=DELAY, turning=TURNING)
    for prop, run in found.counterexamples.items():
        here = {search.start(found.starts[prop])}
        places = []
        for step in run:
            p = step.after.p
            palms = tuple(
                ("shallow" if angle else "steep", left) for angle, left in step.after.palms
            )
            if step.turn is None:
                here = {s for before in here for s in search.disturbed(before) if s[0] == p}
            else:
                robot = step.turn.robot
                here = {
                    s for before in here for who, *_, s in search.turns(before)
                    if who == robot and s[0] == p and s[1] == palms
                }  # fmt: skip
            assert here, (prop, step)
            places.append(here)
        if prop == "progress":
            assert places[-1] & places[-1 - found.loop]
        if prop == "S4":
            assert max(map(abs, run[-1].after.p)) > SPAN
        if prop == "S1":
            assert set(run[-1].after.wheels) == {1, 2}


def test_chart_shows_messages_disturbances_and_the_loop() -> None:
    found = check("table-1", both_wait)
    lines = chart(found.starts["progress"], found.counterexamples["progress"], found.loop)
    assert lines[0].split() == ["p_L", "left", "robot", "right", "robot", "p_R", "palms"]
    assert any("-- TiltUp -->" in line for line in lines)
    assert any("<-- TiltUp --" in line for line in lines)
    assert lines[-found.loop - 2] == "from here the run repeats:"
    found = check("rest-mixed")
    lines = chart(found.starts["S4"], found.counterexamples["S4"])
    assert any("~ disturbed ~  p_R to" in line for line in lines)
