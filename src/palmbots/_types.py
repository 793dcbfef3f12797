# SPDX-License-Identifier: Apache-2.0
"""Types and names that every room uses."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Annotated, Any, Generic, Literal, TypeAlias, TypeVar

T = TypeVar("T")
U = TypeVar("U")

Side = Literal["left", "right"]

SIDES: tuple[Side, Side] = ("left", "right")

Interval: TypeAlias = tuple[float, float]
"""The lower and the upper end."""

Region: TypeAlias = Interval | Literal["implied", "palm"]
"""Contact coordinates [m], or where they come from: the scene, or the whole palm."""

MaybeNaN: TypeAlias = Annotated[float, "null in JSON where it is NaN or infinite"]
"""A number that may be NaN or infinite; JSON has null there."""

FilePath: TypeAlias = str | PathLike[str]
"""The name of a file or folder."""

Overrides: TypeAlias = Mapping[str, Any] | None
"""Scene keys to set on top of a scene, such as ``{"radio.loss": 0.1}``."""


@dataclass(frozen=True, slots=True)
class BySide(Generic[T]):
    """A value for each robot, or for each palm."""

    left: T
    right: T

    @classmethod
    def of(cls, pair: Iterable[T]) -> "BySide[T]":
        """From the values (left, right)."""
        left, right = pair
        return cls(left, right)

    def __getitem__(self, side: Side) -> T:
        """The value of a side, by its name."""
        if side not in SIDES:
            raise KeyError(side)
        return self.left if side == "left" else self.right

    def values(self) -> tuple[T, T]:
        """The values (left, right)."""
        return self.left, self.right

    def items(self) -> tuple[tuple[Side, T], tuple[Side, T]]:
        """Each side with its value."""
        return ("left", self.left), ("right", self.right)

    def map(self, function: Callable[[T], U]) -> "BySide[U]":
        """The function of either value."""
        return BySide(function(self.left), function(self.right))
