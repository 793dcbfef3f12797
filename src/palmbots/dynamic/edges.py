"""Where the object's contact edges lie on the palms: the ends of what overlaps.

The balls by which an edge touches stand at the ends of its overlap with the palm. An object that
slips sideways loses one of its supports unless they are moved: on a curved path at every tick, on a
straight one only once it has come `STAYS` of a palm's width off, for there it hardly ever does.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from palmbots.dynamic.model import layout
from palmbots.geometry import SIDES
from palmbots.scene import Scene

__all__ = ["STAYS", "Edge", "edges_of", "fit_edges"]

STAYS = 0.005  # of a palm's width; balls stand 0.01 of it from the palm's sides


@dataclass(frozen=True)
class Edge:
    """A contact edge of the object and the palm below it, as places in MuJoCo's model."""

    palm: int
    """Body."""
    half: float
    """Half the palm's width, less what keeps balls off its very edge [m]."""
    reach: float
    """Half the edge's length, likewise [m]."""
    balls: tuple[int, int]
    """Geoms, near and far."""


def edges_of(model: Any, scene: Scene) -> list[Edge]:
    """The two contact edges of a scene's object."""
    spec = layout(scene).spec
    found = []
    for k, side in enumerate(SIDES):
        vertex = (0, spec.contact_right)[k]
        balls = tuple(model.geom(f"vertex_{vertex}_{end}").id for end in ("near", "far"))
        half = 0.98 * float(model.geom(f"{side}_palm").size[1])
        found.append(Edge(model.body(f"{side}_palm").id, half, 0.49 * scene.object.depth_m, balls))
    return found


def fit_edges(model: Any, data: Any, edges: list[Edge]) -> None:
    """Move the balls by which edges touch to the ends of what lies on the palm."""
    thing = model.body("object").id
    origin, turn = data.xpos[thing].tolist(), data.xmat[thing].tolist()
    for edge in edges:
        place, axes = data.xpos[edge.palm].tolist(), data.xmat[edge.palm].tolist()
        along, _, up = model.geom_pos[edge.balls[0]].tolist()
        middle = [origin[i] + turn[3 * i] * along + turn[3 * i + 2] * up for i in range(3)]
        off = sum((middle[i] - place[i]) * axes[3 * i + 1] for i in range(3))
        slope = sum(turn[3 * i + 1] * axes[3 * i + 1] for i in range(3))
        for ball, y in zip(edge.balls, _overlap(off, slope, edge), strict=True):
            model.geom_pos[ball, 1] = y


def _overlap(off: float, slope: float, edge: Edge) -> Iterator[float]:
    """Both ends, along the edge, of what lies over a palm whose middle it passes at `off`."""
    ends = sorted(((-edge.half - off) / slope, (edge.half - off) / slope))
    for end in ends:
        yield max(-edge.reach, min(edge.reach, end))
