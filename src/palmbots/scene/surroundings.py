# SPDX-License-Identifier: Apache-2.0
"""Walls and stands of a scene as blocks on the floor: what they cover, and what they look like.

Frame: x forward from the COM of the object at its start, y up from the floor [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots.errors import SceneError
from palmbots.scene.chassis import axle_out
from palmbots.scene.placement import floor_level
from palmbots.scene.robot_dimensions import BODY_GAP, BODY_SIZE, WHEEL_RADIUS
from palmbots.scene.scene import Scene

_ROOM = 0.1  # for robots that back off, beside the length of a palm [m]
_DRAWN_WALL = 0.05  # thickness of a wall in pictures [m]
_DRAWN_HEIGHT = 0.5  # of an endless wall in pictures [m]


@dataclass(frozen=True, slots=True)
class Block:
    """A solid on the floor; a wall is endless behind its face."""

    key: str
    """The key of the scene that describes it."""
    kind: str
    """wall or stand."""
    x_m: tuple[float, float]
    """From where to where it is."""
    height_m: float
    friction: float

    def part(self, behind_m: float, height_m: float) -> tuple[float, float, float]:
        """From where to where it is, and its height, at most this far behind the face of a wall and
        at most this high."""
        low, high = self.x_m
        if math.isinf(low):
            low = high - behind_m
        elif math.isinf(high):
            high = low + behind_m
        return low, high, min(self.height_m, height_m)

    @property
    def drawn(self) -> tuple[float, float, float]:
        """The part that pictures show: from where to where, and its height."""
        return self.part(_DRAWN_WALL, _DRAWN_HEIGHT)


def blocks_of(spec: _core.Spec) -> tuple[Block, ...]:
    """The walls and the stands of a spec."""
    return tuple(Block(*block) for block in _core.ground_blocks(spec)[1:])


def refuse_surroundings(scene: Scene, spec: _core.Spec) -> None:
    """Raise `SceneError` for walls and stands where there is no floor, or in the way of robots."""
    blocks = blocks_of(spec)
    if blocks and not spec.uses_floor:
        raise SceneError(
            f"{blocks[0].key}: a carry that neither begins nor ends on the floor has no "
            'surroundings; allowed: none, or task.from or task.to = "floor"'
        )
    if not blocks:
        return
    pivots, _ = _core.standing_start(spec)
    out = max(BODY_GAP + BODY_SIZE, axle_out(scene) + WHEEL_RADIUS)
    low, high = (
        x + sense * (out + palm.length + _ROOM)
        for (x, _), sense, palm in zip(pivots, (-1, 1), spec.palms, strict=True)
    )
    ahead = spec.direction * spec.distance
    low, high = min(low, low + ahead), max(high, high + ahead)
    for block in blocks:
        if block.x_m[0] < high and block.x_m[1] > low:
            if spec.direction < 0:
                low, high = -high, -low
            raise SceneError(
                f"{block.key}: the robots may drive from {low:.2f} to {high:.2f} m in this job, "
                f"and the {block.kind} is in their way; allowed: {block.kind}s outside, counted "
                "from the COM of the object at its start"
            )


def drawn_blocks(spec: _core.Spec) -> list[tuple[float, float, float, float]]:
    """Left, right, lower and upper end of walls and stands in the frame of placements [m]."""
    blocks = blocks_of(spec)
    if not blocks:
        return []
    if spec.begins_on:
        ((left, _), (right, _)), (com, _) = _core.standing_start(spec)
        x = com - (left + right) / 2
    else:
        x, *_ = _core.World(spec).pose
    floor = floor_level(spec)
    return [
        (x + low, x + high, floor, floor + tall) for low, high, tall in (b.drawn for b in blocks)
    ]
