# SPDX-License-Identifier: Apache-2.0
"""Checks a derived algorithm exhaustively: the compiled machines of both robots, in every run.

The world is that of abstract_world.py: contacts in units, robots that take turns in any order in
which neither is more than one turn ahead, and an adversary that chooses the contact that slides
where the palms do not determine it. A palm reaches its angle `TURNING` + 1 turns after the command.
There are two more adversaries. A *disturbance* moves a contact by a unit at any time, to at most
`REACH` units from 0. And a message may be heard up to `DELAY` turns of its receiver late; messages
arrive in order, and none is lost: this is the radio that the paper assumes.

The properties, with the names of the proofs of the resilient algorithm:

- *S1*: one robot never moves away while the other moves closer.
- *S2*: the pair separates only while one palm is steep and the other one shallow, and the contact
  on the steep one is being corrected.
- *S3*: the pair closes only while one palm is shallow and the other one steep, and the contact on
  the shallow one is being corrected.
- *S4*: no contact leaves its palm, `SPAN` units from 0.
- *progress*: once disturbances stop, every run reaches the goal, and stays there: contacts at 0,
  palms at rest, no motion, no message on its way.

S2 and S3 make one exception, that of the paper: where both robots run the same rule and need no
message for it, nothing orders them, and both palms may have the same angle.
"""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from palmbots.derivation.abstract_world import MachinePair, Motion, State, Turn
from palmbots.derivation.contact_motion import sliders
from palmbots.derivation.distributed_algorithm import Machine, unordered_cases
from palmbots.derivation.global_policy import Angles

MEANINGS = {
    "S1": "one robot moves away while the other moves closer",
    "S2": "the pair separates while the palms do not keep the other contact in place",
    "S3": "the pair closes while the palms do not keep the other contact in place",
    "S4": "a contact leaves its palm",
    "progress": "a run never reaches the goal",
}
"""What a run does that breaks a property."""
REACH = 2
"""Disturbances move a contact at most so far from 0 [units]."""
SPAN = 8
"""The end of a palm [units from 0]. A unit is what a correction moves a contact in a turn. A palm
needs three turns, in the default scene 0.2 s, in which a correction moves a contact by 6 mm: its
palms, 75 mm from the pivot to the end, have 37 units on each side."""
DELAY = 1
"""How late a message may be [turns of its receiver]."""
TURNING = 2
"""Turns after a command in which a palm is still turning. With fewer, the check would not notice a
robot that does not wait for its palm."""


_USUAL_STATES = 20_000


class Step(NamedTuple):
    """A step of a run: a turn, or a disturbance."""

    turn: Turn | None
    """None: a disturbance."""
    after: State


@dataclass
class Verification:
    """The result of a check."""

    states: int = 0
    peak: int = 0
    """The farthest that a contact comes from 0 in a run that breaks no property [units]."""
    worst_turns: int = 0
    """The longest run without disturbances from any state to the goal [turns]."""
    counterexamples: dict[str, list[Step]] = field(default_factory=dict)
    """By property that fails: the shortest run that shows it. One against progress ends with a
    loop."""
    loop: int = 0
    """The number of steps of the loop that ends the run against progress."""
    starts: dict[str, tuple[int, int]] = field(default_factory=dict)
    """The contacts at the start of these runs."""

    @property
    def fails(self) -> list[str]:
        """The properties that fail, in the order of `MEANINGS`."""
        return [name for name in MEANINGS if name in self.counterexamples]

    def checks(self, name: str) -> bool:
        """Whether a property was checked: progress is not if a contact leaves its palm."""
        return name != "progress" or "S4" not in self.counterexamples

    @property
    def holds(self) -> bool:
        """Whether every property holds."""
        return not self.counterexamples


def verify(
    machines: tuple[Machine, Machine],
    rest: Angles,
    *,
    delay: int = DELAY,
    on_progress: Callable[[float], None] | None = None,
) -> Verification:
    """Check the machines of both robots with these palms at rest.

    Args:
        machines: those of the left and the right robot.
        rest: the palms at rest.
        delay: how late a message may be [turns of its receiver].
        on_progress: called now and then with the completed fraction, by the usual size of a check.
    """
    search = _Search(machines, rest, delay, on_progress or (lambda fraction: None))
    return search.run()


_verified: dict[tuple[object, Angles], Verification] = {}


def verified(
    machines: tuple[Machine, Machine],
    rest: Angles,
    on_progress: Callable[[float], None] | None = None,
) -> Verification:
    """The check of these machines; equal ones are checked once in a process."""
    key = tuple(machine.for_core() for machine in machines), rest
    if key not in _verified:
        _verified[key] = verify(machines, rest, on_progress=on_progress)
    return _verified[key]


class _Search:
    """A breadth-first search of all states, then a backward induction from the goal."""

    def __init__(
        self,
        machines: tuple[Machine, Machine],
        rest: Angles,
        delay: int,
        on_progress: Callable[[float], None],
    ) -> None:
        self._system = MachinePair(machines, rest, delay, TURNING)
        self._unordered = unordered_cases(machines)
        self._report = on_progress
        self._came: dict[State, tuple[State, Step] | None] = {}
        self._next: dict[State, list[State]] = {}  # without disturbances
        self._found = Verification()

    def run(self) -> Verification:
        grid = range(-REACH, REACH + 1)
        starts = [self._system.start((left, right)) for left in grid for right in grid]
        self._came = dict.fromkeys(starts)
        queue = deque(starts)
        while queue:
            state = queue.popleft()
            self._expand(state, queue)
            if len(self._next) % 4096 == 0:
                self._report(min(1.0, len(self._came) / _USUAL_STATES))
        self._found.states = len(self._came)
        self._check_progress()
        return self._found

    def _expand(self, state: State, queue: deque[State]) -> None:
        """Follow every step from a state, and check the properties of its motions."""
        followers: list[State] = []
        self._next[state] = followers
        for turn, after in self._system.after(state):
            step = Step(turn, after)
            broken = None if turn.motion is None else self._broken(turn, turn.motion)
            if broken is not None:
                self._fails(broken, state, step)
            if max(map(abs, after.p)) > SPAN:
                self._fails("S4", state, step)
                continue
            followers.append(after)
            if after not in self._came:
                self._found.peak = max(self._found.peak, *map(abs, after.p))
                self._came[after] = (state, step)
                queue.append(after)
        for p in _disturbed(state.p):
            after = state._replace(p=p)
            if after not in self._came:
                self._came[after] = (state, Step(None, after))
                queue.append(after)

    def _broken(self, turn: Turn, motion: Motion) -> str | None:
        """The property that a motion breaks."""
        if motion.fights:
            return "S1"
        kind, name = ("a", "S2") if motion.direction == "away" else ("d", "S3")
        if kind in self._unordered and turn.cases == (kind, kind):
            return None
        movable = sliders(motion.palms, motion.direction)
        if len(movable) == 1:
            (contact,) = movable
            if turn.cases[contact] == kind:
                return None
        return name

    def _fails(self, name: str, state: State, last: Step) -> None:
        if name in self._found.counterexamples:
            return  # the first one is the shortest
        start, run = self._run_to(state)
        self._found.starts[name] = start
        self._found.counterexamples[name] = [*run, last]

    def _run_to(self, state: State) -> tuple[tuple[int, int], list[Step]]:
        """The start of the shortest run to a state, and its steps."""
        steps: list[Step] = []
        while (link := self._came[state]) is not None:
            state, step = link
            steps.append(step)
        return state.p, steps[::-1]

    def _check_progress(self) -> None:
        """Find the states from which every run reaches the goal, and how long it takes at worst."""
        before: dict[State, list[State]] = {}
        left: dict[State, int] = {}
        turns: dict[State, int] = {}
        queue: deque[State] = deque()
        for state, followers in self._next.items():
            if self._system.at_goal(state):
                turns[state] = 0
                queue.append(state)
                continue
            left[state] = len(followers)
            for after in followers:
                before.setdefault(after, []).append(state)
        while queue:
            state = queue.popleft()
            for earlier in before.get(state, ()):
                left[earlier] -= 1
                if left[earlier] == 0:
                    turns[earlier] = turns[state] + 1
                    queue.append(earlier)
        self._found.worst_turns = max(turns.values(), default=0)
        lost = next((state for state in self._came if state not in turns), None)
        if lost is not None and "S4" not in self._found.counterexamples:
            self._found.starts["progress"], run = self._run_to(lost)
            loop = self._loop(lost, turns)
            self._found.counterexamples["progress"] = run + loop[0]
            self._found.loop = loop[1]

    def _loop(self, state: State, turns: dict[State, int]) -> tuple[list[Step], int]:
        """A run from a state that never reaches the goal: its steps until a state comes again, and
        how many of them are the loop."""
        place = {state: 0}
        steps: list[Step] = []
        while True:
            turn, state = next(
                (turn, after) for turn, after in self._system.after(state) if after not in turns
            )
            steps.append(Step(turn, state))
            if state in place:
                return steps, len(steps) - place[state]
            place[state] = len(steps)


def _disturbed(p: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """Where a disturbance can move the contacts."""
    for change in (-1, 1):
        if abs(p[0] + change) <= REACH:
            yield p[0] + change, p[1]
        if abs(p[1] + change) <= REACH:
            yield p[0], p[1] + change
