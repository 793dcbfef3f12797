# SPDX-License-Identifier: Apache-2.0
"""Clearance over a whole region, against a dense scan and against the world."""

import math
from itertools import product
from typing import Any, Literal

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
import palmbots._core as _core
from clearance_cases import arch, keel, lips, touches
from palmbots._types import SIDES
from palmbots.stability.clearance import Clearance, ClosestState, outline_clearance
from palmbots.stability.problem import StabilityProblem, stability_problem

Array = NDArray[np.float64]
Region = tuple[float, float] | Literal["palm"]

CASES: list[tuple[dict[str, Any], Region, dict[str, Any]]] = [
    ({}, "palm", {}),
    ({}, "palm", {"palm.shallow_deg": 3.0}),
    (lips(0.03), (-0.02, 0.02), {}),
    (lips(0.03), "palm", {}),
    (lips(0.02), (-0.01, 0.01), {}),
    (lips(0.02), (-0.02, 0.02), {}),
    (lips(0.01), (-0.01, 0.012), {"palm.right.length_m": 0.14}),
    (lips(0.005), (-0.01, 0.01), {"palm.left.pivot_offset_m": 0.01}),
    (arch(0.02), "palm", {"palm.shallow_deg": 2.0}),
    (arch(0.03), "palm", {"palm.shallow_deg": 2.0}),
    (arch(0.03), "palm", {"palm.shallow_deg": -3.0}),
    (keel(0.01), (-0.04, 0.05), {"palm.shallow_deg": 1.0}),
    (keel(0.003), "palm", {"palm.shallow_deg": 3.0, "palm.left.length_m": 0.12}),
    (keel(0.003), (-0.03, 0.03), {"palm.shallow_deg": 0.0}),
]


def states_of(at: StabilityProblem, steps: int) -> Array:
    """A grid of (θ_L, θ_R, p_L, p_R) in every pose, with its corners."""
    (left_shallow, left_steep), (right_shallow, right_steep) = at.angles
    poses = [
        ((left_steep, left_steep), (right_steep, right_steep), at.contacts),
        ((left_shallow, left_shallow), (right_shallow, right_shallow), at.contacts),
    ]
    for number in (1, 2):
        regions = at.region(number, "left"), at.region(number, "right")
        poses.append(((left_shallow, left_steep), (right_steep, right_steep), regions[0]))
        poses.append(((left_steep, left_steep), (right_shallow, right_steep), regions[1]))
    found = []
    for left, right, contacts in poses:
        axes = [np.unique(np.linspace(*ends, steps)) for ends in (left, right)]
        # A contact at the very end of its palm has no palm beyond it.
        axes += [np.linspace(low + 1e-9, high - 1e-9, steps) for low, high in contacts]
        found.append(np.array(list(product(*axes))))
    return np.concatenate(found)


def seen(at: StabilityProblem, side: int, states: Array) -> tuple[Array, Array, Array, Array]:
    """What the oracle takes: the outline, α, and how far the palm reaches inward and outward."""
    outline = np.array([(vertex[side], vertex[2]) for vertex in at.spec.outline])
    heights = [
        states[:, 2 + i] * np.sin(states[:, i]) + at.offset[i] * np.cos(states[:, i])
        for i in (0, 1)
    ]
    tilt = np.arcsin((heights[1] - heights[0]) / at.width)
    alpha = states[:, side] + (tilt if side == 0 else -tilt)
    half, p = at.half_length[side], states[:, 2 + side]
    return outline, alpha, half + p, half - p


def state_and_side(nearest: ClosestState) -> tuple[int, Array]:
    return SIDES.index(nearest.side), np.array([[*nearest.angles_rad, *nearest.contacts_m]])


@pytest.mark.parametrize(("thing", "region", "changes"), CASES, ids=lambda v: str(v)[-40:])
def test_smallest_margins_agree_with_a_dense_scan(
    thing: dict[str, Any], region: Region, changes: dict[str, Any]
) -> None:
    at = stability_problem(pb.load_scene(thing or "paper", changes), region)
    found = outline_clearance(at)
    states = states_of(at, 11)
    hit = [touches(*seen(at, side, states)).any() for side in (0, 1)]
    assert any(hit) == found.touches
    side, state = state_and_side(found.rotation_margin)
    outline, alpha, inward, outward = seen(at, side, state)
    if found.touches:
        assert touches(outline, alpha, inward, outward).all()
        assert found.rotation_margin.margin < 0
        return
    # Nothing touches anywhere when turned by less, and there it does when turned by more.
    least = found.rotation_margin.margin
    for i, share in product((0, 1), np.linspace(-1, 1, 21)):
        view = seen(at, i, states)
        assert not touches(view[0], view[1] + share * (least - 1e-9), view[2], view[3]).any()
    more = np.array([-1, 1]) * (least + 3e-5)
    assert touches(outline, alpha + more, inward, outward).any()
    if found.length_margin is None:
        for i in (0, 1):
            view = seen(at, i, states)
            assert not touches(view[0], view[1], np.array(10.0), np.array(10.0)).any()
        return
    least = found.length_margin.margin
    assert least > 0
    for i in (0, 1):
        view = seen(at, i, states)
        assert not touches(view[0], view[1], view[2] + least - 1e-9, view[3] + least - 1e-9).any()
    side, state = state_and_side(found.length_margin)
    outline, alpha, inward, outward = seen(at, side, state)
    more = 3e-5 + least
    at_tip = touches(outline, alpha, inward + more, outward).any()
    at_back = touches(outline, alpha, inward, outward + more).any()
    assert at_tip or at_back
    assert found.length_margin.kind == ("tip" if at_tip else "back end")


def test_cases_cover_every_kind_of_touch() -> None:
    answers: list[Clearance] = [
        outline_clearance(stability_problem(pb.load_scene(thing or "paper", changes), region))
        for thing, region, changes in CASES
    ]
    assert {a.rotation_margin.kind for a in answers} == {"flush", "tip", "back end"}
    assert {a.touches for a in answers} == {False, True}
    assert {a.length_margin is None for a in answers} == {False, True}
    assert {a.length_margin.kind for a in answers if a.length_margin} == {
        "flush",
        "tip",
        "back end",
    }
    assert {a.rotation_margin.side for a in answers} == {"left", "right"}


def in_the_world(at: StabilityProblem, state: Array) -> str:
    """How a carry ends that starts in a state; empty: it does not."""
    spec = at.spec
    palms = spec.palms
    for palm, angle in zip(palms, state[:2], strict=True):
        palm.steep = float(angle)
    spec.palms, spec.start = palms, (float(state[2]), float(state[3]))
    return _core.World(spec).check()


@pytest.mark.parametrize(("thing", "region", "changes"), CASES, ids=lambda v: str(v)[-40:])
def test_touching_state_is_a_contact_in_the_world(
    thing: dict[str, Any], region: Region, changes: dict[str, Any]
) -> None:
    at = stability_problem(pb.load_scene(thing or "paper", changes), region)
    found = outline_clearance(at)
    if found.touches:
        for nearest in (found.rotation_margin, found.length_margin):
            assert nearest is not None
            assert in_the_world(at, state_and_side(nearest)[1][0]) in ("flush", "tip")
        return
    for state in states_of(at, 4):
        assert in_the_world(at, state) not in ("flush", "tip")


def test_mirrored_and_scaled_objects_have_the_same_clearance() -> None:
    scene = pb.load_scene(lips(0.015), {"palm.left.length_m": 0.14})
    one = outline_clearance(stability_problem(scene, (-0.01, 0.012)))
    other = outline_clearance(stability_problem(scene.mirrored(), (-0.01, 0.012)))
    assert one.length_margin is not None
    assert other.length_margin is not None
    assert one.length_margin.side == "right"
    assert other.length_margin.side == "left"
    assert other.rotation_margin.margin == pytest.approx(one.rotation_margin.margin, abs=2e-5)
    assert other.length_margin.margin == pytest.approx(one.length_margin.margin, abs=2e-5)


def test_analyze_reports_clearance() -> None:
    summary = pb.analyze("paper").summary()
    assert summary["clearance_deg"] == pytest.approx(0.5468, abs=1e-4)
    clearance = summary["clearance"]
    assert (clearance["touches"], clearance["length_margin"]) == (False, None)
    assert clearance["rotation_margin"]["margin"] == pytest.approx(
        math.radians(summary["clearance_deg"])
    )
