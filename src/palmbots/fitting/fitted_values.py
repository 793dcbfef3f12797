# SPDX-License-Identifier: Apache-2.0
"""What a fit estimates, what it reports, and the part of a scene file that it writes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import ClassVar

from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table
from palmbots._util.text import plural
from palmbots._util.toml_writer import toml_value
from palmbots._version import __version__
from palmbots.errors import PalmbotsError

Value = float | bool | tuple[float, float]
"""Of a key: a number, a switch, or a point [x, y]."""

LEAST_RUNS = 5
"""Fewest runs that intervals are bootstrapped over."""


@dataclass(frozen=True)
class Source:
    """A file that was fitted."""

    name: str
    sha256: str


def refuse_twice(sources: Iterable[Source]) -> None:
    """Refuse to fit a file twice: intervals would be too narrow.

    Raises:
        PalmbotsError: two files have the same content.
    """
    names: dict[str, str] = {}
    for one in sources:
        if one.sha256 in names:
            raise PalmbotsError(
                f"{one.name}: has the content of {names[one.sha256]}; expected each recording once"
            )
        names[one.sha256] = one.name


@dataclass(frozen=True)
class Estimate:
    """One quantity: a key of a scene, or what the recording has besides."""

    key: str
    value: Value | None = None
    low: float | None = None
    """95 % interval, of a point that of its x; equal to the end of the range: a bound on one
    side."""
    high: float | None = None
    reason: str = ""
    """Why it is not identified; empty: it is."""
    remark: str = ""
    """What else the interval means."""

    @property
    def is_identified(self) -> bool:
        """Whether the data determine it."""
        return not self.reason

    @property
    def is_key(self) -> bool:
        """Whether it is a key of a scene."""
        return "." in self.key


def shown(value: Value) -> Value:
    """A value with the digits that a file has."""
    if isinstance(value, tuple):
        return _digits(value[0]), _digits(value[1])
    return value if isinstance(value, bool) else _digits(value)


def _digits(value: float) -> float:
    return float(f"{value:.4g}")


def _text(value: Value) -> str:
    numbers = value if isinstance(value, tuple) else (value,)
    text = ", ".join(f"{one:.4g}" for one in numbers)
    return f"[{text}]" if isinstance(value, tuple) else text


@dataclass(frozen=True)
class Replay:
    """A file that carries replay, or why there is none."""

    name: str = ""
    key: str = ""
    rows: str = ""
    """The columns' names, and the rows."""
    reason: str = ""

    @property
    def remark(self) -> str:
        """The line of the part of a scene that names it."""
        if self.reason:
            return f"{self.key} is not written: {self.reason}"
        return f'{self.name} replays the recording: {self.key} = "{self.name}"'


@dataclass(frozen=True, repr=False, eq=False)
class FittedPart:
    """A part of a scene that was fitted to recordings, with 95 % intervals."""

    name: ClassVar[str]
    """Of the part, and of its files."""

    sources: tuple[Source, ...]
    """The files that were fitted."""
    estimates: tuple[Estimate, ...]
    """Of scene keys, section by section, and of other quantities."""
    replay: Replay | None = field(metadata=NOT_IN_JSON)
    """The recording for carries that replay it; None: there is none of such a part."""

    @property
    def keys(self) -> dict[str, Value]:
        """What was fitted, as overrides of a scene."""
        return {
            one.key: shown(one.value)
            for one in self.estimates
            if one.is_identified and one.is_key and one.value is not None
        }

    def basis(self) -> str:
        """What the keys were fitted to, as a part of a sentence."""
        raise NotImplementedError

    def rows(self) -> list[tuple[str, str]]:
        """What else the report has of the data: names and values."""
        return []

    def lines(self) -> Iterator[Item]:
        """What was fitted, with intervals, what the data are, and why the rest was not fitted."""
        yield f"fitted {plural(len(self.keys), 'key')} {self.basis()}"
        rows = [
            (f"  {one.key}", _text(one.value), f"{one.low:.4g} to {one.high:.4g}")
            for one in self.estimates
            if one.is_identified
            and one.value is not None
            and one.low is not None
            and one.high is not None
        ]
        yield Table(rows, ("", "value", "95 % interval"))
        if more := self.rows():
            yield Table([(f"  {label}", text) for label, text in more])
        for one in self.estimates:
            if text := one.reason or one.remark:
                yield Line(f"{one.key}: {text}", indent=2)

    def fragment(self) -> str:
        """The text of the part of a scene: values with their intervals, and the keys that are not
        identified as comments."""
        lines = [f"# Fitted by palmbots {__version__}; the comments are 95 % intervals.", "#"]
        lines += [f"# {one.name}: SHA-256 {one.sha256}" for one in self.sources]
        if self.replay:
            lines.append(f"# {self.replay.remark}")
        section = ""
        for one in (each for each in self.estimates if each.is_key):
            name, _, key = one.key.rpartition(".")
            if name != section:
                lines += ["", f"[{name}]"]
                section = name
            if one.is_identified and one.value is not None:
                line = f"{key} = {toml_value(shown(one.value))}"
                if one.low is not None and one.high is not None:
                    line += f"  # {one.low:.4g} to {one.high:.4g}"
                    if isinstance(one.value, tuple):
                        line += " for x; y is that of the logs"
                line += f"; {one.remark}" if one.remark else ""
                lines.append(line)
            else:
                lines.append(f"# {key}: {one.reason}")
        others = [each for each in self.estimates if not each.is_key]
        if others:
            lines.append("")
        for one in others:
            if one.is_identified and one.value is not None:
                lines.append(f"# {one.key}: {_text(one.value)} ({one.low:.4g} to {one.high:.4g})")
            else:
                lines.append(f"# {one.key}: {one.reason}")
        return "\n".join(lines) + "\n"
