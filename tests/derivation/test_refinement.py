# SPDX-License-Identifier: Apache-2.0
"""Controllers against the policy: what each may do, and that departures are found and are real."""

import copy
from collections.abc import Iterator
from typing import Any

import pytest

import palmbots._core as _core
from abstract_world import (
    ACK,
    HOLD,
    NONE,
    SHALLOW,
    STEEP,
    TILT_DOWN,
    TILT_UP,
    distributed_table,
    moved,
    sign,
)
from palmbots.derivation.abstract_world import CONTROLLERS, Motion, State, Turn, system_of
from palmbots.derivation.contact_motion import Palms, improves
from palmbots.derivation.global_policy import Policy, as_printed, table_1
from palmbots.derivation.local_rules import derive
from palmbots.derivation.permissions import Permissions
from palmbots.derivation.refinement import Refinement, check_refinement

POLICY = derive(table_1())


@pytest.fixture(scope="module")
def found() -> dict[str, Refinement]:
    return {name: check_refinement(system_of(name), POLICY) for name in CONTROLLERS}


def kinds(of: Refinement) -> set[tuple[str, str, str | None]]:
    return {(d.kind.differs, d.kind.case, d.kind.level) for d in of.departures}


def test_the_station_refines_the_policy_that_it_runs(found: dict[str, Refinement]) -> None:
    station = found["centralized"]
    assert (station.needs, station.departures) == ("policy", [])
    # Each motion of the policy happens: two in each of cases 7 and 8, one in the others, and the
    # second ones of 7 and 8 are those of 1 and 2.
    assert len(station.permitted["policy"]) == 8


def test_table_2_departs_in_three_ways(found: dict[str, Refinement]) -> None:
    """With (+, −) it may separate first; with (−, −) both palms go up at once; (b) may separate
    after a contact has come to 0. Only the last is beyond all that was derived."""
    table_2 = found["distributed"]
    assert table_2.needs is None
    assert kinds(table_2) == {
        ("order", "a", "rules"),
        ("order", "b", "rules"),
        ("palms", "d", "at once"),
        ("palms", "d", "begun"),
        ("palms", "b", None),
        ("order", "b", None),
    }
    motions = {m for d in table_2.departures if d.kind.case == "d" for m in d.motions}
    assert Motion((-1, -1), ("shallow", "shallow"), "closer", False) in motions
    (first,) = [d for d in table_2.departures if d.kind[:3] == ("order", "a", "rules")]
    assert first.motions == {
        Motion((1, -1), ("steep", "shallow"), "away", False),
        Motion((-1, 1), ("shallow", "steep"), "away", False),
    }
    beyond = table_2.permitted[None]
    assert {m.direction for m in beyond} == {"away"}
    assert Motion((0, 1), ("steep", "steep"), "away", False) in beyond


def test_the_resilient_algorithm_refines_the_stated_weakening(found: dict[str, Refinement]) -> None:
    resilient = found["resilient"]
    assert resilient.needs == "begun"
    assert kinds(resilient) == {
        ("order", "a", "rules"),
        ("palms", "a", "rules"),
        ("palms", "d", "at once"),
        ("palms", "d", "begun"),
    }
    # Where it departs beyond dropped guards, both robots close.
    for level in ("at once", "begun"):
        assert {m.direction for m in resilient.permitted[level]} == {"closer"}


def test_states_are_pinned(found: dict[str, Refinement]) -> None:
    assert {name: of.states for name, of in found.items()} == {
        "centralized": 124, "distributed": 1032, "resilient": 3024,
    }  # fmt: skip


def test_nominal_stays_in_reach_and_nothing_falls(found: dict[str, Refinement]) -> None:
    for of in found.values():
        assert (of.stuck, of.falls) == (0, 0)


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_starts_farther_off_bring_nothing_new(
    controller: str, found: dict[str, Refinement]
) -> None:
    farther = check_refinement(system_of(controller), POLICY, reach=4, span=6)
    assert farther.permitted == found[controller].permitted
    assert farther.states > found[controller].states


def test_every_motion_of_the_policy_and_its_rules_improves(found: dict[str, Refinement]) -> None:
    """Both weakenings by dropped guards keep what makes Table 1 work: no contact leaves 0."""
    for of in found.values():
        for level in ("policy", "rules"):
            for motion in of.permitted.get(level, ()):
                assert improves(*motion[:3])
    for departure in found["resilient"].departures:
        assert departure.kind.strays == (not all(improves(*m[:3]) for m in departure.motions))


def test_policy_without_moves_permits_no_motion() -> None:
    """The station against Table 1 as printed: it moves where that stands still."""
    printed = derive(as_printed())
    station = check_refinement(system_of("centralized"), printed)
    (departure,) = station.departures
    assert departure.kind[:3] == ("moves on", "7", "rules")
    assert departure.motions == {Motion((1, -1), ("steep", "shallow"), "closer", False)}


def test_smaller_policy_permits_fewer_motions(found: dict[str, Refinement]) -> None:
    fewer: Policy = table_1()[:6]
    station = check_refinement(system_of("centralized"), derive(fewer))
    assert len(station.permitted["policy"]) == 6
    assert station.needs == "rules"


# Table 2 from the transcript, step by step, in code of its own.


@pytest.mark.parametrize("index", range(7))
def test_transcript_is_a_run_of_table_2(index: int, found: dict[str, Refinement]) -> None:
    departure = found["distributed"].departures[index]
    p, states, inboxes = departure.start, [0, 0], [[], []]
    palms, left = [STEEP, STEEP], [0, 0]
    last: Any = None
    for turn in departure.run:
        me = turn.robot
        assert me is not None
        assert turn.p == p or turn.p in last, "contacts jump"
        p = turn.p
        message = inboxes[me][0] if inboxes[me] else NONE
        step = distributed_table()[states[me], (sign(p[me]), message, left[me] == 0)]
        if step.read and message:
            inboxes[me].pop(0)
        if step.send:
            inboxes[1 - me].append(step.send)
        names = {NONE: "", TILT_UP: "TiltUp", TILT_DOWN: "TiltDown", ACK: "Ack"}
        assert (turn.cases[me], turn.said) == (step.name, names[step.send])
        states[me] = step.state
        left[me] = 1 if step.palm != palms[me] else max(0, left[me] - 1)
        palms[me] = step.palm
        assert turn.palms == tuple(
            "turning" if left[k] else {STEEP: "steep", SHALLOW: "shallow"}[palms[k]] for k in (0, 1)
        )
        assert (turn.motion is None) == (step.move == HOLD)
        if turn.motion is not None:
            settled = tuple(None if left[k] else palms[k] for k in (0, 1))
            last = list(moved(p, (settled[0], settled[1]), turn.motion.direction == "closer"))
            assert turn.motion.signs == (sign(p[0]), sign(p[1]))
        else:
            last = [p]
    assert departure.run[-1].motion in departure.motions


def test_transcript_is_the_shortest_run(found: dict[str, Refinement]) -> None:
    """By breadth: no shorter run ends with a motion of that kind."""
    permissions = Permissions(POLICY)
    for controller in ("distributed", "resilient"):
        system = system_of(controller)
        front = [system.start((a, b)) for a in range(-2, 3) for b in range(-2, 3)]
        first: dict[Any, int] = {}
        seen = set(front)
        for depth in range(1, 12):
            following = []
            for state in front:
                for turn, after in system.after(state):
                    if turn.motion is not None:
                        kind = permissions.kind(turn, turn.motion)
                        first.setdefault(kind, depth)
                    if after not in seen:
                        seen.add(after)
                        following.append(after)
            front = following
        for departure in found[controller].departures:
            assert len(departure.run) == first[departure.kind]


# Controllers that are wrong.


class Stub:
    """Robots in turn, without messages; palms stay steep. `moves`: direction per own sign."""

    def __init__(self, moves: dict[int, str]) -> None:
        self.moves = moves

    def start(self, p: tuple[int, int]) -> State:
        return State(p, ((STEEP, 0), (STEEP, 0)), (0, 0), 0, 0)

    def after(self, state: State) -> Iterator[tuple[Turn, State]]:
        robot = state.minds
        signs = sign(state.p[0]), sign(state.p[1])
        direction: Any = self.moves.get(signs[robot])
        other: Any = self.moves.get(signs[1 - robot])
        palms: Palms = ("steep", "steep")
        motion, ways = None, [state.p]
        if direction:
            motion = Motion(signs, palms, direction, other not in (None, direction))
            ways = list(moved(state.p, (STEEP, STEEP), direction == "closer"))
        turn = Turn(robot, state.p, ("?", "?"), palms, motion, True, "")
        for p in ways:
            yield turn, State(p, state.palms, (0, 0), 1 - robot, 0)


def test_robots_that_never_move_are_stuck() -> None:
    idle = check_refinement(Stub({}), POLICY)
    assert idle.departures == []
    assert idle.stuck == 50 - 2  # robots and contacts, but for contacts at 0


def test_robots_that_fight_are_found() -> None:
    of = check_refinement(Stub({1: "away", -1: "closer"}), POLICY)
    fights = [d for d in of.departures if d.kind.differs == "fight"]
    assert {m.signs for d in fights for m in d.motions} == {(1, -1), (-1, 1)}
    assert all(d.kind.level is None for d in fights)
    assert "the other robot drives the other way" in fights[0].explanation


def test_robots_that_let_go_drop_the_object() -> None:
    of = check_refinement(Stub({0: "away", 1: "away", -1: "away"}), POLICY)
    assert of.falls > 0
    assert of.needs is None


MINDS: list[tuple[Any, Any]] = [
    (_core.Distributed, (1, 0, True)),
    (_core.Centralized, ((1, 0, True), (0, 0, True))),
    (lambda: _core.Resilient(7, 9, 2, False), (0, True, TILT_DOWN, False, False, 2)),
]


@pytest.mark.parametrize(("make", "seen"), MINDS)
def test_memory_distinguishes_the_states_of_a_controller(make: Any, seen: Any) -> None:
    robot = make()
    twin = copy.copy(robot)
    assert robot.memory == twin.memory == make().memory
    robot.step(*seen)
    assert robot.memory != twin.memory == make().memory
    twin.step(*seen)
    assert robot.memory == twin.memory


def closing(robot: int, signs: tuple[int, int], palms: Palms, **changes: Any) -> str | None:
    """The permission of a motion of a robot in (d), both robots there if not said otherwise."""
    keys: dict[str, Any] = {"cases": ("d", "d"), "begins": True, "direction": "closer", **changes}
    motion = Motion(signs, palms, keys["direction"], False)
    turn = Turn(robot, (0, 0), keys["cases"], palms, motion, keys["begins"], "")
    return Permissions(POLICY).level(turn, motion)


def test_only_unordered_rules_are_permitted_at_once() -> None:
    up: Palms = ("shallow", "shallow")
    assert closing(0, (-1, 0), up) == "at once"
    assert closing(0, (-1, 0), ("shallow", "turning")) == "at once"
    assert closing(0, (-1, 0), ("turning", "shallow")) is None, "its own palm is not up"
    assert closing(0, (-1, 0), up, direction="away") is None
    assert closing(0, (-1, 0), up, cases=("d", "c")) is None, "the other robot is in no rule"
    assert closing(0, (-1, 0), up, cases=("d", "a")) is None, "messages order these"
    assert closing(0, (0, -1), up) == "begun"
    assert closing(0, (0, -1), up, begins=False) is None, "not its first unit"
    assert closing(0, (1, -1), up) is None, "beyond 0"


@pytest.mark.parametrize("other", ["distributed", "resilient"])
def test_fighting_robots_are_reported(other: str) -> None:
    """Wheels that drive against each other are a fight, by the state that the pair is in."""
    system: Any = system_of(other)
    idle = system.start((0, -1))
    fights = set()
    seen, queue = {idle}, [idle]
    for state in queue:
        opposed = state._replace(wheels=(1, state.wheels[1]))
        for turn, after in system.after(state):
            if turn.robot == 1 and turn.motion is not None:
                fights |= {t.motion.fights for t, _ in system.after(opposed) if t.robot == 1}
            if after not in seen and len(seen) < 500:
                seen.add(after)
                queue.append(after)
    assert fights == {True}
