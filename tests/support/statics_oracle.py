# SPDX-License-Identifier: Apache-2.0
"""Independent oracles for the mechanics: nothing here is shared with the code under test.

Contact positions come from palm angles and coordinates by plane geometry, equilibrium is a linear
program over the generators of the friction cones (HiGHS, through scipy), kinematics is numerical.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.optimize import linprog

from batched_lp import Program, least_costs

STICK, UP, DOWN = "stick", "up", "down"
MODES = list(product((STICK, UP, DOWN), (STICK, UP, DOWN)))
OFF_BY = 1e-7  # HiGHS's tolerance


@dataclass(frozen=True)
class State:
    """One state of two palms and an object; lengths in m, angles in rad, weight 1."""

    width: float
    com: tuple[float, float]
    theta: tuple[float, float]
    p: tuple[float, float]
    friction: tuple[float, float]
    offset: tuple[float, float] = (0.0, 0.0)
    slope: float = 0.0

    def arguments(self) -> dict[str, float]:
        """As `palmbots.contact_modes_batch` takes it."""
        return {
            "width": self.width,
            "com_x": self.com[0],
            "com_y": self.com[1],
            "theta_left": self.theta[0],
            "theta_right": self.theta[1],
            "p_left": self.p[0],
            "p_right": self.p[1],
            "friction_left": self.friction[0],
            "friction_right": self.friction[1],
            "offset_left": self.offset[0],
            "offset_right": self.offset[1],
            "slope": self.slope,
        }

    def rise(self) -> float:
        """Height of the right contact above the left one."""
        heights = [
            p * math.sin(t) + o * math.cos(t)
            for p, t, o in zip(self.p, self.theta, self.offset, strict=True)
        ]
        return heights[1] - heights[0]

    def points(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Left contact, right contact and COM, with the left contact as origin."""
        tilt = math.asin(self.rise() / self.width)
        along = np.array([math.cos(tilt), math.sin(tilt)])
        across = np.array([-math.sin(tilt), math.cos(tilt)])
        return np.zeros(2), self.width * along, self.com[0] * along + self.com[1] * across

    def generators(self, side: int, mode: str) -> list[np.ndarray]:
        """The force directions a contact can have in a mode: edges of its cone."""
        phi = math.atan(self.friction[side])
        inward = 1.0 if side == 0 else -1.0
        leans = {STICK: (-phi, phi), UP: (phi,), DOWN: (-phi,)}[mode]
        return [
            np.array(
                [inward * math.sin(self.theta[side] + lean), math.cos(self.theta[side] + lean)]
            )
            for lean in leans
        ]

    def balance(self, mode: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
        """Equations A x = b for the shares x ≥ 0 of all generators: forces and moment."""
        left, right, com = self.points()
        weight = np.array([-self.slope, -1.0])
        columns = []
        for side, at in ((0, left), (1, right)):
            for force in self.generators(side, mode[side]):
                columns.append([*force, at[0] * force[1] - at[1] * force[0]])
        moment = com[0] * weight[1] - com[1] * weight[0]
        return np.array(columns).T, -np.array([*weight, moment])

    def feasible(self, mode: tuple[str, str]) -> bool:
        """Whether the contact mode balances, by linear programming."""
        matrix, wanted = self.balance(mode)
        found = linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=wanted, method="highs")
        return found.status == 0

    def squeeze(self, side: int) -> tuple[float, float] | None:
        """Least and greatest mean squeeze that this contact alone allows; None: none at all.

        The other contact may push in any direction.
        """
        free = [np.array(d) for d in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))]
        own = self.generators(side, STICK)
        points = self.points()
        forces = [(f, side) for f in own] + [(f, 1 - side) for f in free]
        columns = [[*f, points[s][0] * f[1] - points[s][1] * f[0]] for f, s in forces]
        matrix = np.array(columns).T
        weight = np.array([-self.slope, -1.0])
        moment = points[2][0] * weight[1] - points[2][1] * weight[0]
        wanted = -np.array([*weight, moment])
        # Mean of the two inward forces: (x of left − x of right) / 2.
        cost = np.array([0.5 * f[0] * (1 if s == 0 else -1) for f, s in forces])
        ends = []
        for sign in (1, -1):
            found = linprog(sign * cost, A_eq=matrix, b_eq=wanted, method="highs")
            if found.status == 2:
                return None
            ends.append(-sign * math.inf if found.status == 3 else sign * found.fun)
        return ends[0], ends[1]


def balanced_modes(states: Sequence[State]) -> list[set[tuple[str, str]]]:
    """The modes of each state that balance, by linear programming, all states at once.

    The forces and the moment that a mode leaves missing may not exceed what HiGHS allows an
    equation to be off by.
    """
    missing = np.hstack([np.eye(3), -np.eye(3)])
    programs = []
    for state in states:
        for mode in MODES:
            matrix, wanted = state.balance(mode)
            n = matrix.shape[1]
            cost = np.r_[np.zeros(n), np.ones(6)]
            a = np.hstack([matrix, missing])
            programs.append(Program(cost, a, wanted, [(0, None)] * (n + 6)))
    least = least_costs(programs)
    return [{mode for mode in MODES if next(least) <= OFF_BY} for _ in states]


def random_state(rng: np.random.Generator) -> State:
    """Any state: φ on either side of θ, negative angles, offsets, slopes, COM anywhere."""
    while True:
        width = rng.uniform(0.05, 0.5)
        state = State(
            width=width,
            com=(width * rng.uniform(-0.2, 1.2), rng.uniform(-0.05, 0.2)),
            theta=tuple(np.radians(rng.uniform(-10, 35, 2))),
            p=tuple(rng.uniform(-0.075, 0.075, 2)),
            friction=tuple(rng.uniform(0.05, 1.0, 2)),
            offset=tuple(rng.choice([0.0, 0.01], 2)),
            slope=float(rng.choice([0.0, rng.uniform(-0.2, 0.2)])),
        )
        if abs(state.rise()) < 0.9 * width:
            return state
