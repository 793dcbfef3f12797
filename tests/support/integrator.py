# SPDX-License-Identifier: Apache-2.0
"""An independent, slow world: tiny steps, a balance of moments, root finding.

Shares nothing with the core: at every step it balances moments with one contact on an edge of its
cone, for each contact, and slides the one that lets go first.
"""

import math

from scipy.optimize import brentq

Point = tuple[float, float]


class SlowWorld:
    """Two palms and an object; lengths in m, angles in rad, x forward, y up."""

    def __init__(self, spec, contacts, separation, palms) -> None:
        self.width = spec.width
        self.com = (spec.com_left, spec.com_height)
        self.friction = [palm.friction for palm in spec.palms]
        self.offset = [palm.offset for palm in spec.palms]
        self.p = list(contacts)
        self.separation = separation
        self.theta = list(palms)

    def point(self, side: int, p: float) -> Point:
        """Where a palm's contact is."""
        pivot, out = (0.0, -1.0) if side == 0 else (self.separation, 1.0)
        sin, cos, offset = math.sin(self.theta[side]), math.cos(self.theta[side]), self.offset[side]
        return pivot + out * (p * cos - offset * sin), p * sin + offset * cos

    def points(self) -> tuple[Point, Point]:
        return self.point(0, self.p[0]), self.point(1, self.p[1])

    def length(self) -> float:
        return math.dist(*self.points())

    def squeeze_at(self, side: int, closing: bool) -> float:
        """The inward force at which a contact lets go: it is on its cone's edge."""
        left, right = self.points()
        length = math.dist(left, right)
        along = ((right[0] - left[0]) / length, (right[1] - left[1]) / length)
        com_x = left[0] + self.com[0] * along[0] - self.com[1] * along[1]
        phi = math.atan(self.friction[side])
        lean = self.theta[side] + (phi if closing else -phi)
        inward = 1.0 if side == 0 else -1.0
        edge = (inward * math.sin(lean), math.cos(lean))
        own, partner = (left, right) if side == 0 else (right, left)
        # Moments about the partner's contact, where its force has none: unknown is the size of the
        # force on the edge.
        arm = (own[0] - partner[0], own[1] - partner[1])
        size = (com_x - partner[0]) / (arm[0] * edge[1] - arm[1] * edge[0])
        return size * math.sin(lean)

    def move(self, change: float, palms: tuple[float, float], steps: int) -> None:
        """Changes the separation and turns the palms, in many small steps."""
        rates = [(new - old) / steps for new, old in zip(palms, self.theta, strict=True)]
        for _ in range(steps):
            self.separation += change / steps
            self.theta = [t + r for t, r in zip(self.theta, rates, strict=True)]
            gap = self.length() - self.width
            if abs(gap) < 1e-15:
                continue
            closing = gap < 0
            lets_go = [self.squeeze_at(side, closing) for side in (0, 1)]
            slider = int(lets_go[0] > lets_go[1]) if closing else int(lets_go[0] < lets_go[1])
            held = self.point(1 - slider, self.p[1 - slider])

            def excess(p: float, slider: int = slider, held: Point = held) -> float:
                return math.dist(self.point(slider, p), held) - self.width

            near = self.p[slider]
            self.p[slider] = brentq(excess, near - 0.02, near + 0.02, xtol=1e-14)
