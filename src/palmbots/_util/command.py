# SPDX-License-Identifier: Apache-2.0
"""Commands of the command line, each declared at the function that does its work.

The docstring of the function is the help of the command: the text above ``Args:``. Its parameters
become options where `command` names them, or where `palmbots.cli.options` has an option of their
name. Annotations state what an option may be: a ``Literal`` is one of these words, a sequence is
given as A,B,…, and an interval as two numbers. What only callers in Python need to know stands in
``Note:``. A function that writes the result to files declares its options with `writes`.

`palmbots.cli.declared_commands` reads the declarations as text, without importing their modules. So
a declaration stands at the start of a line and consists of literals, and so do the defaults of
options.
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
    is_argument: bool = False
    """Positional."""
    is_file: bool = False
    """A positional argument: the file that the result is about."""
    suffixes: tuple[str, ...] = ()
    """Of the file that is written, which select its format; empty: any."""
    is_hidden: bool = False
    """For other programs of the package only."""
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
                f"{name}: value is {shown}; allowed: {scale * low:.10g} to {scale * high:.10g}"
            )
        return float(value)  # also of NumPy's single precision


class _Declaration:
    """What all declarations have: options, whose limits hold in Python, too."""

    def __init__(self, name: str, options: dict[str, Option]) -> None:
        self.name, self.options = name, options

    def __call__(self, function: Callable[P, T]) -> Callable[P, T]:
        limited = {
            key: one for key, one in self.options.items() if (one.least, one.most) != (None, None)
        }
        if not limited:
            return function
        for key, one in limited.items():  # else a call could pass the check by
            assert one.least is not None and one.most is not None, key
            assert key in (getattr(function, "__kwdefaults__", None) or {}), f"{key}: keyword-only"

        @wraps(function)
        def checked(*args: P.args, **kwargs: P.kwargs) -> T:
            for key, one in limited.items():
                if key in kwargs:
                    kwargs[key] = one.checked(key, kwargs[key])
            return function(*args, **kwargs)

        return checked


class command(_Declaration):  # used as a decorator
    """Declare a command around the function below.

    A function that returns an ``int`` runs processes or a screen. All its parameters are options;
    it prints what it has to, and returns the exit status.

    Args:
        name: of the command; empty: the function's. Two words: a command within a group.
        order: its place in ``palmbots --help``.
        example: one line, shown in its help.
        progress: what the work is called while it lasts; empty: it is quick.
        figure: file of the result's figure in the folder of ``--out``; empty: there is none.
        failure: a property of the result, and what it means that it is false, which is exit
            status 1.
        results: what ``--json`` prints, as ``module:Class``, where the function does not return
            it.
        takes_pairs: a pair file may be given in place of a scene.
        then: what to run next, with parameters in braces; empty: nothing in particular.
        options: the options, by parameter.
    """

    def __init__(
        self,
        name: str = "",
        /,
        *,
        order: int,
        example: str,
        progress: str = "",
        figure: str = "",
        failure: tuple[str, str] = ("", ""),
        results: tuple[str, ...] = (),
        takes_pairs: bool = False,
        then: str = "",
        **options: Option,
    ) -> None:
        super().__init__(name, options)
        self.order, self.example, self.progress = order, example, progress
        self.takes_pairs = takes_pairs
        self.figure, self.failure, self.results, self.then = figure, failure, results, then


class writes(_Declaration):  # used as a decorator
    """Declare that the function below writes the result of a command.

    Its parameters are the result, the file or folder to write, and further options. It returns the
    files, and lines for people.

    Args:
        name: of the command.
        progress: what the work is called while it lasts; empty: it is quick.
        options: the options, by parameter.
    """

    def __init__(self, name: str, /, *, progress: str = "", **options: Option) -> None:
        super().__init__(name, options)
        self.progress = progress
