# SPDX-License-Identifier: Apache-2.0
"""The next probe: palm angles, and whether the robots close or open (`next_probe`).

It is the one that leaves the smallest set in the worse of its two outcomes. The object must be held
(property 0) for every object of the set at all angles on the way and at all contacts of the stroke,
and its outline must clear the palms. A contact whose next edge lies beyond the permitted part of
the palm gives no observation. While one is off outward and the other one inward, the angles that
bring one of them back have precedence.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from palmbots._types import Interval
from palmbots.probing.contact_tracking import ContactBounds, Pair
from palmbots.probing.object_set import ObjectSet, sample
from palmbots.probing.slip_comparison import DOWN, UP, Floats, Pose
from palmbots.scene.robot_section import Zone

_COARSE, _FINE = math.radians(5), math.radians(1.25)
_STRIDE = math.radians(4)
_SAMPLE = 120
_TRIED = 600
_HIDDEN = 0.4
"""How much more of the set a probe has to remove that may drive a contact away from the middle."""
_AT_REACH = 0.5
"""How much more a probe has to remove in which a contact rests that may not slide any farther."""
_LEAVES = 0.02
"""How much more a probe has to remove that drives a contact out of the middle, for each probe in a
row that has removed nothing."""
_APART, _KNOWN_M = 2.0, 0.003
"""How much more a probe has to remove after which the contacts may be off to opposite sides, while
one of them is known less exactly than this [m] in a world that is not quasistatic: either way, the
next one could then drive a contact too far."""
_EARLY = 0.3
"""How much more a probe has to remove that may end before it shows which contact slides, in a world
that is not quasistatic."""
SPARE_M = 0.0015
"""How far before the end of its permitted part a contact is stopped."""
_ALIKE = math.radians(2.5)
"""Probes whose palm angles differ by less show the same."""
_IDLE = 0.5
"""How much more of the set a probe has to remove that is like one which has removed nothing."""


@dataclass(frozen=True)
class Probe:
    """One probe."""

    angles: Pair
    """[rad]."""
    way: int
    remains: float
    """Of the set, in the worse outcome, as a fraction."""


@dataclass(frozen=True)
class Limits:
    """What probes may do."""

    angles: Interval
    """Of the palms [rad]."""
    reach: float
    """How far from p = 0 a contact may be [m]."""
    outline: tuple[tuple[float, float, float], ...]
    """Points of the object: from the left contact, from the right one, height [m]."""
    drift: float = 0.003
    """How far contacts may slide while the palms turn [m]."""


def next_probe(
    found: ObjectSet,
    bounds: ContactBounds,
    signs: tuple[int, int],
    limits: Limits,
    idle: Sequence[Probe] = (),
) -> Probe | None:
    """The best probe; None: none is safe.

    Args:
        found: the objects.
        bounds: where the contacts are.
        signs: what the sensors read.
        limits: what probes may do.
        idle: probes that have not cut this set; those alike come last.
    """
    steps = _grid(limits.angles, _COARSE)
    ranked = _ranked(found, bounds, signs, [(a, b) for a in steps for b in steps], limits, idle)
    best = _first_safe(found, bounds, ranked, limits)
    if best is None:
        return None
    near = [
        tuple(
            float(np.clip(angle + k * _FINE, *limits.angles))
            for angle, k in zip(best.angles, ks, strict=True)
        )
        for ks in np.ndindex(7, 7)
        for ks in [tuple(k - 3 for k in ks)]
    ]
    finer = _ranked(found, bounds, signs, [(a, b) for a, b in near], limits, idle)
    return _first_safe(found, bounds, finer, limits) or best


def _grid(ends: Interval, step: float) -> list[float]:
    return [float(x) for x in np.linspace(*ends, max(2, round((ends[1] - ends[0]) / step) + 1))]


def _ranked(
    found: ObjectSet,
    bounds: ContactBounds,
    signs: tuple[int, int],
    pairs: list[Pair],
    limits: Limits,
    idle: Sequence[Probe],
) -> list[Probe]:
    boxes = sample(found.boxes, _SAMPLE)
    middle = np.repeat(boxes.mean(axis=-1, keepdims=True), 2, axis=-1)
    angles = np.array(pairs)
    error, give = bounds.geometry.angle_error, bounds.geometry.give
    rises = [_pose_at(bounds, pair).tangent for pair in pairs]
    tangent = np.array([r[0] for r in rises]), np.array([r[1] for r in rises])

    def column(values: np.ndarray) -> np.ndarray:
        return values[:, np.newaxis]

    pose = Pose(
        tuple((column(angles[:, i]) - error, column(angles[:, i]) + error) for i in (0, 1)),  # ty: ignore[invalid-argument-type]  # two of them
        (column(tangent[0]), column(tangent[1])),
    )
    probes = []
    for way in (UP, DOWN):
        left, right = found.may_slide(middle[np.newaxis], pose, way)
        share = np.stack([left.mean(axis=1), right.mean(axis=1)])
        rest = np.stack([_remains(left, boxes), _remains(right, boxes)])
        shows = [sign * way <= 0 for sign in signs]
        if all(shows):
            score = rest.max(axis=0)
            if give.loop and _widest(bounds) > _KNOWN_M:
                off = [sign * way < 0 for sign in signs]
                score = score + _APART * sum(
                    s for s, o in zip(share, reversed(off), strict=True) if o
                )
        elif any(shows):
            # The other contact shows nothing, and leaves the middle.
            leaves = share[1 if shows[0] else 0]
            is_apart = -1 in signs and 1 in signs
            score = 1 + leaves if is_apart else rest.max(axis=0) + _HIDDEN
            if give.loop and _ends_early(bounds, shows.index(True), way, limits):
                score = np.maximum(score, 1.0) + _EARLY
            if is_at_reach(bounds, way, limits):
                score = np.where(leaves > 0, np.inf, score + _AT_REACH)
        else:
            continue
        outward = [one for sign, one in zip(signs, share, strict=True) if sign * way >= 0]
        score = score + _LEAVES * len(idle) * sum(outward)
        for one in idle:
            if one.way == way:
                score = score + _IDLE * (np.abs(angles - one.angles).max(axis=1) < _ALIKE)
        probes += [Probe(pair, way, float(s)) for pair, s in zip(pairs, score, strict=True)]
    probes = [one for one in probes if one.remains < math.inf]
    return sorted(probes, key=lambda one: (round(one.remains, 3), _turn(bounds, one)))


def _ends_early(bounds: ContactBounds, seen: int, way: int, limits: Limits) -> bool:
    """Whether one contact may be as far as allowed before the other one is sure to have passed its
    edge: the stroke may then show nothing."""
    ends, zones = bounds.contacts, bounds.geometry.zones
    low, high = _stroke(ends[seen], zones[seen], way, limits.reach, 0.0)
    farthest = max(way * end for end in ends[1 - seen])
    return high - low > limits.reach - SPARE_M - farthest


def _widest(bounds: ContactBounds) -> float:
    return max(high - low for low, high in bounds.contacts)


def _remains(kept: np.ndarray, boxes: Floats) -> Floats:
    """What an outcome leaves of the set, as a fraction: of its number, times the interval of its
    COM."""
    place = boxes[:, 0].mean(axis=-1)
    low = np.where(kept, place, np.inf).min(axis=1)
    high = np.where(kept, place, -np.inf).max(axis=1)
    return kept.mean(axis=1) * np.maximum(high - low, 0) / max(float(np.ptp(place)), 1e-9)


def _turn(bounds: ContactBounds, probe: Probe) -> float:
    return max(abs(a - b) for a, b in zip(bounds.angles, probe.angles, strict=True))


def _pose_at(bounds: ContactBounds, angles: Pair) -> Pose:
    """At other angles, with the contacts where they are."""
    return replace(bounds, angles=angles).pose()


def _first_safe(
    found: ObjectSet, bounds: ContactBounds, ranked: list[Probe], limits: Limits
) -> Probe | None:
    for probe in ranked[:_TRIED]:
        if is_safe(found, bounds, probe, limits):
            return probe
    return None


def is_safe(found: ObjectSet, bounds: ContactBounds, probe: Probe, limits: Limits) -> bool:
    """Whether the robots keep every object of the set, while they turn and while they slide it."""
    few = sample(found.boxes, 40)
    most = bounds.geometry.give.squeeze
    if probe.way == UP and most < math.inf:
        pose = stroke_pose(replace(bounds, angles=probe.angles), UP, limits)
        if found.largest_squeeze(pose) > most:
            return False
    return all(
        _clears(limits, pose) and found.held(boxes, pose)
        for boxes in (few, found.boxes)
        for pose in _poses(bounds, probe, limits)
    )


def _poses(bounds: ContactBounds, probe: Probe, limits: Limits) -> Iterator[Pose]:
    reach, drift = limits.reach, limits.drift
    yield stroke_pose(replace(bounds, angles=probe.angles), probe.way, limits)
    wide = [(max(low - drift, -reach), min(high + drift, reach)) for low, high in bounds.contacts]
    free = replace(bounds, contacts=(wide[0], wide[1]))
    steps = max(1, math.ceil(_turn(bounds, probe) / _STRIDE))
    poses = [
        _pose_at(free, turned_towards(bounds.angles, probe.angles, _STRIDE * k))
        for k in range(steps + 1)
    ]
    for one, other in itertools.pairwise(poses):
        yield _hull(one, other)


def stroke_pose(bounds: ContactBounds, way: int, limits: Limits) -> Pose:
    """All poses of a stroke at these palm angles."""
    give = bounds.geometry.give
    left, right = (
        _stroke(ends, zones, way, limits.reach, give.late + give.overshoot)
        for ends, zones in zip(bounds.contacts, bounds.geometry.zones, strict=True)
    )
    return replace(bounds, contacts=(left, right)).pose()


def _stroke(
    ends: Interval, zones: tuple[Zone, ...], way: int, reach: float, late: float
) -> tuple[float, float]:
    """Where a contact can be until its next switch changes, or it is as far as it may be."""
    low, high = ends
    edges = sorted({edge for zone in zones for edge in (zone.from_m, zone.to_m)} | {-reach, reach})
    if way == UP:
        return low, next((edge for edge in edges if edge >= high), high) + late
    return next((edge for edge in reversed(edges) if edge <= low), low) - late, high


def is_at_reach(bounds: ContactBounds, way: int, limits: Limits) -> bool:
    """Whether a contact may be as far that way as it is allowed to be."""
    last = limits.reach - SPARE_M
    return any(max(way * low, way * high) >= last for low, high in bounds.contacts)


def turned_towards(angles: Pair, target: Pair, most: float) -> Pair:
    """Both palms after a turn towards a target by at most this angle."""
    left, right = (
        max(angle - most, min(angle + most, end)) for angle, end in zip(angles, target, strict=True)
    )
    return left, right


def _hull(one: Pose, other: Pose) -> Pose:
    def hull(a: Interval, b: Interval) -> Interval:
        return min(a[0], b[0]), max(a[1], b[1])

    left, right = (hull(a, b) for a, b in zip(one.angles, other.angles, strict=True))
    return Pose((left, right), hull(one.tangent, other.tangent))


def _clears(limits: Limits, pose: Pose) -> bool:
    """Whether every point of the outline lies above both palms, if these had no ends."""
    for tangent in pose.tangent:
        turn = math.atan(tangent)
        for i, sense in ((0, 1), (1, -1)):
            for angle in pose.angles[i]:
                for point in limits.outline:
                    x, y = point[i], point[2]
                    if abs(x) + abs(y) < 1e-9:
                        continue
                    across = x * math.cos(turn) - sense * y * math.sin(turn)
                    up = sense * x * math.sin(turn) + y * math.cos(turn)
                    if up * math.cos(angle) + across * math.sin(angle) <= 0:
                        return False
    return True
