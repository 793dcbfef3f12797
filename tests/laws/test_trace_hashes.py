# SPDX-License-Identifier: Apache-2.0
"""A carry has the same bits alone, in lanes and in any batch, from every compiler and processor.

Of every controller, over random values of every key in the core's table, and over special scenes.
tests/site and tests/firmware test the page and the boards with the same keys.
"""

import importlib
import itertools
import random
import subprocess
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import palmbots as pb
from cxx import program
from palmbots.control import StepInput, StepOutput
from palmbots.control.registry import controller_names, reference_names, resolve, shipped_names
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import OUTCOMES, REASONS, Columns, batch_modules, run_batch
from random_keys import CARRIED_ROWS, names_in, random_keys
from sampled import sampled
from strategies import scenes

PRECISIONS: tuple[Any, ...] = ("double", "float")
RUNS = list(itertools.product(shipped_names(), PRECISIONS))
SLOW = "optimal-stopping"  # is computed for many seconds
POLICIES = Path(__file__).parents[2] / "examples" / "policies"

# GCC with -O3 compiles the extension, so only `make soak` compiles that again.
BUILDS = ["clang++-O3", "g++-O3", *(f"{c}-O{n}" for c in ("clang++", "g++") for n in range(3))]

# Of the scene `paper` with seed 0. They change only if the physics, a controller or the random
# numbers do, and then in a release that says so.
PINNED = {
    ("none", "double"): "44d4f4979032c3fb",
    ("none", "float"): "6497fe6a46b997b6",
    ("centralized", "double"): "48cd0e5e2cc3613c",
    ("centralized", "float"): "4bd524b2e10624ed",
    ("distributed", "double"): "0997afd2f59498e1",
    ("distributed", "float"): "f17f2ca1dcc84385",
    ("resilient", "double"): "cf24fa7e2d29ab7d",
    ("resilient", "float"): "1adb9883c0b1be5a",
    ("silent", "double"): "532a6fea0e4b1dd3",
    ("silent", "float"): "f73fee217a701a47",
    ("shared-sign", "double"): "ff8860048a72abbf",
    ("shared-sign", "float"): "24e63948c34663ee",
}

# Lengths, outcomes and numbers of zones that random keys do not have.
SPECIAL: list[dict[str, Any]] = [
    {},
    {"robot.left.bias_m_s": 0.008, "task.distance_m": 0.7},
    {"palm.friction": 0.12, "robot.noise_m_s": 0.06},
    {"bumps.rate_per_m": 5.0, "tactile.false_rate": 0.02, "task.slope_deg": 1.0},
    {"tactile.zones": [
        {"sign": "-0+"[k % 3], "from_m": -0.05 + 0.01 * k, "to_m": -0.042 + 0.01 * k}
        for k in range(10)
    ]},
    {"radio.loss": 0.02, "radio.jitter_s": 0.03, "task.timeout_s": 4.0},
    {"task.inertia": False, "robot.noise_m_s": 0.0},
    {"object": "l-shape", "task.direction": "backward"},
    {"palm.rate_deg_s": 2000},  # palms that are there before they are looked at again
    {"faults.script": [
        {"kind": "reboot", "robot": "left", "at_s": 4.0, "duration_s": 0.5, "limp_deg": 0.0},
    ]},
    {"radio.replay": 0.3, "radio.jitter_s": 0.02, "radio.left.latency_s": 0.09},
    {"robot.left.period_s": 0.03, "robot.right.period_s": 0.02},
    {"robot.noise_m_s": 0.04, "robot.standing_noise_m_s": 0.01},
    {"robot.motor_force_n": 1.1, "robot.right.traction_n": 1.0},
    {"robot.gain_sd": 0.1, "robot.left.gain": 0.95, "robot.right.white_noise_m_per_sqrt_s": 0.01},
    {"faults.random_reboots": 2, "faults.script": [
        {"kind": "stuck", "robot": "left", "at_s": 2.0, "duration_s": 1.0, "stuck_at": "+"},
        {"kind": "freeze", "robot": "left", "at_s": 8.0, "duration_s": 0.6},
        {"kind": "station-down", "at_s": 10.0, "duration_s": 0.5},
        {"kind": "clock-rate", "robot": "right", "at_s": 2, "duration_s": 5, "ppm": 30000.0},
        {"kind": "clock-jump", "robot": "left", "at_s": 8, "duration_s": 1.5},
    ]},
    {"object.box_m": [0.16, 0.16], "object.edge_radius_m": 0.08, "palm.length_m": 0.08,
     "palm.shallow_deg": 45, "palm.steep_deg": 50, "task.distance_m": 0.3},  # a pipe
]  # fmt: skip


@cache
def lot() -> tuple[Scene, ...]:
    """The special scenes, and random ones until every key of the core had a value."""
    draw, given = random.Random(12), set[str]()
    found = [load_scene("paper", keys) for keys in SPECIAL]
    while not given >= CARRIED_ROWS:
        keys = random_keys(draw)
        given |= set(names_in(keys))
        found.append(load_scene("paper", keys))
    return tuple(found)


def accepted(controller: Any, candidates: Sequence[Scene]) -> list[Scene]:
    """The scenes in which the controller can keep its time bounds."""
    has_time_bounds = resolve(controller).has_time_bounds
    found = []
    for scene in candidates:
        try:
            if has_time_bounds:
                bounds_of(scene)
        except SceneError:
            continue
        found.append(scene)
    return found


def assert_same(one: Columns, two: Columns) -> None:
    assert one.keys() == two.keys()
    for name, column in one.items():
        assert column.tobytes() == two[name].tobytes(), name


def assert_is_single(columns: Columns, i: int, one: pb.simulation.Carry) -> None:
    assert columns["finished"][i]
    assert OUTCOMES[columns["outcome"][i]] == one.outcome
    assert REASONS[columns["reason"][i]] == one.reason
    for name in ("time_s", "distance_m", "messages", "messages_lost"):
        assert columns[name][i] == getattr(one, name), name
    assert columns["corrections"][i] == one.correction_count
    for name in ("contact_rms_m", "contact_peak_m", "waiting_s"):
        assert tuple(columns[name][i]) == getattr(one, name).values(), name


class Held:
    """A controller in Python, which does not run in lanes."""

    def step(self, seen: StepInput) -> StepOutput:
        return StepOutput(palm="shallow" if seen.sign < 0 else "steep", move="hold")


@pytest.mark.parametrize("can_go_limp", [False, True])
@pytest.mark.parametrize(("controller", "precision"), RUNS)
def test_batches(controller: str, precision: Any, can_go_limp: bool) -> None:
    """For any threads, order, company and number of lanes; where a palm goes limp, no lanes."""
    some = accepted(controller, [s for s in lot() if to_spec(s).may_go_limp == can_go_limp])
    specs = [to_spec(scene) for scene in some]
    which = np.arange((2 if can_go_limp else 5) * len(specs), dtype=np.uint32) * 7 % len(specs)
    seeds = (np.arange(len(which)) % 11).astype(np.uint64)

    def run(rows: Any = slice(None), threads: int = 1) -> Columns:
        return run_batch(specs, which[rows], seeds[rows], controller, precision, threads=threads)

    reference = run()
    for i in np.unique(which, return_index=True)[1]:
        one = pb.carry(
            some[which[i]], controller, seed=int(seeds[i]), precision=precision, record=False
        )
        assert_is_single(reference, i, one)
    order = np.random.default_rng(0).permutation(len(which))
    assert_same({k: v[order] for k, v in reference.items()}, run(order, threads=2))
    if can_go_limp:
        return
    assert len(set(reference["outcome"])) > 1
    assert_same(reference, run(threads=5))
    for k in range(3):
        rows = slice(k, None, 3)
        assert_same({name: v[rows] for name, v in reference.items()}, run(rows))
    table = b"".join(spec.to_bytes() for spec in specs)
    for module in batch_modules():
        if find_spec(f"palmbots.{module}") is None:  # after `make quick`; test_batch.py misses it
            continue
        built = importlib.import_module(f"palmbots.{module}")
        found = built.run_many(table, which, seeds, controller, precision, 1)
        assert not found.pop("interrupted")
        found["finished"] = found["finished"].astype(bool)
        assert_same(reference, found)


@settings(max_examples=40)
@given(scene=scenes(), controller=st.sampled_from(shipped_names()), seed=st.integers(0, 2**64 - 1))
def test_batches_of_any_scene(scene: Scene, controller: str, seed: int) -> None:
    for precision in PRECISIONS if accepted(controller, [scene]) else ():
        columns = run_batch([to_spec(scene)], [0, 0], [seed, 1], controller, precision)
        one = pb.carry(scene, controller, seed=seed, precision=precision, record=False)
        assert_is_single(columns, 0, one)


@pytest.mark.parametrize(
    "controller",
    [
        *(name for name in controller_names() if name not in shipped_names()),
        *(name for name in reference_names() if name != SLOW),
        pytest.param(SLOW, marks=pytest.mark.soak),
        *(f"{path}{how}" for path in sorted(POLICIES.glob("*.toml")) for how in ("", "@station")),
        Held,
    ],
    ids=lambda controller: Path(str(controller)).name,
)
def test_batches_without_lanes(controller: Any) -> None:
    keys = {"robot.noise_m_s": 0.03, "task.distance_m": 0.3}
    entry = resolve(controller, unproved=True)
    some = [load_scene("paper", keys)] + ([] if entry.preparation else [Scene()])
    specs = [to_spec(scene) for scene in some]
    which, seeds = np.arange(10) % len(some), np.arange(10)
    reference = run_batch(specs, which, seeds, entry)
    assert_same(reference, run_batch(specs, which, seeds, entry, threads=3))
    if entry.is_policy:
        table = b"".join(spec.to_bytes() for spec in specs)
        assert_same(reference, run_batch(table, which, seeds, entry))
    for i in (0, 3, 8):
        one = pb.carry(some[which[i]], entry, seed=int(seeds[i]), record=False)
        assert_is_single(reference, i, one)


@pytest.mark.parametrize(("controller", "precision"), RUNS)
def test_hash_is_pinned(controller: str, precision: Any) -> None:
    carry = pb.carry("paper", controller, precision=precision, record=False)
    assert carry.trace_hash == PINNED[controller, precision]


@pytest.mark.parametrize("build", sampled(BUILDS, len(BUILDS)))
def test_compilers(build: str) -> None:
    """A program, compiled otherwise, gives the same hashes."""
    executable = program(f"sim/trace_hash-{build}")
    for k, (controller, precision) in enumerate(RUNS):
        some = accepted(controller, lot())
        for scene, seed in zip(some[k % 3 :: 3], itertools.cycle((0, 1, 2**64 - 1)), strict=False):
            carry = pb.carry(scene, controller, precision=precision, seed=seed, record=False)
            run = subprocess.run(
                [executable, controller, str(seed), precision],
                input=to_spec(scene).to_bytes(), capture_output=True, check=True, timeout=60,
            )  # fmt: skip
            assert run.stdout.decode().strip() == carry.trace_hash, (controller, precision, seed)


def test_hashes_of_other_carries_differ() -> None:
    hashes = [
        pb.carry(scene, controller, precision=precision, seed=seed, record=False).trace_hash
        for controller, precision in RUNS
        for scene in accepted(controller, lot()[:4])
        for seed in range(4)
    ]
    assert len(set(hashes)) == len(hashes)


@pytest.mark.parametrize(("controller", "precision"), RUNS)
def test_recording_and_repeating_change_nothing(controller: str, precision: Any) -> None:
    for scene in accepted(controller, lot())[::4]:
        bare, full, again = (
            pb.carry(scene, controller, precision=precision, record=is_on)
            for is_on in (False, True, True)
        )
        assert bare.trace_hash == full.trace_hash
        assert bare.corrections == full.corrections
        assert bare.summary() == full.summary() == again.summary()
        assert bare.trace is None and full.trace is not None and again.trace is not None
        assert full.trace.identical(again.trace)
