# SPDX-License-Identifier: Apache-2.0
"""The objects that the prior and the observations allow: a union of boxes (`ObjectSet`).

A box is an interval of c_x, the COM's place along the line of contacts from the left contact
vertex [m], of φ_L and of φ_R, the friction angles [rad]. A box leaves the set only if the
observations contradict *every* object in it, for every palm angle, object angle, height of the COM
and specific force that were possible. So the truth stays in the set. Boxes that remain are
bisected; the smaller ones are judged anew by all observations.

If no box explains all observations, one of them is wrong, or the truth is outside the prior. The
set then consists of the boxes that contradict the fewest observations, which is the q-relaxed
intersection of L. Jaulin (Automatica, 2009).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from palmbots._types import Interval
from palmbots.probing.slip_comparison import DOWN, UP, Booleans, Floats, Pose, bounds, leans

_SPLIT_BELOW = 1500
_FINAL_BELOW = 24_000
"""Boxes that are fewer than this are bisected: during the probes, and after them."""
_ENDS_BELOW, _ENDS_DEEPER = 8000, 40
"""As many boxes at an end of the COM's interval are bisected, so many times, after the probes."""
_SMALLEST = 2.0**-9
"""Boxes that are shorter than this part of the prior in every dimension are not bisected."""


@dataclass(frozen=True)
class Prior:
    """What is known before the probe; intervals in m, and coefficients of friction."""

    width: float
    com_x: Interval
    com_y: Interval
    friction: tuple[Interval, Interval]
    slope: Interval = (0.0, 0.0)


@dataclass(frozen=True)
class Observation:
    """One contact slid past the edge of a zone while the robots closed or opened."""

    side: int
    """The palm whose switch changed: left is 0, right 1."""
    way: int
    """`UP` while closing, `DOWN` while opening."""
    pose: Pose


@dataclass
class ObjectSet:
    """The prior, cut by observations."""

    prior: Prior
    least_cut: float = 0.12
    """An observation is used if it removes at least this part of the set."""
    observations: list[Observation] = field(default_factory=list)
    boxes: Floats = field(init=False)
    """Shape (n, 3, 2): c_x, φ_L, φ_R; low and high."""
    misfits: int = field(init=False, default=0)
    """How many observations each box may contradict: the fewest that leave a box; 0: none."""
    contradicted: set[int] = field(init=False, default_factory=set)
    """The numbers of the observations that any box of the set contradicts."""

    def __post_init__(self) -> None:
        self.boxes = self._whole()
        self._cut()

    def add(self, observation: Observation) -> bool:
        """Cut the set by an observation; returns whether it was used.

        One that contradicts few objects of the set is not: leaving it out removes no object.
        """
        if np.all(self.may_slide(self.boxes, observation.pose, observation.way)[observation.side]):
            return False
        before = self.boxes, self.contradicted
        self.observations.append(observation)
        self._cut()
        if len(self.boxes) and _size(self.boxes) > (1 - self.least_cut) * _size(before[0]):
            self.observations.pop()
            self.boxes, self.contradicted = before
            return False
        self._relax(_SPLIT_BELOW)
        return True

    def hull(self) -> Floats:
        """The least box around the set, shape (3, 2)."""
        return np.stack([self.boxes[:, :, 0].min(axis=0), self.boxes[:, :, 1].max(axis=0)], axis=-1)

    def volume(self) -> float:
        """Of the set, as a fraction of the prior's."""
        return _size(self.boxes) / _size(self._whole())

    def contains(self, com_x: float, friction: tuple[float, float]) -> bool:
        """Whether an object is in the set."""
        point = np.array([com_x, *map(math.atan, friction)])
        inside = (self.boxes[:, :, 0] <= point) & (point <= self.boxes[:, :, 1])
        return bool(inside.all(axis=1).any())

    def log_levers(self) -> Interval:
        """ln (x_L / x_R) at ϑ = 0."""
        low, high = self.hull()[0]
        width = self.prior.width
        return math.log(low / (width - low)), math.log(high / (width - high))

    def held(self, boxes: Floats, pose: Pose) -> bool:
        """Whether both contacts stick somewhere in the friction cones, for every object in the
        boxes and every pose: property 0."""
        for first, second in ((DOWN, UP), (UP, DOWN)):
            low, high = self.compared(boxes, pose, (first, second))
            if not bool(np.all(low > 0 if first == DOWN else high < 0)):
                return False
        return True

    def largest_squeeze(self, pose: Pose) -> float:
        """At most this squeeze makes a contact slide outward, for any object, in its weight. At a
        small object angle: the levers are taken as those of a level object."""
        boxes, width = self.boxes, self.prior.width
        left, right = (
            leans(pose.angles[i], (boxes[:, 1 + i, 0], boxes[:, 1 + i, 1]), UP)[1] for i in (0, 1)
        )
        both = np.minimum(left * (width - boxes[:, 0, 0]), right * boxes[:, 0, 1])
        return float(both.max()) / width

    def compared(self, boxes: Floats, pose: Pose, ways: tuple[int, int]) -> tuple[Floats, Floats]:
        """The bounds of G for each box, at these ends of the friction cones (left, right)."""
        left, right = (
            leans(pose.angles[i], (boxes[..., 1 + i, 0], boxes[..., 1 + i, 1]), ways[i])
            for i in (0, 1)
        )
        prior = self.prior
        com_x = boxes[..., 0, 0], boxes[..., 0, 1]
        return bounds(prior.width, com_x, prior.com_y, prior.slope, pose.tangent, left, right)

    def may_slide(self, boxes: Floats, pose: Pose, way: int) -> tuple[Booleans, Booleans]:
        """For each box whether the left contact may slide first, and whether the right one may."""
        low, high = self.compared(boxes, pose, (way, way))
        return (high >= 0, low <= 0) if way == UP else (low <= 0, high >= 0)

    def _whole(self) -> Floats:
        cones = [[math.atan(end) for end in ends] for ends in self.prior.friction]
        return np.array([[[*self.prior.com_x], *cones]])

    def sharpen(self) -> None:
        """Bisect the boxes further: the smaller they are, the closer they enclose the objects."""
        self._cut(_FINAL_BELOW)
        self._relax(_FINAL_BELOW)

    def narrow_ends(self) -> None:
        """Bisect the boxes at both ends of the COM's interval again and again, in all dimensions.

        Boxes overestimate the set. The interval of the COM does so less afterwards. From then on
        the boxes differ in size, so the set takes no further observation.
        """
        for end in (0, 1):
            for _ in range(_ENDS_DEEPER):
                edge = self.boxes[:, 0, end]
                is_last = edge == (edge.max() if end else edge.min())
                parts = self.boxes[is_last]
                if len(parts) > _ENDS_BELOW:
                    break
                for axis in range(3):
                    parts = _halves(parts, axis)
                parts, _ = self._judged(parts)
                self.boxes = np.concatenate([self.boxes[~is_last], parts])
                if not len(self.boxes):
                    self._relax(_FINAL_BELOW)
                    return

    def _relax(self, split_below: int) -> None:
        """While no box is left, permit one contradiction more."""
        while not len(self.boxes):
            self.misfits += 1
            self.boxes = self._whole()
            self._cut(split_below)

    def _cut(self, split_below: int = _SPLIT_BELOW) -> None:
        self.boxes, counts = self._judged(self.boxes)
        while 0 < len(self.boxes) < split_below and self._lengths().max() > _SMALLEST:
            self.boxes, counts = self._judged(self._halved())
        self.contradicted = (
            set(np.flatnonzero(counts.any(axis=0)).tolist()) if counts.size else set()
        )

    def _judged(self, boxes: Floats) -> tuple[Floats, Booleans]:
        """The boxes that contradict few enough observations, and which ones they contradict."""
        against = np.zeros((len(boxes), len(self.observations)), bool)
        for number, seen in enumerate(self.observations):
            against[:, number] = ~self.may_slide(boxes, seen.pose, seen.way)[seen.side]
        kept = against.sum(axis=1) <= self.misfits
        return boxes[kept], against[kept]

    def _lengths(self) -> Floats:
        """Of a box, over those of the prior: all boxes are equally large."""
        (own, whole) = (np.diff(boxes[0])[:, 0] for boxes in (self.boxes, self._whole()))
        return np.where(whole > 0, own / np.maximum(whole, 1e-300), 0.0)

    def _halved(self) -> Floats:
        """All boxes, each cut in two across the dimension that is the longest, over the prior's."""
        return _halves(self.boxes, int(np.argmax(self._lengths())))


def _halves(boxes: Floats, axis: int) -> Floats:
    """All boxes, each cut in two across a dimension."""
    low, high = boxes.copy(), boxes.copy()
    low[:, axis, 1] = high[:, axis, 0] = boxes[:, axis].mean(axis=1)
    return np.concatenate([low, high])


def sample(boxes: Floats, most: int) -> Floats:
    """Evenly chosen boxes, at most that many."""
    step = max(1, math.ceil(len(boxes) / most))
    return boxes[::step]


def _size(boxes: Floats) -> float:
    """The volume of boxes together."""
    return float(np.prod(np.maximum(boxes[:, :, 1] - boxes[:, :, 0], 1e-12), axis=1).sum())
