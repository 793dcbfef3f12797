# SPDX-License-Identifier: Apache-2.0
"""Carries in the dynamic world: the same scenes, controllers, results, log and figures."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import palmbots as pb
from commands import Run, assert_refused
from palmbots.control.interface import DistributedController
from palmbots.control.registry import describe, shipped_names
from palmbots.logs.replaying import replay
from palmbots.simulation.result import Carry
from sampled import sampled


@pytest.fixture(scope="module")
def done() -> Carry:
    return pb.carry("paper", "distributed", seed=0, world="mujoco")


def test_the_distributed_algorithm_carries_the_box(done: Carry) -> None:
    assert (done.outcome, done.reason, done.world) == ("delivered", None, "mujoco")
    assert done.distance_m == pytest.approx(1.5, abs=1e-3)
    assert done.time_s == pytest.approx(25, abs=2)
    assert max(done.contact_peak_m.values()) < 0.04
    assert {c.case for c in done.corrections} <= set("abd")
    assert len(done.corrections) > 5


def test_trace_has_the_common_variables_and_those_of_mujoco(done: Carry) -> None:
    known = pb.carry("paper", "distributed", seed=0)
    assert done.trace is not None and known.trace is not None
    assert set(known.trace.data_vars) < set(done.trace.data_vars)
    trace = done.trace
    for name in known.trace.data_vars:
        assert trace[name].dims == known.trace[name].dims
        assert trace[name].attrs["units"] == known.trace[name].attrs["units"]
    # The force on both palms is the weight, over a carry as over any time.
    angle = trace["palm"]
    lift = (trace["force"] * np.cos(angle) - trace["friction_force"] * np.sin(angle)).sum("side")
    assert float(lift.mean()) == pytest.approx(0.5 * 9.80665, rel=0.01)
    # The measured speed is the commanded speed plus noise; its sum is the distance travelled.
    period = done.scene.control.period_s
    way = trace["speed"].mean("side").to_numpy()[:-1].sum() * period
    assert way == pytest.approx(done.distance_m, abs=0.003)
    closed = trace["separation"].to_numpy()[-1] - trace["separation"].to_numpy()[0]
    apart = trace["speed"].sel(side="right") - trace["speed"].sel(side="left")
    assert float(apart[:-1].sum()) * period == pytest.approx(closed, abs=0.001)


def test_the_same_seed_gives_the_same_bits(tmp_path: Path) -> None:
    short = pb.load_scene("paper", {"task.distance_m": 0.1})
    done = pb.carry(short, "distributed", seed=0, world="mujoco")
    pb.write_log(done, tmp_path / "carry.mcap")
    again = replay(tmp_path / "carry.mcap")
    assert again.identical, again.difference
    assert again.log.world == "mujoco"
    assert done.trace is not None
    assert set(again.log.trace.data_vars) == set(done.trace.data_vars)
    for name in ("force", "friction_force", "wheel_slip", "pitch", "yaw"):
        logged, own = again.log.trace[name], done.trace[name]
        assert np.array_equal(logged, own) and logged.attrs == own.attrs and own.any(), name
    other = pb.carry(short, "distributed", seed=1, world="mujoco", record=False)
    assert other.trace_hash != done.trace_hash


def test_noise_and_radio_are_those_of_the_quasistatic_world_with_that_seed(done: Carry) -> None:
    """Paired by seed: until the first command differs, the robots err alike."""
    known = pb.carry("paper", "distributed", seed=0)
    assert done.trace is not None and known.trace is not None
    other = pb.carry("paper", "distributed", seed=1)
    assert other.trace is not None
    own, same, another = (
        np.diff(t["separation"].to_numpy()[:80:5]) for t in (done.trace, known.trace, other.trace)
    )
    assert np.corrcoef(own, same)[0, 1] > 0.9  # wheels lag by 8 ms
    assert np.corrcoef(own, another)[0, 1] < 0.5


@pytest.mark.parametrize(
    "controller", sampled((c for c in shipped_names() if c not in ("distributed", "none")), 2)
)
def test_other_controllers_carry_too(controller: str) -> None:
    scene = pb.load_scene("paper", {"task.distance_m": 0.5})
    done = pb.carry(scene, controller, seed=1, world="mujoco", record=False)
    assert done.outcome == "delivered"
    assert (done.bounds is not None) == describe(controller).has_time_bounds
    assert done.trace is None and done.mujoco_record is None


@pytest.mark.parametrize("friction", [0.15, 0.8])
def test_little_and_much_friction_carry(friction: float) -> None:
    """Twelve seeds of each, and of five between, are benchmarks/bench_mujoco.py."""
    scene = pb.load_scene("paper", {"palm.friction": friction, "task.distance_m": 0.75})
    assert pb.carry(scene, world="mujoco", seed=1, record=False).outcome == "delivered"


def test_python_controller_carries_in_mujoco() -> None:
    scene = pb.load_scene("paper", {"task.distance_m": 0.2})
    mine = pb.carry(scene, DistributedController, world="mujoco", seed=2)
    shipped = pb.carry(scene, "distributed", world="mujoco", seed=2)
    assert mine.trace_hash == shipped.trace_hash


def test_high_noise_without_controller_drops_the_object() -> None:
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.05})
    done = pb.carry(scene, "none", world="mujoco", record=False)
    assert (done.outcome, done.reason) == ("dropped", "off-palm")


def test_path_in_backward_direction_is_valid() -> None:
    done = pb.carry("paper", world="mujoco", seed=3, record=False, overrides={
        "task.direction": "backward", "task.distance_m": 0.3,
    })  # fmt: skip
    assert done.outcome == "delivered"


def test_progress_and_watch_are_called() -> None:
    seen: list[float] = []
    times: list[float] = []
    pb.carry(
        "paper", world="mujoco", record=False, overrides={"task.distance_m": 0.1},
        on_progress=seen.append, on_tick=lambda world: times.append(world.time_s),
    )  # fmt: skip
    assert seen == sorted(seen) and 0 < len(seen) < len(times)
    assert times[0] == 0.0 and np.diff(times) == pytest.approx(0.01)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--precision", "float"], 'precision (world mujoco): value is "float"; allowed: double'),
        (["--set", "bumps.rate_per_m=1"], "mujoco.ridges"),
        (["--world", "moon"], "allowed: quasistatic, mujoco"),
    ],
)
def test_unsupported_scenes_are_refused_in_one_line(
    here: Run, arguments: list[str], message: str
) -> None:
    assert_refused(here("carry", "--world", "mujoco", *arguments), message)


def test_missing_mujoco_is_reported_in_one_line() -> None:
    hide = "import sys; sys.modules['mujoco'] = None; from palmbots.cli.main import main; main()"
    ran = subprocess.run(
        [sys.executable, "-c", hide, "carry", "--world", "mujoco"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert (ran.returncode, ran.stdout) == (2, "")
    assert ran.stderr.count("\n") == 1
    assert "mujoco: the package mujoco is missing; run: " in ran.stderr
