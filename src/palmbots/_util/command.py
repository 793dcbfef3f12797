# SPDX-License-Identifier: Apache-2.0
"""Commands of the command line, each declared at the function that does its work.

The docstring of the function is the help of the command: the text above ``Args:``. Its parameters
become options where `command` names them. ``scene``, ``overrides``, ``controller``,
``controllers``, ``seed``, ``precision`` and ``on_progress`` need no declaration. What only
callers in Python need to know stands in ``Note:``. `palmbots.cli.declared_commands` reads the
declarations without importing their modules, so a declaration stands at the start of a line and
gives name, order and example as literals.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from palmbots.errors import PalmbotsError

P = ParamSpec("P")
T = TypeVar("T")


@dataclass(frozen=True)
class Option:
    """A parameter as an option. Its type and default are those of the parameter."""

    names: str = ""
    """As typed, separated by blanks; empty: made of the parameter's name, as in ``--drop-rate``."""
    help: str = ""
    """Empty: the first sentence on the parameter in ``Args:``, in which "; None: …" reads
    "[default: …]"."""
    metavar: str | None = None
    is_file: bool = False
    """A positional argument: the file that the result is about."""
    percent: bool = False
    """Given in percent: the parameter is a fraction, and the option's name ends in -percent."""
    least: float | None = None
    most: float | None = None
    """Limits of the parameter, which also hold for callers in Python. Whole limits allow whole
    numbers only. None: the function itself checks."""

    def checked(self, name: str, value: Any, scale: int = 1) -> Any:
        """The value, if it is within the limits.

        Args:
            name: of the value, in a refusal.
            value: to be checked.
            scale: of the value: 100 for a percentage.

        Raises:
            PalmbotsError: it is not.
        """
        from palmbots._util.arguments import show, whole_number

        low, high = self.least, self.most
        if value is None or low is None or high is None:
            return value
        if isinstance(low, int) and isinstance(high, int):
            return whole_number(name, value, low, high)
        if not scale * low <= value <= scale * high:
            shown = f"{value:g}" if isinstance(value, float) else show(value)
            raise PalmbotsError(
                f"{name}: value is {shown}; allowed: {scale * low:g} to {scale * high:g}"
            )
        return value


@dataclass(frozen=True)
class Command:
    """A command, as its function declares it."""

    function: Callable[..., Any]
    name: str
    order: int
    example: str
    progress: str
    """What the work is called while it lasts; empty: it is quick."""
    figure: str
    """File of the result's figure in the folder of ``--out``; empty: there is none."""
    failure: tuple[str, str]
    """A property of the result, and what it means that it is false, which is exit status 1."""
    results: tuple[str, ...]
    """The kinds of results, as ``module:Class``; empty: the one that the function returns."""
    options: dict[str, Option]


COMMANDS: dict[str, Command] = {}
"""Those whose modules are imported, by name."""


def command(
    name: str = "",
    *,
    order: int,
    example: str,
    progress: str = "",
    figure: str = "",
    failure: tuple[str, str] = ("", ""),
    results: tuple[str, ...] = (),
    **options: Option,
) -> Callable[[Callable[P, T]], Callable[P, T]]:
    """Declare a command around the function below.

    Args:
        name: of the command; empty: the function's. Two words: a command within a group.
        order: its place in ``palmbots --help``.
        example: one line, shown in its help.
        progress: what the work is called while it lasts.
        figure: file of the result's figure.
        failure: the property of the result that decides the exit status, and what its absence
            means.
        results: what ``--json`` prints, where the function does not return it.
        options: the options, by parameter.
    """

    def declare(function: Callable[P, T]) -> Callable[P, T]:
        limited = {
            key: one for key, one in options.items() if (one.least, one.most) != (None, None)
        }
        for key, one in limited.items():  # else a call could pass the check by
            assert one.least is not None and one.most is not None, key
            assert key in (getattr(function, "__kwdefaults__", None) or {}), f"{key}: keyword-only"

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> T:
            for key, one in limited.items():
                if key in kwargs:
                    kwargs[key] = one.checked(key, kwargs[key])
            return function(*args, **kwargs)

        known = name or function.__name__.replace("_", "-")
        made = checked if limited else function
        COMMANDS[known] = Command(
            made, known, order, example, progress, figure, failure, results, options
        )
        return made

    return declare
