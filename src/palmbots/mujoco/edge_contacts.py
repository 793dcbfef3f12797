# SPDX-License-Identifier: Apache-2.0
"""The overlap of the contact edges of the object with the palms.

An edge touches its palm with two balls, at the ends of the overlap. An object that slips laterally
would lose one of these supports, so the balls are moved: on a curved path at every tick, on a
straight one only after a shift of more than `STAYS` of the palm's width, which is rare there.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from palmbots._types import SIDES
from palmbots.mujoco.mjcf import layout
from palmbots.scene.scene import Scene

STAYS = 0.005  # of a palm's width; balls stand 0.01 of it from the palm's sides


@dataclass(frozen=True)
class Edge:
    """A contact edge of the object and the palm below it, as indices of MuJoCo's model."""

    palm: int
    """Body."""
    half: float
    """Half the width of the palm, minus the margin of the balls [m]."""
    reach: float
    """Half the length of the edge, with the same margin [m]."""
    balls: tuple[int, int]
    """The geoms, near and far."""


def edges_of(model: Any, scene: Scene) -> list[Edge]:
    """The two contact edges of the object of a scene."""
    edges = []
    for side, vertex in zip(SIDES, layout(scene).contact_vertices, strict=True):
        balls = tuple(model.geom(f"vertex_{vertex}_{end}").id for end in ("near", "far"))
        half = 0.98 * (scene.palm_of(side).width_m / 2)
        edges.append(Edge(model.body(f"{side}_palm").id, half, 0.49 * scene.object.depth_m, balls))
    return edges


def fit_edges(model: Any, data: Any, edges: list[Edge]) -> None:
    """Move the balls of the edges to the ends of the overlap with the palms."""
    body = model.body("object").id
    origin, turn = data.xpos[body].tolist(), data.xmat[body].tolist()
    for edge in edges:
        place, axes = data.xpos[edge.palm].tolist(), data.xmat[edge.palm].tolist()
        along, _, up = model.geom_pos[edge.balls[0]].tolist()
        middle = [origin[i] + turn[3 * i] * along + turn[3 * i + 2] * up for i in range(3)]
        off = sum((middle[i] - place[i]) * axes[3 * i + 1] for i in range(3))
        slope = sum(turn[3 * i + 1] * axes[3 * i + 1] for i in range(3))
        for ball, y in zip(edge.balls, _overlap(off, slope, edge), strict=True):
            model.geom_pos[ball, 1] = y


def _overlap(off: float, slope: float, edge: Edge) -> Iterator[float]:
    """Both ends of the overlap along the edge, which passes the middle of the palm at `off`."""
    ends = sorted(((-edge.half - off) / slope, (edge.half - off) / slope))
    for end in ends:
        yield max(-edge.reach, min(edge.reach, end))
