# SPDX-License-Identifier: Apache-2.0
"""The same carry, to the last bit, from every compiler, at every optimization level, on every
run."""

import subprocess
from itertools import product
from pathlib import Path

import pytest

import palmbots as pb
from cxx import program
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec

COMPILERS = ("g++", "clang++")
BUILDS = [
    *(f"{compiler}-O3" for compiler in COMPILERS),
    *(
        pytest.param(f"{compiler}-O{level}", marks=pytest.mark.soak)
        for compiler in COMPILERS
        for level in range(3)
    ),
]
RUNS = list(product(shipped_names(), ("double", "float")))

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
    ("shared-sign", "double"): "0b5a3f2117259ef0",
    ("shared-sign", "float"): "f8208b1ef3fabcb3",
}

# Everything that a scene can switch on.
BUSY = load_scene(
    {
        "object": {"com_m": [0.118, 0.06]},
        "palm": {"pivot_offset_m": 0.01, "left": {"friction": 0.25}},
        "robot": {"noise_m_s": 0.015, "right": {"bias_m_s": 0.002}},
        "tactile": {"false_rate": 0.005},
        "radio": {"jitter_s": 0.04, "loss": 0.001},
        "bumps": {"rate_per_m": 4.0, "script": [{"robot": "left", "at_s": 1.0, "shift_m": 0.01}]},
        "task": {"slope_deg": 0.5, "direction": "backward"},
    }
)

# Everything that can break.
BROKEN = load_scene(
    {
        "robot": {"noise_m_s": 0.012, "left": {"clock_ppm": 900.0}, "right": {"clock_ppm": -700.0}},
        "radio": {
            "jitter_s": 0.04, "reorder": True, "loss": 0.02, "burst_fraction": 0.1,
            "duplicate": 0.1, "airtime_s": 0.001,
            "outages": [{"sender": "right", "start_s": 4.0, "end_s": 6.0}],
        },
        "faults": {
            "random_reboots": 1,
            "script": [
                {"kind": "freeze", "robot": "left", "at_s": 2.0, "duration_s": 0.3},
                {"kind": "intermittent", "robot": "right", "at_s": 8.0, "duration_s": 1.0,
                 "probability": 0.2},
                {"kind": "stuck", "robot": "left", "at_s": 10.0, "duration_s": 0.2,
                 "stuck_at": "+"},
                {"kind": "station-down", "at_s": 11.0, "duration_s": 0.2},
            ],
        },
    }
)  # fmt: skip


def hash_by(executable: Path, scene: Scene, controller: str, seed: int, precision: str) -> str:
    command = [executable, controller, str(seed), precision]
    run = subprocess.run(
        command, input=to_spec(scene).to_bytes(), capture_output=True, check=True, timeout=60
    )
    return run.stdout.decode().strip()


@pytest.mark.parametrize(("controller", "precision"), RUNS)
def test_hash_is_pinned(controller: str, precision: str) -> None:
    carry = pb.carry("paper", controller, precision=precision, record=False)
    assert carry.trace_hash == PINNED[controller, precision]


@pytest.mark.parametrize("build", BUILDS)
@pytest.mark.parametrize("scene", [Scene(), BUSY, BROKEN], ids=["paper", "busy", "broken"])
def test_every_compiler_gives_the_same_hash(build: str, scene: Scene) -> None:
    executable = program(f"sim/trace_hash-{build}")
    for controller, precision in RUNS:
        for seed in (0, 1, 2**64 - 1):
            carry = pb.carry(scene, controller, precision=precision, seed=seed, record=False)
            compiled = hash_by(executable, scene, controller, seed, precision)
            assert compiled == carry.trace_hash, (controller, precision, seed)


def test_hash_differs_between_carries() -> None:
    hashes = {
        pb.carry(scene, controller, precision=precision, seed=seed, record=False).trace_hash
        for scene in (Scene(), BUSY, BROKEN)
        for controller, precision in RUNS
        for seed in range(5)
    }
    assert len(hashes) == 3 * len(RUNS) * 5


def test_recording_does_not_change_results() -> None:
    for controller, precision in RUNS:
        bare = pb.carry(BUSY, controller, precision=precision, record=False)
        full = pb.carry(BUSY, controller, precision=precision, record=True)
        assert bare.trace_hash == full.trace_hash
        assert bare.corrections == full.corrections
        assert bare.summary() == full.summary()
        assert bare.trace is None
