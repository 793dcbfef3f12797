# SPDX-License-Identifier: Apache-2.0
"""Table 1 of the paper, word for word, against the shipped station on every input."""

import re
from dataclasses import dataclass

import pytest

from abstract_world import (
    AWAY,
    CLOSER,
    HOLD,
    REPORTS,
    SHALLOW,
    START,
    STEEP,
    Contacts,
    Report,
    moved,
    sign,
    station_table,
)

# "Case, Contacts, Actions", as in our copy of the paper.
PRINTED = {
    1: ("L > 0, R = 0", "tilt up R, separate until L <= 0, restore R"),
    2: ("L = 0, R > 0", "tilt up L, separate until R <= 0, restore L"),
    3: ("L < 0, R = 0", "tilt up L, move closer until L >= 0, restore L"),
    4: ("L = 0, R < 0", "tilt up R, move closer until R >= 0, restore R"),
    5: ("L > 0, R > 0", "separate until L <= 0 or R <= 0"),
    6: ("L < 0, R < 0", "move closer until L >= 0 or R >= 0"),
    7: (
        "L > 0, R < 0",
        "tilt up R, move closer until R <= 0, separate until L >= 0, restore R",
    ),
    8: (
        "L < 0, R > 0",
        "tilt up L, move closer until L >= 0, separate until R <= 0, restore L",
    ),
}
# Case 7 as the mirror image of case 8, which is what the project runs.
CASE_7 = (
    "L > 0, R < 0",
    "tilt up R, move closer until R >= 0, separate until L <= 0, restore R",
)
TABLE = PRINTED | {7: CASE_7}

SIDES = {"L": 0, "R": 1}
Signs = tuple[int, int]


def contacts_of(text: str) -> Signs:
    relation = {">": 1, "=": 0, "<": -1}
    at = {side: relation[sign] for side, sign in re.findall(r"([LR]) ([<>=]) 0", text)}
    return at["L"], at["R"]


@dataclass(frozen=True)
class Action:
    """A tilt (palm and side) or a move (until any of the conditions holds)."""

    words: str
    palm: int | None = None
    side: int = 0
    move: int = HOLD
    until: tuple[tuple[int, str], ...] = ()

    def over(self, signs: Signs) -> bool:
        return any(signs[s] <= 0 if r == "<=" else signs[s] >= 0 for s, r in self.until)


def actions_of(text: str) -> tuple[Action, ...]:
    actions = []
    for words in text.split(", "):
        if tilt := re.fullmatch(r"(tilt up|restore) ([LR])", words):
            palm = SHALLOW if tilt[1] == "tilt up" else STEEP
            actions.append(Action(words, palm=palm, side=SIDES[tilt[2]]))
        else:
            conditions = re.findall(r"([LR]) (<=|>=) 0", words)
            until = tuple((SIDES[side], relation) for side, relation in conditions)
            move = AWAY if words.startswith("separate") else CLOSER
            actions.append(Action(words, move=move, until=until))
    return tuple(actions)


POLICY = {case: (contacts_of(when), actions_of(what)) for case, (when, what) in TABLE.items()}


@dataclass(frozen=True)
class Place:
    """Where the reader of the table is: case (0: none) and action."""

    case: int = 0
    action: int = 0


NOTHING = Action("nothing")


def listed(case: int) -> tuple[Action, ...]:
    """The actions of a case. Cases 5 and 6 have no palm to restore; that, too, takes one tick."""
    actions = POLICY[case][1]
    return actions if actions[-1].palm is not None else (*actions, NOTHING)


def tick(place: Place, reports: tuple[Report, Report]) -> Place:
    """Each tick looks at the action in progress once; a new one is looked at the tick after."""
    signs = (reports[0][0], reports[1][0])
    if place.case == 0:
        case = next((c for c, (when, _) in POLICY.items() if when == signs), 0)
        return Place(case)
    action = listed(place.case)[place.action]
    if action.until:
        done = action.over(signs)
    elif action.palm is None:
        done = True
    else:
        _, commanded, turned = reports[action.side]
        done = turned and commanded == action.palm
    if not done:
        return place
    after = place.action + 1
    return Place() if after == len(listed(place.case)) else Place(place.case, after)


def orders(place: Place) -> tuple[tuple[int, int], tuple[int, int]]:
    """Palms and moves; a palm that was tilted up stays so until it is restored."""
    palms, moves = [STEEP, STEEP], (HOLD, HOLD)
    if place.case:
        actions = listed(place.case)
        for action in actions[: place.action + 1]:
            if action.palm is not None:
                palms[action.side] = action.palm
        move = actions[place.action].move
        moves = (move, move)
    return (palms[0], palms[1]), moves


def test_every_state_and_input() -> None:
    table = station_table()
    place = {START: Place()}
    for state in (queue := [START]):
        for left in REPORTS:
            for right in REPORTS:
                expected = tick(place[state], (left, right))
                shipped = table[state, left, right]
                assert (shipped.palms, shipped.moves) == orders(expected), (state, left, right)
                assert shipped.state[0] == expected.case
                if shipped.state not in place:
                    place[shipped.state] = expected
                    queue.append(shipped.state)
                assert place[shipped.state] == expected, (state, left, right)
    assert len(set(place.values())) == len(place)
    assert {state for state, _, _ in table} == set(place)


def test_cases_are_all_signs_but_both_zero() -> None:
    assert len({when for when, _ in POLICY.values()}) == 8
    assert (0, 0) not in {when for when, _ in POLICY.values()}


def swapped(text: str) -> str:
    return text.translate(str.maketrans("LR", "RL"))


@pytest.mark.parametrize(("case", "image"), [(1, 2), (3, 4), (5, 5), (6, 6), (7, 8)])
def test_cases_mirror_each_other(case: int, image: int) -> None:
    when, what = (swapped(text) for text in TABLE[case])
    assert contacts_of(when) == POLICY[image][0]
    there, back = actions_of(what), POLICY[image][1]
    assert [(a.palm, a.side, a.move, set(a.until)) for a in there] == [
        (a.palm, a.side, a.move, set(a.until)) for a in back
    ]


def run_case(what: str, p: Contacts) -> Contacts:
    """A case on the grid, its conditions looked at before the first unit of each motion."""
    palms: list[int] = [STEEP, STEEP]
    for action in actions_of(what):
        if action.palm is not None:
            palms[action.side] = action.palm
        while action.until and not action.over((sign(p[0]), sign(p[1]))):
            (p,) = moved(p, (palms[0], palms[1]), closing=action.move == CLOSER)
            assert max(map(abs, p)) < 9
    return p


@pytest.mark.parametrize("p", [(1, -1), (2, -1), (1, -2), (2, -2)])
def test_case_7_as_printed_has_no_motion(p: Contacts) -> None:
    """p_R ≤ 0 and p_L ≥ 0 hold on entry, so the printed case ends where it began, for ever."""
    assert run_case(PRINTED[7][1], p) == p
    assert run_case(CASE_7[1], p) == (0, 0)
    assert run_case(PRINTED[8][1], (p[1], p[0])) == (0, 0)


def test_only_case_7_is_changed() -> None:
    assert [case for case in PRINTED if PRINTED[case] != TABLE[case]] == [7]
    assert PRINTED[7][0] == CASE_7[0]
