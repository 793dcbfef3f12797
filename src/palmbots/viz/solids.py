# SPDX-License-Identifier: Apache-2.0
"""The solids of robots, palms and object: what logs, MuJoCo, URDF, Rerun and the side view draw.

Frames: x forward, y to the left of the direction of travel, z up (REP-103), metres. The side view
of `scene.placement` is the plane y = 0; its y is z here. The fixed frame is `world`. The frames of
a robot and of its palm have their origin at the pivot; the palm's turns. Drawn robots have four
wheels; those of the MuJoCo world have two, and a caster.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from palmbots._types import SIDES, Side
from palmbots.scene import chassis
from palmbots.scene.extrusion import triangles
from palmbots.scene.placement import Placement, floor_level
from palmbots.scene.robot_dimensions import (
    ARM_HALF_SPACING,
    BODY_GAP,
    BODY_SIZE,
    GROUND_CLEARANCE,
    WHEEL_INSET,
    WHEEL_RADIUS,
    WHEEL_WIDTH,
)
from palmbots.scene.surroundings import drawn_blocks
from palmbots.viz.style import HUE, INK, OBJECT, PALE, QUIET, RULE, ZERO

if TYPE_CHECKING:
    from palmbots._core import Spec
    from palmbots.scene.palm_section import PalmParameters
    from palmbots.scene.scene import Scene

WORLD = "world"
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Box:
    """A box about `centre`, rotated by `turn` about y; > 0 rotates x towards z."""

    size: Vector
    centre: Vector
    turn: float = 0.0

    def corners(self) -> list[tuple[float, float]]:
        """The four corners of its side view, in (x, z)."""
        x, z = self.size[0] / 2, self.size[2] / 2
        cos, sin = math.cos(self.turn), math.sin(self.turn)
        return [
            (self.centre[0] + a * cos - b * sin, self.centre[2] + a * sin + b * cos)
            for a, b in ((-x, -z), (x, -z), (x, z), (-x, z))
        ]


@dataclass(frozen=True)
class Cylinder:
    """A cylinder about `centre`, its axis along y."""

    radius: float
    length: float
    centre: Vector


@dataclass(frozen=True)
class Ball:
    """A ball about the origin of its frame."""

    radius: float


@dataclass(frozen=True)
class Prism:
    """A polygon in the (x, z) plane, counter-clockwise, extruded along y by ± depth / 2."""

    outline: tuple[tuple[float, float], ...]
    depth: float

    def mesh(self) -> tuple[list[Vector], list[tuple[int, int, int]]]:
        """Its corners, and triangles of them, counter-clockwise seen from outside."""
        count, half = len(self.outline), self.depth / 2
        corners = [(x, y, z) for y in (-half, half) for x, z in self.outline]
        faces: list[tuple[int, int, int]] = []
        for a, b, c in triangles(self.outline):
            faces += [(a, b, c), (c + count, b + count, a + count)]
        for k in range(count):
            n = (k + 1) % count
            faces += [(k, k + count, n + count), (k, n + count, n)]
        return corners, faces


@dataclass(frozen=True)
class Solid:
    """A shape with its colour, fixed in a frame."""

    frame: str
    shape: Box | Cylinder | Ball | Prism
    colour: str  # "#RRGGBB"


def body(side: Side, floor: float) -> Solid:
    """The cubic body in the frame of its robot, whose pivot is at z = 0, above the floor."""
    middle = _outward(side) * (BODY_GAP + BODY_SIZE / 2)
    low = floor + GROUND_CLEARANCE
    box = Box((BODY_SIZE, BODY_SIZE, BODY_SIZE), (middle, 0.0, low + BODY_SIZE / 2))
    return Solid(f"{side}_robot", box, PALE[side])


ARM_WIDTH = 0.015  # m


def shoulder(side: Side, floor: float) -> tuple[float, float]:
    """Where the arm begins (x, z), in the frame of the robot; it ends at the pivot."""
    out, up = chassis.shoulder(floor)
    return _outward(side) * out, up


def arm(side: Side, floor: float) -> list[Solid]:
    """The two bars between shoulder and pivot."""
    x, z = shoulder(side, floor)
    bars = (
        Box((math.hypot(x, z), ARM_WIDTH, ARM_WIDTH), (x / 2, across, z / 2), math.atan2(z, x))
        for across in (-ARM_HALF_SPACING, ARM_HALF_SPACING)
    )
    return [Solid(f"{side}_robot", bar, QUIET) for bar in bars]


def wheel(side: Side, hub: Vector, radius: float = WHEEL_RADIUS) -> Solid:
    """A wheel whose middle is at `hub`."""
    return Solid(f"{side}_robot", Cylinder(radius, WHEEL_WIDTH, hub), INK)


def robot(side: Side, floor: float) -> list[Solid]:
    """Body, four wheels and arm in the frame of the robot."""
    middle = _outward(side) * (BODY_GAP + BODY_SIZE / 2)
    wheels = [
        wheel(side, (middle + along, across, floor + WHEEL_RADIUS))
        for along in (-0.05, 0.05)
        for across in (-BODY_SIZE / 2 - WHEEL_INSET, BODY_SIZE / 2 + WHEEL_INSET)
    ]
    return [body(side, floor), *wheels, *arm(side, floor)]


def plate(side: Side, palm: "PalmParameters") -> list[Solid]:
    """The palm in its own frame: a plate without its bevel, and the heel if there is one."""
    thick, top = palm.plate_m, palm.pivot_offset_m
    boxes = [Box((palm.length_m, palm.width_m, thick), (0.0, 0.0, top - thick / 2))]
    if palm.heel_m > 0:
        high = palm.heel_m + thick
        out = _outward(side) * (palm.length_m + thick) / 2
        boxes.append(Box((thick, palm.width_m, high), (out, 0.0, top - thick + high / 2)))
    return [Solid(f"{side}_palm", box, HUE[side]) for box in boxes]


def solids(scene: "Scene", spec: "Spec") -> list[Solid]:
    """All visible solids of a scene."""
    floor = floor_level(spec)
    wide = max(BODY_SIZE, scene.object.depth_m)
    travel = spec.distance * spec.direction
    start, end = min(0.0, travel) - 1.0, max(0.0, travel) + 1.0
    ground = Box((end - start, 4 * wide, 0.004), ((start + end) / 2, 0.0, floor - 0.002))
    marks = (Box((0.01, 4 * wide, 0.002), (x, 0.0, floor + 0.001)) for x in (0.0, travel))
    parts = [Solid(WORLD, ground, RULE), *(Solid(WORLD, mark, QUIET) for mark in marks)]
    for left, right, low, high in drawn_blocks(spec):
        middle = ((left + right) / 2, 0.0, (low + high) / 2)
        parts.append(Solid(WORLD, Box((right - left, 2 * wide, high - low), middle), QUIET))
    for side in SIDES:
        parts += [*robot(side, floor), *plate(side, scene.palm_of(side))]
    thing = Prism(tuple(spec.silhouette), scene.object.depth_m)
    return [*parts, Solid("object", thing, OBJECT)]


def contact_balls() -> list[Solid]:
    """The contact points as solids, for viewers that do not read `contact_update`."""
    return [Solid(f"{side}_contact", Ball(0.006), ZERO) for side in SIDES]


def poses(place: Placement, row: int) -> dict[str, tuple[Vector, float]]:
    """Origin and rotation about y (> 0: x towards z) of every moving frame."""
    frames: dict[str, tuple[Vector, float]] = {}

    def put(frame: str, point: "tuple[float, float]", turn: float) -> None:
        frames[frame] = ((point[0], 0.0, point[1]), turn)

    pivots = place.pivot[row].tolist()
    put("pair", ((pivots[0][0] + pivots[1][0]) / 2, 0.0), 0.0)
    for k, side in enumerate(SIDES):
        put(f"{side}_robot", (pivots[k][0], 0.0), 0.0)  # it does not rise with its pivot
        put(f"{side}_palm", pivots[k], float(place.palm_turn[row, k]))
        put(f"{side}_contact", place.contact[row, k].tolist(), float(place.palm_turn[row, k]))
    put("object", place.origin[row].tolist(), float(place.turn[row]))
    return frames


def _outward(side: Side) -> float:
    return -1.0 if side == "left" else 1.0
