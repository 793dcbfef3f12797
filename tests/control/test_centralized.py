# SPDX-License-Identifier: Apache-2.0
"""The shipped centralized algorithm: its mirror symmetry, and its behaviour in a world with both
properties of the paper's section 2. tests/paper/test_table1.py checks Table 1 itself.
"""

import pytest

from abstract_world import (
    CLOSER,
    HOLD,
    REPORTS,
    SHALLOW,
    START,
    STEEP,
    Contacts,
    Report,
    StationState,
    moved,
    sign,
    station_table,
)

IMAGE = {0: 0, 1: 2, 2: 1, 3: 4, 4: 3, 5: 5, 6: 6, 7: 8, 8: 7}


def image(state: StationState) -> StationState:
    return IMAGE[state[0]], state[1]


def test_mirror_symmetry() -> None:
    """For every state and every pair of reports: exchanged reports give exchanged commands."""
    table = station_table()
    assert len(table) == 25 * len(REPORTS) ** 2
    for (state, left, right), out in table.items():
        back = table[image(state), right, left]
        assert back.palms == out.palms[::-1]
        assert back.moves == out.moves[::-1]
        assert back.state == image(out.state)


def test_both_robots_always_get_the_same_move() -> None:
    for out in station_table().values():
        assert out.moves[0] == out.moves[1]
        assert SHALLOW not in out.palms or STEEP in out.palms  # never both shallow


class Trip:
    """The worst run from a pair of signs to (0, 0)."""

    def __init__(self, turn: int) -> None:
        self.turn = turn
        self.memo: dict[object, tuple[int, int]] = {}
        self.open: set[object] = set()

    def worst(
        self, p: Contacts, state: StationState, palms: tuple[int, int], left: tuple[int, int]
    ) -> tuple[int, int]:
        """Most cases and most primitive actions from here on; AssertionError on a livelock.

        `left`: how many ticks each palm still turns.
        """
        here = (p, state, palms, left)
        if here in self.memo:
            return self.memo[here]
        assert here not in self.open, f"livelock at {here}"
        if p == (0, 0) and state == START and palms == (STEEP, STEEP):
            return 0, 0
        self.open.add(here)
        reports: list[Report] = [(sign(p[s]), palms[s], left[s] == 0) for s in (0, 1)]
        out = station_table()[state, reports[0], reports[1]]
        turned = [self.turn if out.palms[s] != palms[s] else max(0, left[s] - 1) for s in (0, 1)]
        cases = int(out.state[0] != 0 and state[0] == 0)
        idle_end = out.state[0] in (5, 6) and out.moves[0] == HOLD  # no palm to restore
        actions = int(out.state not in (state, START) and not idle_end)
        if out.moves[0] == HOLD:
            places = [p]
        else:
            palms_now = [None if turned[s] else out.palms[s] for s in (0, 1)]
            places = list(moved(p, (palms_now[0], palms_now[1]), out.moves[0] == CLOSER))
        ways = [self.worst(q, out.state, out.palms, (turned[0], turned[1])) for q in places]
        self.open.remove(here)
        result = cases + max(w[0] for w in ways), actions + max(w[1] for w in ways)
        self.memo[here] = result
        return result


NEAR = [(a, b) for a in range(-2, 3) for b in range(-2, 3)]


@pytest.mark.parametrize("turn", [0, 3])
def test_reaches_the_nominal_configuration(turn: int) -> None:
    """From |p| ≤ 2 units, whichever contact slides between equal palms: at most two cases, six
    primitive actions (tilt, move, restore; here four), and no livelock."""
    trip = Trip(turn)
    worst = {p: trip.worst(p, START, (STEEP, STEEP), (0, 0)) for p in NEAR}
    assert worst[0, 0] == (0, 0)
    assert max(cases for cases, _ in worst.values()) == 2
    assert max(actions for _, actions in worst.values()) == 4
    for p, (cases, _) in worst.items():
        if p[0] * p[1] <= 0 and p != (0, 0):
            assert cases == 1, "cases 1-4, 7 and 8 correct completely"


def test_reaches_the_nominal_configuration_from_far() -> None:
    trip = Trip(2)
    for a in range(-6, 7):
        for b in range(-6, 7):
            assert trip.worst((a, b), START, (STEEP, STEEP), (0, 0))[0] <= 2
