# SPDX-License-Identifier: Apache-2.0
"""Batches of carries equal single carries, to the last bit, for any threads, order and
processor."""

import importlib
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import palmbots as pb
import palmbots._core as _core
from cxx import program
from palmbots.cli import main as cli
from palmbots.control.registry import shipped_names
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import batch
from palmbots.simulation.batch import Columns, batch_modules, run_batch, run_seeds
from strategies import scenes

CONTROLLERS = shipped_names()
OUTCOMES = ("running", "delivered", "dropped", "stalled")


def assert_is_single(columns: Columns, i: int, one: pb.simulation.Carry) -> None:
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
    """Scenes that run in lockstep and scenes that do not, of different lengths and outcomes."""
    zones = [
        {"sign": "-0+"[k % 3], "from_m": -0.05 + 0.01 * k, "to_m": -0.042 + 0.01 * k}
        for k in range(10)
    ]
    broken = [
        {"kind": "stuck", "robot": "left", "at_s": 2.0, "duration_s": 1.0, "stuck_at": "+"},
        {
            "kind": "intermittent",
            "robot": "right",
            "at_s": 4.0,
            "duration_s": 2.0,
            "probability": 0.3,
        },
        {"kind": "freeze", "robot": "left", "at_s": 8.0, "duration_s": 0.6},
        {"kind": "station-down", "at_s": 10.0, "duration_s": 0.5},
    ]
    keys: list[dict[str, Any]] = [
        {},
        {"palm.pivot_offset_m": 0.01, "task.direction": "backward"},
        {"robot.left.bias_m_s": 0.008, "task.distance_m": 0.7},
        {"palm.friction": 0.12, "robot.noise_m_s": 0.06},
        {"bumps.rate_per_m": 5.0},
        {"tactile.false_rate": 0.02, "task.slope_deg": 1.0},
        {"faults.random_reboots": 2},
        {"faults.script": broken},
        {"tactile.zones": zones},
        {"radio.loss": 0.02, "radio.jitter_s": 0.03, "task.timeout_s": 4.0},
        {"task.inertia": False, "robot.noise_m_s": 0.0},
        {"object": "l-shape"},
        {"palm.rate_deg_s": 2000},  # palms that are there before they are looked at again
    ]
    specs = [to_spec(load_scene("paper", k)) for k in keys]
    n = 8 * len(specs)
    which = (np.arange(n) * 7 % len(specs)).astype(np.uint32)
    return specs, which, (np.arange(n) % 11).astype(np.uint64)


@settings(max_examples=40)
@given(scene=scenes(), controller=st.sampled_from(CONTROLLERS), seed=st.integers(0, 2**64 - 1))
def test_lockstep_carry_of_any_scene_equals_the_single_carry(
    scene: Scene, controller: str, seed: int
) -> None:
    try:
        bounds_of(scene)
    except SceneError:
        if controller == "resilient":
            return  # its time bounds cannot be kept
    for precision in ("double", "float"):
        columns = run_batch([to_spec(scene)], [0, 0], [seed, 1], controller, precision)
        one = pb.carry(scene, controller, seed=seed, precision=precision, record=False)
        assert_is_single(columns, 0, one)


@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize("precision", ["double", "float"])
def test_results_do_not_depend_on_threads_order_and_processor(
    lot: tuple[list[_core.Spec], np.ndarray, np.ndarray], controller: str, precision: str
) -> None:
    specs, which, seeds = lot
    reference = run_batch(specs, which, seeds, controller, precision)
    assert reference["finished"].all()
    assert set(reference["outcome"]) >= {1, 2}
    for threads in (2, 5):
        assert_same(
            reference, run_batch(specs, which, seeds, controller, precision, threads=threads)
        )
    order = np.random.default_rng(0).permutation(len(which))
    shuffled = run_batch(specs, which[order], seeds[order], controller, precision, threads=2)
    assert_same({k: v[order] for k, v in reference.items()}, shuffled)
    split = [run_batch(specs, which[k::3], seeds[k::3], controller, precision) for k in range(3)]
    for k in range(3):
        assert_same({name: v[k::3] for name, v in reference.items()}, split[k])
    table = b"".join(spec.to_bytes() for spec in specs)
    for module in batch_modules():
        built = importlib.import_module(f"palmbots.{module}")
        run = built.run_many(table, which, seeds, controller, precision, 1)
        assert not run.pop("interrupted")
        run["finished"] = run["finished"].astype(bool)
        assert_same(reference, run)


def test_modules_have_different_numbers_of_lanes() -> None:
    lanes = {"_batch": (2, 4), "_batch_v3": (4, 8), "_batch_v4": (8, 16)}
    for name in batch_modules():
        built = importlib.import_module(f"palmbots.{name}")
        assert (built.lanes_double, built.lanes_float) == lanes[name]
    flags = Path("/proc/cpuinfo").read_text().split()
    assert ("_batch_v3" in batch_modules()) == ({"avx2", "bmi2", "fma"} <= set(flags))
    assert ("_batch_v4" in batch_modules()) == ({"avx2", "avx512vl", "avx512dq"} <= set(flags))
    assert not _core.supports_x86_level(2)


@pytest.mark.soak
@pytest.mark.parametrize("level", [3, 4])
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_lockstep_for_larger_processors_passes_sanitizers(level: int, compiler: str) -> None:
    """tests/cpp/test_programs.py runs the same program with the lanes of any processor."""
    if not _core.supports_x86_level(level):
        pytest.skip(f"this processor has no level x86-64-v{level}")
    command = [program(f"batch/lockstep_test-v{level}-{compiler}"), "30"]  # seeds
    run = subprocess.run(command, capture_output=True, text=True, timeout=1500)
    assert run.returncode == 0, run.stderr


def test_exception_in_watch_stops_the_batch() -> None:
    spec = to_spec(load_scene("paper", {"task.distance_m": 1000.0, "task.timeout_s": 20000.0}))
    seen: list[int] = []

    def stop(done: int) -> None:
        seen.append(done)
        raise ValueError("enough")

    with pytest.raises(ValueError, match=r"enough"):
        run_batch([spec], np.zeros(40, np.uint32), np.arange(40), "distributed", watch=stop)
    assert seen == [0]


@pytest.mark.parametrize("command", ["study", "compare", "validate"])
def test_command_without_lockstep_modules_is_refused_before_it_writes(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """As after `make carry`, which does not build them."""
    monkeypatch.setattr(batch, "batch_modules", lambda: ["_batch_that_is_not_built"])
    monkeypatch.chdir(tmp_path)
    batch._module.cache_clear()
    try:
        assert cli.run([command, *(["what-matters"] if command == "study" else [])]) == 2
    finally:
        batch._module.cache_clear()
    printed = capsys.readouterr()
    line = "palmbots: the lockstep modules are not built; run: make build\n"
    assert (printed.out, printed.err) == ("", line)
    assert list(tmp_path.iterdir()) == []


INTERRUPTED = """
import sys
import numpy as np
from palmbots.simulation.batch import run_batch
from palmbots.scene.spec import to_spec
from palmbots.scene.scene import load_scene

short = to_spec(load_scene("paper"))
far = {"task.distance_m": 1e4, "robot.speed_m_s": 0.02, "task.timeout_s": 1e5}
long = to_spec(load_scene("paper", far))
which = np.array([0] * 5 + [1] * 100)
watch = lambda done: print(done, flush=True)
try:
    run_batch([short, long], which, np.arange(105), "distributed", threads=2, watch=watch)
except KeyboardInterrupt as stopped:
    finished = stopped.args[0]["finished"]
    print("kept", finished[:5].all(), finished[5:].any(), stopped.args[0]["time_s"][:5].min() > 20)
"""


def test_ctrl_c_keeps_finished_carries() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", INTERRUPTED], stdout=subprocess.PIPE, text=True, cwd=os.getcwd()
    ) as process:
        assert process.stdout is not None
        while int(process.stdout.readline()) < 5:  # the short ones
            pass
        process.send_signal(signal.SIGINT)
        out, _ = process.communicate(timeout=60)
        assert out.splitlines()[-1] == "kept True False True"
        assert process.returncode == 0


def test_invalid_arguments_are_refused() -> None:
    spec = to_spec(Scene())
    with pytest.raises(PalmbotsError, match=r"controller: value is .nobody"):
        run_seeds(spec, "nobody", 0, 1)
    with pytest.raises(ValueError, match=r"precision"):
        run_seeds(spec, "none", 0, 1, "half")
    with pytest.raises(ValueError, match=r"threads"):
        run_seeds(spec, "none", 0, 1, threads=0)
    with pytest.raises(IndexError, match=r"which"):
        run_batch([spec], [1], [0], "none")
    with pytest.raises(ValueError, match=r"specs"):
        run_batch([], [], [], "none")
    with pytest.raises(ValueError, match=r"as many"):
        run_batch([spec], [0, 0], [0], "none")
