# SPDX-License-Identifier: Apache-2.0
"""Walls and stands of a scene as blocks on the floor: what they cover, and what they look like.

Frame: x forward from the COM of the object at its start, y up from the floor [m].
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.errors import SceneError
from palmbots.scene.chassis import axle_out
from palmbots.scene.placement import floor_level
from palmbots.scene.robot_dimensions import (
    BODY_GAP,
    BODY_SIZE,
    WHEEL_INSET,
    WHEEL_RADIUS,
    WHEEL_WIDTH,
)
from palmbots.scene.scene import Scene

_ROOM = 0.1  # for robots that back off, beside the length of a palm [m]
_DRAWN_WALL = 0.05  # thickness of a wall in pictures [m]
_DRAWN_HEIGHT = 0.5  # of an endless wall in pictures [m]
_WIDTH = BODY_SIZE + 2 * WHEEL_INSET + WHEEL_WIDTH  # of a robot with its wheels [m]


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
    gap_m: float = 0.0
    """Between its two halves, across the path; 0: it has no gap."""

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


def stand_below(spec: _core.Spec, ends: bool) -> Block | None:
    """The stand below the COM of the object where a job begins, or ends."""
    x = spec.direction * spec.distance if ends else 0.0
    found = (one for one in blocks_of(spec) if one.kind == "stand" and one.x_m[0] < x < one.x_m[1])
    return next(found, None)


def refuse_surroundings(scene: Scene, spec: _core.Spec) -> None:
    """Raise `SceneError` for walls and stands where there is no floor or in the way of robots, and
    for a job that begins or ends on a stand that is not there, or on the floor where one is."""
    blocks = blocks_of(spec)
    if blocks and not spec.uses_floor:
        raise SceneError(
            f"{blocks[0].key}: a carry that neither begins nor ends on the floor or on a stand has "
            'no surroundings; allowed: none, or task.from or task.to = "floor" or "stand"'
        )
    for key, on in zip(("from", "to"), scene.task.ends, strict=True):
        _refuse_stand(scene, spec, key, on)
    if not blocks:
        return
    pivots, _ = _core.standing_start(spec)
    out = max(BODY_GAP + BODY_SIZE, axle_out(scene) + WHEEL_RADIUS)
    low, high = (
        x + sense * (out + palm.length + _ROOM)
        for (x, _), sense, palm in zip(pivots, (-1, 1), spec.palms, strict=True)
    )
    if scene.task.dock == "alone":  # the other robot stands aside
        low, high = (0.0, high) if spec.direction > 0 else (low, 0.0)
    ahead = spec.direction * spec.distance
    low, high = min(low, low + ahead), max(high, high + ahead)
    for block in blocks:
        if _lets_robots_pass(scene, block):
            continue
        if block.x_m[0] < high and block.x_m[1] > low:
            if spec.direction < 0:
                low, high = -high, -low
            raise SceneError(
                f"{block.key}: the robots may drive from {low:.2f} to {high:.2f} m in this job, "
                f"and the {block.kind} is in their way; allowed: {block.kind}s outside, counted "
                "from the COM of the object at its start"
            )


def _refuse_stand(scene: Scene, spec: _core.Spec, key: str, on: str) -> None:
    where = "begins" if key == "from" else "ends"
    stand = stand_below(spec, key == "to")
    if on != "stand":
        if stand is not None and on == "floor":
            raise SceneError(
                f'task.{key}: value is "floor", but {stand.key} is below the object where the job '
                f'{where}; allowed: "stand", or a stand elsewhere'
            )
        return
    place = "0" if key == "from" else f"{spec.distance:g}"
    if stand is None:
        raise SceneError(
            f'task.{key}: "stand" needs a stand below the object where the job {where}; allowed: '
            f"an entry of floor.stands with from_m < {place} < to_m"
        )
    if not _lets_robots_pass(scene, stand):
        given = f"value is {stand.gap_m:g}" if stand.gap_m > 0 else "is not set"
        raise SceneError(
            f"{stand.key}.gap_m: {given}, and robots of {_WIDTH:g} m pass between "
            f"its halves; allowed: at least {_least_gap(scene):g}, and less than object.depth_m"
        )
    if stand.gap_m >= scene.object.depth_m:
        raise SceneError(
            f"{stand.key}.gap_m: value is {stand.gap_m:g}, and the object, "
            f"{scene.object.depth_m:g} m deep, would fall through; allowed: less than that"
        )


def _least_gap(scene: Scene) -> float:
    return max(_WIDTH, *(scene.palm_of(side).width_m for side in SIDES))


def _lets_robots_pass(scene: Scene, block: Block) -> bool:
    """Whether robots pass between its halves."""
    return block.gap_m >= _least_gap(scene)


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
