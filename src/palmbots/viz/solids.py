# SPDX-License-Identifier: Apache-2.0
"""Robots, palms and object as solids in moving frames, for three-dimensional viewers.

Frames: x forward, y to the left of the direction of travel, z up (REP-103), metres. The side view
of `geometry` is the plane y = 0; its y is z here. The fixed frame is `world`. All other frames are
its children, and `poses` gives their motion. Each solid is defined once and written twice: as
`foxglove.SceneUpdate`, and as URDF for viewers that draw only robots.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from palmbots._types import SIDES, Side
from palmbots.scene.placement import Placement, floor_level
from palmbots.scene.robot_dimensions import (
    ARM_HALF_SPACING,
    BODY_GAP,
    BODY_SIZE,
    GROUND_CLEARANCE,
    PALM_THICKNESS,
    SHOULDER_INSET,
    WHEEL_INSET,
    WHEEL_RADIUS,
    WHEEL_WIDTH,
)
from palmbots.viz.style import HUE, INK, OBJECT, PALE, QUIET, RULE, ZERO

if TYPE_CHECKING:
    from palmbots._core import Spec
    from palmbots.scene.scene import Scene

WORLD = "world"
Vector = tuple[float, float, float]

_WALL = 0.004  # m, thickness of the sides of the object in URDF, which has no prisms


@dataclass(frozen=True)
class Box:
    """A box about `centre`, rotated by `turn` about y; > 0 rotates x towards z."""

    size: Vector
    centre: Vector
    turn: float = 0.0


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


@dataclass(frozen=True)
class Solid:
    """A shape with its colour, fixed in a frame."""

    frame: str
    shape: Box | Cylinder | Ball | Prism
    colour: str  # "#RRGGBB"


def solids(scene: "Scene", spec: "Spec") -> list[Solid]:
    """All visible solids of a scene."""
    floor = floor_level(spec)
    wide = max(BODY_SIZE, scene.object.depth_m)
    travel = spec.distance * spec.direction
    start, end = min(0.0, travel) - 1.0, max(0.0, travel) + 1.0
    parts = [
        Solid(
            WORLD,
            Box((end - start, 4 * wide, 0.004), ((start + end) / 2, 0.0, floor - 0.002)),
            RULE,
        ),
        *(
            Solid(WORLD, Box((0.01, 4 * wide, 0.002), (x, 0.0, floor + 0.001)), QUIET)
            for x in (0.0, travel)
        ),
    ]
    for k, side in enumerate(SIDES):
        palm = scene.palm_of(side)
        parts += _robot(side, -1.0 if k == 0 else 1.0, floor)
        plate = (palm.length_m, palm.width_m, PALM_THICKNESS)
        middle = (0.0, 0.0, palm.pivot_offset_m - PALM_THICKNESS / 2)
        parts.append(Solid(f"{side}_palm", Box(plate, middle), HUE[side]))
    outline = tuple((x, y) for x, _, y in spec.outline)
    parts.append(Solid("object", Prism(outline, scene.object.depth_m), OBJECT))
    return parts


def contact_balls() -> list[Solid]:
    """The contact points as solids, for viewers that do not read `contact_update`."""
    return [Solid(f"{side}_contact", Ball(0.006), ZERO) for side in SIDES]


def _robot(side: Side, outward: float, floor: float) -> list[Solid]:
    """Body, wheels and arm in the frame of the robot, whose origin is its pivot."""
    frame = f"{side}_robot"
    middle = outward * (BODY_GAP + BODY_SIZE / 2)
    low = floor + GROUND_CLEARANCE
    shoulder = (outward * (BODY_GAP + SHOULDER_INSET), low + BODY_SIZE - SHOULDER_INSET)
    arm = math.hypot(*shoulder)
    lean = math.atan2(shoulder[1], shoulder[0])
    arms = [
        Box((arm, 0.015, 0.015), (shoulder[0] / 2, across, shoulder[1] / 2), lean)
        for across in (-ARM_HALF_SPACING, ARM_HALF_SPACING)
    ]
    wheels = [
        Cylinder(WHEEL_RADIUS, WHEEL_WIDTH, (middle + along, across, floor + WHEEL_RADIUS))
        for along in (-0.05, 0.05)
        for across in (-BODY_SIZE / 2 - WHEEL_INSET, BODY_SIZE / 2 + WHEEL_INSET)
    ]
    body = Box((BODY_SIZE, BODY_SIZE, BODY_SIZE), (middle, 0.0, low + BODY_SIZE / 2))
    return [
        Solid(frame, body, PALE[side]),
        *(Solid(frame, wheel, INK) for wheel in wheels),
        *(Solid(frame, part, QUIET) for part in arms),
    ]


def poses(place: Placement, row: int) -> dict[str, tuple[Vector, float]]:
    """Origin and rotation about y (> 0: x towards z) of every moving frame."""
    frames: dict[str, tuple[Vector, float]] = {}

    def put(frame: str, point: "tuple[float, float]", turn: float) -> None:
        frames[frame] = ((point[0], 0.0, point[1]), turn)

    pivots = place.pivot[row].tolist()
    put("pair", ((pivots[0][0] + pivots[1][0]) / 2, 0.0), 0.0)
    for k, side in enumerate(SIDES):
        put(f"{side}_robot", pivots[k], 0.0)
        put(f"{side}_palm", pivots[k], float(place.palm_turn[row, k]))
        put(f"{side}_contact", place.contact[row, k].tolist(), float(place.palm_turn[row, k]))
    put("object", place.contact[row, 0].tolist(), float(place.turn[row]))
    return frames


def urdf(parts: list[Solid]) -> str:
    """The solids as a robot description: one link for each frame, with a floating joint to `world`.

    URDF has no prisms, so a prism is written as thin walls along its outline.
    """
    frames = list(dict.fromkeys([WORLD, *(part.frame for part in parts)]))
    lines = ['<robot name="palmbots">']
    for frame in frames:
        lines.append(f"  <link name={quoteattr(frame)}>")
        for part in parts:
            if part.frame == frame:
                lines += _visuals(part)
        lines.append("  </link>")
    for frame in frames[1:]:
        lines += [
            f'  <joint name="{frame}_place" type="floating">',
            f'    <parent link="{WORLD}"/><child link={quoteattr(frame)}/>',
            "  </joint>",
        ]
    return "\n".join([*lines, "</robot>", ""])


def _visuals(part: Solid) -> list[str]:
    red, green, blue = (int(part.colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    rgba = f"{red:.4f} {green:.4f} {blue:.4f} 1"
    name = f"colour_{part.colour[1:]}"
    material = f'<material name="{name}"><color rgba="{rgba}"/></material>'

    def visual(centre: Vector, rpy: Vector, geometry: str) -> str:
        place = f'<origin xyz="{_text(centre)}" rpy="{_text(rpy)}"/>'
        return f"    <visual>{place}<geometry>{geometry}</geometry>{material}</visual>"

    shape = part.shape
    if isinstance(shape, Cylinder):
        size = f'<cylinder radius="{shape.radius:.6g}" length="{shape.length:.6g}"/>'
        return [visual(shape.centre, (math.pi / 2, 0.0, 0.0), size)]
    if isinstance(shape, Ball):
        size = f'<sphere radius="{shape.radius:.6g}"/>'
        return [visual((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), size)]
    boxes = [shape] if isinstance(shape, Box) else _walls(shape)
    return [
        visual(box.centre, (0.0, -box.turn, 0.0), f'<box size="{_text(box.size)}"/>')
        for box in boxes
    ]


def _walls(prism: Prism) -> list[Box]:
    """A thin box inside each edge of the outline."""
    walls = []
    for (ax, az), (bx, bz) in zip(
        prism.outline, (*prism.outline[1:], prism.outline[0]), strict=True
    ):
        long = math.hypot(bx - ax, bz - az)
        inward = (-(bz - az) / long * _WALL / 2, (bx - ax) / long * _WALL / 2)
        centre = ((ax + bx) / 2 + inward[0], 0.0, (az + bz) / 2 + inward[1])
        walls.append(Box((long, prism.depth, _WALL), centre, math.atan2(bz - az, bx - ax)))
    return walls


def _text(vector: Vector) -> str:
    return " ".join(f"{value:.6g}" for value in vector)
