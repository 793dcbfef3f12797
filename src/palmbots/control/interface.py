# SPDX-License-Identifier: Apache-2.0
"""The interface of controllers in Python, and the shipped distributed controller to step by hand.

A controller decides once every control period from what one robot knows: the tactile sign of its
contact, the oldest unread message, whether its palm has reached the angle last commanded, and
whether the robot leads. Any class with such a ``step`` is a controller:
``pb.carry(controller=MyController)`` makes one for each robot. It runs in the same worlds and over
the same radio as the shipped controllers, but slower.

Two class attributes are optional: ``cases`` explains the letters that `StepOutput.case` may hold,
and ``assisted_cases`` lists those in which a robot asks its partner for assistance. Corrections are
recorded only while `StepOutput.case` holds a letter.
"""

from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, Literal, Protocol, cast, get_args

import palmbots._core as _core
from palmbots._util.arguments import shown
from palmbots.control.own_code import name_of, own_code, show_error
from palmbots.errors import PalmbotsError

MessageKind = Literal["TiltUp", "TiltDown", "Ack"]
"""What a message of the distributed algorithm says: `TiltUp`, `TiltDown` or `Ack`."""
Palm = Literal["steep", "shallow"]
"""The commanded palm angle: `steep` or `shallow`."""
Move = Literal["hold", "away", "closer"]
"""How the wheels differ from the nominal speed: `hold` not at all, `away` from or `closer` to the
partner."""

# In the order of the core's numbers (control/messages.hpp). The core has further kinds of message,
# which only the beacons of the resilient algorithm carry.
PALMS = cast("tuple[Palm, ...]", tuple(_core.Palm.__members__))
"""The names of the palm angles."""
MOVES = cast("tuple[Move, ...]", tuple(_core.Move.__members__))
"""The names of the moves."""
SIGN_WORDS = {-1: "p < 0", 0: "p = 0", 1: "p > 0"}
"""What a tactile sign says about the contact coordinate p."""
MESSAGE_KINDS = cast(
    "tuple[MessageKind | None, ...]",
    (None, *sorted(get_args(MessageKind), key=lambda name: _core.MessageKind[name])),
)


@dataclass(frozen=True, slots=True)
class StepInput:
    """What a robot knows at a tick."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    message: MessageKind | None
    """The oldest message that is not consumed yet."""
    palm_at_target: bool
    """The palm has reached the angle last commanded."""
    leads: bool = False
    """The robot is the front one in the direction of travel; the same in every step."""


# Every possible input. Finding one is faster than making it.
_INPUTS = {
    (sign, number, at_target, leads): StepInput(sign, message, at_target, leads)
    for sign in (-1, 0, 1)
    for number, message in enumerate(MESSAGE_KINDS)
    for at_target in (False, True)
    for leads in (False, True)
}


@dataclass(frozen=True, slots=True)
class StepOutput:
    """What a robot does until the next tick."""

    palm: Palm = "steep"
    move: Move = "hold"
    """Keep the nominal speed, or add the correction speed away from or towards the partner."""
    send: MessageKind | None = None
    consume: bool = False
    """The message is used up; otherwise the next tick sees it again."""
    case: str | None = None
    """The case that the robot is in, ``"a"`` to ``"d"`` as in Table 2. While it is not None, the
    carry records a correction."""
    waiting: bool = False
    """The robot waits for a message; the time counts as ``waiting_s``."""
    stop: bool = False
    """Do not travel: the nominal speed is 0. `move` still adds the correction speed."""


class Controller(Protocol):
    """One robot's controller."""

    def step(self, seen: StepInput, /) -> StepOutput:
        """Decide for one control period."""
        ...


class DistributedController:
    """The shipped distributed algorithm (Table 2): the compiled code that carries run."""

    def __init__(self) -> None:
        self._core = _core.Distributed()

    def step(self, seen: StepInput, /) -> StepOutput:
        """Decide for one control period."""
        palm, move, send, consume = self._core.step(
            seen.sign, MESSAGE_KINDS.index(seen.message), seen.palm_at_target
        )
        return StepOutput(
            palm=PALMS[palm],
            move=MOVES[move],
            send=MESSAGE_KINDS[send],
            consume=consume,
            case=self._core.name,
            waiting=self._core.waits,
        )


Step = Callable[[int, int, bool, bool], tuple[object, ...]]


def make_controller_pair(maker: Callable[[], Controller]) -> tuple[Step, Step]:
    """A new controller for each robot, as the step functions that the core calls.

    Raises:
        PalmbotsError: see `make_step`.
    """
    return make_step(maker), make_step(maker)


def make_step(maker: Callable[[], Controller]) -> Step:
    """The step of a new controller as the core calls it, in numbers.

    Raises:
        PalmbotsError: `maker` is no class of controllers. When the core calls the step, also: the
            controller fails, or returns something that is not legal.
    """
    with own_code(f"controller: {name_of(maker)} cannot be used"):
        controller = _make(maker)
        name = type(controller).__name__
        if not callable(getattr(controller, "step", None)):
            raise PalmbotsError(
                f"controller: {name} has no step; needed: "
                "def step(self, seen: StepInput) -> StepOutput"
            )

    def step(sign: int, message: int, palm_at_target: bool, leads: bool) -> tuple[object, ...]:
        seen = _INPUTS[sign, message, palm_at_target, leads]
        try:
            return _numbers(controller.step(seen), name)
        except (KeyboardInterrupt, PalmbotsError):
            raise
        except BaseException as error:  # SystemExit, too
            raise PalmbotsError(f"controller: {name}.step failed: {show_error(error)}") from error

    return step


def _make(maker: Any) -> Any:
    if not callable(maker):
        if hasattr(maker, "step"):
            name = type(maker).__name__
            raise PalmbotsError(
                f"controller: expected a class, got an instance of {name}; pass "
                f"controller={name} so that each robot gets its own"
            )
        raise PalmbotsError(
            f"controller: value is {shown(maker)}; allowed: a name, or a class with a step"
        )
    with own_code(f"controller: {name_of(maker)}() failed"):
        return maker()


def _numbers(output: object, name: str) -> tuple[object, ...]:
    """The output of a step in the core's numbers; `name` is the class of the controller."""
    if not isinstance(output, StepOutput):
        if isinstance(output, Coroutine):
            output.close()  # otherwise Python warns that it was never awaited
        raise PalmbotsError(
            f"controller: {name}.step returned {shown(output)}; allowed: a StepOutput, as in "
            'StepOutput(palm="shallow", move="away")'
        )
    return (
        _index("palm", PALMS, output.palm),
        _index("move", MOVES, output.move),
        bool(output.stop),
        _index("send", MESSAGE_KINDS, output.send),
        bool(output.consume),
        _case(output.case),
        bool(output.waiting),
    )


def _index(what: str, legal: tuple[str | None, ...], value: object) -> int:
    if (isinstance(value, str) or value is None) and value in legal:
        return legal.index(value)
    raise PalmbotsError(
        f"controller: {what} is {shown(value)}; allowed: {', '.join(shown(name) for name in legal)}"
    )


def _case(name: object) -> int:
    if name is None:
        return ord(" ")
    if isinstance(name, str) and len(name) == 1 and name in " abcd":
        return ord(name)
    raise PalmbotsError(f'controller: case is {shown(name)}; allowed: "a" to "d", or None')
