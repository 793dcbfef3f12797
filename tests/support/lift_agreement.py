# SPDX-License-Identifier: Apache-2.0
"""Random jobs on the floor in both worlds: do they end alike where the end is certain?

.venv/bin/python tests/support/lift_agreement.py FROM TO     compares the jobs of these seeds
.venv/bin/python tests/support/lift_agreement.py yaw         bisects the yaw with which jobs succeed

A start has *margin* if in the quasistatic world the job ends alike (success, or what was not
achieved) under each of these changes alone, in both directions, and under `NEARBY` random
combinations of all of them: COM ± 2 mm, friction angles of palms and floor ± 1°, plate ± 0.2 mm,
force limits ± 10 %. The combinations have the noise of another seed, so that either robot may be
the first one, and motions are drawn where contacts permit several. The motors of both
worlds have the same force limit; in MuJoCo the wheels also slip. Jobs that the product refuses, or
would if the robots pushed with 0.9 of their force, are no starts.
"""

import math
import sys
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots.control.registry import resolve
from palmbots.errors import SceneError
from palmbots.mechanics.lifting import check_lift, lifting
from palmbots.mechanics.load_limits import check_load
from palmbots.mujoco.carry_runner import run
from palmbots.mujoco.lift_world import LiftWorld
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_job import floor_job
from palmbots.simulation.prepare import Prepared
from palmbots.simulation.worlds import world_entry
from random_lifts import random_lift

CONTROLLER = "shared-sign"
MOST_YAW_DEG = 2.0
NEARBY = 6
_CHANGES = ("com", "palm", "floor", "plate", "force")
_SHARE = 0.9  # of the force limits
_FIXED = {
    "robot.motor_force_n": 10.0,
    "mujoco.palm_torque_n_m": 1.0,  # wrists that hold the objects at the end of a palm
    "task.distance_m": 0.1,
    "task.timeout_s": 60.0,
}
# The worlds notice at different instants that an object falls.
_KINDS = {"off-palm": "fell", "sliding": "fell", "lifting": "fell", "tipping": "toppled"}


@dataclass(frozen=True)
class Pair:
    """One start in both worlds."""

    seed: int
    yaw_deg: tuple[float, float]
    exact: str
    """``delivered``, or what was not achieved."""
    mujoco: str

    @property
    def agrees(self) -> bool:
        return self.exact == self.mujoco


def end_of(scene: Scene, measured: Any) -> str:
    """``delivered``, or what happened and what was not achieved."""
    missed = floor_job(scene, measured).failure or "delivered"
    return (
        f"{_KINDS.get(measured.reason, measured.reason)}: {missed}" if measured.reason else missed
    )


def exact_end(keys: dict[str, Any], seed: int, name: str = "lift") -> str:
    scene = load_scene(name, keys)
    return end_of(scene, _core.run(to_spec(scene), CONTROLLER, seed, "double", False))


def mujoco_end(
    keys: dict[str, Any], seed: int, yaw_deg: tuple[float, float], name: str = "lift"
) -> str:
    """The same in MuJoCo, where robots stand askew; no check before the start."""
    scene = load_scene(name, keys)
    ready = Prepared(
        scene, resolve(CONTROLLER), world_entry("mujoco"), to_spec(scene), None, warnings=()
    )
    headings = math.radians(yaw_deg[0]), math.radians(yaw_deg[1])
    start = LiftWorld(scene, measures=False, headings=headings)
    return end_of(scene, run(ready, seed, start=start).measured)


def is_possible(keys: dict[str, Any]) -> bool:
    """Whether the product does not refuse the job, also with robots that push less."""
    scene = load_scene("lift", keys)
    try:
        check_load(scene)
        check_lift(scene)
    except SceneError:
        return False
    found = lifting(scene)
    assert found is not None
    return all(
        need <= _SHARE * palm.push_n
        for palm in found.palms.values()
        for need in (palm.squeeze_n, palm.second_n)
    )


def keys_of(seed: int) -> dict[str, Any]:
    return random_lift(seed) | _FIXED


def nearby(keys: dict[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    """The start with all small changes, each at random in one direction or the other."""
    found = keys | {"world.ambiguity": "drawn"}
    for name in _CHANGES:
        found |= changed(keys, name, float(rng.choice((-1.0, 1.0))))
    return found


def changed(keys: dict[str, Any], name: str, way: float) -> dict[str, Any]:
    """The keys that one of the small changes sets, in the direction `way` (1 or −1)."""
    if name == "com":
        x, y = keys["object.com_m"]
        return {"object.com_m": [x + 0.002 * way, y]}
    if name == "plate":
        nose = max(0.0, keys["palm.nose_m"] + 0.0002 * way)
        return {
            "palm.nose_m": nose,
            "palm.thickness_m": max(nose, keys["palm.thickness_m"] + 0.0002 * way),
        }
    if name == "force":
        return {"robot.motor_force_n": keys["robot.motor_force_n"] * (1.0 + 0.1 * way)}
    return {f"{name}.friction": turned(keys[f"{name}.friction"], way)}


def turned(friction: float, by_deg: float) -> float:
    return math.tan(math.atan(friction) + math.radians(by_deg))


def start_of(seed: int) -> tuple[dict[str, Any], str] | None:
    """The keys of a start with margin, and its end in the quasistatic world; None: no margin."""
    keys = keys_of(seed)
    rng = np.random.default_rng(seed)
    try:
        if not is_possible(keys):
            return None
        end = exact_end(keys, seed)
        for other in range(seed + 1, seed + 1 + NEARBY):
            if exact_end(nearby(keys, rng), other) != end:
                return None
        for name, way in product(_CHANGES, (-1.0, 1.0)):
            if exact_end(keys | changed(keys, name, way), seed) != end:
                return None
    except SceneError:  # the object does not stand, or a change leads out of a range
        return None
    return keys, end


def yaw_of(seed: int) -> tuple[float, float]:
    left, right = np.random.default_rng(seed).uniform(-MOST_YAW_DEG, MOST_YAW_DEG, 2).tolist()
    return left, right


def compare(seed: int) -> Pair | None:
    """A start in both worlds; None: it has no margin."""
    start = start_of(seed)
    if start is None:
        return None
    keys, end = start
    return Pair(seed, yaw_of(seed), end, mujoco_end(keys, seed, yaw_of(seed)))


def can_start(seed: int) -> bool:
    try:
        return is_possible(keys_of(seed))
    except SceneError:  # the object does not stand
        return False


def largest_yaw_deg(left: float, right: float, seed: int) -> float:
    """The angle, times these factors, by which robots may be askew, to 1° (MuJoCo)."""
    low, high = 2.0, 60.0
    while high - low > 1:
        middle = 0.5 * (low + high)
        end = mujoco_end({"task.distance_m": 0.1}, seed, (left * middle, right * middle))
        low, high = (middle, high) if end == "delivered" else (low, middle)
    return low


def print_largest_yaws() -> None:
    for left, right in ((1.0, 1.0), (1.0, -1.0), (1.0, 0.0)):
        found = [largest_yaw_deg(left, right, seed) for seed in (1, 2, 3)]
        print(f"left {left:g}, right {right:g}:", *(f"{yaw:.1f}°" for yaw in found))


if __name__ == "__main__":
    if sys.argv[1:] == ["yaw"]:
        print_largest_yaws()
        sys.exit()
    first, end = map(int, sys.argv[1:])
    pairs = [compare(seed) for seed in range(first, end) if can_start(seed)]
    certain = [one for one in pairs if one is not None]
    differ = [one for one in certain if not one.agrees]
    print(
        f"{len(pairs)} can begin, {len(certain)} have margin, {len(differ)} differ",
        *differ,
        sep="\n",
    )
