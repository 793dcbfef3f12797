# SPDX-License-Identifier: Apache-2.0
"""Solids as URDF, for viewers of logs that draw only robots.

One link for each frame of `palmbots.viz.solids`, with a floating joint to `world`.
"""

import math
from xml.sax.saxutils import quoteattr

from palmbots._util.xml_attributes import rgba
from palmbots.viz.solids import WORLD, Ball, Box, Cylinder, Prism, Solid, Vector

_WALL = 0.004  # m, thickness of the sides of the object: URDF has no prisms


def urdf(parts: list[Solid]) -> str:
    """The text of the robot description; a prism is written as thin walls along its outline."""
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
    name = f"colour_{part.colour[1:]}"
    material = f'<material name="{name}"><color rgba="{rgba(part.colour)}"/></material>'

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
