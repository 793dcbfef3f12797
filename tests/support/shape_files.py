# SPDX-License-Identifier: Apache-2.0
"""Small drawings and meshes for tests, as the text of their files."""

import base64
import json
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path

Point = tuple[float, ...]
Mesh = tuple[list[Point], list[tuple[int, int, int]]]


def prism(outline: Sequence[Point], depth: float) -> Mesh:
    """A convex outline, counter-clockwise in (x, z), extruded along y."""
    n = len(outline)
    vertices: list[Point] = [(x, y, z) for y in (0.0, depth) for x, z in outline]
    front = [(0, k, k + 1) for k in range(1, n - 1)]
    back = [(n, n + k + 1, n + k) for k in range(1, n - 1)]
    sides = [(i, n + i, j) for i in range(n) for j in [(i + 1) % n]]
    sides += [(j, n + i, n + j) for i in range(n) for j in [(i + 1) % n]]
    return vertices, [*front, *back, *sides]


def stl(mesh: Mesh) -> str:
    vertices, faces = mesh
    lines = ["solid made"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop"]
        lines += ["vertex " + " ".join(map(str, vertices[k])) for k in face]
        lines += ["endloop", "endfacet"]
    return "\n".join([*lines, "endsolid made", ""])


def obj(mesh: Mesh) -> str:
    vertices, faces = mesh
    lines = ["v " + " ".join(map(str, vertex)) for vertex in vertices]
    lines += ["f " + " ".join(str(k + 1) for k in face) for face in faces]
    return "\n".join([*lines, ""])


def gltf(mesh: Mesh) -> str:
    """One buffer within the file: indices, then positions."""
    vertices, faces = mesh
    indices = struct.pack(f"<{3 * len(faces)}H", *(k for face in faces for k in face))
    indices += b"\0" * (-len(indices) % 4)
    places = struct.pack(f"<{3 * len(vertices)}f", *(x for vertex in vertices for x in vertex))
    low, high = ([f(v[k] for v in vertices) for k in range(3)] for f in (min, max))
    uri = base64.b64encode(indices + places).decode()
    views = [
        {"buffer": 0, "byteOffset": 0, "byteLength": 6 * len(faces)},
        {"buffer": 0, "byteOffset": len(indices), "byteLength": len(places)},
    ]
    accessors = [
        {"bufferView": 0, "componentType": 5123, "count": 3 * len(faces), "type": "SCALAR"},
        {"bufferView": 1, "componentType": 5126, "count": len(vertices), "type": "VEC3",
         "min": low, "max": high},
    ]  # fmt: skip
    table = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1}, "indices": 0}]}],
        "buffers": [
            {
                "uri": f"data:application/octet-stream;base64,{uri}",
                "byteLength": len(indices + places),
            }
        ],
        "bufferViews": views,
        "accessors": accessors,
    }
    return json.dumps(table)


def svg(shapes: str, size: str = 'width="250mm" height="160mm" viewBox="0 0 250 160"') -> str:
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{shapes}</svg>'


def dxf(entities: Iterable[Sequence[object]], unit: int = 4) -> str:
    """Entities as (type, group code, value, …)."""
    head = [0, "SECTION", 2, "HEADER", 9, "$ACADVER", 1, "AC1015", 9, "$INSUNITS", 70, unit]
    tags: list[object] = [*head, 0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"]
    for kind, *groups in entities:
        tags += [0, kind, 8, "0", *groups]
    return "\n".join(map(str, [*tags, 0, "ENDSEC", 0, "EOF", ""]))


def line(x: float, y: float, u: float, v: float) -> tuple[object, ...]:
    return "LINE", 10, x, 20, y, 11, u, 21, v


def written(path: Path, text: str) -> Path:
    path.write_text(text, "utf-8")
    return path
