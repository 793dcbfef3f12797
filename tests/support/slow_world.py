# SPDX-License-Identifier: Apache-2.0
"""An independent, slow world of rigid contacts: tiny steps of a free body among surfaces.

Shares nothing with the core. Contacts are found anew at every step from plain geometry. Of all ways
in which each may stick, slide or break one is taken whose twist is that of a rigid body (least
squares) and whose forces balance (by non-negative ones). A way that still holds goes on; otherwise
contacts on both palms come first, then as many contacts as possible. Of several that move the
object differently, one in which all contacts slide comes first, then the one with the largest
margin, then one in which the robot in front, in the direction of travel, slides.
"""

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

from feature_pairs import Contact, CornerOnFace, pairs_of
from motion_oracle import OUT, Moment, Oracle

_STICK, _UP, _DOWN, _BREAK = range(4)
CLOSED = 2e-8  # gap of a contact [m]
BEGUN = -2e-9  # gap at which a step ends, as a contact has begun [m]
SUNK = 10 * CLOSED  # no contact gets deeper than this [m]
BEHIND = 2e-4  # what lies deeper than this is no contact: it is on the other side [m]
# A contact of an arc that is as near as this to another one, where the palm ends, is the same: with
# the smallest radius the gap of the other one is less than CLOSED there.
SAME, ALIKE = 1e-4, 0.01  # [m], [rad]
NEAR = 4e-3  # pairs with a larger gap are left out until something has moved by half of it [m]
HALVINGS = 16  # with which a step finds where a mode ends
TRIED = (2.0**-6, 2.0**-16)  # of a step: for so long a mode that follows must hold
SLACK = 2e-5  # of the pace of the surfaces: a speed of the wrong sign that counts as none
ELSEWHERE = 1e-3  # of the pace: motions that differ by less are the same
UNBALANCED = 1e-6  # [weights]
STEEPEST = math.radians(89.0)  # friction angle
FINE = math.radians(0.1)  # to which margins are compared
ALMOST = 1e-4  # the same where a mode begins [weights]

Names = tuple[int, ...]
Mode = tuple[int, ...]


class Rows(NamedTuple):
    """Of each contact: its normal and its tangent as wrenches (moment in sizes of the object), and
    the speed of the surface along both."""

    n: list[tuple[float, float, float]]
    t: list[tuple[float, float, float]]
    vn: list[float]
    vt: list[float]


class SlowWorld:
    """An object among the surfaces of an oracle. `on_both`: it ends where the object leaves one
    palm, or a contact corner what may be used of its palm."""

    def __init__(self, oracle: Oracle, at: Moment, on_both: bool) -> None:
        spec = oracle.spec
        self.at = at
        self.ambiguous_events = 0  # after which other modes are as good
        self._oracle = oracle
        self._last: tuple[Names, Mode] | None = None
        self._weight = np.array([oracle.slope, 1.0, 0.0])
        self._all = pairs_of(oracle)
        self._near: tuple[Moment, list[int]] | None = None
        # How far from the middle of each palm its contact corner may be: inward, outward [m].
        self._reach: list[tuple[float, float]] | None = None
        if on_both:
            self._reach = []
            for palm in spec.palms:
                half, usable = 0.5 * palm.length, 0.5 * min(palm.usable, palm.length)
                self._reach.append((half, math.inf) if palm.stops else (usable, usable))
        own = (0, spec.contact_right if oracle.edges else 0)
        faces = [face.carrier for face in oracle.faces(at)]
        self._own = [faces.index(side) * len(oracle.corners) + own[side] for side in (0, 1)]

    # --- Geometry ---------------------------------------------------------------------------------

    def _contacts(self, at: Moment, of: Any) -> dict[int, Contact]:
        frames = [
            (*at.pivots[side], math.cos(at.palms[side]), OUT[side] * math.sin(at.palms[side]))
            for side in (0, 1)
        ]
        x, y, angle = at.pose
        body = x, y, math.cos(angle), math.sin(angle)
        found = {}
        for i in of:
            pair = self._all[i]
            still = (0.0, 0.0, 1.0, 0.0)
            found[i] = pair.contact(frames[pair.carrier] if pair.carrier < 2 else still, body)
        return found

    def _near_pairs(self, at: Moment) -> list[int]:
        if self._near is None or self._moved(self._near[0], at) > 0.5 * NEAR:
            every = self._contacts(at, range(len(self._all)))
            near = [i for i, c in every.items() if abs(c.gap) < NEAR]
            self._near = at, sorted({*near, *self._own})
        return self._near[1]

    def _moved(self, before: Moment, after: Moment) -> float:
        """How far any two near points have approached each other at most [m]."""
        size = 2 * self._oracle.size
        pose = math.dist(before.pose[:2], after.pose[:2])
        ways = zip(before.pivots, after.pivots, before.palms, after.palms, strict=True)
        palms = max(math.dist(p, q) + size * abs(a - b) for p, q, a, b in ways)
        return pose + size * abs(before.pose[2] - after.pose[2]) + palms

    def _closed(self, contacts: dict[int, Contact]) -> Names:
        """The contacts: where a feature hands over to its neighbour, only one of both."""
        last = self._last[0] if self._last else ()
        near = [i for i, c in contacts.items() if c.within and -BEHIND < c.gap < CLOSED]
        found: list[int] = []
        for i in sorted(near, key=lambda i: (i not in last, abs(contacts[i].gap))):
            if not any(self._are_same(i, k, contacts) for k in found):
                found.append(i)
        return tuple(sorted(found))

    def _at_one_point(self, i: int, k: int, contacts: dict[int, Contact]) -> bool:
        near = math.dist(contacts[i].point, contacts[k].point) < SAME
        return near and self._all[i].carrier == self._all[k].carrier

    def _are_faces(self, i: int, k: int) -> bool:
        return all(isinstance(self._all[one], CornerOnFace) for one in (i, k))

    def _are_same(self, i: int, k: int, contacts: dict[int, Contact]) -> bool:
        alike = math.dist(contacts[i].normal, contacts[k].normal) < ALIKE
        return alike and self._at_one_point(i, k, contacts)

    def _off_palm(self, contacts: dict[int, Contact], at: Moment) -> bool:
        """Whether a contact corner has left what may be used of its palm."""
        if self._reach is None:
            return False
        for side, i in enumerate(self._own):
            (x, y), (px, py), angle = contacts[i].point, at.pivots[side], at.palms[side]
            place = OUT[side] * (x - px) * math.cos(angle) + (y - py) * math.sin(angle)
            inward, outward = self._reach[side]
            if contacts[i].gap < CLOSED and not -inward < place < outward:
                return True
        return False

    # --- Modes ------------------------------------------------------------------------------------

    def _rows(self, names: Names, contacts: dict[int, Contact], at: Moment) -> Rows:
        x, y, _ = at.pose
        size = self._oracle.size
        rows = Rows([], [], [], [])
        for i in names:
            (px, py), (nx, ny) = contacts[i].point, contacts[i].normal
            rx, ry = px - x, py - y
            rows.n.append((nx, ny, (rx * ny - ry * nx) / size))
            rows.t.append((ny, -nx, -(rx * nx + ry * ny) / size))
            vx = vy = 0.0
            if (side := self._all[i].carrier) < 2:
                spin = OUT[side] * self._turns[side]
                vx = self._by[side][0] - spin * (py - at.pivots[side][1])
                vy = self._by[side][1] + spin * (px - at.pivots[side][0])
            rows.vn.append(vx * nx + vy * ny)
            rows.vt.append(vx * ny - vy * nx)
        return rows

    def _rays(
        self, names: Names, mode: Mode, rows: Rows, leans: tuple[float, ...] = (0.0, 0.0, 0.0)
    ) -> np.ndarray:
        """The wrenches of the forces that balance; `leans`: with the friction angles of the
        surfaces of each carrier greater by so much."""
        n, t = np.array(rows.n), np.array(rows.t)
        pairs = [self._all[i] for i in names]
        angles = [math.atan(pair.friction) + leans[pair.carrier] for pair in pairs]
        frictions = [math.tan(min(max(angle, 0.0), STEEPEST)) for angle in angles]
        rays = [
            n[k] + sign * frictions[k] * t[k]
            for k, how in enumerate(mode)
            for edge, sign in ((_UP, -1.0), (_DOWN, 1.0))
            if how in (edge, _STICK)
        ]
        return np.array(rays)

    def _is_balanced(self, rays: np.ndarray, most: float) -> bool:
        return len(rays) > 0 and bool(nnls(rays.T, self._weight)[1] < most)

    def _twist(self, names: Names, mode: Mode, contacts: dict[int, Contact], at: Moment) -> Any:
        """Of the object in this mode, its turn in sizes; None: there is none."""
        rows = self._rows(names, contacts, at)
        left, right, sticks, touches = [], [], 0, 0
        for k, how in enumerate(mode):
            if how != _BREAK:
                touches += 1
                left.append(rows.n[k])
                right.append(rows.vn[k])
            if how == _STICK:
                sticks += 1
                left.append(rows.t[k])
                right.append(rows.vt[k])
        if len(left) < 2:
            return None
        equations, values = np.array(left), np.array(right)
        twist, _, rank, _ = np.linalg.lstsq(equations, values, rcond=1e-7)
        slack = SLACK * self._pace
        if len(left) > rank and np.abs(equations @ twist - values).max() > slack:
            return None
        if rank == touches == 2 and sticks == 0:
            twist = self._balanced(names, mode, at, twist, np.cross(left[0], left[1]))
        elif rank < 3:
            return None
        if twist is None:
            return None
        x, y, turn = twist.tolist()
        for k, how in enumerate(mode):
            a, b, c = rows.n[k] if how == _BREAK else rows.t[k]
            speed = a * x + b * y + c * turn
            if how == _BREAK:
                # A corner at a corner may leave one edge without being in front of it, but not one
                # of the two faces between which it is.
                doubled = any(
                    i != names[k]
                    and self._at_one_point(i, names[k], contacts)
                    and not self._are_faces(i, names[k])
                    for i in names
                )
                if speed < rows.vn[k] - slack and not doubled:
                    return None
            slip = speed - rows.vt[k]
            if (how == _UP and slip < -slack) or (how == _DOWN and slip > slack):
                return None
        return twist

    def _balanced(self, names: Any, mode: Mode, at: Moment, twist: Any, along: Any) -> Any:
        """Two contacts that slide leave the object one freedom; then it stays in balance."""
        slides = [how for how in mode if how != _BREAK]
        if self._reach is not None and slides[0] == slides[1]:
            return None  # over both palms in one direction: it falls off

        def drift(way: np.ndarray) -> float:
            off = []
            for t in (-h, h):
                there = self._shifted(at, way, t)
                rows = self._rows(names, self._contacts(there, names), there)
                off.append(np.linalg.det(np.vstack([self._rays(names, mode, rows), self._weight])))
            return float(off[1] - off[0]) / (2 * h)

        h = 1e-6 * self._oracle.size / self._pace
        along = self._pace * along / np.linalg.norm(along)
        own = drift(twist)
        gain = drift(twist + along) - own
        return None if abs(gain) < 1e-9 * self._pace else twist - own / gain * along

    def _holds(self, names: Names, mode: Mode, contacts: Any, at: Moment, most: float) -> Any:
        """The twist in this mode if it is possible and in balance."""
        twist = self._twist(names, mode, contacts, at)
        if twist is None:
            return None
        rays = self._rays(names, mode, self._rows(names, contacts, at))
        if len(rays) == 2:  # it began where another mode had just left the balance
            most = ALMOST
        return twist if self._is_balanced(rays, most) else None

    def _on_both(self, names: Names, mode: Mode) -> bool:
        sides = {self._all[i].carrier for i, how in zip(names, mode, strict=True) if how != _BREAK}
        return {0, 1} <= sides

    def _rank(self, names: Names, mode: Mode) -> tuple[bool, int]:
        return not self._on_both(names, mode), mode.count(_BREAK)

    def _why(self, names: Names, contacts: dict[int, Contact]) -> str:
        """Why there is no motion."""
        stuck = (_STICK,) * len(names)
        if self._reach is not None and not self._on_both(names, stuck):
            return "lifting"
        x, y, _ = self.at.pose
        points = [contacts[i].point for i in names]
        beside = [px - x - self._oracle.slope * (py - y) for px, py in points]
        if all(b < UNBALANCED for b in beside) or all(b > -UNBALANCED for b in beside):
            return "toppled" if self._reach is None else "tipping"
        rays = self._rays(names, stuck, self._rows(names, contacts, self.at))
        if self._is_balanced(rays, UNBALANCED):
            return "jammed"
        return "fell" if self._reach is None else "sliding"

    def _modes(self, names: Names, contacts: dict[int, Contact]) -> Iterator[tuple[Mode, Any]]:
        """Those that are possible and in balance, the best ones first."""
        ways = list(itertools.product(range(3), repeat=len(names)))  # stick, slide, break
        to_mode = (_STICK, _UP, _BREAK)
        ways.sort(key=lambda way: self._rank(names, tuple(to_mode[w] for w in way)))
        for way in ways:
            slides = [k for k, w in enumerate(way) if w == 1]
            # The twist says in which direction each slides; few are so near to zero that both may.
            for directions in itertools.product((_UP, _DOWN), repeat=len(slides)):
                mode = [to_mode[w] for w in way]
                for k, direction in zip(slides, directions, strict=True):
                    mode[k] = direction
                twist = self._holds(names, tuple(mode), contacts, self.at, ALMOST)
                if twist is not None:
                    yield tuple(mode), twist

    # --- Motion -----------------------------------------------------------------------------------

    def _shifted(self, at: Moment, twist: np.ndarray, h: float) -> Moment:
        (lx, ly), (rx, ry) = (
            (p[0] + h * b[0], p[1] + h * b[1]) for p, b in zip(at.pivots, self._by, strict=True)
        )
        left, right = (p + h * turn for p, turn in zip(at.palms, self._turns, strict=True))
        (x, y, angle), (vx, vy, turn) = at.pose, twist.tolist()
        pose = x + h * vx, y + h * vy, angle + h * turn / self._oracle.size
        return Moment(((lx, ly), (rx, ry)), (left, right), pose)

    def _step(
        self, names: Names, mode: Mode, twist: np.ndarray, contacts: Any, h: float
    ) -> tuple[Moment, dict[int, Contact], bool]:
        """Where this mode leads, and whether something ends until then."""
        half = self._shifted(self.at, twist, 0.5 * h)
        middle = self._twist(names, mode, self._contacts(half, names), half)
        end = self._shifted(self.at, twist if middle is None else middle, h)
        # Closes the gaps that the curvature of the motion leaves. A contact that began with a gap
        # keeps it: closing it would press the object into one that is leaving.
        active = tuple(i for i, how in zip(names, mode, strict=True) if how != _BREAK)
        begun = np.array([max(0.0, contacts[i].gap) for i in active])
        for _ in range(2):
            then = self._contacts(end, active)
            n = np.array(self._rows(active, then, end).n)
            gaps = np.array([then[i].gap for i in active]) - begun
            x, y, turn = np.linalg.lstsq(n, -gaps, rcond=1e-7)[0].tolist()
            at, size = end.pose, self._oracle.size
            end = replace(end, pose=(at[0] + x, at[1] + y, at[2] + turn / size))
        then = self._contacts(end, contacts)
        is_event = (
            any(
                c.within and self._sinks(contacts[i].gap, c.gap) and i not in active
                for i, c in then.items()
            )
            or not all(then[i].within for i in active)
            or self._off_palm(then, end)
            or self._holds(names, mode, then, end, UNBALANCED) is None
        )
        return end, then, is_event

    @staticmethod
    def _sinks(before: float, after: float) -> bool:
        """Whether a gap closed, or one that was closed gets deeper: a contact that another one at
        its point replaces, or that rounding moves, may be a little below zero."""
        if before > 0:
            return after < BEGUN
        return before > -2 * SUNK and after < min(-SUNK, before - 1e-3 * CLOSED)

    def _last_mode(self, names: Names, contacts: Any) -> tuple[Mode, np.ndarray] | None:
        """That of the step before, if it still holds."""
        if self._last is None or self._last[0] != names:
            return None
        mode = self._last[1]
        twist = self._holds(names, mode, contacts, self.at, UNBALANCED)
        return None if twist is None else (mode, twist)

    def _margin(self, names: Names, mode: Mode, contacts: Any) -> float:
        """By how much the friction angles of all surfaces may change before forces balance no more,
        to `FINE` [rad]."""
        rows = self._rows(names, contacts, self.at)

        def holds(by: float) -> bool:
            return all(
                self._is_balanced(self._rays(names, mode, rows, signs), UNBALANCED)
                for signs in itertools.product((-by, by), repeat=3)
            )

        steps = np.arange(FINE, STEEPEST, FINE).tolist()
        return next((by for by in steps if not holds(by)), math.inf)

    def _choose(self, names: Names, contacts: Any, h: float) -> tuple[Mode, np.ndarray] | None:
        """The mode that follows: the best one that goes on for a while."""
        found = list(self._modes(names, contacts))
        for share in TRIED:
            best: list[tuple[Mode, np.ndarray]] = []
            for mode, twist in found:
                if best and self._rank(names, mode) != self._rank(names, best[0][0]):
                    break
                known = (np.abs(twist - other).max() < ELSEWHERE * self._pace for _, other in best)
                if any(known) or self._step(names, mode, twist, contacts, share * h)[2]:
                    continue
                best.append((mode, twist))
            if best:
                self.ambiguous_events += len(best) > 1
                best.sort(key=lambda found: _STICK in found[0])
                alike = [found for found in best if (_STICK in found[0]) == (_STICK in best[0][0])]
                if len(alike) == 1:
                    return best[0]
                front = int(sum(way[0] for way in self._by) > 0)
                held = [
                    sum(
                        how == _STICK and self._all[i].carrier == front
                        for i, how in zip(names, mode, strict=True)
                    )
                    for mode, _ in alike
                ]
                margins = [self._margin(names, mode, contacts) for mode, _ in alike]
                first = min(range(len(alike)), key=lambda k: (-margins[k], held[k]))
                return alike[first]
        return None

    def move(self, by: Any, palms: tuple[float, float], pace: float) -> tuple[str, float]:
        """Moves the pivots by these ways [m] and turns the palms to these angles [rad], at constant
        rates, in steps in which no palm moves farther than `pace` [m]. Why it ended early ("": it
        did not), and the share that was done."""
        self._by = [(float(x), float(y)) for x, y in by]
        self._turns = [new - old for new, old in zip(palms, self.at.palms, strict=True)]
        turns = [self._oracle.size * abs(turn) for turn in self._turns]
        self._pace = max(math.hypot(*way) + turn for way, turn in zip(by, turns, strict=True))
        share = pace / max(self._pace, pace)
        done = 0.0
        contacts = self._contacts(self.at, self._near_pairs(self.at))
        while done < 1.0 - 1e-9 and self._pace > 1e-12:
            names = self._closed(contacts)
            if self._off_palm(contacts, self.at):
                return "off-palm", done
            h = min(share, 1.0 - done)
            found = self._last_mode(names, contacts) or self._choose(names, contacts, h)
            if found is None:
                return self._why(names, contacts), done
            mode, twist = found
            if self._reach is not None and not self._on_both(names, mode):
                return "lifting", done
            self._last = names, mode
            end, _, is_event = self._step(names, mode, twist, contacts, h)
            low = 0.0
            for _ in range(HALVINGS if is_event else 0):
                middle = 0.5 * (low + h)
                there, _, is_event = self._step(names, mode, twist, contacts, middle)
                if is_event:
                    h, end = middle, there
                else:
                    low = middle
            self.at = end
            contacts = self._contacts(end, self._near_pairs(end))
            done += h
        return "", 1.0
