# SPDX-License-Identifier: Apache-2.0
"""Random scripts for the quasistatic world, and whether mechanics force the end of one.

A script moves the robots and turns the palms, at and below 0° included, under objects of many
shapes. One end is a definition: a contact vertex leaves its palm. Every other end must be forced:
the slow world (rigid_body_oracle) does not carry on there either.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import palmbots as pb
import palmbots._core as _core
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import contact_radii, to_spec
from rigid_body_oracle import SlowContacts

POINTED = [[0, 0], [0.02, 0.02], [0.23, 0.02], [0.25, 0], [0.25, 0.16], [0, 0.16]]
LID = [[0, 0], [0.25, 0], [0.25, 0.02], [0.35, 0.02], [0.35, 0.1], [-0.1, 0.1], [-0.1, 0.02], [0, 0.02]]  # fmt: skip  # noqa: E501
KEEL = [[0, 0], [0.06, -0.01], [0.25, 0], [0.25, 0.1], [0, 0.1]]
SHARP = [
    name
    for name in pb.object_names()
    if not any(contact_radii(to_spec(load_scene({"object": name}))))
]
"""Built-in objects whose contact vertices are not rounded."""
OBJECTS: list[dict[str, Any]] = [
    *({"object": name} for name in SHARP),
    {"object": {"vertices_m": POINTED, "contacts": [0, 3], "com_m": [0.125, 0.06]}},
    {"object": {"vertices_m": LID, "com_m": [0.125, 0.05]}},
    {"object": {"vertices_m": KEEL, "contacts": [0, 2], "com_m": [0.125, 0.05]}},
]
# Level palms are chosen more often: an edge of the object lies flush on them.
ALL_ANGLES = (-5, -3, -1, 0, 0, 1, 2, 5, 8, 15, 25)
FLAT_ANGLES = (-5, -2, 0, 0, 1, 3, 5)
STEPS = 8
PER_SCENE = 10  # scripts that share a scene: building one takes longer than a script
NEAR = 0.02  # how far the ends in both worlds may differ, as a share of a step

Move = tuple[float, float, float]  # change of the separation [m], angles of the palms [°]


@dataclass(frozen=True)
class Script:
    thing: dict[str, Any]
    keys: dict[str, Any]
    moves: list[Move]


@dataclass(frozen=True)
class End:
    reason: str
    move: int
    fraction: float


def scripts(seed: int, count: int) -> list[Script]:
    rng = np.random.default_rng(seed)
    made: list[Script] = []
    thing: dict[str, Any] = {}
    keys: dict[str, Any] = {}
    for n in range(count):
        if n % PER_SCENE == 0:
            thing = OBJECTS[int(rng.integers(len(OBJECTS)))]
            keys = {
                "palm.friction": float(rng.choice([0.08, 0.15, 0.3, 0.5])),
                "palm.right": {"friction": float(rng.choice([0.2, 0.3, 0.45]))},
                "palm.pivot_offset_m": float(rng.choice([0.0, 0.01])),
                "start.left_m": float(rng.uniform(-0.04, 0.04)),
                "start.right_m": float(rng.uniform(-0.04, 0.04)),
            }
        angles = FLAT_ANGLES if rng.random() < 0.5 else ALL_ANGLES
        made.append(Script(thing, keys, [_move(rng, angles) for _ in range(STEPS)]))
    return made


def _move(rng: np.random.Generator, angles: tuple[float, ...]) -> Move:
    left, right = (float(angle) for angle in rng.choice(angles, 2))
    if left + right == 0:
        right += 3.0  # parallel palms under a level object leave open which contact slides
    return float(rng.choice([0.0, rng.uniform(-0.02, 0.02)])), left, right


class Runner:
    """Runs scripts in the quasistatic world; keeps the scene of the script before."""

    def __init__(self) -> None:
        self._keys: dict[str, Any] | None = None
        self._spec: Any = None

    def spec(self, script: Script) -> Any:
        if self._keys is not script.keys:
            self._keys, self._spec = script.keys, to_spec(load_scene(script.thing, script.keys))
        return self._spec

    def end(self, script: Script) -> End | None:
        """How the script ends early; None if it does not, or if the object is not held at first."""
        world = _core.World(self.spec(script))
        if world.check():
            return None
        for k, (change, left, right) in enumerate(script.moves):
            reason, fraction, *_ = world.advance(change, (math.radians(left), math.radians(right)))
            if reason:
                return End(reason, k, fraction)
        return None

    def is_forced(self, script: Script, end: End) -> bool:
        """Whether the slow world ends there too.

        It takes what is nearer than a step for a contact, so it may continue where an opening is
        narrower: then it is asked again with smaller steps in the last move.
        """
        return any(self._slow_end_agrees(script, end, steps) for steps in (200, 2000, 60_000))

    def _slow_end_agrees(self, script: Script, end: End, steps: int) -> bool:
        spec = self.spec(script)
        start = _core.World(spec)
        slow = SlowContacts(spec, start.contacts, start.separation, start.palms)
        for k, (change, left, right) in enumerate(script.moves[: end.move + 1]):
            steps_here = steps if k == end.move else min(steps, 8000)
            done = slow.move(change, (math.radians(left), math.radians(right)), steps_here)
            if done < 1:
                return k < end.move or done <= end.fraction + NEAR
        return end.fraction > 1 - NEAR
