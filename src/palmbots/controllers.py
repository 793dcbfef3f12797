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
from palmbots.errors import PalmbotsError, show

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


Step = Callable[[int, int, bool], tuple[object, ...]]


def adapted_pair(maker: Callable[[], Controller]) -> tuple[Step, Step]:
    """A controller for each robot, its step as the core calls it.

    Raises:
        PalmbotsError: `maker` is no class of controllers; or, when the core calls a step, it
            answers with something that is not legal.
    """
    if not callable(maker):
        name = type(maker).__name__
        if hasattr(maker, "step"):
            raise PalmbotsError(
                f"controller: is one {name}, but each robot needs its own; "
                f"allowed: the class, controller={name}"
            )
        raise PalmbotsError(
            f"controller: value is {_shown(maker)}; allowed: a name, or a class with a step"
        )
    return _adapted(maker()), _adapted(maker())


def _adapted(controller: Controller) -> Step:
    """The controller's step as the core calls it, in numbers."""
    name = type(controller).__name__
    if not callable(getattr(controller, "step", None)):
        raise PalmbotsError(
            f"controller: {name} has no step; needed: def step(self, seen: StepInput) -> StepOutput"
        )

    def step(sign: int, letter: int, turned: bool) -> tuple[object, ...]:
        out: object = controller.step(StepInput((-1, 0, 1)[sign + 1], _LETTERS[letter], turned))
        if not isinstance(out, StepOutput):
            raise PalmbotsError(
                f"controller: {name}.step gave {_shown(out)}; allowed: a StepOutput, as in "
                'StepOutput(palm="shallow", move="away")'
            )
        return (
            _index("palm", _PALMS, out.palm),
            _index("move", _MOVES, out.move),
            _index("send", _LETTERS, out.send),
            bool(out.read),
            _case(out.case),
            bool(out.waits),
        )

    return step


def _shown(value: object) -> str:
    return "None" if value is None else show(value)


def _index(what: str, legal: tuple[str | None, ...], value: object) -> int:
    if (isinstance(value, str) or value is None) and value in legal:
        return legal.index(value)
    raise PalmbotsError(
        f"controller: {what} is {_shown(value)}; "
        f"allowed: {', '.join(_shown(name) for name in legal)}"
    )


def _case(name: object) -> int:
    if isinstance(name, str) and len(name) == 1 and name in " abcd":
        return ord(name)
    raise PalmbotsError(f'controller: case is {_shown(name)}; allowed: "a" to "d", or " "')
