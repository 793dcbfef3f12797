# SPDX-License-Identifier: Apache-2.0
"""Batches of carries: the modules that run them, what stops them, and what they refuse."""

import importlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import palmbots._core as _core
from commands import unwrapped
from cxx import program
from palmbots.cli import main as cli
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation import batch
from palmbots.simulation.batch import batch_modules, run_batch


def test_modules_have_different_numbers_of_lanes() -> None:
    lanes = {"_batch": (2, 4), "_batch_v3": (4, 8), "_batch_v4": (8, 16)}
    for name in batch_modules():
        assert find_spec(f"palmbots.{name}"), f"{name} is not built; `make build` builds it"
        built = importlib.import_module(f"palmbots.{name}")
        assert (built.lanes_double, built.lanes_float) == lanes[name]
    flags = Path("/proc/cpuinfo").read_text().split()
    assert ("_batch_v3" in batch_modules()) == ({"avx2", "bmi2", "fma"} <= set(flags))
    assert ("_batch_v4" in batch_modules()) == ({"avx2", "avx512vl", "avx512dq"} <= set(flags))
    assert not _core.supports_x86_level(2)


@pytest.mark.soak
@pytest.mark.parametrize("level", [3, 4])
@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_lanes_of_larger_processors_passes_sanitizers(level: int, compiler: str) -> None:
    """tests/cpp/test_programs.py runs the same programs with the lanes of any processor."""
    if not _core.supports_x86_level(level):
        pytest.skip(f"this processor has no level x86-64-v{level}")
    for name in ("base/simd_lanes_test", "batch/lane_carries_test"):
        command = [program(f"{name}-v{level}-{compiler}"), "30"]  # seeds, of the second one
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


@pytest.fixture
def as_after_make_carry(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No batch module is built."""
    monkeypatch.setattr(batch, "batch_modules", lambda: ["_batch_that_is_not_built"])
    monkeypatch.setattr(batch, "_slow_ticks", 0.0)
    batch._module.cache_clear()
    yield
    batch._module.cache_clear()


TABLE = [to_spec(load_scene("paper", {"robot.noise_m_s": noise})) for noise in (0.01, 0.03)]


@pytest.fixture(scope="module")
def in_lanes() -> dict[str, batch.Columns]:
    """Some carries of every shipped controller."""
    return {name: run_batch(TABLE, [0, 1] * 4, range(8), name) for name in shipped_names()}


def test_same_bits_without_modules(
    as_after_make_carry: None, in_lanes: dict[str, batch.Columns]
) -> None:
    specs = b"".join(spec.to_bytes() for spec in TABLE)
    for name, wanted in in_lanes.items():
        for given, threads in ((TABLE, 2), (specs, 1)):
            found = run_batch(given, [0, 1] * 4, range(8), name, threads=threads)
            assert found.keys() == wanted.keys()
            for column, values in wanted.items():
                assert found[column].tobytes() == values.tobytes(), (name, column)


STUDY = """
scene = "paper"
controllers = ["distributed"]

[vary]
robot.noise_m_s = [0.01, 0.04]

[seeds]
count = 3
"""


@pytest.mark.filterwarnings("always::palmbots.simulation.batch.SlowBuildWarning")
@pytest.mark.parametrize(
    "command", ["study small.toml", "compare -n 6 --values 0.01,0.04 --sweep robot.noise_m_s"]
)
def test_commands_without_modules_say_once_what_is_faster(
    command: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    as_after_make_carry: None,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(STUDY)
    for carries, lines in ((batch.FEW_SECONDS, 0), (1, 1)):
        monkeypatch.setattr(batch, "FEW_SECONDS", carries)
        monkeypatch.setattr(batch, "_slow_ticks", 0.0)
        out = [] if command.startswith("compare") else ["--out", f"of-{carries}"]
        assert cli.run([*command.split(), *out]) == 0
        printed = unwrapped(capsys.readouterr().err)
        assert printed.count(f"palmbots: warning: {batch.SLOW_BUILD}\n") == lines, printed


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
