# SPDX-License-Identifier: Apache-2.0
"""The section `task.path` of a scene: the line on the floor that the robots follow.

Frame: seen from above, x points ahead at the start, in the direction of travel, and y to the left.
A path is straight until its curve begins (`lead_in_m`), and straight again after its end. The curve
itself is computed in `palmbots.mujoco.path_curve`.
"""

import csv
import itertools
import math
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots._util.user_paths import user_path
from palmbots.scene.fields import Range, field_error, from_list
from palmbots.scene.section import Section

_MOST_CHARACTERS = 1 << 20
_MOST_POINTS = 10_000
_LEAST_STEP_M = 0.01

Spot = Annotated[float, BeforeValidator(Range("m", least=-1000, most=1000))]
Point = Annotated[tuple[Spot, Spot], BeforeValidator(from_list("[x, y], two numbers in m", 2, 2))]
Points = Annotated[
    tuple[Point, ...],
    BeforeValidator(from_list(f"a list of 3 to {_MOST_POINTS} points [x, y]", 3, _MOST_POINTS)),
]
Radius = Annotated[float, BeforeValidator(Range("m", least=0.01, most=10_000))]
Sweep = Annotated[float, BeforeValidator(Range("degrees", least=1, most=3600))]
Stretch = Annotated[float, BeforeValidator(Range("m", least=0, most=100))]

CURVED = ("arc", "s", "waypoints")
_KINDS_OF_KEY = {  # the kinds of path that have a key
    "radius_m": CURVED,
    "angle_deg": ("arc", "s"),
    "turn": ("arc", "s"),
    "transition_m": CURVED,
    "lead_in_m": CURVED,
    "waypoints_m": ("waypoints",),
}


class Path(Section):
    """[task.path] The line on the floor that both robots follow, like the bogies of a rail car."""

    kind: Literal["straight", "arc", "s", "waypoints"] = "straight"
    """straight, arc (a circle), s (an arc and a second one in the other direction) or waypoints
    (through points). All but straight need `--world mujoco`."""
    radius_m: Radius | None = None
    """Radius of an arc or an s. Not set: 2. With waypoints: the path is straight between them, and
    its corners are rounded with this radius. Not set: a smooth curve goes through them."""
    angle_deg: Sweep | None = None
    """Angle by which an arc, or each half of an s, turns. Not set: an arc turns until the carry
    ends, at most once around, and each half of an s turns by 45."""
    turn: Literal["left", "right"] | None = None
    """Side to which an arc, or the first half of an s, turns in the direction of travel. Not set:
    left."""
    transition_m: Stretch | None = None
    """Length of the transition curves, on which the curvature of an arc or an s rises from 0 or
    falls to 0. Not set: 0.1."""
    lead_in_m: Stretch | None = None
    """Straight distance that the leading robot drives before the curve begins. Not set: 0.1."""
    waypoints_m: Points | None = None
    """Points on the floor, in any frame. The curve begins at the first one and ends at the last
    one."""
    file: str | None = None
    """A CSV file with a point `x,y` in m on each line, in place of `waypoints_m`. A line that
    begins with # is a comment, and names of columns are skipped. The name is relative to the scene
    file. The scene contains the points, not the name."""

    @model_validator(mode="before")
    @classmethod
    def _read(cls, data: Any) -> Any:
        """Points from the file, and the keys that follow from others."""
        if not isinstance(data, dict):
            return data
        data = dict(data)
        if (name := data.pop("file", None)) is not None:
            if data.get("waypoints_m") is not None:
                raise field_error(name, "is given beside waypoints_m", "one of the two", "file")
            data["waypoints_m"] = read_points(name)
        if data.get("waypoints_m") is not None:
            data.setdefault("kind", "waypoints")
        if data.get("kind") in ("arc", "s") and data.get("turn") is None:
            data["turn"] = "left"
        return data

    @model_validator(mode="after")
    def _check(self) -> Self:
        for key, kinds in _KINDS_OF_KEY.items():
            value = getattr(self, key)
            if value is not None and self.kind not in kinds:
                given = [list(p) for p in value] if key == "waypoints_m" else value
                raise field_error(
                    given,
                    f"is given to a path of kind {self.kind}",
                    f"{key} with kind = {' or '.join(kinds)}",
                    key,
                )
        if self.kind != "waypoints":
            return self
        if self.waypoints_m is None:
            raise field_error(
                None,
                "is not set, but the path has kind waypoints",
                f"a list of 3 to {_MOST_POINTS} points [x, y], or file",
                "waypoints_m",
            )
        refuse_near_points(self.waypoints_m)
        return self

    @property
    def is_curved(self) -> bool:
        """Whether the path is not a straight line."""
        return self.kind in CURVED

    def mirrored(self) -> "Path":
        """The mirror image: left turns become right turns."""
        table = self.model_dump()
        if self.kind in ("arc", "s"):
            table["turn"] = "left" if self.turn == "right" else "right"
        if self.waypoints_m is not None:
            table["waypoints_m"] = tuple((x, 0.0 - y) for x, y in self.waypoints_m)
        return Path.model_validate(table)


def refuse_near_points(points: tuple[Point, ...]) -> None:
    """Raise the fault of a scene for waypoints that are too close to each other."""
    for k, (one, two) in enumerate(itertools.pairwise(points), start=1):
        if math.dist(one, two) < _LEAST_STEP_M:
            raise field_error(
                list(two),
                f"is {math.dist(one, two):g} m from the waypoint before it",
                f"at least {_LEAST_STEP_M:g} m from each waypoint to the next",
                f"waypoints_m[{k}]",
            )


def read_points(name: object) -> list[list[float]]:
    """The points of a CSV file; raises the fault of a scene, with file and line."""
    wanted = "the name of a CSV file with a point x,y in m on each line"
    if not isinstance(name, str):
        raise field_error(name, "is not a file name", wanted, "file")
    try:
        with user_path(name).open(encoding="utf-8-sig") as stream:
            text = stream.read(_MOST_CHARACTERS + 1)
        rows = list(csv.reader(text.splitlines()))
    except (OSError, ValueError) as error:  # ValueError: not UTF-8, or a null character in the name
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise field_error(name, f"cannot be read ({reason})", wanted, "file") from None
    except csv.Error:  # such as a very long field
        raise field_error(name, "is not a CSV file", wanted, "file") from None
    if len(text) > _MOST_CHARACTERS:  # a device may be endless
        raise field_error(name, "is larger than 1 MiB", wanted, "file")
    points: list[list[float]] = []
    for number, row in enumerate(rows, start=1):
        if not row or row[0].lstrip().startswith("#"):
            continue
        if not points and not any(map(_is_number, row)):  # the names of the columns
            continue
        try:
            x, y = (float(cell) for cell in row)
        except ValueError:
            line = ",".join(row)
            raise field_error(
                name, f'has "{line[:40]}" in line {number}, which is not a point', wanted, "file"
            ) from None
        points.append([x, y])
        if len(points) > _MOST_POINTS:
            raise field_error(name, f"has more than {_MOST_POINTS} points", "fewer points", "file")
    if len(points) < 3:
        raise field_error(
            name,
            f"has {len(points)} point{'s' * (len(points) != 1)}",
            f"3 to {_MOST_POINTS} points, one x,y in m on each line",
            "file",
        )
    return points


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
