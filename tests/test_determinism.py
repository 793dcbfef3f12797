"""The same carry, to the last bit, from every compiler, at every optimization, on every run."""

import subprocess
from concurrent.futures import ThreadPoolExecutor
from itertools import product
from pathlib import Path

import pytest

import palmbots as pb
from cxx import ROOT, compile_cxx
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene

SOURCE = ROOT / "tests" / "core" / "trace_hash.cpp"
BUILDS = list(product(("g++", "clang++"), ("-O0", "-O3")))
RUNS = list(product(("none", "centralized", "distributed", "resilient"), ("double", "float")))

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
            "jitter_s": 0.04, "reorder": True, "loss": 0.02, "burst_share": 0.1,
            "duplicate": 0.1, "airtime_s": 0.001,
            "outages": [{"sender": "right", "start_s": 4.0, "end_s": 6.0}],
        },
        "faults": {
            "reboots": 1,
            "script": [
                {"kind": "freeze", "robot": "left", "at_s": 2.0, "for_s": 0.3},
                {"kind": "flicker", "robot": "right", "at_s": 8.0, "for_s": 1.0, "rate": 0.2},
                {"kind": "stuck", "robot": "left", "at_s": 10.0, "for_s": 0.2, "reads": "+"},
                {"kind": "station", "at_s": 11.0, "for_s": 0.2},
            ],
        },
    }
)  # fmt: skip


@pytest.fixture(scope="module")
def programs() -> dict[tuple[str, str], Path]:
    with ThreadPoolExecutor(2) as pool:
        built = pool.map(lambda build: compile_cxx(SOURCE, [build[1]], build[0]), BUILDS)
        return dict(zip(BUILDS, built, strict=True))


def hash_by(program: Path, scene: Scene, controller: str, seed: int, precision: str) -> str:
    command = [program, controller, str(seed), precision]
    done = subprocess.run(
        command, input=lower(scene).to_bytes(), capture_output=True, check=True, timeout=60
    )
    return done.stdout.decode().strip()


@pytest.mark.parametrize(("controller", "precision"), RUNS)
def test_hash_is_pinned(controller: str, precision: str) -> None:
    carry = pb.carry("paper", controller, precision=precision, record=False)
    assert carry.trace_hash == PINNED[controller, precision]


@pytest.mark.parametrize("build", BUILDS, ids=" ".join)
@pytest.mark.parametrize("scene", [Scene(), BUSY, BROKEN], ids=["paper", "busy", "broken"])
def test_every_compiler_gives_the_same_hash(
    build: tuple[str, str], scene: Scene, programs: dict[tuple[str, str], Path]
) -> None:
    for controller, precision in RUNS:
        for seed in (0, 1, 2**64 - 1):
            carry = pb.carry(scene, controller, precision=precision, seed=seed, record=False)
            compiled = hash_by(programs[build], scene, controller, seed, precision)
            assert compiled == carry.trace_hash, (controller, precision, seed)


def test_hash_tells_carries_apart() -> None:
    hashes = {
        pb.carry(scene, controller, precision=precision, seed=seed, record=False).trace_hash
        for scene in (Scene(), BUSY, BROKEN)
        for controller, precision in RUNS
        for seed in range(5)
    }
    assert len(hashes) == 3 * len(RUNS) * 5


def test_recording_changes_nothing() -> None:
    for controller, precision in RUNS:
        bare = pb.carry(BUSY, controller, precision=precision, record=False)
        full = pb.carry(BUSY, controller, precision=precision, record=True)
        assert bare.trace_hash == full.trace_hash
        assert bare.corrections == full.corrections
        assert bare.summary() == full.summary()
        assert bare.trace is None
