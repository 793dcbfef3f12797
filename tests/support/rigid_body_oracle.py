# SPDX-License-Identifier: Apache-2.0
"""An independent, slow world of many contacts: tiny steps of a free body among segments.

Shares nothing with the core: the object is a pose, contacts are found anew at every step from
plain geometry, and of all ways in which each may stick, slide or break one is taken whose twist
solves the equations of motion (least squares) and whose forces balance (by non-negative ones).
"""

import itertools
import math

import numpy as np
from scipy.optimize import nnls

_STICK, _UP, _DOWN, _BREAK = range(4)
_OUT = (-1.0, 1.0)
FLUSH = 1e-3  # an edge is flush with a plate up to this angle [rad]


class SlowContacts:
    """Lengths in m, angles in rad, x forward, y up; the pose is that of the left contact vertex."""

    def __init__(self, spec, contacts, separation, palms) -> None:
        self.spec = spec
        self.outline = np.array([(x, y) for x, _, y, _ in spec.outline])
        self.separation = separation
        self.theta = list(palms)
        feet = [self._foot(side) + contacts[side] * self._along(side) for side in (0, 1)]
        across = feet[1] - feet[0]
        self.at = feet[0]
        self.turn = math.atan2(across[1], across[0])
        self._last: tuple[tuple, tuple[int, ...]] | None = None

    def _along(self, side: int) -> np.ndarray:
        return np.array([_OUT[side] * math.cos(self.theta[side]), math.sin(self.theta[side])])

    def _normal(self, side: int) -> np.ndarray:
        return np.array([-_OUT[side] * math.sin(self.theta[side]), math.cos(self.theta[side])])

    def _pivot(self, side: int) -> np.ndarray:
        return np.array([side * self.separation, 0.0])

    def _foot(self, side: int) -> np.ndarray:
        return self._pivot(side) + self.spec.palms[side].offset * self._normal(side)

    def _turned(self, points: np.ndarray) -> np.ndarray:
        c, s = math.cos(self.turn), math.sin(self.turn)
        return points @ np.array([[c, s], [-s, c]])

    def vertex(self, side: int) -> tuple[float, float]:
        """Of a contact vertex: its coordinate along its palm and its height above it."""
        corner = np.array([side * self.spec.width, 0.0])
        from_foot = self.at + self._turned(corner) - self._foot(side)
        return float(from_foot @ self._along(side)), float(from_foot @ self._normal(side))

    def _contacts(self, near: float) -> list[tuple[tuple, int, np.ndarray, np.ndarray, float]]:
        """Name, side, point, normal into the object and gap of each contact."""
        corners = self.at + self._turned(self.outline)
        edges = np.roll(corners, -1, axis=0) - corners
        lengths = np.hypot(edges[:, 0], edges[:, 1])
        inward = np.column_stack([-edges[:, 1], edges[:, 0]]) / lengths[:, None]
        before = -np.roll(edges, 1, axis=0)
        # An inner corner touches nothing flat.
        outer = before[:, 0] * edges[:, 1] - before[:, 1] * edges[:, 0] <= 0
        reach = np.hypot(before[:, 0], before[:, 1])
        found = []
        for side in (0, 1):
            foot, along, normal = self._foot(side), self._along(side), self._normal(side)
            half = self.spec.palms[side].length / 2
            gap, place = (corners - foot) @ normal, (corners - foot) @ along
            # The plate's normal must lie in the normal cone of the corner. If an edge of the corner
            # passes below the plate, the palm's tip touches that edge, not the corner.
            above = (edges @ normal >= -FLUSH * lengths) & (before @ normal >= -FLUSH * reach)
            on_plate = outer & above & (abs(gap) < near) & (abs(place) <= half)
            for i in np.flatnonzero(on_plate).tolist():
                found.append((("corner", side, i), side, corners[i], normal, gap[i]))
            for end in (-half, half):
                tip = foot + end * along
                share = ((tip - corners) * edges).sum(axis=1) / lengths
                gap = ((corners - tip) * inward).sum(axis=1)
                touching = (abs(gap) < near) & (share >= 0) & (share <= lengths)
                for i in np.flatnonzero(touching).tolist():
                    found.append((("tip", side, end, i), side, tip, inward[i], gap[i]))
        return found

    def _moves(self, contacts, mode, com, velocity, closing) -> np.ndarray | None:
        """The body's displacement in this mode, or None: (x, y of the COM, turn)."""
        rows, values, least = [], [], []
        for (_, side, point, normal, gap), how in zip(contacts, mode, strict=True):
            tangent = _OUT[side] * np.array([normal[1], -normal[0]])
            r = point - com
            along = [np.array([*d, r[0] * d[1] - r[1] * d[0]]) for d in (normal, tangent)]
            given = velocity(side, point)
            if how == _BREAK:
                least.append((along[0], normal @ given - gap))
                continue
            rows.append(along[0])
            values.append(normal @ given - min(gap, closing))
            if how == _STICK:
                rows.append(along[1])
                values.append(tangent @ given)
            else:
                sign = 1.0 if how == _UP else -1.0
                least.append((sign * along[1], sign * (tangent @ given)))
        if not rows:
            return None
        step, _, rank, _ = np.linalg.lstsq(np.array(rows), np.array(values), rcond=1e-7)
        slack = 1e-3 * closing
        if rank < 3 or np.abs(np.array(rows) @ step - values).max() > slack:
            return None
        return step if all(row @ step >= value - slack for row, value in least) else None

    def _balances(self, contacts, mode, com) -> bool:
        rays = []
        for (_, side, point, normal, _), how in zip(contacts, mode, strict=True):
            tangent = _OUT[side] * np.array([normal[1], -normal[0]])
            for edge, sign in ((_UP, -1.0), (_DOWN, 1.0)):
                if how in (edge, _STICK):
                    force = normal + sign * self.spec.palms[side].friction * tangent
                    r = point - com
                    rays.append([*force, 10 * (r[0] * force[1] - r[1] * force[0])])
        weight = np.array([self.spec.slope, 1.0, 0.0])
        return bool(rays) and nnls(np.array(rays).T, weight)[1] < 1e-6

    def move(self, change: float, palms: tuple[float, float], steps: int) -> float:
        """Changes the separation and turns the palms; the share of it that went well."""
        turns = [(new - old) / steps for new, old in zip(palms, self.theta, strict=True)]
        pace = max(abs(change) / steps, 0.1 * max(map(abs, turns)))
        if pace < 1e-12:
            return 1.0
        com_in = np.array([self.spec.com_left, self.spec.com_height])
        for k in range(steps):
            com = self.at + self._turned(com_in)
            contacts = self._contacts(2 * pace)

            def velocity(side: int, point: np.ndarray) -> np.ndarray:
                r = point - self._pivot(side)
                spin = _OUT[side] * turns[side]
                return np.array([side * change / steps - spin * r[1], spin * r[0]])

            names = tuple(c[0] for c in contacts)
            modes = itertools.product(range(4), repeat=len(contacts))
            ordered = sorted(modes, key=lambda m: m.count(_BREAK))
            if self._last is not None and self._last[0] == names:
                ordered.insert(0, self._last[1])
            for mode in ordered:
                sides = {c[1] for c, how in zip(contacts, mode, strict=True) if how != _BREAK}
                if not self._balances(contacts, mode, com):
                    continue
                step = self._moves(contacts, mode, com, velocity, pace)
                if step is not None:
                    break
            else:
                return k / steps
            if len(sides) < 2:
                return k / steps
            self._last = (names, mode)
            self.separation += change / steps
            self.theta = [t + turn for t, turn in zip(self.theta, turns, strict=True)]
            self.turn += step[2]
            self.at = com + step[:2] - self._turned(com_in)
        return 1.0
