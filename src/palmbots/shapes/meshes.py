# SPDX-License-Identifier: Apache-2.0
"""A mesh (STL, OBJ, glTF): its triangles, its cut by a vertical plane, its volume.

Coordinates are turned so that x points along the direction of travel, y upwards and z across.
"""

from __future__ import annotations

import io
import itertools
import json
import logging
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palmbots._util.optional_imports import require
from palmbots.errors import PalmbotsError
from palmbots.shapes.point_arrays import Points


@dataclass(frozen=True)
class Mesh:
    """The triangles of a body."""

    vertices: Points
    """In the unit of the file; x along, y up, z across."""
    faces: Any
    """Three indices of vertices each."""
    open_edges: int
    """Edges that do not join two triangles with the same side outwards; 0: the mesh is closed."""
    aligned: float = 0.0
    """By which angle the body was turned so that its sides are parallel to the axes [rad]."""

    @property
    def triangles(self) -> Points:
        """Three points each."""
        return self.vertices[self.faces]

    @property
    def depth(self) -> float:
        """Extent across."""
        return float(np.ptp(self.vertices[:, 2]))

    def volume_and_centre(self) -> tuple[float, Points]:
        """Volume and centre of volume of a closed mesh: sums over tetrahedra from one point."""
        reference = self.vertices.mean(axis=0)
        a, b, c = np.moveaxis(self.triangles - reference, 1, 0)
        volumes = (a * np.cross(b, c)).sum(axis=1) / 6
        volume = float(volumes.sum())
        if volume == 0:
            raise PalmbotsError("the mesh encloses no volume")
        return abs(volume), reference + volumes @ (a + b + c) / (4 * volume)

    def overlapping(self) -> int:
        """Number of closed bodies whose boxes overlap, so that their volume may count twice. A
        cavity, whose triangles face inwards, is none."""
        labels = np.arange(len(self.vertices))
        while True:  # the least vertex that is connected with each one
            least = labels.copy()
            np.minimum.at(least, self.faces, labels[self.faces].min(axis=1, keepdims=True))
            least = least[least]
            if (least == labels).all():
                break
            labels = least
        a, b, c = np.moveaxis(self.triangles - self.vertices.mean(axis=0), 1, 0)
        volumes = (a * np.cross(b, c)).sum(axis=1)
        bodies = [labels[self.faces[:, 0]] == label for label in np.unique(labels[self.faces])]
        solid = [of for of in bodies if volumes[of].sum() * volumes.sum() > 0]
        boxes = [(self.triangles[of].min((0, 1)), self.triangles[of].max((0, 1))) for of in solid]
        return sum(
            any(
                (low < high_).all() and (low_ < high).all()
                for low_, high_ in boxes[:k] + boxes[k + 1 :]
            )
            for k, (low, high) in enumerate(boxes)
        )

    def cut(self, share: float) -> list[Points]:
        """The lines in which a plane at this share of the depth cuts the triangles.

        Lines of neighbouring triangles end at the same point, to the last bit.
        """
        # A plane through vertices would cut their triangles in points, so it is off by a little.
        low, depth = self.vertices[:, 2].min(), self.depth
        above = self.vertices[:, 2] - (low + (share + 1.7e-7) * depth)
        sides = above[self.faces] > 0
        found: list[Points] = []
        for face in self.faces[sides.any(axis=1) & ~sides.all(axis=1)]:
            ends = []
            for i, j in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
                if (above[i] > 0) != (above[j] > 0):
                    i, j = min(i, j), max(i, j)
                    part = above[i] / (above[i] - above[j])
                    ends.append(self.vertices[i] + part * (self.vertices[j] - self.vertices[i]))
            found.append(np.array(ends)[:, :2])
        return found


def read_mesh(path: Path, data: bytes, up: str, across: str, align: bool = False) -> Mesh:
    """The mesh of a file. Vertices at the same place are one.

    Args:
        path: of the file; glTF may refer to files beside it.
        data: its content.
        up: the axis of the file that points upwards, such as ``z`` or ``-y``.
        across: its axis across the direction of travel: x, y or z.
        align: whether the sides of the smallest box around the body become parallel to the axes
            of the file.
    """
    trimesh = require("trimesh", "import")
    if path.suffix.lower() == ".gltf":
        json.loads(data)  # trimesh would report something else
    binary_size = 84 + 50 * int.from_bytes(data[80:84], "little")
    if path.suffix.lower() == ".stl" and len(data) != binary_size:
        data.decode()  # trimesh would guess the encoding
    logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # of textures, which do not matter
    scene = trimesh.load_scene(
        io.BytesIO(data),
        file_type=path.suffix[1:].lower(),
        resolver=trimesh.resolvers.FilePathResolver(str(path.absolute())),
        process=False,
    )
    parts = [one for one in scene.dump() if hasattr(one, "faces") and len(one.faces)]
    if not parts:
        raise PalmbotsError("there are no triangles in it")
    found = trimesh.util.concatenate(parts)
    vertices, faces = np.asarray(found.vertices, float), np.asarray(found.faces)
    if not np.isfinite(vertices).all():
        raise PalmbotsError("a coordinate is not finite")
    vertices, same = np.unique(vertices, axis=0, return_inverse=True)
    faces = same.reshape(-1)[faces]
    is_flat = (faces == np.roll(faces, 1, axis=1)).any(axis=1)  # two of its corners are one
    faces = faces[~is_flat]
    ends = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, edge, counts = np.unique(
        np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    ways = np.bincount(edge.reshape(-1), np.where(ends[:, 0] < ends[:, 1], 1, -1))
    turn = 0.0
    if align:
        vertices, turn = _aligned(vertices)
    opened = int(((counts != 2) | (ways != 0)).sum())
    return Mesh(_turned(vertices, up, across), faces, opened, turn)


def _aligned(vertices: Points) -> tuple[Points, float]:
    """The body, turned as little as makes the sides of the smallest box around it parallel to the
    axes; and the angle [rad]."""
    bounds = require("trimesh", "import").bounds
    axes = bounds.oriented_bounds(vertices)[0][:3, :3]
    turns = [
        np.array([sign * axes[k] for sign, k in zip(signs, order, strict=True)])
        for order in itertools.permutations(range(3))
        for signs in itertools.product((1.0, -1.0), repeat=3)
    ]
    turn = max((one for one in turns if np.linalg.det(one) > 0), key=np.trace)
    return vertices @ turn.T, math.acos(min(1.0, (np.trace(turn) - 1) / 2))


def _turned(vertices: Points, up: str, across: str) -> Points:
    sign = -1.0 if up.startswith("-") else 1.0
    above, over = "xyz".index(up[-1]), "xyz".index(across)
    along = 3 - above - over
    return vertices[:, [along, above, over]] * (sign, sign, 1.0)
