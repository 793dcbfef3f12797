"""Controllers from Python: the shipped one to step by hand, and the interface for your own.

A controller decides, once every control period, from what one robot knows: the tactile sign of its
contact, the oldest unread letter, and whether its palm has reached the angle last commanded. Any
object with such a ``step`` can carry: ``pb.carry(controller=MyController)`` makes one for each
robot. It runs in the same world and over the same radio as the built-in ones, only slower.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol

from palmbots import _core

__all__ = ["Controller", "Distributed", "Letter", "Move", "Palm", "StepInput", "StepOutput"]

Letter = Literal["TiltUp", "TiltDown", "Ack"]
Palm = Literal["steep", "shallow"]
Move = Literal["hold", "away", "closer"]

_LETTERS: tuple[Letter | None, ...] = (None, "TiltUp", "TiltDown", "Ack")
_PALMS: tuple[Palm, ...] = ("steep", "shallow")
_MOVES: tuple[Move, ...] = ("hold", "away", "closer")


@dataclass(frozen=True, slots=True)
class StepInput:
    """What a robot knows at a tick."""

    sign: Literal[-1, 0, 1]
    """Tactile sign of the contact coordinate p; p > 0 is outward."""
    letter: Letter | None
    """The oldest letter not yet read."""
    turned: bool
    """The palm has reached the angle last commanded."""


@dataclass(frozen=True, slots=True)
class StepOutput:
    """What a robot does until the next tick."""

    palm: Palm = "steep"
    move: Move = "hold"
    """Keep the nominal speed, or add the correction speed away from or towards the partner."""
    send: Letter | None = None
    read: bool = False
    """The letter is used up; otherwise it is there again at the next tick."""
    case: str = " "
    """The case of Table 2 that the robot is in, ``"a"`` to ``"d"``, for the trace; or a blank."""
    waits: bool = False
    """The robot waits for a letter, for ``waiting_s``."""


class Controller(Protocol):
    """One robot's controller."""

    def step(self, seen: StepInput, /) -> StepOutput:
        """One control period."""
        ...


class Distributed:
    """The shipped distributed algorithm (Table 2), the very code that carries."""

    def __init__(self) -> None:
        self._core = _core.Distributed()

    def step(self, seen: StepInput, /) -> StepOutput:
        """One control period."""
        palm, move, send, read = self._core.step(
            seen.sign, _LETTERS.index(seen.letter), seen.turned
        )
        return StepOutput(
            palm=_PALMS[palm],
            move=_MOVES[move],
            send=_LETTERS[send],
            read=read,
            case=self._core.name,
            waits=self._core.waits,
        )


def adapted(controller: Controller) -> Callable[[int, int, bool], tuple[object, ...]]:
    """The controller's step as the core calls it, in numbers.

    Raises:
        ValueError: when called, if the controller answers with something that is not legal.
    """

    def step(sign: int, letter: int, turned: bool) -> tuple[object, ...]:
        out = controller.step(StepInput((-1, 0, 1)[sign + 1], _LETTERS[letter], turned))
        return (
            _index("palm", _PALMS, out.palm),
            _index("move", _MOVES, out.move),
            _index("send", _LETTERS, out.send),
            bool(out.read),
            _case(out.case),
            bool(out.waits),
        )

    return step


def _index(what: str, legal: tuple[object, ...], value: object) -> int:
    try:
        return legal.index(value)
    except ValueError:
        raise ValueError(f"controller: {what} is {value!r}; allowed: {legal}") from None


def _case(name: str) -> int:
    if len(name) == 1 and name in " abcd":
        return ord(name)
    raise ValueError(f"controller: case is {name!r}; allowed: 'a' to 'd', or ' '")
