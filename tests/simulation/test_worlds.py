# SPDX-License-Identifier: Apache-2.0
"""The registry of worlds: a world from outside the package, and what worlds refuse."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import BySide
from palmbots.errors import PalmbotsError, SceneError
from palmbots.simulation import quasistatic
from palmbots.simulation.prepare import Prepared, prepare
from palmbots.simulation.worlds import (
    WorldEntry,
    WorldRun,
    register_world,
    unregister_world,
    world_entry,
    world_names,
)

ADDED = {"units": "K", "long_name": "a constant", "log_field": "dynamics/constant_k"}


def run_warm(prepared: Prepared, seed: int, *, record: bool = False, **options: Any) -> WorldRun:
    """The quasistatic world, with one variable more."""
    run = quasistatic.run(prepared, seed, record=record)
    ticks = len(run.measured.trace["time_s"]) if record else 0
    return WorldRun(
        run.measured,
        warnings=("it is warm",),
        lateral_peak_m=(0.25, 0.5),
        trace={"constant": (np.full((ticks, 2), 300.0), ADDED)},
    )


WARM = WorldEntry("warm", "constant temperature", run=run_warm, trace_variables={"constant": ADDED})


@pytest.fixture
def warm() -> Iterator[str]:
    register_world("warm", f"{__name__}:WARM")
    yield "warm"
    unregister_world("warm")


def test_world_from_outside_the_package_carries(warm: str) -> None:
    carry = pb.carry("paper", world=warm, seed=3)
    known = pb.carry("paper", seed=3)
    assert carry.world == warm
    assert carry.trace_hash == known.trace_hash
    assert carry.warnings[-1] == "it is warm"
    assert carry.lateral_peak_m == BySide(0.25, 0.5)
    assert carry.trace is not None
    assert carry.trace["constant"].attrs == ADDED
    assert (carry.trace["constant"] == 300.0).all()
    assert warm in carry.headline()


def test_unregistered_world_is_refused(warm: str) -> None:
    unregister_world(warm)
    with pytest.raises(PalmbotsError, match=r"world: value is .warm.*allowed: quasistatic, mujoco"):
        pb.carry(world=warm)


def test_worlds_of_the_package_are_registered() -> None:
    assert world_names()[:2] == ("quasistatic", "mujoco")
    assert world_entry("quasistatic").precisions == ("double", "float")
    assert world_entry("mujoco").precisions == ("double",)


def test_world_without_single_precision_refuses_it(warm: str) -> None:
    with pytest.raises(PalmbotsError, match=r"precision \(world warm\): value is .float.*double"):
        pb.carry(world=warm, precision="float")


def test_curved_path_is_refused_with_the_worlds_that_support_it(warm: str) -> None:
    curved = pb.load_scene(
        "paper", {"task.path": {"kind": "arc", "radius_m": 3.0, "angle_deg": 30}}
    )
    for world in ("quasistatic", warm):
        words = f"task.path.kind: .*the {world} world.* planar; .*--world mujoco"
        with pytest.raises(SceneError, match=words):
            prepare(curved, "distributed", world)
    assert prepare(curved, "distributed", "mujoco").spec.distance == curved.task.distance_m


def test_bumps_are_refused_with_the_worlds_that_support_them(warm: str) -> None:
    bumpy = pb.load_scene("paper", {"bumps.rate_per_m": 1.0})
    words = "bumps: the mujoco world cannot shift contacts; .*carry --world quasistatic"
    with pytest.raises(SceneError, match=words):
        prepare(bumpy, "distributed", "mujoco")
    with pytest.raises(SceneError, match=r"the warm world cannot"):
        prepare(bumpy, "distributed", warm)
    assert prepare(bumpy, "distributed", "quasistatic").warnings == ()


def test_refusals_come_before_the_carry(warm: str) -> None:
    class Untouched:
        def step(self, seen: Any) -> Any:
            raise AssertionError("a carry has begun")

    with pytest.raises(SceneError):
        pb.carry({"bumps": {"rate_per_m": 1.0}}, Untouched, world=warm)
