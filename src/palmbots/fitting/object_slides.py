# SPDX-License-Identifier: Apache-2.0
"""The object and the palms, as logs of carries show them: which contact slides, at which palm
angles, how fast palms turn, and where the switches change.

While the robots drive, one contact slides on its palm in nearly every tick. Which one depends on
the palm angles, so where the slide passes from one contact to the other while a palm turns, COM and
friction obey an equation, within the angle of one tick. All slides together cut the set of objects
(`ObjectSet`, as in a probe). An inclined force is the same as an inclined floor: the specific force
of the robots' accelerations turns palms and object.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots.probing.object_set import ObjectSet, Observation, Prior
from palmbots.probing.slip_comparison import DOWN, UP, Pose
from palmbots.scene.spec import to_spec
from palmbots.simulation.result import Carry

Floats = NDArray[np.float64]

FRICTION = (0.02, 2.0)
"""Coefficients between which those of the palms are sought."""

_GRAVITY_M_S2 = 9.80665
_SLACK_RAD = 1e-6  # of each angle: logs are rounded
_ALIKE_RAD = 1e-3  # angles of slides that count as one
_AT_ONCE = 32  # slides: so few stay in the processor's cache
_TRIED = 500  # objects that choose the observations which cut the set
_ROUNDS = 4
_CUTS = 40  # observations in a round
_LEAST_CUT = 0.07  # of the set, by an observation that is used


@dataclass(frozen=True)
class Slides:
    """Ticks in which one contact slides; arrays with a row for each."""

    side: NDArray[np.int64]
    """The contact that slides: left is 0, right 1."""
    way: NDArray[np.int64]
    """1 outward, while the robots close; -1 inward, while they open."""
    ends: Floats
    """Shape (n, 3, 2): low and high of the angles of the left palm, of the right palm and of the
    object, with respect to the total specific force [rad]."""

    def __len__(self) -> int:
        return len(self.side)

    @classmethod
    def joined(cls, parts: Sequence[Slides]) -> Slides:
        """All of them; slides that are nearly alike count once."""
        side, way, ends = (
            np.concatenate([getattr(one, name) for one in parts])
            for name in ("side", "way", "ends")
        )
        rounded = np.round(ends.reshape(len(ends), 6) / _ALIKE_RAD).astype(np.int64)
        _, first = np.unique(np.column_stack([side, way, rounded]), axis=0, return_index=True)
        return cls(side[first], way[first], ends[first])

    def poses(self, rows: Any) -> Pose:
        """Palms and object of some of them."""
        low, high = self.ends[rows, :, 0] - _SLACK_RAD, self.ends[rows, :, 1] + _SLACK_RAD
        left, right, of_object = ((low[..., i], high[..., i]) for i in range(3))
        return Pose((left, right), (np.tan(of_object[0]), np.tan(of_object[1])))

    def observation(self, row: int) -> Observation:
        """One of them."""
        return Observation(int(self.side[row]), int(self.way[row]), self.poses(row))


def slides_in(carry: Carry) -> Slides:
    """The ticks of a carry in which one contact slides and the other one sticks."""
    trace = carry.trace
    assert trace is not None
    motion = trace["motion"].transpose("time", "side").to_numpy().astype(np.int64)
    palms = trace["palm"].transpose("time", "side").to_numpy()
    angles = np.column_stack([palms, trace["object"].to_numpy()])
    is_known = np.isfinite(angles.sum(axis=1))
    rows = np.flatnonzero(((motion[:-1] != 0).sum(axis=1) == 1) & is_known[:-1] & is_known[1:])
    lean = np.arctan(to_spec(carry.scene).slope + _pushes(carry))[rows]
    ends = np.stack([angles[rows], angles[rows + 1]], axis=-1)
    ends += (lean[:, None] * [-1.0, 1.0, 1.0])[:, :, None]
    side = (motion[rows, 1] != 0).astype(np.int64)
    return Slides(side, motion[rows, side], np.sort(ends, axis=-1))


def _pushes(carry: Carry) -> Floats:
    """The specific force of the robots' mean acceleration in each tick [g], as the world has it."""
    trace, task, period_s = carry.trace, carry.scene.task, carry.scene.control.period_s
    assert trace is not None
    speeds = trace["speed"].transpose("time", "side").to_numpy()
    memory = math.exp(-period_s / task.inertia_tau_s) if task.inertia_tau_s > 0 else 0.0
    push, pushes = 0.0, []
    for change in np.diff(speeds.mean(axis=1), prepend=0.0).tolist():
        push = memory * push + (1 - memory) * change / (period_s * _GRAVITY_M_S2)
        pushes.append(push)
    return np.array(pushes) if task.inertia else np.zeros(len(pushes))


def objects_with(
    slides: Slides, prior: Prior, on_progress: Callable[[float], None] = lambda part: None
) -> ObjectSet:
    """The objects of the prior that slide as observed.

    Few slides decide. In each round, objects are drawn from the set, and slides that contradict
    many of them cut it.

    Args:
        slides: of all logs.
        prior: where the object is sought.
        on_progress: called with the completed fraction.
    """
    found = ObjectSet(prior, least_cut=_LEAST_CUT)
    random = np.random.default_rng(0)
    used: set[int] = set()
    for number in range(_ROUNDS):
        on_progress(number / _ROUNDS)
        points = _drawn(found.boxes, random)
        excluded = _excluded(found, slides, points)
        excluded[sorted(used)] = False
        remain = np.ones(len(points), bool)
        for _ in range(_CUTS):
            counts = (excluded & remain).sum(axis=1)
            best = int(counts.argmax())
            if counts[best] == 0:
                break
            remain &= ~excluded[best]
            used.add(best)
            found.add(slides.observation(best))
    found.sharpen()
    return found


def _drawn(boxes: Floats, random: np.random.Generator) -> Floats:
    """Objects of the boxes, as boxes without an extent."""
    volumes = np.prod(boxes[:, :, 1] - boxes[:, :, 0], axis=1)
    shares = volumes / volumes.sum() if volumes.sum() > 0 else None
    chosen = boxes[random.choice(len(boxes), _TRIED, p=shares)]
    parts = random.random((_TRIED, 3))
    points = chosen[:, :, 0] + parts * (chosen[:, :, 1] - chosen[:, :, 0])
    return np.repeat(points[:, :, None], 2, axis=2)


def _excluded(found: ObjectSet, slides: Slides, points: Floats) -> NDArray[np.bool_]:
    """Which objects each slide contradicts; shape (slides, objects)."""
    excluded = np.zeros((len(slides), len(points)), bool)
    for side, way in itertools.product((0, 1), (UP, DOWN)):
        those = np.flatnonzero((slides.side == side) & (slides.way == way))
        for rows in np.split(those, range(_AT_ONCE, len(those), _AT_ONCE)):
            poses = slides.poses(rows[:, None])  # for each object
            excluded[rows] = ~found.may_slide(points, poses, way)[side]
    return excluded
