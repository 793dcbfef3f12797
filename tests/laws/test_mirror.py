# SPDX-License-Identifier: Apache-2.0
"""Left and right are mirror images: a mirrored scene gives the mirrored result, to the last bit.

Of every controller, with random values of every key in the core's table, and of every object.
"""

import itertools
import random
import re
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import palmbots as pb
from palmbots.control.registry import controller_names, reference_names, resolve
from palmbots.errors import SceneError
from palmbots.scene.files import built_in_scenes
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.trace import VARIABLES
from palmbots.simulation.worlds import world_names
from random_keys import CARRIED_ROWS, names_in, random_keys
from strategies import scenes

CONTROLLERS = [
    pytest.param(name, marks=pytest.mark.soak) if resolve(name).preparation else name
    for name in controller_names() + reference_names()
]
TURNED = ("speed", "commanded", "midpoint", "object", "object_x", "rest_angle_deg")
"""What changes its sign, in the trace and in JSON; values of both sides change places."""
IMAGES = {"left": "right", "right": "left"}
MOTIONS = {"SL": "SR", "SR": "SL"}
CASES = dict(zip("12345678", "21435687", strict=True))
"""The images of the cases of Table 1; those of Table 2 are of one robot."""


def mirrored(value: Any, key: str = "") -> Any:
    """The mirror image of what JSON has of a result."""
    if isinstance(value, str):
        if key in ("case", "motion"):
            return (CASES if key == "case" else MOTIONS).get(value, value)
        return re.sub("left|right", lambda found: IMAGES[found[0]], value)
    if isinstance(value, dict):
        return {mirrored(name): mirrored(inner, name) for name, inner in value.items()}
    if isinstance(value, list):
        return [mirrored(inner, key) for inner in value]
    return -value if key in TURNED and value is not None else value


def shown(carry: pb.simulation.Carry) -> dict[str, Any]:
    """The result, in an order that does not depend on the sides."""
    result = carry.summary()
    for name in ("scene", "trace_hash"):
        del result[name]
    result["warnings"] = [re.sub(r"-(\d+°)", r"\1", line) for line in result["warnings"]]
    result["corrections"] = [{**one, "label": ""} for one in result["corrections"]]
    result["log"] = [dict.fromkeys(one.__slots__) for one in carry.message_log]
    for one, table in zip(carry.message_log, result["log"], strict=True):
        table.update((name, getattr(one, name)) for name in table)
    return result


def in_order(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: in_order(value[name]) for name in sorted(value)}
    return sorted(map(in_order, value), key=str) if isinstance(value, list) else value


def check(scene: Scene, controller: str, seed: int, precision: Any = "double") -> bool:
    """Whether the carry was possible; AssertionError if its image differs."""
    image = scene.mirrored()
    assert image.mirrored() == scene
    assert to_spec(image.mirrored()).to_bytes() == to_spec(scene).to_bytes()
    try:
        there = pb.carry(scene, controller, seed=seed, precision=precision)
    except SceneError:  # the controller cannot keep its time bounds
        with pytest.raises(SceneError):
            pb.carry(image, controller, seed=seed, precision=precision)
        return False
    back = pb.carry(image, controller, seed=seed, precision=precision)
    assert in_order(shown(there)) == in_order(mirrored(shown(back)))
    assert there.trace is not None and back.trace is not None
    for name in map(str, there.trace.data_vars):
        one, two = there.trace[name].to_numpy(), back.trace[name].to_numpy()
        if "side" in there.trace[name].dims:
            two = two[:, ::-1]
        if name == "case":
            two = np.vectorize(lambda case: CASES.get(case, case), otypes=["U1"])(two)
        np.testing.assert_array_equal(one, -two if name in TURNED else two, err_msg=name)
    return True


@pytest.mark.slow
@pytest.mark.parametrize("controller", CONTROLLERS)
def test_carries_with_every_key(controller: str) -> None:
    """Every key is given for a table with beacons and one with a queue; for the others a few."""
    every = CARRIED_ROWS if controller in ("shared-sign", "distributed") else frozenset()
    draw = random.Random(controller)
    given: set[str] = set()
    done = 0
    for seed in itertools.count():
        keys = random_keys(draw)
        single = seed % 3 == 0 and not resolve(controller).is_reference
        if check(pb.load_scene("paper", keys), controller, seed, "float" if single else "double"):
            given |= set(names_in(keys))
            done += 1
        if done >= 6 and given >= every:
            return


@given(
    scenes(),
    st.sampled_from(controller_names()),
    st.integers(0, 2**64 - 1),
    st.sampled_from(("double", "float")),
)
def test_carries_of_any_scene(scene: Scene, controller: str, seed: int, precision: str) -> None:
    check(scene, controller, seed, precision)


@pytest.mark.slow
@pytest.mark.parametrize("name", built_in_scenes())
def test_carries_of_the_built_in_scenes(name: str) -> None:
    scene = pb.load_scene(name)
    refused = {c for c in controller_names() if not check(scene, c, 3)}
    if scene.task.route.is_set:  # it takes several carries
        assert refused == {*controller_names()}
    else:
        assert refused == ({"resilient"} if name == "pipe" else set())


@pytest.mark.parametrize("name", pb.object_names())
def test_carries_of_every_object(name: str) -> None:
    assert check(pb.load_scene("paper", {"object": name}), "distributed", 3)


def test_carries_that_a_bump_ends() -> None:
    """Both robots are bumped in one tick, and one of the bumps ends the carry."""
    keys = {"robot.noise_m_s": 0.0, "bumps.rate_per_m": 100.0, "bumps.max_shift_m": 0.2}
    for seed in range(50):
        assert check(pb.load_scene("paper", keys), "none", seed)


@pytest.mark.parametrize("world", [name for name in world_names() if name != "quasistatic"])
def test_other_worlds(world: str) -> None:
    """Engines do not compute the same bits, but the same motion."""
    keys = {
        "object.com_m": [0.13, 0.04], "palm.left.friction": 0.4, "robot.right.bias_m_s": 0.002,
        "start.left_m": 0.006, "task.distance_m": 0.1,
    }  # fmt: skip
    scene = pb.load_scene("paper", keys)
    there, back = (pb.carry(one, world=world, seed=3) for one in (scene, scene.mirrored()))
    assert there.outcome == back.outcome
    assert there.trace is not None and back.trace is not None
    for name in set(VARIABLES) - {"case"}:
        one, two = there.trace[name].to_numpy(), back.trace[name].to_numpy()
        if "side" in there.trace[name].dims:
            two = two[:, ::-1]
        assert one == pytest.approx(-two if name in TURNED else two, abs=1e-4), name
