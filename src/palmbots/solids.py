"""Robots, palms and object as solids in moving frames, for viewers of three-dimensional scenes.

Frames: x forward, y to the left of the direction of travel, z up (REP-103), metres. The side view
of `geometry` is the plane y = 0, its y being z here. The fixed frame is `world`; every other frame
is a child of it and moves as `poses` says. Each solid is described once and written twice: as
`foxglove.SceneUpdate` for viewers that draw it, and as URDF for those that know only robots.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from palmbots.geometry import (
    BODY_GAP,
    BODY_SIZE,
    CLEARANCE,
    PALM_THICKNESS,
    SIDES,
    WHEEL_RADIUS,
    Placement,
    floor_level,
)
from palmbots.sections import Side
from palmbots.style import HUE, INK, OBJECT, PALE, QUIET, ZERO

if TYPE_CHECKING:
    from palmbots._core import Spec
    from palmbots.scene import Scene

__all__ = [
    "WORLD",
    "Ball",
    "Box",
    "Cylinder",
    "Prism",
    "Solid",
    "contact_balls",
    "poses",
    "solids",
    "urdf",
]

WORLD = "world"
Vector = tuple[float, float, float]

_WALL = 0.004  # m, thickness of the object's sides in URDF, which knows no prisms


@dataclass(frozen=True)
class Box:
    """A box about `centre`, turned by `turn` about y so that x goes towards z for turn > 0."""

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
    """A polygon in the (x, z) plane, counter-clockwise, stretched along y by ± depth / 2."""

    outline: tuple[tuple[float, float], ...]
    depth: float


@dataclass(frozen=True)
class Solid:
    """A shape with its colour, fixed in a frame."""

    frame: str
    shape: Box | Cylinder | Ball | Prism
    colour: str  # "#RRGGBB"


def solids(scene: "Scene", spec: "Spec") -> list[Solid]:
    """Everything there is to see of a scene."""
    floor = floor_level(spec)
    wide = max(BODY_SIZE, scene.object.depth_m)
    travel = spec.distance * spec.direction
    start, end = min(0.0, travel) - 1.0, max(0.0, travel) + 1.0
    found = [
        Solid(
            WORLD,
            Box((end - start, 4 * wide, 0.004), ((start + end) / 2, 0.0, floor - 0.002)),
            "#DDDDDD",
        ),
        *(
            Solid(WORLD, Box((0.01, 4 * wide, 0.002), (x, 0.0, floor + 0.001)), QUIET)
            for x in (0.0, travel)
        ),
    ]
    for k, side in enumerate(SIDES):
        palm = scene.palm_of(side)
        found += _robot(side, -1.0 if k == 0 else 1.0, floor)
        plate = (palm.length_m, palm.width_m, PALM_THICKNESS)
        middle = (0.0, 0.0, palm.pivot_offset_m - PALM_THICKNESS / 2)
        found.append(Solid(f"{side}_palm", Box(plate, middle), HUE[side]))
    outline = tuple((x, y) for x, _, y in spec.outline)
    found.append(Solid("object", Prism(outline, scene.object.depth_m), OBJECT))
    return found


def contact_balls() -> list[Solid]:
    """The contact points as solids, for viewers that get no `contact_update`."""
    return [Solid(f"{side}_contact", Ball(0.006), ZERO) for side in SIDES]


def _robot(side: Side, outward: float, floor: float) -> list[Solid]:
    """Body, wheels and arm in the frame of the robot, whose origin is its pivot."""
    frame = f"{side}_robot"
    middle = outward * (BODY_GAP + BODY_SIZE / 2)
    low = floor + CLEARANCE
    shoulder = (outward * (BODY_GAP + 0.03), low + BODY_SIZE - 0.03)
    arm = math.hypot(*shoulder)
    lean = math.atan2(shoulder[1], shoulder[0])
    arms = [
        Box((arm, 0.015, 0.015), (shoulder[0] / 2, across, shoulder[1] / 2), lean)
        for across in (-0.02, 0.02)
    ]
    wheels = [
        Cylinder(WHEEL_RADIUS, 0.02, (middle + along, across, floor + WHEEL_RADIUS))
        for along in (-0.05, 0.05)
        for across in (-BODY_SIZE / 2 - 0.01, BODY_SIZE / 2 + 0.01)
    ]
    body = Box((BODY_SIZE, BODY_SIZE, BODY_SIZE), (middle, 0.0, low + BODY_SIZE / 2))
    return [
        Solid(frame, body, PALE[side]),
        *(Solid(frame, wheel, INK) for wheel in wheels),
        *(Solid(frame, part, QUIET) for part in arms),
    ]


def poses(place: Placement, row: int) -> dict[str, tuple[Vector, float]]:
    """Origin in the world and turn about y (x towards z for turn > 0) of every moving frame."""
    found: dict[str, tuple[Vector, float]] = {}

    def put(frame: str, point: "tuple[float, float]", turn: float) -> None:
        found[frame] = ((point[0], 0.0, point[1]), turn)

    pivots = place.pivot[row].tolist()
    put("pair", ((pivots[0][0] + pivots[1][0]) / 2, 0.0), 0.0)
    for k, side in enumerate(SIDES):
        put(f"{side}_robot", pivots[k], 0.0)
        put(f"{side}_palm", pivots[k], float(place.palm_turn[row, k]))
        put(f"{side}_contact", place.contact[row, k].tolist(), float(place.palm_turn[row, k]))
    put("object", place.contact[row, 0].tolist(), float(place.turn[row]))
    return found


def urdf(parts: list[Solid]) -> str:
    """The solids as a robot description: one link a frame, all floating on `world`.

    A prism becomes the thin walls along its outline, since URDF has no such shape.
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
