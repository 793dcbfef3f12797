"""Does the outline touch a palm anywhere in the operating region, and how near does it come?

Where no vertex comes down to the line of a palm, palms of any length are clear, and the nearest
place is a corner of the region: a closed form, in the core. Where a part of the outline hangs below
that line, the palms as long as they are decide. Then the least margin over all contacts and over
all angles that a turning palm passes through is enclosed by branch and bound: parts of the region
are halved as long as a bound for all of a part leaves open whether it holds the least margin. So
"does not touch" is certain; for floating-point rounding `_ROUNDING` is taken off.

Seen from its contact vertex the palm reaches inward to its tip and outward to its back end, along a
line that is turned against the object by α = θ ± ϑ. A piece of the outline within reach of an end
keeps the palm out of an interval of α; the interior angle at the contact vertex does so, however
short the palm. The distance from an interval changes no faster than α and only shrinks as the palm
gets longer: that bounds it over a part. Source: MECHANICS section 5.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from palmbots.sections import SIDES, Side
from palmbots.stability.situation import Pair, Situation

__all__ = ["Clearance", "Nearest", "clearance"]

Array = NDArray[np.float64]
Kind = Literal["flush", "tip", "back end"]

_ROUNDING = 1e-9
_INSET = 1e-9  # relative: a contact at the very end of its palm has no palm beyond it to touch
_RESOLUTION = 2e-5  # rad and m: margins are at most so much greater than what is told
_COARSE = 0.05  # where it touches, it may be so much deeper elsewhere
_LEVELS = 120
_MOST = 20_000


@dataclass(frozen=True)
class Nearest:
    """The state in which a margin is least, and what touches there first."""

    margin: float
    side: Side
    kind: Kind
    """flush: an edge or another vertex on the palm; tip, back end: that end meets an edge."""
    angles_rad: Pair
    contacts_m: Pair


@dataclass(frozen=True)
class Clearance:
    """How far the outline stays from both palms, everywhere in the operating region."""

    turn: Nearest
    """How far palm or object may turn until something touches [rad]; negative: it touches, and by
    how much it would have to turn back. Counted for palms of any length where those clear."""
    longer: Nearest | None
    """How much longer the palms may be at either end [m]; negative: it touches, and by how much
    they would have to be shorter there. None: palms of any length are clear."""

    @property
    def touches(self) -> bool:
        """Whether the outline touches a palm somewhere; False is certain."""
        return not self.turn.margin > 0


def clearance(at: Situation) -> Clearance:
    """The least margins of clearance over the whole operating region."""
    low, high = _region(at)
    views = [_View(at, side) for side in (0, 1)]
    if at.envelope().clearance(at.angles) > 0:
        corners = _corners(low, high)
        found = [(view, view.endless(corners)) for view in views]
        view, margins = min(found, key=lambda pair: float(pair[1].min()))
        state = corners[int(margins.argmin())]
        return Clearance(view.nearest(state, float(margins.min()), "flush"), None)
    turn = min((_least(v, v.turn, low, high) for v in views), key=lambda n: n.margin)
    longer = min((_least(v, v.longer, low, high) for v in views), key=lambda n: n.margin)
    return Clearance(turn, longer if np.isfinite(longer.margin) else None)


def _region(at: Situation) -> tuple[Array, Array]:
    """Least and greatest (θ_L, θ_R, p_L, p_R) of every pose."""
    (left_shallow, left_steep), (right_shallow, right_steep) = at.angles
    poses = [
        ((left_steep, left_steep), (right_steep, right_steep), at.contacts),
        ((left_shallow, left_shallow), (right_shallow, right_shallow), at.contacts),
        *(((left_shallow, left_steep), (right_steep,) * 2, at.region(n, "left")) for n in (1, 2)),
        *(((left_steep,) * 2, (right_shallow, right_steep), at.region(n, "right")) for n in (1, 2)),
    ]
    ends = np.array([(left, right, *contacts) for left, right, contacts in poses])
    low, high = ends[..., 0], ends[..., 1]
    inset = _INSET * np.array([0.0, 0.0, *at.half_length])
    return low + inset, np.maximum(high - inset, low + inset)


def _corners(low: Array, high: Array) -> Array:
    picks = np.stack(np.meshgrid(*[[0, 1]] * 4, indexing="ij"), axis=-1).reshape(-1, 1, 4)
    return np.where(picks == 0, low, high).reshape(-1, 4)


def _wrapped(angle: Array) -> Array:
    return (angle + np.pi) % (2 * np.pi) - np.pi


class _View:
    """The object from one palm's contact vertex; states are rows (θ_L, θ_R, p_L, p_R)."""

    def __init__(self, at: Situation, side: int) -> None:
        self.at, self.side = at, side
        outline = np.array([(vertex[side], vertex[2]) for vertex in at.spec.outline])
        own = int(np.flatnonzero((outline == 0).all(axis=1))[0])
        points = np.roll(outline, -own, axis=0)
        starts, ends = points[1:-1], points[2:]  # without the two edges at the contact vertex
        # What lies outward of the contact is seen along the palm's line from the other end.
        self.a = np.concatenate([starts, -starts])
        self.d = np.concatenate([ends - starts, starts - ends])
        self.inward = np.arange(len(self.a)) < len(starts)
        first, last = points[1], points[-1]
        middle, half = self._interval(first, last)
        self.own = np.array([middle, middle + np.pi]), half

    @staticmethod
    def _interval(a: Array, b: Array) -> tuple[Array, Array]:
        """Middle and half width of the angles α between two directions."""
        cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        delta = -np.arctan2(cross, (a * b).sum(axis=-1))
        return -np.arctan2(a[..., 1], a[..., 0]) + delta / 2, np.abs(delta) / 2

    def _turned(self, low: Array, high: Array) -> tuple[Array, Array]:
        """Middle and half width of α over boxes of states."""
        at = self.at
        rise_low, rise_high = np.zeros(len(low)), np.zeros(len(low))
        for i, sign in ((0, -1.0), (1, 1.0)):
            theta = np.stack([low[:, i], high[:, i]], axis=-1)
            sine, p = np.sin(theta), np.stack([low[:, 2 + i], high[:, 2 + i]], axis=-1)
            along = (sine[:, :, None] * p[:, None, :]).reshape(-1, 4)
            cosine = np.cos(theta)
            level = (theta[:, 0] < 0) & (theta[:, 1] > 0)
            across = at.offset[i] * np.column_stack([cosine, np.where(level, 1.0, cosine[:, 0])])
            least = along.min(axis=1) + across.min(axis=1)
            most = along.max(axis=1) + across.max(axis=1)
            rise_low += -most if sign < 0 else least
            rise_high += -least if sign < 0 else most
        tilt = np.arcsin(np.clip(np.stack([rise_low, rise_high]) / at.width, -1, 1))
        if self.side == 1:
            tilt = -tilt[::-1]
        lowest, highest = low[:, self.side] + tilt[0], high[:, self.side] + tilt[1]
        return 0.5 * (lowest + highest), 0.5 * (highest - lowest)

    def _reach(self, p: Array) -> tuple[Array, Array]:
        half = self.at.half_length[self.side]
        return half + p, half - p

    def _kept_out(self, alpha: Array, inward: Array, outward: Array) -> tuple[Array, Array, Array]:
        """For every edge: how far α is from what it keeps out, and which parts are in reach."""
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
        far = np.full(len(states), np.inf)
        return np.minimum(self._own_room(alpha), self._kept_out(alpha, far, far)[0].min(axis=1))

    def turn(self, alpha: Array, spread: Array, inward: Array, outward: Array) -> Array:
        """At most how far a palm may turn, for all α within a spread."""
        room = self._kept_out(alpha, inward, outward)[0].min(axis=1, initial=np.inf)
        return np.minimum(self._own_room(alpha), room) - spread

    def _room(self, alpha: Array, spread: Array, inward: Array, outward: Array) -> Array:
        """For every edge: how much longer the palm may be until it meets it."""
        middle, half = self._interval(self.a, self.a + self.d)
        off = _wrapped(alpha[:, None] - middle)
        # Where the edge lies in the angles looked at, the place nearest to the contact counts.
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
        """At most how much longer a palm may be, for all α within a spread."""
        flat = self._own_room(alpha) <= spread
        room = self._room(alpha, spread, inward, outward).min(axis=1, initial=np.inf)
        return np.where(flat, -np.maximum(inward, outward), room)

    def at_states(self, margin: "_Margin", states: Array) -> Array:
        """A margin in single states."""
        return margin(*self._turned(states, states), *self._reach(states[:, 2 + self.side]))

    def bounds(self, margin: "_Margin", low: Array, high: Array) -> tuple[Array, Array]:
        """At most a margin anywhere in boxes: for one α in the middle, and for every α."""
        own = 2 + self.side
        alpha, spread = self._turned(low, high)
        inward, outward = self._reach(high[:, own])[0], self._reach(low[:, own])[1]
        return margin(alpha, 0 * spread, inward, outward), margin(alpha, spread, inward, outward)

    def effects(self, low: Array, high: Array) -> Array:
        """By how much each of a state's four numbers turns the palm within a box, roughly."""
        extent, width = high - low, self.at.width
        far = np.maximum(np.abs(low), np.abs(high))
        found = extent * np.column_stack(
            [far[:, 2] / width, far[:, 3] / width, *np.abs(np.sin(far[:, :2].T)) / width]
        )
        found[:, self.side] = extent[:, self.side]
        return found

    def nearest(self, state: Array, margin: float, kind: Kind) -> Nearest:
        """A state with what is told of it."""
        left, right, p_left, p_right = (float(value) for value in state)
        return Nearest(margin - _ROUNDING, SIDES[self.side], kind, (left, right), (p_left, p_right))

    def kind(self, margin: "_Margin", state: Array) -> Kind:
        """What touches first where a margin is used up in a state."""
        row = state[None]
        alpha, spread = self._turned(row, row)
        reach = self._reach(row[:, 2 + self.side])
        own = float(self._own_room(alpha)[0])
        if margin == self.longer:
            k = int(self._room(alpha, spread, *reach)[0].argmin())
            return "flush" if own <= 0 else self._end(k)
        room, start, end = (found[0] for found in self._kept_out(alpha, *reach))
        k = int(room.argmin())
        if own <= room[k]:
            return "flush"
        # At its nearer side what keeps the palm out ends with a vertex or where the palm ends.
        shares = [start[k], end[k]]
        places = [self.a[k] + share * self.d[k] for share in shares]
        off = [abs(float(_wrapped(alpha + np.arctan2(y, x))[0])) for x, y in places]
        return "flush" if shares[int(np.argmin(off))] in (0.0, 1.0) else self._end(k)

    def _end(self, edge: int) -> Kind:
        return "tip" if self.inward[edge] else "back end"


_Margin = Callable[[Array, Array, Array, Array], Array]


def _least(view: _View, margin: _Margin, low: Array, high: Array) -> Nearest:
    """The least margin over all states between `low` and `high`, from below."""
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
        # How deep a palm is in the object need not be known as well as whether it is.
        lowest = best - max(_RESOLUTION, -_COARSE * best)
        left = bound < lowest
        if not left.any():
            break
        lowest = float(bound[left].min())
        if left.sum() > _MOST:
            break
        low, high, middle = low[left], high[left], middle[left]
        effects = view.effects(low, high)
        with np.errstate(invalid="ignore"):  # ∞ − ∞: nothing in reach
            by_reach = np.nan_to_num((margins - narrow)[left])
            by_angle = np.nan_to_num((narrow - bound)[left])
        # Halve the contact where the palm's reach matters more than its angle.
        own = 2 + view.side
        reach = (by_reach > by_angle) & (high[:, own] > low[:, own])
        which = np.where(reach, own, effects.argmax(axis=1))
        rows = np.arange(len(low))
        upper, lower = high.copy(), low.copy()
        upper[rows, which] = lower[rows, which] = middle[rows, which]
        low, high = np.concatenate([low, lower]), np.concatenate([upper, high])
    return view.nearest(state, lowest if best > 0 else best, view.kind(margin, state))
