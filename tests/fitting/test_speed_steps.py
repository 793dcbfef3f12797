# SPDX-License-Identifier: Apache-2.0
"""Acceleration, dead time and curvature are found again from changes of the commanded speed."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

from palmbots.drivers.hardware import HardwareParameters, wheel_scales
from palmbots.fitting.clock_alignment import align
from palmbots.fitting.fitted_values import Estimate
from palmbots.fitting.motion_fit import fit_motion
from palmbots.fitting.speed_steps import Step, step_estimates, steps_in
from palmbots.fitting.straight_stretches import COMMANDS, POSITIONS, straight, way_of
from palmbots.scene.recorded_tables import read_recording
from recordings import HIDDEN, LAG_S, recorded

QUIET = dict.fromkeys(HIDDEN, 0.0) | {"robot.gain": 1.0, "robot.noise_tau_s": 0.4}


def fitted(folder: Path, seed: int, stretches: int, hidden: dict[str, float]) -> list[Estimate]:
    files = recorded(folder, hidden, seed=seed, stretches=stretches)
    commands = read_recording(files[0], COMMANDS, 2)
    positions = read_recording(files[1], POSITIONS, 2)
    lag_s = align(commands, positions).lag_s
    way = way_of(commands, positions, lag_s)
    assert way is not None
    steps = steps_in(straight(commands), positions.times_s, way, lag_s, 0)
    return step_estimates(steps, "dead time")


def test_without_noise_both_are_exact(tmp_path: Path) -> None:
    """Within the period of the commands."""
    acceleration, dead = fitted(tmp_path, 1, 20, QUIET)
    assert acceleration.value == pytest.approx(0.5, rel=0.02)
    assert dead.value == pytest.approx(LAG_S, abs=0.012)


@pytest.mark.slow
def test_intervals_cover_the_hidden_values(tmp_path: Path) -> None:
    fits, hits = 20, np.zeros(2)
    for seed in range(fits):
        acceleration, dead = fitted(tmp_path, seed, 50, HIDDEN)
        for k, (one, value) in enumerate(((acceleration, 0.5), (dead, LAG_S))):
            hits[k] += one.low is None or one.high is None or one.low <= value <= one.high
    assert (hits >= binom.ppf(1e-3, fits, 0.95)).all(), hits


@pytest.mark.parametrize(
    ("steps", "reason"),
    [
        ([Step(0.05, 0.2, 0)] * 19, "needs 20 changes between constant speeds; there are 19"),
        ([Step(0.05, 0.2, 0)] * 30, "all changes of the speed are of about one size"),
        (
            [Step(0.02 + 0.002 * k, 0.2 + 1e-4 * (-1) ** k, 0) for k in range(30)],
            "too great for the data: at least",
        ),
    ],
)
def test_what_is_not_identified_has_a_reason(steps: list[Step], reason: str) -> None:
    assert reason in step_estimates(steps, "dead time")[0].reason


def test_a_robot_that_turns_without_a_command_has_a_curvature(tmp_path: Path) -> None:
    """On a circle, as its wheels have a trim: the trim is that of `hardware.trim`."""
    trim, separation_m = -0.005, 0.25
    left, right = wheel_scales(HardwareParameters(trim=trim))
    curvature = (right - left) / separation_m
    commands, _ = recorded(tmp_path, QUIET, seed=3, stretches=8)
    table = np.loadtxt(tmp_path / "positions.csv", delimiter=",", skiprows=1)
    way = np.hypot(table[:, 1] - table[0, 1], table[:, 2] - table[0, 2])
    heading = 0.7 + curvature * way
    x, y = np.sin(heading) / curvature, -np.cos(heading) / curvature
    seen = np.column_stack([table[:, 0], x, y, heading])
    file = tmp_path / "turning.csv"
    np.savetxt(file, seen, "%.9f", ",", header="time_s,x_m,y_m,heading_rad", comments="")
    of = {one.key: one for one in fit_motion([commands, file]).estimates}
    found = of["curvature_rad_per_m"].value
    assert isinstance(found, float)
    assert -found * separation_m == pytest.approx(trim, rel=0.01)
