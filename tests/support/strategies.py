# SPDX-License-Identifier: Apache-2.0
"""Hypothesis strategies: valid scenes of every kind, for any test that wants one."""

from collections.abc import Sequence
from typing import Any

from hypothesis import assume
from hypothesis import strategies as st

import palmbots._core as _core
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec

Point = tuple[float, float]


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high, allow_nan=False, allow_infinity=False, allow_subnormal=False)


@st.composite
def _standing(draw: st.DrawFn) -> tuple[list[Point], int]:
    """An outline on the line y = 0: counter-clockwise from its left contact (0, 0), and the index
    of its right contact (w, 0). Convex and not, with and without feet, with and without a keel."""
    w = draw(numbers(0.08, 0.6))
    h = draw(numbers(0.05, 0.5))
    a, b = (draw(numbers(-0.3, 0.3)) * w for _ in range(2))  # overhang of the upper corners
    t = draw(numbers(0.1, 0.4))
    foot, sole = t * w, t * min(w, h)
    kind = draw(
        st.sampled_from(["box", "trapezoid", "feet", "points", "keel", "tray", "L", "dome"])
    )
    match kind:
        case "box":
            return [(0, 0), (w, 0), (w, h), (0, h)], 1
        case "trapezoid":
            return [(0, 0), (w, 0), (w + a, h), (-b, h)], 1
        case "feet":
            inner = [(foot, 0), (foot, sole), (w - foot, sole), (w - foot, 0)]
            return [(0, 0), *inner, (w, 0), (w, h), (0, h)], 5
        case "points":
            return [(0, 0), (foot, sole), (w - foot, sole), (w, 0), (w + a, h), (-b, h)], 3
        case "keel":
            return [(0, 0), (w / 2, -sole), (w, 0), (w + a, h), (-b, h)], 2
        case "tray":
            cavity = [(w - foot, h), (w - foot, sole), (foot, sole), (foot, h)]
            return [(0, 0), (w, 0), (w, h), *cavity, (0, h)], 1
        case "L":
            return [(0, 0), (w, 0), (w, sole), (foot, sole), (foot, h), (0, h)], 1
    # A dome: points on rays from the middle of the base, in order of their angle.
    corners = draw(st.integers(1, 12))
    dome = [(w, 0.0)]
    for k in range(corners):
        x = 1 - 2 * (k + 1) / (corners + 1)
        reach = draw(numbers(0.4, 1.2))
        dome.append((w / 2 + w * x * reach, 2 * h * (1 - x * x) * reach))
    return [(0.0, 0.0), *dome], 1


def _above(outline: Sequence[Point], x: float) -> list[tuple[float, float]]:
    """The stretches of the vertical line at x that lie in the outline above y = 0."""
    heights = []
    for k, (ax, ay) in enumerate(outline):
        bx, by = outline[(k + 1) % len(outline)]
        if (ax > x) != (bx > x):
            heights.append(ay + (x - ax) / (bx - ax) * (by - ay))
    heights.sort()
    pairs = zip(heights[::2], heights[1::2], strict=True)
    return [(max(low, 0.0), high) for low, high in pairs if high > 1e-3]


@st.composite
def objects(draw: st.DrawFn) -> dict[str, Any]:
    """A valid [object], its outline anywhere, turned, either way round, from any vertex on."""
    outline, right = draw(_standing())
    w = outline[right][0]
    x = w * draw(numbers(0.05, 0.95))
    assume(all(abs(x - corner) > 1e-6 for corner, _ in outline))  # not on an upright edge
    low, high = draw(st.sampled_from(_above(outline, x)))
    share = draw(numbers(0.05, 0.95))
    com = (x, low + share * (high - low))

    t = draw(st.sampled_from([0.0, 0.0, 1.0]) | numbers(-2, 2))
    cos, sin = (1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)
    shift = draw(st.just((0.0, 0.0)) | st.tuples(numbers(-1, 1), numbers(-1, 1)))

    def placed(p: Point) -> list[float]:
        return [p[0] * cos - p[1] * sin + shift[0], p[0] * sin + p[1] * cos + shift[1]]

    order = list(range(len(outline)))
    if draw(st.booleans()):
        order.reverse()
    first = draw(st.integers(0, len(order) - 1))
    order = order[first:] + order[:first]
    return {
        "vertices_m": [placed(outline[k]) for k in order],
        "contacts": [order.index(0), order.index(right)],
        "com_m": placed(com),
        "mass_kg": draw(numbers(0.02, 0.1)),  # light enough for the robots wherever it starts
        "depth_m": draw(numbers(0.02, 0.3)),
    }


@st.composite
def _palm(draw: st.DrawFn, width: float) -> dict[str, float]:
    shallow = draw(numbers(-10, 20))
    return {
        "length_m": draw(numbers(0.05, 0.3)),
        "width_m": draw(numbers(0.03, 0.1)),
        "pivot_offset_m": draw(st.just(0.0) | numbers(-0.1, 0.1)) * width,
        "friction": draw(st.just(0.3) | numbers(0.02, 1.0)),
        "shallow_deg": shallow,
        "steep_deg": shallow + draw(numbers(0.5, 20)),
        "rate_deg_s": draw(numbers(5, 500)),
    }


@st.composite
def _robot(draw: st.DrawFn) -> dict[str, float]:
    speed = draw(numbers(0.01, 0.15))
    return {
        "speed_m_s": speed,
        "correction_m_s": draw(numbers(0, 0.06)),
        "acceleration_m_s2": draw(numbers(0.05, 5)),
        "max_speed_m_s": speed + draw(numbers(0, 0.1)),
        "noise_m_s": draw(st.just(0.0) | numbers(0, 0.04)),
        "noise_tau_s": draw(numbers(0.05, 5)),
        "gain": draw(st.just(1.0) | numbers(0.9, 1.1)),
        "gain_sd": draw(st.just(0.0) | numbers(0, 0.1)),
        "white_noise_m_per_sqrt_s": draw(st.just(0.0) | numbers(0, 0.02)),
        "standing_noise_m_s": draw(st.just(0.0) | numbers(0, 0.04)),
        "bias_m_s": draw(st.just(0.0) | numbers(-0.01, 0.01)),
    }


_sides = st.sampled_from(["left", "right"])


@st.composite
def _tactile(draw: st.DrawFn) -> dict[str, Any]:
    tactile: dict[str, Any] = {
        "zero_half_width_m": draw(st.just(0.005) | numbers(0, 0.03)),
        "false_rate": draw(st.just(0.0) | numbers(0, 0.2)),
    }
    if draw(st.booleans()):  # switches from the inner end outward, and one or none for zero
        a, b, c, d = sorted(draw(st.lists(numbers(-0.2, 0.2), min_size=4, max_size=4, unique=True)))
        zones = [
            {"sign": "-", "from_m": a, "to_m": b},
            {"sign": "+", "from_m": c, "to_m": d},
            {"sign": "0", "from_m": a / 2 + b / 2, "to_m": d},
        ]
        tactile["zones"] = draw(st.permutations(zones))[: draw(st.integers(0, 3))]
    return tactile


@st.composite
def _bump(draw: st.DrawFn) -> dict[str, Any]:
    when = draw(st.sampled_from(["at_m", "at_s"]))
    at = draw(numbers(0, 1))
    return {"robot": draw(_sides), when: at, "shift_m": draw(numbers(-0.03, 0.03))}


@st.composite
def scene_tables(draw: st.DrawFn) -> dict[str, Any]:
    """A valid scene as the table that a scene file holds, most of its keys given."""
    thing = draw(objects())
    (lx, ly), (rx, ry) = (thing["vertices_m"][k] for k in thing["contacts"])
    width = ((rx - lx) ** 2 + (ry - ly) ** 2) ** 0.5
    palm: dict[str, Any] = draw(_palm(width))
    robot: dict[str, Any] = draw(_robot())
    lengths = {}
    for side in ("left", "right"):
        override = draw(st.just({}) | _palm(width))
        lengths[side] = override.get("length_m", palm["length_m"])
        if override:
            palm[side] = override
        if draw(st.booleans()):
            robot[side] = draw(_robot())
    period = draw(st.just(0.01) | numbers(0.005, 0.04))
    start = {
        f"{side}_m": draw(st.just(0.0) | numbers(-1, 1)) * min(length / 2, 0.3 * width)
        for side, length in lengths.items()
    }
    task: dict[str, Any] = {
        "distance_m": draw(numbers(0.02, 0.5)),
        "slope_deg": draw(st.just(0.0) | numbers(-5, 5)),
        "direction": draw(st.sampled_from(["forward", "backward"])),
        "inertia": draw(st.booleans()),
        "inertia_tau_s": draw(st.just(0.05) | st.just(0.0) | numbers(0.001, 1)),
    }
    if draw(st.booleans()):
        task["timeout_s"] = draw(numbers(0.5, 30))
    return {
        "object": thing,
        "palm": palm,
        "robot": robot,
        "tactile": draw(_tactile()),
        "control": {"period_s": period},
        "radio": {
            "latency_s": draw(numbers(0, 30)) * period,
            "jitter_s": draw(st.just(0.0) | numbers(0, 30)) * period,
            "loss": draw(st.just(0.0) | numbers(0, 1)),
        },
        "bumps": {
            "script": draw(st.lists(_bump(), max_size=5)),
            "rate_per_m": draw(st.just(0.0) | numbers(0, 20)),
            "max_shift_m": draw(numbers(0, 0.02)),
        },
        "start": start,
        "task": task,
    }


def scenes() -> st.SearchStrategy[Scene]:
    """Valid scenes: all kinds of objects, palms, errors, sensors, radios, bumps and starts.

    No palms collide under the object.
    """
    found = scene_tables().map(Scene.model_validate)
    return found.filter(lambda scene: not _core.palm_refusal(to_spec(scene, unrolled=True)))
