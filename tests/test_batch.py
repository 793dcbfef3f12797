"""Many carries at once are the single ones, to the last bit, however they are spread."""

import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import palmbots as pb
from cxx import ROOT, SANITIZERS, compile_cxx
from palmbots import _core
from palmbots.batch import Columns, lane_modules, run_many, run_seeds
from palmbots.bounds import bounds_of
from palmbots.errors import SceneError
from palmbots.lowering import lower
from palmbots.scene import Scene, load_scene
from strategies import scenes

CONTROLLERS = ("none", "centralized", "distributed", "resilient")
OUTCOMES = ("running", "delivered", "dropped", "stalled")


def assert_is_single(columns: Columns, i: int, one: pb.Carry) -> None:
    assert columns["finished"][i]
    assert OUTCOMES[columns["outcome"][i]] == one.outcome
    assert columns["time_s"][i] == one.time_s
    assert columns["distance_m"][i] == one.distance_m
    assert tuple(columns["contact_rms_m"][i]) == tuple(one.contact_rms_m.values())
    assert tuple(columns["contact_peak_m"][i]) == tuple(one.contact_peak_m.values())
    assert tuple(columns["waiting_s"][i]) == tuple(one.waiting_s.values())
    assert columns["messages"][i] == one.messages


def assert_same(one: Columns, two: Columns) -> None:
    assert one.keys() == two.keys()
    for name, column in one.items():
        assert column.tobytes() == two[name].tobytes(), name


@pytest.fixture(scope="module")
def lot() -> tuple[list[_core.Spec], np.ndarray, np.ndarray]:
    """Scenes that lanes carry and scenes that they do not, of unlike lengths and outcomes."""
    zones = [
        {"sign": "-0+"[k % 3], "from_m": -0.05 + 0.01 * k, "to_m": -0.042 + 0.01 * k}
        for k in range(10)
    ]
    broken = [
        {"kind": "stuck", "robot": "left", "at_s": 2.0, "for_s": 1.0, "reads": "+"},
        {"kind": "flicker", "robot": "right", "at_s": 4.0, "for_s": 2.0, "rate": 0.3},
        {"kind": "freeze", "robot": "left", "at_s": 8.0, "for_s": 0.6},
        {"kind": "station", "at_s": 10.0, "for_s": 0.5},
    ]
    keys: list[dict[str, Any]] = [
        {},
        {"palm.pivot_offset_m": 0.01, "task.direction": "backward"},
        {"robot.left.bias_m_s": 0.008, "task.distance_m": 0.7},
        {"palm.friction": 0.12, "robot.noise_m_s": 0.03},
        {"bumps.rate_per_m": 5.0},
        {"tactile.false_rate": 0.02, "task.slope_deg": 1.0},
        {"faults.reboots": 2},
        {"faults.script": broken},
        {"tactile.zones": zones},
        {"radio.loss": 0.02, "radio.jitter_s": 0.03, "task.timeout_s": 4.0},
        {"task.inertia": False, "robot.noise_m_s": 0.0},
        {"object": "l-shape"},
        {"palm.rate_deg_s": 2000},  # palms that are there before they are looked at again
    ]
    specs = [lower(load_scene("paper", k)) for k in keys]
    n = 8 * len(specs)
    which = (np.arange(n) * 7 % len(specs)).astype(np.uint32)
    return specs, which, (np.arange(n) % 11).astype(np.uint64)


@settings(deadline=None, max_examples=40)
@given(scene=scenes(), controller=st.sampled_from(CONTROLLERS), seed=st.integers(0, 2**64 - 1))
def test_any_scene_in_lanes_is_the_single_carry(scene: Scene, controller: str, seed: int) -> None:
    try:
        bounds_of(scene)
    except SceneError:
        if controller == "resilient":
            return  # its time bounds cannot be kept
    for precision in ("double", "float"):
        columns = run_many([lower(scene)], [0, 0], [seed, 1], controller, precision)
        one = pb.carry(scene, controller, seed=seed, precision=precision, record=False)
        assert_is_single(columns, 0, one)


@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize("precision", ["double", "float"])
def test_threads_order_and_processor_change_nothing(
    lot: tuple[list[_core.Spec], np.ndarray, np.ndarray], controller: str, precision: str
) -> None:
    specs, which, seeds = lot
    reference = run_many(specs, which, seeds, controller, precision)
    assert reference["finished"].all()
    assert set(reference["outcome"]) >= {1, 2}
    for threads in (2, 5):
        assert_same(
            reference, run_many(specs, which, seeds, controller, precision, threads=threads)
        )
    order = np.random.default_rng(0).permutation(len(which))
    shuffled = run_many(specs, which[order], seeds[order], controller, precision, threads=2)
    assert_same({k: v[order] for k, v in reference.items()}, shuffled)
    split = [run_many(specs, which[k::3], seeds[k::3], controller, precision) for k in range(3)]
    for k in range(3):
        assert_same({name: v[k::3] for name, v in reference.items()}, split[k])
    table = b"".join(spec.to_bytes() for spec in specs)
    for module in lane_modules():
        built = importlib.import_module(f"palmbots.{module}")
        run = built.run_many(table, which, seeds, controller, precision, 1)
        assert not run.pop("interrupted")
        run["finished"] = run["finished"].astype(bool)
        assert_same(reference, run)


def test_the_modules_have_other_lanes() -> None:
    lanes = {"_lanes": (2, 4), "_lanes_v3": (4, 8), "_lanes_v4": (8, 16)}
    for name in lane_modules():
        built = importlib.import_module(f"palmbots.{name}")
        assert (built.lanes_double, built.lanes_float) == lanes[name]
    flags = Path("/proc/cpuinfo").read_text().split()
    assert ("_lanes_v3" in lane_modules()) == ({"avx2", "bmi2", "fma"} <= set(flags))
    assert ("_lanes_v4" in lane_modules()) == ({"avx2", "avx512vl", "avx512dq"} <= set(flags))
    assert not _core.has_level(2)


@pytest.mark.parametrize(
    ("level", "compiler"), [(3, "g++"), (3, "clang++"), (4, "g++"), (4, "clang++")]
)
def test_lanes_of_the_larger_processors_under_sanitizers(level: int, compiler: str) -> None:
    """`test_core` runs the same program with the lanes of any processor."""
    if not _core.has_level(level):
        pytest.skip(f"this processor has no level x86-64-v{level}")
    source = ROOT / "tests" / "core" / "lanes_test.cpp"
    program = compile_cxx(source, ["-O0", f"-march=x86-64-v{level}", *SANITIZERS], compiler)
    done = subprocess.run([program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


def test_watch_counts_and_may_stop() -> None:
    spec = lower(load_scene("paper", {"task.distance_m": 1000.0, "task.timeout_s": 20000.0}))
    seen: list[int] = []

    def stop(done: int) -> None:
        seen.append(done)
        raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):
        run_many([spec], np.zeros(40, np.uint32), np.arange(40), "distributed", watch=stop)
    assert seen == [0]


INTERRUPTED = """
import sys
import numpy as np
from palmbots.batch import run_many
from palmbots.lowering import lower
from palmbots.scene import load_scene

short = lower(load_scene("paper"))
far = {"task.distance_m": 1e4, "robot.speed_m_s": 0.02, "task.timeout_s": 1e5}
long = lower(load_scene("paper", far))
which = np.array([0] * 5 + [1] * 100)
print("started", flush=True)
try:
    run_many([short, long], which, np.arange(105), "distributed", threads=2)
except KeyboardInterrupt as stopped:
    finished = stopped.args[0]["finished"]
    print(finished[:5].all(), finished[5:].any(), (stopped.args[0]["time_s"][:5] > 20).all())
"""


def test_ctrl_c_keeps_what_is_finished() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True, cwd=os.getcwd()
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "started\n"
        time.sleep(2)
        began = time.monotonic()
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
        assert time.monotonic() - began < 20
        assert out == "True False True\n"
        assert process.returncode == 0


def test_bad_arguments() -> None:
    spec = lower(Scene())
    with pytest.raises(ValueError, match="controller"):
        run_seeds(spec, "nobody", 0, 1)
    with pytest.raises(ValueError, match="precision"):
        run_seeds(spec, "none", 0, 1, "half")
    with pytest.raises(ValueError, match="threads"):
        run_seeds(spec, "none", 0, 1, threads=0)
    with pytest.raises(IndexError, match="which"):
        run_many([spec], [1], [0], "none")
    with pytest.raises(ValueError, match="specs"):
        run_many([], [], [], "none")
    with pytest.raises(ValueError, match="as many"):
        run_many([spec], [0, 0], [0], "none")
