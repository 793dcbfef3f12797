# SPDX-License-Identifier: Apache-2.0
"""Lists for people, in Python, notebooks and a terminal: scenes, objects and keys."""

import fnmatch
from collections.abc import Iterator
from dataclasses import dataclass

from palmbots._util.arguments import show
from palmbots._util.command import Option, command
from palmbots._util.report import Item, Line, Table, bold, quiet
from palmbots._util.results import Result
from palmbots.errors import PalmbotsError
from palmbots.scene.key_reference import SceneKey, built_in_meanings, scene_keys


@dataclass(frozen=True)
class Named:
    """A name with its meaning."""

    name: str
    meaning: str


@dataclass(frozen=True, repr=False)
class SceneList(Result):
    """The built-in scenes."""

    scenes: tuple[Named, ...]

    def lines(self) -> Iterator[Item]:
        """The names with their meanings."""
        yield _table(self.scenes)


@dataclass(frozen=True, repr=False)
class ObjectList(Result):
    """The built-in objects."""

    objects: tuple[Named, ...]

    def lines(self) -> Iterator[Item]:
        """The names with their meanings."""
        yield _table(self.objects)


@dataclass(frozen=True, repr=False)
class KeyList(Result):
    """Keys of a scene."""

    keys: tuple[SceneKey, ...]

    def lines(self) -> Iterator[Item]:
        """Each key with its default and unit, and its meaning below."""
        for key in self.keys:
            default = f" = {key.default_text}" if key.default_text else "  (not set)"
            unit = quiet(f"  {key.unit}") if key.unit else ""
            yield Line(bold(key.name), default, unit)
            if key.meaning:
                yield Line(key.meaning, indent=4)


@command(order=150, example="palmbots scenes")
def scenes() -> SceneList:
    """List the built-in scenes.

    Start a scene of your own with palmbots init scene FILE.
    """
    return SceneList(_named("scenes"))


@command(order=160, example="palmbots objects")
def objects() -> ObjectList:
    """List the built-in objects.

    Use one with --set object=NAME, or object = "NAME" in a scene file.
    """
    return ObjectList(_named("objects"))


@command(order=170, example="palmbots keys radio", pattern=Option(is_argument=True))
def keys(pattern: str = "") -> KeyList:
    """List the scene keys with default, unit and meaning.

    palm.left.KEY and palm.right.KEY override one side, and so in the sections robot and arm.

    Args:
        pattern: part of a key, or a pattern such as 'radio.*_s'.

    Raises:
        PalmbotsError: there is no such key.
    """
    text = pattern.lower()
    if any(sign in text for sign in "*?["):
        found = tuple(key for key in scene_keys() if fnmatch.fnmatchcase(key.name, text))
    else:
        found = tuple(key for key in scene_keys() if text in key.name)
    if not found:
        sections = sorted({key.name.partition(".")[0] for key in scene_keys()})
        raise PalmbotsError(
            f"PATTERN: value is {show(pattern)}, which matches no key; sections: "
            f"{', '.join(sections)}"
        )
    return KeyList(found)


def _named(kind: str) -> tuple[Named, ...]:
    return tuple(Named(name, meaning) for name, meaning in built_in_meanings(kind).items())


def _table(rows: tuple[Named, ...]) -> Table:
    return Table([(bold(row.name), row.meaning) for row in rows], gap=2)
