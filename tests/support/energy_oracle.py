# SPDX-License-Identifier: Apache-2.0
"""Where the energy of a motion goes: the work of the surfaces lifts the object or becomes heat.

Poses before and after a short motion show three things independently. Work: forces that balance
the weight halfway, times the ways of the surfaces at the contacts. Potential energy: the way of the
COM. Heat: friction times slip, which is measured along surfaces and outline (places before and
after), not from velocities. Only if the poses belong to one motion with such forces does the sum
vanish, up to the curvature of the motion; one in which it does not is made again in halves.
"""

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import nnls

import palmbots._core as _core
from motion_oracle import BENT, OUT, TOUCHES, Moment, Oracle, cross, dot
from palm_scripts import PERIODS, Drive, world_of
from palmbots.errors import SceneError

STICKS = 1e-11  # slip that is none [m]
MISSING = 3e-5  # of the forces times the ways of the palms: what curvature may explain
# [weights × m]: within 10 µm of where a contact passes from an arc to an edge, the oracle takes
# either for the contact, as both are nearer than TOUCHES.
EITHER = 1e-9
HALVINGS = 10  # of a period: motions with an event that are shorter have no forces of their own
JUMP = 5.0  # by so many times the ways of the palms the object may rise or fall in these
# Where it goes farther, they are halved so often again. Near the end of the poses in which two
# sliding contacts balance, the object moves as the root of the ways: the motion then becomes
# shorter than this [m]. A jump would not.
FAST, SHORT = 9, 3e-6


class Energy(NamedTuple):
    """Of a motion [weights × m]."""

    work: float  # of the surfaces
    gained: float  # potential energy
    heat: float  # of contacts that slide
    forces: float  # sum [weights]

    @property
    def missing(self) -> float:
        return self.work - self.gained - self.heat


@dataclass
class Account:
    """The energy of a number of scripts."""

    motions: int = 0
    events: int = 0
    work: float = 0.0
    gained: float = 0.0
    heat: float = 0.0
    worst: float = 0.0  # missing, as a share of what may be
    longest_jump: float = 0.0  # of the object, in ways of the palms
    faults: list[str] = field(default_factory=list)


def potential(oracle: Oracle, pose: tuple[float, float, float]) -> float:
    """Energy of the object [weights × m]; on a slope it falls towards −x."""
    return pose[1] + oracle.slope * pose[0]


class EnergyOracle:
    """The energy of motions of an object among the surfaces of an oracle."""

    def __init__(self, oracle: Oracle) -> None:
        self.oracle = oracle
        self._last: tuple[Moment, Any] | None = None

    def _seen(self, at: Moment) -> tuple[Any, ...]:
        """Contacts and geometry; those of the end of a motion are those of the next one's start."""
        if self._last is None or self._last[0] != at:
            o = self.oracle
            self._last = at, (o.touches(at), *o.placed(at), o.faces(at), o.tips(at))
        return self._last[1]

    @staticmethod
    def _passed(at: Moment, seen: tuple[Any, ...], name: tuple[Any, ...]) -> float:
        """How far the outline has gone past the surface at a contact, to the right of the normal,
        except for a constant [m]. A rounded corner rolls."""
        _, circles, edges, faces, tips = seen
        kind, surface, feature = name
        if kind == "face":
            face, (centre, radius) = faces[surface], circles[feature]
            turn = at.pose[2]
            if face.carrier < 2:
                turn -= OUT[face.carrier] * at.palms[face.carrier]
            return dot(centre - face.start, -1j * face.normal) + radius * turn
        tip = tips[surface].place
        if kind == "tip":
            return dot(edges[feature].start - tip, 1j * edges[feature].out)
        centre, radius = circles[feature]
        return radius * (at.pose[2] - cmath.phase(tip - centre))

    def of(self, before: Moment, after: Moment) -> Energy | None:
        """None: no contact persists."""
        at = before.between(after)
        first, last = self._seen(before), self._seen(after)
        com, size = complex(*at.pose[:2]), self.oracle.size
        rays: list[list[float]] = []
        parts = []  # of each ray: its size, work and heat per share
        for name, touch in self.oracle.touches(at, BENT).items():
            ends = [seen[0].get(name) for seen in (first, last)]
            if any(one is None or abs(one.gap) > TOUCHES for one in ends):
                continue
            slip = self._passed(after, last, name) - self._passed(before, first, name)
            if name[0] == "arc":  # angles
                round_ = 2 * math.pi * self.oracle.corners[name[2]][1]
                slip -= round_ * round(slip / round_)
            way = 0j
            if (side := touch.carrier) < 2:
                # The point of the palm that is there halfway.
                spin = OUT[side] * (after.palms[side] - before.palms[side])
                way = complex(*np.subtract(after.pivots[side], before.pivots[side]))
                way += 2j * math.sin(0.5 * spin) * (touch.point - complex(*at.pivots[side]))
            right, r = -1j * touch.normal, touch.point - com
            for sign in (-1.0, 1.0):
                if sign * slip > STICKS:
                    continue  # friction opposes slip
                force = touch.normal + sign * touch.friction * right
                rays.append([force.real, force.imag, cross(r, force) / size])
                heat = touch.friction * abs(slip) if abs(slip) > STICKS else 0.0
                parts.append((abs(force), dot(force, way), heat))
        if not rays:
            return None
        shares, _ = nnls(np.array(rays).T, np.array([self.oracle.slope, 1.0, 0.0]))
        forces, work, heat = (float(total) for total in shares @ np.array(parts))
        gained = potential(self.oracle, after.pose) - potential(self.oracle, before.pose)
        return Energy(work, gained, heat, forces)

    def ways(self, before: Moment, after: Moment) -> float:
        """How far the surfaces of both palms move at most [m]."""
        pivots = zip(before.pivots, after.pivots, strict=True)
        turns = zip(before.palms, after.palms, strict=True)
        return sum(math.dist(p, q) for p, q in pivots) + self.oracle.size * sum(
            abs(p - q) for p, q in turns
        )

    def move(
        self, world: _core.World, by: Any, palms: tuple[float, float], into: Account, halvings: int
    ) -> tuple[_core.World, str]:
        """Moves the palms of a world and accounts for the energy. The world then, and why it ended
        early."""
        twin, before = world.copy(), Moment.of(world)
        reason, *_, pieces = world.move(by, palms)
        if reason:
            return world, reason
        after = Moment.of(world)
        ways = self.ways(before, after)
        energy = self.of(before, after) if pieces == 1 else None
        share = math.inf  # of what curvature may explain
        if energy is not None:
            share = abs(energy.missing) / (MISSING * energy.forces * ways + EITHER)
        gained = potential(self.oracle, after.pose) - potential(self.oracle, before.pose)
        is_far = abs(gained) > JUMP * ways
        if share > 1.0 and halvings > (-FAST if is_far else 0):
            (lx, ly), (rx, ry) = by
            half = ((0.5 * lx, 0.5 * ly), (0.5 * rx, 0.5 * ry))
            left, right = (0.5 * (a + b) for a, b in zip(twin.palms, palms, strict=True))
            for angles in ((left, right), palms):
                twin, reason = self.move(twin, half, angles, into, halvings - 1)
                if reason:
                    break
            return twin, reason
        if energy is None and pieces > 1:
            into.events += 1
            into.longest_jump = max(into.longest_jump, abs(gained) / ways)
            if is_far and abs(gained) > SHORT:
                into.faults.append(f"rises by {gained:.2g} m where palms move by {ways:.2g} m")
            return world, ""
        into.motions += 1
        into.worst = max(into.worst, share)
        if energy is None or share > 1.0:
            into.faults.append(f"{before} to {after}: {energy}")
        else:
            into.work += energy.work
            into.gained += energy.gained
            into.heat += energy.heat
        return world, ""


def account_for(
    seed: int,
    into: Account,
    judge: Callable[[Oracle], Oracle] | None = None,
    halvings: int = HALVINGS,
) -> None:
    """One script of palm_scripts.py, to its end; `judge` changes the oracle."""
    rng = np.random.default_rng(seed)
    try:
        world, oracle, on_floor = world_of(rng)
    except SceneError:
        return
    if not on_floor and world.check():
        return
    energy, drive = EnergyOracle(oracle if judge is None else judge(oracle)), Drive(rng, on_floor)
    for k in range(PERIODS):
        first = len(into.faults)
        world, reason = energy.move(world, *drive.next(k, world.palms), into, halvings)
        into.faults[first:] = [f"seed {seed}, period {k}: {one}" for one in into.faults[first:]]
        if reason:
            return
