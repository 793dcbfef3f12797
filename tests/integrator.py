"""An independent, slow world: tiny steps, linear algebra, root finding.

Shares nothing with the core: at every step it solves the balance of forces and moments with one
contact on an edge of its cone, for each contact, and slides the one that lets go first.
"""

import math

import numpy as np
from scipy.optimize import root_scalar


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

    def points(self, p=None) -> tuple[np.ndarray, np.ndarray]:
        p = self.p if p is None else p
        found = []
        for side, pivot in ((0, 0.0), (1, self.separation)):
            out = -1.0 if side == 0 else 1.0
            t = self.theta[side]
            along = np.array([out * math.cos(t), math.sin(t)])
            normal = np.array([-out * math.sin(t), math.cos(t)])
            found.append(np.array([pivot, 0.0]) + p[side] * along + self.offset[side] * normal)
        return found[0], found[1]

    def length(self, p=None) -> float:
        left, right = self.points(p)
        return float(np.linalg.norm(right - left))

    def squeeze_at(self, side: int, closing: bool) -> float:
        """The inward force at which a contact lets go: it is on its cone's edge."""
        left, right = self.points()
        along = (right - left) / np.linalg.norm(right - left)
        com = left + self.com[0] * along + self.com[1] * np.array([-along[1], along[0]])
        phi = math.atan(self.friction[side])
        lean = self.theta[side] + (phi if closing else -phi)
        inward = 1.0 if side == 0 else -1.0
        edge = np.array([inward * math.sin(lean), math.cos(lean)])
        own, partner = (left, right) if side == 0 else (right, left)
        # Unknown: size of the force on the edge, and the two parts of the other force.
        matrix = np.zeros((3, 3))
        matrix[:2, 0] = edge
        matrix[2, 0] = own[0] * edge[1] - own[1] * edge[0]
        matrix[:, 1] = [1.0, 0.0, -partner[1]]
        matrix[:, 2] = [0.0, 1.0, partner[0]]
        size = np.linalg.solve(matrix, [0.0, 1.0, com[0]])[0]
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

            def excess(value: float, slider: int = slider) -> float:
                p = list(self.p)
                p[slider] = value
                return self.length(p) - self.width

            near = self.p[slider]
            bracket = (near - 0.02, near + 0.02)
            self.p[slider] = root_scalar(excess, bracket=bracket, xtol=1e-14).root
