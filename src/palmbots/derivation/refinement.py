# SPDX-License-Identifier: Apache-2.0
"""Checks exhaustively that a controller makes only motions that the policy permits.

A motion that the policy does not permit (permissions.py) is a departure. Departures are grouped by
kind, each with the shortest run that shows it, and with whether the motion may carry a contact away
from 0, which no motion of Table 1 does. Of every state it is asked, too, whether the nominal
configuration can still be reached: contacts at 0, palms steep, nothing moving. A controller that
never moved would depart from nothing.
"""

from collections import deque
from dataclasses import dataclass, field

from palmbots._types import SIDES
from palmbots.derivation.abstract_world import Motion, State, System, Turn
from palmbots.derivation.local_rules import Derivation
from palmbots.derivation.permissions import LEVELS, Kind, Permissions


@dataclass
class Departure:
    """All departures of a kind, and the shortest run to one of them."""

    kind: Kind
    motions: set[Motion]
    start: tuple[int, int]
    run: list[Turn]
    explanation: str

    def transcript(self) -> list[str]:
        """The run, a line for each turn: contacts before it, robot, action, palms."""
        return [_line(turn) for turn in self.run]


def _line(turn: Turn) -> str:
    who = "both" if turn.robot is None else SIDES[turn.robot]
    places = " ".join(f"{p:+d}" if p else " 0" for p in turn.p)
    case = turn.cases[turn.robot or 0]
    does = [f"({case})" if case.strip() else ""]
    does += [f"says {turn.said}"] if turn.said else []
    if turn.motion is not None:
        does.append("moves " + turn.motion.direction)
    return f"{places}  {who:5}  {' '.join(filter(None, does)):20}  palms {', '.join(turn.palms)}"


@dataclass
class Refinement:
    """The result for one controller."""

    states: int = 0
    permitted: dict[str | None, set[Motion]] = field(default_factory=dict)
    """The motions that occur, by their narrowest permission; None: not permitted."""
    departures: list[Departure] = field(default_factory=list)
    stuck: int = 0
    """Number of states from which the nominal configuration cannot be reached."""
    falls: int = 0
    """Number of turns after which a contact is off its palm."""

    @property
    def needs(self) -> str | None:
        """The narrowest permission that covers every motion; None: there is none."""
        if self.permitted.get(None):
            return None
        return max((n for n in self.permitted if n is not None), key=LEVELS.index, default="policy")


def check_refinement(
    system: System, derivation: Derivation, reach: int = 2, span: int = 4
) -> Refinement:
    """Check every run that starts with contacts at most `reach` units from 0.

    A contact more than `span` units from 0 has left its palm.
    """
    permissions = Permissions(derivation)
    found = Refinement()
    grid = range(-reach, reach + 1)
    starts = [system.start((left, right)) for left in grid for right in grid]
    came: dict[State, tuple[State, Turn] | None] = dict.fromkeys(starts)
    into: dict[State, list[State]] = {}
    kinds: dict[Kind, Departure] = {}
    queue = deque(starts)
    while queue:
        state = queue.popleft()
        for turn, after in system.after(state):
            if turn.motion is not None:
                motion = turn.motion
                kind = permissions.kind(turn, motion)
                level = "policy" if kind is None else kind.level
                found.permitted.setdefault(level, set()).add(motion)
                if kind is not None:
                    if kind not in kinds:
                        start, run = _run(came, state)
                        why = permissions.explained(turn, motion)
                        kinds[kind] = Departure(kind, set(), start, [*run, turn], why)
                    kinds[kind].motions.add(motion)
            if max(map(abs, after.p)) > span:
                found.falls += 1
                continue
            into.setdefault(after, []).append(state)
            if after not in came:
                came[after] = (state, turn)
                queue.append(after)
    found.states = len(came)
    found.departures = list(kinds.values())
    found.stuck = len(came) - len(_can_reach(into, [s for s in came if s.nominal]))
    return found


def _run(
    came: dict[State, tuple[State, Turn] | None], state: State
) -> tuple[tuple[int, int], list[Turn]]:
    """The start of the shortest run to a state, and its turns."""
    turns: list[Turn] = []
    while (link := came[state]) is not None:
        state, turn = link
        turns.insert(0, turn)
    return state.p, turns


def _can_reach(into: dict[State, list[State]], goals: list[State]) -> set[State]:
    """All states from which one of the goals can be reached."""
    reached = set(goals)
    queue = list(goals)
    while queue:
        for before in into.get(queue.pop(), ()):
            if before not in reached:
                reached.add(before)
                queue.append(before)
    return reached
