# SPDX-License-Identifier: Apache-2.0
"""Random motions of palms with a shape, over a floor or without one, under objects with arcs.

On some floors there are walls or stands, and beside some walls only one palm.

A script lasts 500 control periods. In each of them nothing may sink into anything, and the motion
must be one for which an independent program finds forces (motion_oracle.py). The motions that
follow events are judged, and some of those in between.
"""

import math
from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import palmbots._core as _core
from motion_oracle import FAR, Block, Moment, Oracle
from palmbots.errors import SceneError
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec

PERIODS = 500
PHASE = 25  # periods in which the speeds stay the same
SAMPLED = 40  # periods, of which one is judged even if nothing changes
PARTS = 8  # in which a period with an event is made again
SUNK = 1e-6  # [m]
BALANCED = 2e-3  # [weights]: the poses of a motion are those at its ends
MOST_PIECES = 200  # of a period: a step that gives up

BOX = [[0, 0], [0.25, 0], [0.25, 0.16], [0, 0.16]]
LEANING = [[0, 0], [0.25, 0], [0.28, 0.1], [-0.03, 0.1]]
NARROWER = [[0, 0], [0.25, 0], [0.2, 0.12], [0.05, 0.12]]
SIX = [[0, 0], [0.22, 0], [0.25, 0.05], [0.25, 0.12], [-0.03, 0.12], [-0.03, 0.05]]
PIPE = {"object.box_m": [0.16, 0.16], "object.edge_radius_m": 0.08, "palm.length_m": 0.08,
        "palm.shallow_deg": 45, "palm.steep_deg": 50}  # fmt: skip


@dataclass
class Found:
    """What a number of scripts showed."""

    ends: Counter[str] = field(default_factory=Counter)
    moved: int = 0
    checked: int = 0  # motions
    events: int = 0  # that begin within a period
    judged_events: int = 0  # with the motion that followed in the same period
    worst_depth_m: float = -math.inf
    worst_imbalance: float = 0.0
    faults: list[str] = field(default_factory=list)


def things_on_floor(
    rng: np.random.Generator, end: tuple[float, float]
) -> tuple[dict[str, Any], list[Block], list[bool]]:
    """Keys of random walls and stands around an object between these ends, what they are, and
    whether there is a palm on each side."""
    keys: dict[str, Any] = {}
    blocks: list[Block] = []
    palms = [True, True]
    kind = rng.random()
    friction = float(rng.choice([0.1, 0.3, 0.5]))
    if 0.4 < kind < 0.75:  # a wall
        side = int(rng.integers(2))
        x = end[side] + (-1, 1)[side] * float(rng.uniform(0.0005, 0.02))
        height = float(rng.choice([0.01, 0.03, math.inf]))
        wall = {"at_m": x, "friction": friction, "height_m": height}
        if height == math.inf:
            del wall["height_m"]
        keys["floor.walls"] = [wall]
        ends = (-FAR, x) if side == 0 else (x, FAR)
        blocks.append(Block(*ends, min(height, FAR), friction))
        palms[side] = bool(rng.random() < 0.3)
    elif kind >= 0.75:  # the object stands on a stand, or beside one
        if rng.random() < 0.75:
            low, high = -float(rng.uniform(0.005, 0.2)), float(rng.uniform(0.005, 0.2))
        else:
            low = end[1] + float(rng.uniform(0.0005, 0.02))
            high = low + float(rng.uniform(0.01, 0.1))
        height = float(rng.choice([0.005, 0.02, 0.05]))
        keys["floor.stands"] = [
            {"from_m": low, "to_m": high, "height_m": height, "friction": friction}
        ]
        blocks.append(Block(low, high, height, friction))
    return keys, blocks, palms


def world_of(
    rng: np.random.Generator, limits: tuple[float, float] | None = None
) -> tuple[_core.World, Oracle, bool]:
    """A random object on two random palms, or beside them on a floor; `limits` are those of the
    forces of the robots [weights]."""
    on_floor = bool(rng.random() < 0.6)
    floor = float(rng.choice([0.15, 0.3, 0.6])) if on_floor else None
    thick = float(rng.choice([0.0, 0.0015, 0.003]))
    nose = thick if thick == 0 or rng.random() < 0.5 else 0.0003
    keys: dict[str, Any] = {
        "palm.left.friction": float(rng.choice([0.1, 0.2, 0.3, 0.45])),
        "palm.right.friction": float(rng.choice([0.15, 0.3, 0.4])),
        "palm.thickness_m": thick,
        "palm.heel_m": float(rng.choice([0.0, 0.012])),
        "task.slope_deg": float(rng.choice([0.0, rng.uniform(-2, 2)])),
    }
    if nose < thick:
        keys |= {"palm.nose_m": nose, "palm.bevel_m": 0.008}
    if not on_floor and rng.random() < 0.15:
        keys |= PIPE
    else:
        shape = (BOX, LEANING, NARROWER, SIX)[rng.integers(4)]
        radius = rng.choice([0.0, 0.003, 0.012, 0.02])
        low, high = float(radius), float(rng.choice([0.0, radius]))
        keys |= {
            "object.vertices_m": shape,
            "object.edge_radius_m": [low, low, *[high] * (len(shape) - 2)],
            "palm.pivot_offset_m": float(rng.choice([0.0, 0.01])),
        }
    scene = load_scene("paper", keys)
    blocks: list[Block] = []
    palms_there = [True, True]
    spec = to_spec(scene)
    ends = [x - spec.com_left for x, _ in spec.silhouette]
    if floor is not None and limits is None:
        things, blocks, palms_there = things_on_floor(rng.spawn(1)[0], (min(ends), max(ends)))
        spec = to_spec(load_scene(scene, {"floor.friction": floor, **things}))
    elif floor is not None:
        spec.floor_friction = floor
    if limits is not None:
        robots = spec.robots
        for robot, limit in zip(robots, limits, strict=True):
            robot.motor_limit = limit
        spec.robots = robots
    world = _core.World(spec, on_floor)
    if on_floor:
        world.set_phase("by_hand")
        angles = np.radians(rng.uniform(2, 30, 2)).tolist()
        level = max(
            (b.height for b in blocks if b.low < spec.com_right and b.high > -spec.com_left),
            default=0.0,
        )
        pivots = []
        for side, (out, end) in enumerate(zip((-1, 1), (min(ends), max(ends)), strict=True)):
            palm, angle = spec.palms[side], angles[side]
            arm = palm.length / 2 * math.cos(angle) + palm.offset * math.sin(angle)
            gap = float(rng.uniform(0.0005, 0.01))
            away = gap + arm if palms_there[side] else FAR
            pivots.append((end + out * away, level + palm.lowest_pivot(angle)))
        low = min(y for _, y in spec.silhouette)
        high = level + spec.com_height - low
        world.put((pivots[0], pivots[1]), (angles[0], angles[1]), (0.0, high), 0.0)
    return world, Oracle(spec, floor, blocks), on_floor


class Drive:
    """Random motions of both palms, constant for some periods."""

    def __init__(self, rng: np.random.Generator, on_floor: bool) -> None:
        self._rng, self._on_floor = rng, on_floor
        self._goal = [0.0, 0.0]
        self._speeds = [(0.0, 0.0), (0.0, 0.0)]
        self._rate = 0.0

    def next(self, k: int, palms: tuple[float, float]) -> tuple[Any, tuple[float, float]]:
        """The way of each pivot in a period, and the palm angles after it."""
        rng = self._rng
        if k % PHASE == 0:
            inward = 4e-4 if self._on_floor else 0.0
            rise = 3e-4 if self._on_floor and rng.random() < 0.3 else 0.0
            self._speeds = [
                (float(rng.normal(-out * inward, 3e-4)), float(rng.normal(0.0, rise)))
                for out in (-1, 1)
            ]
            self._rate = math.radians(0.3) if rng.random() < 0.5 else 0.0
            steep = rng.random() < 0.2
            self._goal = np.radians(rng.uniform(-10, 80 if steep else 25, 2)).tolist()
        turned = [
            angle + max(-self._rate, min(self._rate, goal - angle))
            for angle, goal in zip(palms, self._goal, strict=True)
        ]
        return (self._speeds[0], self._speeds[1]), (turned[0], turned[1])


class Judge:
    """Looks for the forces of motions of a script."""

    def __init__(self, seed: int, oracle: Oracle, found: Found) -> None:
        self._seed, self._oracle, self._found = seed, oracle, found

    def has_forces(self, k: int, before: Moment, after: Moment) -> bool:
        """Judges the motion of period `k`; False: it is too small to be judged."""
        rest = self._oracle.imbalance(before, after)
        if rest is None:
            return False
        self._found.checked += 1
        self._found.worst_imbalance = max(self._found.worst_imbalance, rest)
        if rest > BALANCED:
            self._found.faults.append(f"seed {self._seed}, period {k}: no forces, {rest:.3g}")
        return True

    def events(self, k: int, world: _core.World, by: Any, palms: tuple[float, float]) -> None:
        """Makes the motion of period `k` in parts; judges the first whole part after each event."""
        first, here = world.palms, Moment.of(world)
        follows = False
        for part in range(1, PARTS + 1):
            share = part / PARTS
            left, right = (a + share * (b - a) for a, b in zip(first, palms, strict=True))
            (lx, ly), (rx, ry) = by
            parts = ((lx / PARTS, ly / PARTS), (rx / PARTS, ry / PARTS))
            reason, *_, pieces = world.move(parts, (left, right))
            before, here = here, Moment.of(world)
            if reason:
                return
            if pieces > 1:
                self._found.events += 1
                follows = True
            elif follows and self.has_forces(k, before, here):
                self._found.judged_events += 1
                follows = False


def run(seed: int, found: Found) -> None:
    """One script, to its end."""
    rng = np.random.default_rng(seed)
    try:
        world, oracle, on_floor = world_of(rng)
    except SceneError:  # arcs that need more than an edge, or a palm too steep for its friction
        found.ends["refused"] += 1
        return
    if not on_floor and world.check():
        found.ends["not held at first"] += 1
        return
    drive, judge = Drive(rng, on_floor), Judge(seed, oracle, found)
    end = "completed"
    here = Moment.of(world)
    moments: list[Moment] = []  # after each period
    mode: Any = None
    follows = False
    for k in range(PERIODS):
        twin = world.copy()
        by, palms = drive.next(k, world.palms)
        reason, _, *motion, pieces = world.move(by, palms)
        before, here = here, Moment.of(world)
        moments.append(here)
        last, mode = mode, (world.constraints, motion)
        if pieces > 1:
            judge.events(k, twin, by, palms)
        elif not reason and (follows or mode != last or k % SAMPLED == 0):
            judge.has_forces(k, before, here)
        follows = pieces > 1
        if reason:
            gave_up = reason == "jammed" and pieces > MOST_PIECES
            end = "gave up" if gave_up else reason
            break
    found.moved += len(moments)
    depths = oracle.deepest(moments)
    found.worst_depth_m = max(found.worst_depth_m, float(depths.max()))
    for k in np.flatnonzero(depths > SUNK):
        found.faults.append(f"seed {seed}, period {k}: sunk {1e6 * depths[k]:.3g} um")
    found.ends[end] += 1
