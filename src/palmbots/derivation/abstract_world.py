# SPDX-License-Identifier: Apache-2.0
"""Pairs of compiled controllers in the abstract world of the derivation.

Contacts are whole numbers of units; 0 is the nominal position. In a turn a robot receives its
messages, senses the sign of its contact and decides, and its wheels move by one unit. If the two
properties do not determine which contact slides, every possibility is followed. Robots take turns
in any order in which neither is more than one turn ahead. A palm reaches a new angle two turns
after the command. Messages arrive before the next turn of their receiver, in order, and none is
lost: this is the radio that the paper assumes.

A `System` gives its initial states and the successors of each state; states are hashable. The
station of the centralized algorithm takes a turn for both robots at once.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from copy import copy
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, cast

import palmbots._core as _core
from palmbots.control.interface import MOVES
from palmbots.derivation.contact_motion import Palm, Palms, sliders, up
from palmbots.derivation.global_policy import Angles, Direction, Signs

if TYPE_CHECKING:
    from palmbots.derivation.distributed_algorithm import Machine

# Indexed by the numbers of the core, which names the absence of a message "none".
_MOVES = cast("tuple[Direction | None, ...]", (None, *MOVES[1:]))
_MESSAGES = ("", *tuple(_core.MessageKind.__members__)[1:])
_STEEP = int(_core.Palm.steep)
_AHEAD = 1  # number of turns by which one robot may be ahead of the other
_TURNING = 1  # number of turns after a command in which the palm is still turning


class Motion(NamedTuple):
    """A motion of one unit, closing or opening, and the state in which it happens."""

    signs: Signs
    palms: Palms
    direction: Direction
    fights: bool
    """The wheels of the other robot drive in the opposite direction."""


class Turn(NamedTuple):
    """The observable part of a turn."""

    robot: int | None
    """The robot that takes the turn; None: both."""
    p: tuple[int, int]
    cases: tuple[str, str]
    palms: Palms
    motion: Motion | None
    begins: bool
    """The wheels did not move before this turn."""
    said: str


class State(NamedTuple):
    """Contacts, palms as (commanded angle, turns until it is reached), wheels, controllers with the
    messages in transit, and the number of turns by which the left robot is ahead."""

    p: tuple[int, int]
    palms: tuple[tuple[int, int], tuple[int, int]]
    wheels: tuple[int, int]
    minds: Any
    lead: int

    @property
    def nominal(self) -> bool:
        """Contacts at 0, palms steep, palms and wheels at rest."""
        steep = ((_STEEP, 0), (_STEEP, 0))
        return self.p == (0, 0) and self.palms == steep and self.wheels == (0, 0)


class System(Protocol):
    """Two robots and their controllers."""

    def start(self, p: tuple[int, int]) -> State:
        """Both robots travel and correct nothing; the contacts are as given."""
        ...

    def after(self, state: State) -> Iterator[tuple[Turn, State]]:
        """Every possible next turn, with the state after it."""
        ...


class _Machine:
    """A compiled controller as a function from memory to memory."""

    def __init__(self, first: Any) -> None:
        self._robots = {first.memory: first}
        self.first: bytes = first.memory
        self.step = cache(self._step)
        self.name = cache(self._name)

    def _step(self, memory: bytes, *seen: Any) -> tuple[bytes, Any]:
        robot = copy(self._robots[memory])
        out = robot.step(*seen)
        self._robots.setdefault(robot.memory, robot)
        return robot.memory, out

    def _name(self, memory: bytes) -> str:
        return self._robots[memory].name

    def robot(self, memory: bytes) -> Any:
        """The controller with this memory."""
        return self._robots[memory]


def _sign(p: int) -> int:
    return (p > 0) - (p < 0)


def _after_turn(palm: tuple[int, int], command: int, turning: int = _TURNING) -> tuple[int, int]:
    """A palm after a turn with this command."""
    return (command, turning) if command != palm[0] else (command, max(0, palm[1] - 1))


@cache
def _shown(palms: tuple[tuple[int, int], tuple[int, int]]) -> Palms:
    def shown(angle: int, turning: int) -> Palm:
        return "turning" if turning else "steep" if angle == _STEEP else "shallow"

    return shown(*palms[0]), shown(*palms[1])


def _both(pair: tuple[Any, Any], robot: int, value: Any) -> tuple[Any, Any]:
    """The pair with one entry replaced."""
    return (value, pair[1]) if robot == 0 else (pair[0], value)


def _moved(p: tuple[int, int], motion: Motion | None) -> Iterator[tuple[int, int]]:
    if motion is None:
        yield p
        return
    for contact in sorted(sliders(motion.palms, motion.direction)):
        yield _both(p, contact, p[contact] + up(motion.direction))


class _Pair(ABC):
    """The common part of the decentralized algorithms."""

    turning = _TURNING
    """Number of turns after a command in which a palm is still turning."""

    def start(self, p: tuple[int, int]) -> State:
        return State(p, ((_STEEP, 0), (_STEEP, 0)), (0, 0), self.begin(), 0)

    @abstractmethod
    def begin(self) -> Any:
        """The memory at the start."""

    @abstractmethod
    def names(self, minds: Any) -> tuple[str, str]:
        """The case of each robot."""

    @abstractmethod
    def hear(self, minds: Any, robot: int, sign: int, turned: bool) -> tuple[Any, int, int, str]:
        """A step: the memory after it, the commanded palm and move, and the message sent."""

    def hears(
        self, minds: Any, robot: int, sign: int, turned: bool
    ) -> Iterator[tuple[Any, int, int, str]]:
        """Every possible step; as `hear`."""
        yield self.hear(minds, robot, sign, turned)

    def after(self, state: State) -> Iterator[tuple[Turn, State]]:
        for robot in (0, 1):
            if abs(state.lead + (1, -1)[robot]) > _AHEAD:
                continue
            sign, turned = _sign(state.p[robot]), state.palms[robot][1] == 0
            for step in self.hears(state.minds, robot, sign, turned):
                yield from self._stepped(state, robot, *step)

    def _stepped(
        self, state: State, robot: int, minds: Any, palm: int, move: int, said: str
    ) -> Iterator[tuple[Turn, State]]:
        """The turn of a robot that has taken this step."""
        lead = state.lead + (1, -1)[robot]
        palms = _both(state.palms, robot, _after_turn(state.palms[robot], palm, self.turning))
        wheels = _both(state.wheels, robot, move)
        direction, other = _MOVES[move], _MOVES[wheels[1 - robot]]
        signs = (_sign(state.p[0]), _sign(state.p[1]))
        shown = _shown(palms)
        motion = None
        if direction is not None:
            fights = other not in (None, direction)
            motion = Motion(signs, shown, direction, fights)
        begins = state.wheels[robot] == 0
        turn = Turn(robot, state.p, self.names(minds), shown, motion, begins, said)
        for p in _moved(state.p, motion):
            yield turn, State(p, palms, wheels, minds, lead)


class _Distributed(_Pair):
    """Table 2. The memory consists of both controllers and their unread messages."""

    def __init__(self) -> None:
        self._robot = _Machine(_core.Distributed())

    def begin(self) -> Any:
        return (self._robot.first, self._robot.first), ((), ())

    def names(self, minds: Any) -> tuple[str, str]:
        left, right = minds[0]
        return self._robot.name(left), self._robot.name(right)

    def hear(self, minds: Any, robot: int, sign: int, turned: bool) -> tuple[Any, int, int, str]:
        robots, inboxes = minds
        inbox = inboxes[robot]
        memory, (palm, move, send, read) = self._robot.step(
            robots[robot], sign, inbox[0] if inbox else 0, turned
        )
        inboxes = _both(inboxes, robot, inbox[1:] if read else inbox)
        if send:
            inboxes = _both(inboxes, 1 - robot, (*inboxes[1 - robot], send))
        return (_both(robots, robot, memory), inboxes), palm, move, _MESSAGES[send]


class MachinePair(_Pair):
    """Two machines of a derived algorithm (distributed_algorithm.py).

    The memory consists of both machines and their unread messages, each with its age in turns of
    its receiver. A message may be heard `delay` turns late.
    """

    def __init__(
        self, machines: "tuple[Machine, Machine]", rest: Angles, delay: int, turning: int
    ) -> None:
        """The machines of the left and the right robot, and the palms at rest."""
        self.turning = turning
        left, right = machines
        self._at_goal = (bytes([left.idle]), bytes([right.idle])), ((), ())
        core = _core.Machines(left.for_core(), right.for_core())
        self._robots = tuple(_Machine(_core.MachineRobot(core, side)) for side in (0, 1))
        self._rest = rest
        self._delay = delay

    def begin(self) -> Any:
        """Both machines in their first state, no message."""
        return (self._robots[0].first, self._robots[1].first), ((), ())

    def at_goal(self, state: State) -> bool:
        """Contacts at 0, palms at rest, no motion, no message on its way, both robots idle."""
        at_rest = _shown(state.palms) == self._rest and state.wheels == (0, 0)
        return state.p == (0, 0) and at_rest and state.minds == self._at_goal

    def names(self, minds: Any) -> tuple[str, str]:
        """The case of each robot."""
        left, right = minds[0]
        return self._robots[0].name(left), self._robots[1].name(right)

    def hear(self, minds: Any, robot: int, sign: int, turned: bool) -> tuple[Any, int, int, str]:
        """The step in which no message is late."""
        return next(self.hears(minds, robot, sign, turned))

    def hears(
        self, minds: Any, robot: int, sign: int, turned: bool
    ) -> Iterator[tuple[Any, int, int, str]]:
        """The step in which no message is late, and the one in which the oldest is."""
        robots, inboxes = minds
        inbox = inboxes[robot]
        older = tuple((kind, min(age + 1, self._delay)) for kind, age in inbox)
        heard = [inbox[0][0] if inbox else 0]
        if inbox and inbox[0][1] < self._delay:
            heard.append(0)  # it is late
        for message in heard:
            memory, (palm, move, send, read) = self._robots[robot].step(
                robots[robot], sign, message, turned
            )
            after = _both(inboxes, robot, older[1:] if read else older)
            if send:
                after = _both(after, 1 - robot, (*after[1 - robot], (send, 0)))
            yield (_both(robots, robot, memory), after), palm, move, _MESSAGES[send]


class _Resilient(_Pair):
    """The resilient algorithm, a beacon each turn.

    It remembers both controllers; for each the beacon that it has not heard, as (message, rests,
    ready, age of its echo); for each how many turns ago it sent the newest beacon that the other
    has heard; and what each said last. Ages are in turns of the robot whose clock counts them
    (palmbots/control/mailbox.hpp).
    """

    # As control/resilient_timing.hpp has it: 2 (delay + beacon) + 2 ticks, each of them 1, and one
    # turn that the other robot may be ahead. Wheels stop at once.
    lease = 7
    hold = lease + 1 + 1
    join = 1 + 1

    def __init__(self) -> None:
        self._robots = tuple(
            _Machine(_core.Resilient(self.lease, self.hold, self.join, leads))
            for leads in (False, True)
        )

    def begin(self) -> Any:
        """The state after a boot with contacts at 0, once both robots travel steadily."""
        never = self.lease + 1
        minds: Any = (
            (self._robots[0].first, self._robots[1].first),
            (None, None),
            (never, never),
            (0, 0),
        )
        for _ in range(4 * self.hold):
            for robot in (0, 1):
                minds = self.hear(minds, robot, 0, True)[0]
        return minds

    def names(self, minds: Any) -> tuple[str, str]:
        left, right = minds[0]
        return self._robots[0].name(left), self._robots[1].name(right)

    def hear(self, minds: Any, robot: int, sign: int, turned: bool) -> tuple[Any, int, int, str]:
        robots, mail, known, said = minds
        known = _both(known, robot, min(known[robot] + 1, self.lease + 1))
        message, rests, ready, echo = mail[robot] or (0, False, False, self.lease)
        if mail[robot] is not None:  # so the partner's newest beacon is known here from now on
            known = _both(known, 1 - robot, 0)
        age = min(echo + 1, self.lease + 1)
        memory, (palm, move, says, rest, willing) = self._robots[robot].step(
            robots[robot], sign, turned, message, rests, ready, age
        )
        beacon = (says, rest, willing, known[1 - robot])
        mail = _both(_both(mail, robot, None), 1 - robot, beacon)
        news = _MESSAGES[says] if says != said[robot] else ""
        after = _both(robots, robot, memory), mail, known, _both(said, robot, says)
        return after, palm, move, news


class _Centralized:
    """Table 1, run by a station that exchanges messages with both robots."""

    def __init__(self) -> None:
        self._station = _Machine(_core.Centralized())

    def start(self, p: tuple[int, int]) -> State:
        return State(p, ((_STEEP, 0), (_STEEP, 0)), (0, 0), self._station.first, 0)

    def after(self, state: State) -> Iterator[tuple[Turn, State]]:
        signs = (_sign(state.p[0]), _sign(state.p[1]))
        reports = (
            (sign, palm, turning == 0)
            for sign, (palm, turning) in zip(signs, state.palms, strict=True)
        )
        memory, (left, move, right, _) = self._station.step(state.minds, *reports)
        palms = _after_turn(state.palms[0], left), _after_turn(state.palms[1], right)
        direction = _MOVES[move]
        motion = None if direction is None else Motion(signs, _shown(palms), direction, False)
        number = self._station.robot(memory).case_number
        case = str(number) if number else " "
        begins = state.wheels[0] == 0
        turn = Turn(None, state.p, (case, case), _shown(palms), motion, begins, "")
        for p in _moved(state.p, motion):
            yield turn, State(p, palms, (move, move), memory, 0)


_SYSTEMS: dict[str, Any] = {
    "centralized": _Centralized,
    "distributed": _Distributed,
    "resilient": _Resilient,
}

CONTROLLERS = tuple(_SYSTEMS)
"""The controllers of which there is an abstract system."""


def system_of(controller: str) -> System:
    """Two robots under one of `CONTROLLERS`."""
    return _SYSTEMS[controller]()
