# SPDX-License-Identifier: Apache-2.0
"""Clearance: how close the outline comes to a palm in the operating region.

Where all vertices lie above the line of a palm, palms of any length are clear, and the closest
state is a corner of the region: a closed form, in the core. Where a part of the outline lies below
that line, the length of the palm decides. Branch and bound then encloses the smallest margin over
all contacts and over all angles of a turning palm: a part of the region is bisected as long as its
bound does not exclude that it contains the smallest margin. A result "does not touch" is therefore
certain; `_ROUNDING` is subtracted for floating-point rounding.

As seen from its contact vertex, the palm extends inward to its tip and outward to its back end,
along a line at the angle α = θ ± ϑ to the object. A piece of the outline within reach of an end
excludes an interval of α. The interior angle at the contact vertex excludes an interval for palms
of any length. The distance from such an interval changes at most as fast as α, and decreases as the
palm gets longer: this gives the bound over a part. Source: docs/theory/stability.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, bad
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots.stability.problem import Pair, StabilityProblem

Array = NDArray[np.float64]
Kind = Literal["flush", "tip", "back end"]

_ROUNDING = 1e-9
_INSET = 1e-9  # relative: beyond a contact at the end of its palm there is no palm to touch
_RESOLUTION = 2e-5  # rad and m: a margin exceeds its reported value by at most this much
_COARSE = 0.05  # relative: an overlap may be this much deeper elsewhere
_LEVELS = 120
_MOST = 20_000


@dataclass(frozen=True)
class ClosestState:
    """The state in which a margin is smallest, and what touches there first."""

    margin: float
    side: Side
    kind: Kind
    """flush: an edge or another vertex on the palm; tip, back end: that end meets an edge."""
    angles_rad: Pair
    contacts_m: Pair


@dataclass(frozen=True, repr=False)
class Clearance(Result):
    """How far the outline stays from both palms, everywhere in the operating region."""

    rotation_margin: ClosestState
    """How far a palm or the object may turn until the outline touches a palm [rad]; negative: it
    touches, and how far it would have to turn back. For palms of any length where those are
    clear, or where a contact vertex is rounded."""
    length_margin: ClosestState | None
    """How much longer the palms may be at either end [m]; negative: the outline touches, and how
    much shorter they would have to be. None: palms of any length are clear, or a contact vertex is
    rounded."""

    @derived
    def touches(self) -> bool:
        """Whether the outline touches a palm in some state; False is certain."""
        return not self.rotation_margin.margin > 0

    def lines(self) -> Iterator[Item]:
        """Whether the outline clears both palms, and where they touch first."""
        turn = f"{abs(math.degrees(self.rotation_margin.margin)):.2f}°"
        ends = self.length_margin
        if ends is None and not self.touches:
            yield f"clearance {turn}, for palms of any length"
        elif ends is None:
            yield Line(
                bad("the outline TOUCHES a palm"), f", by {turn}, if the palm is long enough"
            )
        elif not self.touches:
            yield f"clearance {turn}, or {millimetres(ends.margin)} at the ends of the palms"
        else:
            over = (
                "" if ends.kind == "flush" else f", {millimetres(-ends.margin)} from a palm's end"
            )
            yield Line(bad("the outline TOUCHES a palm"), f", by {turn}{over}")
        first = self.rotation_margin
        angles = ", ".join(f"{math.degrees(angle):.1f}°" for angle in first.angles_rad)
        contacts = ", ".join(map(millimetres, first.contacts_m))
        kind = "flush with the outline" if first.kind == "flush" else first.kind
        yield Line(
            f"first contact: {first.side} palm, {kind}, palms at {angles}, contacts {contacts}",
            indent=2,
        )


def outline_clearance(problem: StabilityProblem) -> Clearance:
    """The smallest margins of clearance over the whole operating region."""
    low, high = _region(problem)
    views = [_View(problem, side) for side in (0, 1)]
    # The length of the palms is not considered where a contact vertex is rounded.
    if any(problem.radius) or problem.envelope().clearance(problem.angles) > 0:
        corners = _corners(low, high)
        candidates = [(view, view.endless(corners)) for view in views]
        view, margins = min(candidates, key=lambda pair: float(pair[1].min()))
        state = corners[int(margins.argmin())]
        return Clearance(view.nearest(state, float(margins.min()), "flush"), None)
    turn = min((_least(v, v.turn, low, high) for v in views), key=lambda n: n.margin)
    longer = min((_least(v, v.longer, low, high) for v in views), key=lambda n: n.margin)
    return Clearance(turn, longer if np.isfinite(longer.margin) else None)


def _region(problem: StabilityProblem) -> tuple[Array, Array]:
    """Smallest and largest (θ_L, θ_R, p_L, p_R) of every pose."""
    (left_shallow, left_steep), (right_shallow, right_steep) = problem.angles
    poses = [
        ((left_steep, left_steep), (right_steep, right_steep), problem.contacts),
        ((left_shallow, left_shallow), (right_shallow, right_shallow), problem.contacts),
        *(
            ((left_shallow, left_steep), (right_steep,) * 2, problem.region(n, "left"))
            for n in (1, 2)
        ),
        *(
            ((left_steep,) * 2, (right_shallow, right_steep), problem.region(n, "right"))
            for n in (1, 2)
        ),
    ]
    ends = np.array([(left, right, *contacts) for left, right, contacts in poses])
    low, high = ends[..., 0], ends[..., 1]
    inset = _INSET * np.array([0.0, 0.0, *problem.half_length])
    return low + inset, np.maximum(high - inset, low + inset)


def _corners(low: Array, high: Array) -> Array:
    picks = np.stack(np.meshgrid(*[[0, 1]] * 4, indexing="ij"), axis=-1).reshape(-1, 1, 4)
    return np.where(picks == 0, low, high).reshape(-1, 4)


def _wrapped(angle: Array) -> Array:
    return (angle + np.pi) % (2 * np.pi) - np.pi


class _View:
    """The object seen from one palm's contact vertex; states are rows (θ_L, θ_R, p_L, p_R)."""

    def __init__(self, problem: StabilityProblem, side: int) -> None:
        self.problem, self.side = problem, side
        outline = np.array([(vertex[side], vertex[2]) for vertex in problem.spec.outline])
        own = (0, problem.spec.contact_right)[side]
        points = np.roll(outline, -own, axis=0)
        starts, ends = points[1:-1], points[2:]  # without the two edges at the contact vertex
        # Outward of the contact, the edges are mirrored through the contact vertex.
        self.a = np.concatenate([starts, -starts])
        self.d = np.concatenate([ends - starts, starts - ends])
        self.inward = np.arange(len(self.a)) < len(starts)
        first, last = points[1], points[-1]
        middle, half = self._interval(first, last)
        self.own = np.array([middle, middle + np.pi]), half

    @staticmethod
    def _interval(a: Array, b: Array) -> tuple[Array, Array]:
        """Middle and half-width of the angles α between two directions."""
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        delta = -np.arctan2(cross, (a * b).sum(axis=-1))
        return -np.arctan2(a[..., 1], a[..., 0]) + delta / 2, np.abs(delta) / 2

    def _turned(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Middle and half-width of α over boxes of states."""
        problem = self.problem
        rise_low, rise_high = np.zeros(len(low)), np.zeros(len(low))
        for i, sign in ((0, -1.0), (1, 1.0)):
            theta = np.stack([low[:, i], high[:, i]], axis=-1)
            sine, p = np.sin(theta), np.stack([low[:, 2 + i], high[:, 2 + i]], axis=-1)
            along = (sine[:, :, None] * p[:, None, :]).reshape(-1, 4)
            cosine = np.cos(theta)
            level = (theta[:, 0] < 0) & (theta[:, 1] > 0)
            across = problem.offset[i] * np.column_stack(
                [cosine, np.where(level, 1.0, cosine[:, 0])]
            )
            least = along.min(axis=1) + across.min(axis=1)
            most = along.max(axis=1) + across.max(axis=1)
            rise_low += -most if sign < 0 else least
            rise_high += -least if sign < 0 else most
        tilt = np.arcsin(np.clip(np.stack([rise_low, rise_high]) / problem.width, -1, 1))
        if self.side == 1:
            tilt = -tilt[::-1]
        lowest, highest = low[:, self.side] + tilt[0], high[:, self.side] + tilt[1]
        return 0.5 * (lowest + highest), 0.5 * (highest - lowest)

    def _reach(self, p: Array) -> tuple[Array, Array]:
        half = self.problem.half_length[self.side]
        return half + p, half - p

    def _excluded(self, alpha: Array, inward: Array, outward: Array) -> tuple[Array, Array, Array]:
        """For every edge: distance of α from the excluded interval, and the part within reach."""
        reach = np.where(self.inward, inward[:, None], outward[:, None])
        square, along = (self.d**2).sum(axis=-1), (self.a * self.d).sum(axis=-1)
        inside = along**2 - square * ((self.a**2).sum(axis=-1) - reach**2)
        root = np.sqrt(np.maximum(inside, 0.0))
        start, end = (-along - root) / square, (-along + root) / square
        hit = (inside >= 0) & (start <= 1) & (end >= 0)
        start, end = np.clip(start, 0, 1), np.clip(end, 0, 1)
        middle, half = self._interval(
            self.a + start[..., None] * self.d, self.a + end[..., None] * self.d
        )
        room = np.abs(_wrapped(alpha[:, None] - middle)) - half
        return np.where(hit, room, np.inf), start, end

    def _own_room(self, alpha: Array) -> Array:
        middle, half = self.own
        return np.abs(_wrapped(alpha[:, None] - middle)).min(axis=1) - half

    def endless(self, states: Array) -> Array:
        """How far palms of any length may turn."""
        alpha, _ = self._turned(states, states)
        low, high = np.arctan(_core.clear_cones(self.problem.spec)[self.side])
        return np.minimum(alpha - low, high - alpha)

    def turn(self, alpha: Array, spread: Array, inward: Array, outward: Array) -> Array:
        """Lower bound of how far a palm may turn, for all α within a spread."""
        room = self._excluded(alpha, inward, outward)[0].min(axis=1, initial=np.inf)
        return np.minimum(self._own_room(alpha), room) - spread

    def _room(self, alpha: Array, spread: Array, inward: Array, outward: Array) -> Array:
        """For every edge: how much longer the palm may be until it reaches it."""
        middle, half = self._interval(self.a, self.a + self.d)
        off = _wrapped(alpha[:, None] - middle)
        # Within these angles, the point of the edge closest to the contact counts.
        low = np.maximum(off - spread[:, None], -half)
        high = np.minimum(off + spread[:, None], half)
        length = np.hypot(*self.d.T)
        normal = np.abs(self.a[:, 0] * self.d[:, 1] - self.a[:, 1] * self.d[:, 0]) / length
        foot = self.a - ((self.a * self.d).sum(axis=-1) / length**2)[:, None] * self.d
        to_foot = _wrapped(-np.arctan2(foot[:, 1], foot[:, 0]) - middle)
        away = np.maximum(np.maximum(low - to_foot, to_foot - high), 0.0)
        nearest = np.minimum(np.hypot(*self.a.T), np.hypot(*(self.a + self.d).T))
        radial = normal < _ROUNDING * length  # the edge points at the contact vertex
        far = np.where(radial, nearest, normal / np.cos(np.minimum(away, np.pi / 2 - 1e-12)))
        far = np.where(low <= high, far, np.inf)
        return far - np.where(self.inward, inward[:, None], outward[:, None])

    def longer(self, alpha: Array, spread: Array, inward: Array, outward: Array) -> Array:
        """Lower bound of how much longer a palm may be, for all α within a spread."""
        flat = self._own_room(alpha) <= spread
        room = self._room(alpha, spread, inward, outward).min(axis=1, initial=np.inf)
        return np.where(flat, -np.maximum(inward, outward), room)

    def at_states(self, margin: _Margin, states: Array) -> Array:
        """A margin in single states."""
        return margin(*self._turned(states, states), *self._reach(states[:, 2 + self.side]))

    def bounds(self, margin: _Margin, low: Array, high: Array) -> tuple[Array, Array]:
        """Lower bounds of a margin in boxes: for α in the middle, and for every α."""
        own = 2 + self.side
        alpha, spread = self._turned(low, high)
        inward, outward = self._reach(high[:, own])[0], self._reach(low[:, own])[1]
        return margin(alpha, 0 * spread, inward, outward), margin(alpha, spread, inward, outward)

    def effects(self, low: Array, high: Array) -> Array:
        """Approximate change of α within a box due to each of a state's four numbers."""
        extent, width = high - low, self.problem.width
        far = np.maximum(np.abs(low), np.abs(high))
        effects = extent * np.column_stack(
            [far[:, 2] / width, far[:, 3] / width, *np.abs(np.sin(far[:, :2].T)) / width]
        )
        effects[:, self.side] = extent[:, self.side]
        return effects

    def nearest(self, state: Array, margin: float, kind: Kind) -> ClosestState:
        """The result for a state."""
        left, right, p_left, p_right = (float(value) for value in state)
        return ClosestState(
            margin - _ROUNDING, SIDES[self.side], kind, (left, right), (p_left, p_right)
        )

    def kind(self, margin: _Margin, state: Array) -> Kind:
        """What touches first where the margin of a state is used up."""
        row = state[None]
        alpha, spread = self._turned(row, row)
        reach = self._reach(row[:, 2 + self.side])
        own = float(self._own_room(alpha)[0])
        if margin == self.longer:
            k = int(self._room(alpha, spread, *reach)[0].argmin())
            return "flush" if own <= 0 else self._end(k)
        room, start, end = (values[0] for values in self._excluded(alpha, *reach))
        k = int(room.argmin())
        if own <= room[k]:
            return "flush"
        # The nearer end of the excluded interval is a vertex, or where the palm's end is.
        shares = [start[k], end[k]]
        places = [self.a[k] + share * self.d[k] for share in shares]
        off = [abs(float(_wrapped(alpha + np.arctan2(y, x))[0])) for x, y in places]
        return "flush" if shares[int(np.argmin(off))] in (0.0, 1.0) else self._end(k)

    def _end(self, edge: int) -> Kind:
        return "tip" if self.inward[edge] else "back end"


_Margin = Callable[[Array, Array, Array, Array], Array]


def _least(view: _View, margin: _Margin, low: Array, high: Array) -> ClosestState:
    """Lower bound of the margin over all states between `low` and `high`."""
    states = _corners(low, high)
    margins = view.at_states(margin, states)
    best, state = float(margins.min()), states[int(margins.argmin())]
    lowest = best
    for _ in range(_LEVELS):
        middle = 0.5 * (low + high)
        margins = view.at_states(margin, middle)
        if margins.min() < best:
            best, state = float(margins.min()), middle[int(margins.argmin())]
        narrow, bound = view.bounds(margin, low, high)
        # The depth of an overlap needs less accuracy than its existence.
        lowest = best - max(_RESOLUTION, -_COARSE * best)
        left = bound < lowest
        if not left.any():
            break
        lowest = float(bound[left].min())
        if left.sum() > _MOST:
            break
        low, high, middle = low[left], high[left], middle[left]
        effects = view.effects(low, high)
        with np.errstate(invalid="ignore"):  # ∞ − ∞: no edge is in reach
            by_reach = np.nan_to_num((margins - narrow)[left])
            by_angle = np.nan_to_num((narrow - bound)[left])
        # Bisect the contact coordinate where the palm's reach matters more than its angle.
        own = 2 + view.side
        reach = (by_reach > by_angle) & (high[:, own] > low[:, own])
        which = np.where(reach, own, effects.argmax(axis=1))
        rows = np.arange(len(low))
        upper, lower = high.copy(), low.copy()
        upper[rows, which] = lower[rows, which] = middle[rows, which]
        low, high = np.concatenate([low, lower]), np.concatenate([upper, high])
    return view.nearest(state, lowest if best > 0 else best, view.kind(margin, state))
