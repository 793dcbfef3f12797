# SPDX-License-Identifier: Apache-2.0
"""What commands print that is no result of a function: lists, and files that were written."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palmbots._types import Interval, Side
from palmbots._util.plain_values import NOT_IN_JSON
from palmbots._util.report import Item, Line, Table, bold, good, quiet
from palmbots._util.results import Result
from palmbots.control.registry import describe
from palmbots.control.tolerated_noise import RECOMMENDED, tolerated_noise
from palmbots.scene.key_reference import SceneKey
from palmbots.scene.scene import Scene


@dataclass(frozen=True)
class Named:
    """A name with its meaning."""

    name: str
    meaning: str


def _named(meanings: Mapping[str, str]) -> tuple[Named, ...]:
    return tuple(Named(name, meaning) for name, meaning in meanings.items())


def _table(rows: tuple[Named, ...]) -> Table:
    return Table([(bold(row.name), row.meaning) for row in rows], gap=2)


@dataclass(frozen=True, repr=False)
class SceneList(Result):
    """The built-in scenes."""

    scenes: tuple[Named, ...]

    @classmethod
    def of(cls, meanings: Mapping[str, str]) -> "SceneList":
        """From names and meanings."""
        return cls(_named(meanings))

    def lines(self) -> Iterator[Item]:
        """The names with their meanings."""
        yield _table(self.scenes)


@dataclass(frozen=True, repr=False)
class ObjectList(Result):
    """The built-in objects."""

    objects: tuple[Named, ...]

    @classmethod
    def of(cls, meanings: Mapping[str, str]) -> "ObjectList":
        """From names and meanings."""
        return cls(_named(meanings))

    def lines(self) -> Iterator[Item]:
        """The names with their meanings."""
        yield _table(self.objects)


@dataclass(frozen=True)
class ListedController:
    """A controller, and the noise that it tolerates in the default scene."""

    name: str
    meaning: str
    messages: tuple[str, ...]
    requirements: tuple[str, ...]
    sigma_star_m_s: float | None
    sigma_star_interval: Interval | None
    sigma_star_command: str | None
    """The command that measured it."""

    @classmethod
    def of(cls, name: str) -> "ListedController":
        """The controller of this name."""
        entry, noise = describe(name), tolerated_noise(name)
        return cls(
            name,
            entry.description,
            entry.messages,
            entry.requirements,
            noise and noise.sigma_star_m_s,
            noise and noise.interval,
            noise and noise.command,
        )


@dataclass(frozen=True, repr=False)
class ControllerList(Result):
    """The controllers."""

    controllers: tuple[ListedController, ...]

    def lines(self) -> Iterator[Item]:
        """Each controller with σ*, its messages, what it requires, and its meaning."""
        for one in self.controllers:
            noise = one.sigma_star_m_s
            star = "" if noise is None else f"  σ* {100 * noise:.2f} cm/s"
            mark = good("  recommended") if one.name == RECOMMENDED else ""
            yield Line(bold(one.name), star, mark)
            yield Line(one.meaning, indent=4)
            if one.messages:
                yield Line(quiet(f"messages: {', '.join(one.messages)}"), indent=4)
            for need in one.requirements:
                yield Line(quiet(f"needs {need}"), indent=4)
        yield quiet(
            "σ*: the speed noise at which 1 % of carries drop the object in the default scene; "
            "measured with: palmbots noise-limit -c CONTROLLER --relative-error-percent 0.3"
        )


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


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Files that a command wrote; people read their names and sizes."""

    files: tuple[Path, ...]

    def lines(self) -> Iterator[Item]:
        """Nothing besides the files."""
        return iter(())


@dataclass(frozen=True, repr=False)
class Exported(Files):
    """A scene in other formats."""

    files: tuple[Path, ...] = field(metadata=NOT_IN_JSON)
    mjcf: Path | None
    urdf: Path | None
    scene: Scene


@dataclass(frozen=True, repr=False)
class Published(Result):
    """What the bridge to ROS 2 has published for a robot."""

    side: Side
    published: dict[str, int]
    """Messages by topic."""

    def lines(self) -> Iterator[Item]:
        """The number of messages of each topic."""
        for topic, count in self.published.items():
            yield f"{topic:16} {count:7} messages"


SchemaTable = dict[str, Any]
"""A JSON Schema."""
