# SPDX-License-Identifier: Apache-2.0
"""Random scripts for the quasistatic world, and whether mechanics force the end of one.

A script moves the robots and turns the palms, at and below 0° included, under objects of many
shapes. One end is a definition: a contact vertex leaves its palm. Every other end must be forced:
the slow world (slow_world.py) does not carry on there either.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

import palmbots as pb
import palmbots._core as _core
from motion_oracle import Oracle
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import contact_radii, to_spec
from script_ends import Course, End

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

Move = tuple[float, float, float]  # change of the separation [m], angles of the palms [°]


@dataclass(frozen=True)
class Script:
    thing: dict[str, Any]
    keys: dict[str, Any]
    moves: list[Move]


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

    def course(self, script: Script) -> Course:
        if self._keys is not script.keys:
            self._keys, self._spec = script.keys, to_spec(load_scene(script.thing, script.keys))
        moves = [
            (((-change / 2, 0.0), (change / 2, 0.0)), (math.radians(left), math.radians(right)))
            for change, left, right in script.moves
        ]
        return Course(_core.World(self._spec), Oracle(self._spec, None), True, moves)

    def end(self, script: Script) -> End | None:
        """How the script ends early; None if it does not, or if the object is not held at first."""
        course = self.course(script)
        end = course.exact() if course.is_held else None
        return end if end is not None and end.reason else None
