# SPDX-License-Identifier: Apache-2.0
"""The box and the scene of a certificate as text."""

import math
from collections.abc import Callable, Iterator
from typing import Any

from palmbots._util.arguments import show
from palmbots.scene.scene import Scene
from palmbots.stability.certificates.checker.claimed_box import ClaimedBox
from palmbots.stability.certificates.checker.enclosures import Ends


def _number(value: float) -> str:
    return f"{value:.6g}"


def _interval(ends: Ends, scale: float = 1.0, unit: str = "") -> str:
    low, high = (_number(scale * float(end)) for end in ends)
    return f"{low}{unit}" if low == high else f"{low} to {high}{unit}"


def _mm(ends: Ends) -> str:
    return _interval(ends, 1e3, " mm")


def _degrees(ends: Ends) -> str:
    return _interval(ends, 1.0, "°")


def _both(pair: tuple[Ends, Ends], show: Callable[[Ends], str]) -> str:
    """One text where both sides are the same, two otherwise."""
    left, right = map(show, pair)
    return left if left == right else f"left {left}, right {right}"


def _extent(box: ClaimedBox, axis: int) -> float:
    values = [float(vertex[axis]) for vertex in box.outline.outline]
    return max(values) - min(values)


def box_facts(box: ClaimedBox) -> dict[str, str]:
    """The quantities of a box by name."""
    outline = box.outline.outline
    size = " × ".join(_number(1e3 * _extent(box, axis)) for axis in (0, 2))
    xs, ys = zip(*box.params.com, strict=True)
    friction = _both(box.friction, _interval)
    is_uncertain = any(low < high for low, high in box.friction)
    if is_uncertain:
        friction += ", common to both palms" if box.common_friction else ", each palm its own"
    slopes = [math.degrees(math.atan(float(end))) for end in box.params.slope]
    slope = " to ".join(dict.fromkeys(f"{value:.4g}°" for value in slopes))
    lengths = [(2 * low, 2 * high) for low, high in box.outline.half_length]
    palm = _both((lengths[0], lengths[1]), _mm)
    if any(end for ends in box.params.offset for end in ends):
        palm += f", pivot offset {_both(box.params.offset, _mm)}"
    contacts = _both(box.contacts, _mm)
    if box.beyond:
        contacts += f", corrections continue {_number(1e3 * float(box.beyond))} mm past p = 0"
    return {
        "object": f"{len(outline)} vertices, {size} mm",
        "contact vertices": f"{_mm(box.width)} apart",
        "COM": f"x {_mm((min(xs), max(xs)))}, y {_mm((min(ys), max(ys)))}",
        "friction": friction,
        "palm angles": f"{_both(box.shallow_deg, _degrees)} and {_both(box.steep_deg, _degrees)}",
        "palm length": palm,
        "contacts": contacts,
        "slope, uphill to +x": slope,
    }


def scene_text(scene: Scene) -> str:
    """The keys of a scene that differ from the scene ``paper``."""
    default = dict(_leaves(Scene().model_dump(), ""))
    changes = [
        f"{key} = {show(value)}"
        for key, value in _leaves(scene.model_dump(), "")
        if key not in default or default[key] != value
    ]
    return f"paper with {', '.join(changes)}" if changes else "paper"


def _leaves(table: dict[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Every value of nested tables with its dotted key."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _leaves(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", value
