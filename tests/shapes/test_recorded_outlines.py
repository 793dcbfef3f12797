# SPDX-License-Identifier: Apache-2.0
"""Outlines that others published: pushing experiments, and the literature on nesting.

Each one, in four orientations, is imported and carried, or refused in one clear line. Nothing
enters anything. The files are read where they lie; neither they nor figures of them belong to the
project.
"""

import json
import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.scene.placement import floor_level
from palmbots.scene.spec import to_spec
from palmbots.simulation.result import Carry
from sampled import amounts

pytest.importorskip("shapely", reason="needs the extra `import`")
pytest.importorskip("trimesh", reason="needs the extra `import`")

from shapely import affinity
from shapely.geometry import Polygon

DATA = Path(__file__).parents[3] / "shared" / "data" / "shapes"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="needs ../shared/data/shapes")

WIDE = 0.25  # between the contacts of what is too narrow for the palms [m]
WIDEST = 0.8  # [m]
SUNK = 5e-6  # [m]
LOOKS = 60  # at a carry

Outline = list[tuple[float, float]]


def nested() -> Iterator[tuple[str, Outline]]:
    """Every polygon of the nesting files, in four orientations."""
    for file in sorted((DATA / "nesting").glob("*.json")):
        for item in json.loads(file.read_text())["items"]:
            points = [(float(x), float(y)) for x, y in item["shape"]["data"][:-1]]
            for turn in range(4):
                yield f"{file.stem} {item['id']}, turned {90 * turn} degrees", points
                points = [(-y, x) for x, y in points]


def svg(points: Outline, width_m: float) -> str:
    """A drawing of a polygon, in millimetres."""
    left, right = (f(x for x, _ in points) for f in (min, max))
    top = max(y for _, y in points)
    scale = 1000 * width_m / (right - left)
    text = " ".join(f"{(x - left) * scale:.5f},{(top - y) * scale:.5f}" for x, y in points)
    return (
        '<svg xmlns="http://www.w3.org/2000/svg" width="1000mm" height="1000mm" '
        f'viewBox="0 0 1000 1000"><polygon points="{text}"/></svg>'
    )


def is_clear(error: PalmbotsError | str) -> bool:
    """Whether it is one line, and says what is allowed or why."""
    text = str(error)
    return "\n" not in text and 20 < len(text) < 400 and "Traceback" not in text


def imported(points: Outline, file: Path) -> dict[str, Any]:
    """The section `object`, scaled so that both palms have room under it."""
    width = WIDE
    for _ in range(2):
        file.write_text(svg(points, width))
        found = pb.import_object(file)
        left, right = (found.vertices_m[k][0] for k in found.contacts)
        if found.palm_length_m is None and "palms would collide" not in found.carried:
            break
        width *= WIDE / (right - left)
        if width > WIDEST:
            raise PalmbotsError("the contacts are too near to each other for both palms")
    assert found.deviation_m <= found.tolerance_m
    keys = ("vertices_m", "edge_radius_m", "contacts", "com_m")
    return {name: getattr(found, name) for name in keys} | {"mass_kg": min(found.mass_kg, 0.5)}


def sinks_in(carry: Carry, by: float = SUNK) -> bool:
    """Whether a palm is ever in the object by this depth [m]: the palm's plate meets the outline
    without a strip of this width."""
    spec, trace = to_spec(carry.scene), carry.trace
    assert trace is not None
    body = Polygon([(x - spec.com_left, y - spec.com_height) for x, y in spec.silhouette])
    assert body.is_valid
    inner = body.buffer(-by)
    carried = -floor_level(spec)
    ticks = trace.sizes["time"]
    for k in range(0, ticks, max(1, ticks // LOOKS)):
        place = float(trace.object_x[k]), float(trace.object_height[k])
        turned = affinity.rotate(inner, float(trace.object[k]), origin=(0, 0), use_radians=True)
        there = affinity.translate(turned, *place)
        for side, palm in enumerate(spec.palms):
            out = (-1, 1)[side]
            x = float(trace.midpoint[k]) + out * 0.5 * float(trace.separation[k])
            y = float(trace.pivot_height[k][side]) if "pivot_height" in trace else carried
            sine, cosine = (f(float(trace.palm[k][side])) for f in (math.sin, math.cos))
            half, top = 0.5 * palm.length, palm.offset
            low = top - max(palm.nose, 2e-4)
            plate = Polygon(
                (x + out * (u * cosine - v * sine), y + u * sine + v * cosine)
                for u, v in ((-half, low), (half, low), (half, top), (-half, top))
            )
            if plate.intersects(there):
                return True
    return False


@needs_data
@pytest.mark.parametrize("every", amounts(23, 1))
def test_each_outline_is_carried_or_refused_in_one_line(every: int, tmp_path: Path) -> None:
    ends: Counter[str] = Counter()
    for n, (name, points) in enumerate(nested()):
        if n % every:
            continue
        try:
            table = imported(points, tmp_path / "outline.svg")
        except PalmbotsError as error:
            assert is_clear(error), name
            ends["not imported"] += 1
            continue
        for scene, keys in (("paper", {}), ("lift", {"edge_radius_m": 0.003})):
            overrides = {"object": table | keys, "task.timeout_s": 60.0}
            try:
                carry = pb.carry(scene, "shared-sign", seed=n, overrides=overrides)
            except PalmbotsError as error:
                assert is_clear(error), name
                ends[f"{scene}: refused"] += 1
                continue
            job = carry.floor_job
            assert carry.outcome == "delivered" or carry.reason or (job and job.failure), name
            assert not sinks_in(carry), (name, scene)
            ends[f"{scene}: {carry.outcome}"] += 1
        str(pb.analyze("paper", overrides={"object": table}))
        str(pb.contact_modes("paper", overrides={"object": table}))
    tried = sum(ends.values())
    assert ends["paper: delivered"] > 0.2 * tried and ends["not imported"] > 0, ends


@needs_data
def test_each_pushed_shape_is_imported_or_stands_on_one_point() -> None:
    stands = 0
    for file in sorted((DATA / "push").glob("*.obj")):
        try:
            found = pb.import_object(file, unit="m")
        except PalmbotsError as error:
            assert is_clear(error) and "stands on one point" in str(error)
            continue
        stands += 1
        assert is_clear(found.carried) or found.carried == "delivered"
        with pytest.raises(PalmbotsError, match="unit"):
            pb.import_object(file)
    assert stands > 1


def test_a_palm_in_the_object_is_noticed() -> None:
    """On palms the box is touched: a strip outside of it is met, and one inside is not."""
    carry = pb.carry("paper", "shared-sign", seed=1)
    assert sinks_in(carry, by=-SUNK) and not sinks_in(carry)
