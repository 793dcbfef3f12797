# SPDX-License-Identifier: Apache-2.0
"""What a fit estimates, and the part of a scene file that it writes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from palmbots._util.atomic_files import folder, write_whole
from palmbots._util.toml_writer import toml_value
from palmbots._version import __version__

Value = float | bool | tuple[float, float]
"""Of a key: a number, a switch, or a point [x, y]."""

LEAST_RUNS = 5
"""Fewest runs that intervals are bootstrapped over."""


@dataclass(frozen=True)
class Source:
    """A file that was fitted."""

    name: str
    sha256: str


@dataclass(frozen=True)
class Estimate:
    """One quantity: a key of a scene, or what the recording has besides."""

    key: str
    value: Value | None
    low: float | None
    """95 % interval, of a point that of its x; equal to the end of the range: a bound on one
    side."""
    high: float | None
    reason: str
    """Why it is not identified; empty: it is."""

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


def fitted_keys(estimates: Sequence[Estimate]) -> dict[str, Value]:
    """What was identified, as overrides of a scene."""
    return {
        one.key: shown(one.value)
        for one in estimates
        if one.is_identified and one.is_key and one.value is not None
    }


def estimate_rows(estimates: Sequence[Estimate]) -> list[tuple[str, str, str]]:
    """Key, value and interval of what was identified."""
    return [
        (f"  {one.key}", _text(one.value), f"{one.low:.4g} to {one.high:.4g}")
        for one in estimates
        if one.is_identified
        and one.value is not None
        and one.low is not None
        and one.high is not None
    ]


def fragment(
    estimates: Sequence[Estimate], sources: Sequence[Source], remarks: Sequence[str]
) -> str:
    """The text of a part of a scene: values with their intervals, and the keys that are not
    identified as comments.

    Args:
        estimates: of keys of the scene, section by section, and of other quantities.
        sources: what was fitted.
        remarks: further lines at the top.
    """
    lines = [f"# Fitted by palmbots {__version__}; the comments are 95 % intervals.", "#"]
    lines += [f"# {one.name}: SHA-256 {one.sha256}" for one in sources]
    lines += [f"# {one}" for one in remarks]
    section = ""
    for one in (each for each in estimates if each.is_key):
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
            lines.append(line)
        else:
            lines.append(f"# {key}: {one.reason}")
    others = [each for each in estimates if not each.is_key]
    if others:
        lines.append("")
    for one in others:
        if one.is_identified and one.value is not None:
            lines.append(f"# {one.key}: {_text(one.value)} ({one.low:.4g} to {one.high:.4g})")
        else:
            lines.append(f"# {one.key}: {one.reason}")
    return "\n".join(lines) + "\n"


def write_fragment(text: str, path: str | os.PathLike[str], name: str) -> Path:
    """Write the fragment to a folder; returns the file."""
    file = folder(Path(path)) / f"{name}.toml"
    write_whole(file, text)
    return file
