# SPDX-License-Identifier: Apache-2.0
"""The recordings that `palmbots fit` writes for carries.

Their errors are those that the robots had, without the noise of the positions, and their packets
are those that were lost.
"""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from commands import Run
from palmbots.fitting.motion_likelihood import PARAMETERS, Stretch
from palmbots.fitting.replay_files import SPEEDS_M_S, error_replay, smoothed
from recordings import HIDDEN, packets_csv, recorded
from traces import wandering

MODEL = {
    "gain": 1.04, "bias_m_s": 0.002, "gain_sd": 0.03, "noise_m_s": 0.006, "log_tau": np.log(0.5),
    "white": 0.0, "position_noise_m": 0.004,
}  # fmt: skip
PARTS = np.array([MODEL[name] for name in PARAMETERS])


def made(seed: int, speed_m_s: float = 0.06) -> tuple[Stretch, Any, float]:
    """A stretch, its true displacement error beyond its gain, and this gain."""
    rng = np.random.default_rng(seed)
    (error,) = wandering(1, 20.0, 0.006, 0.5, seed, 0.01)
    error = error[::10]
    times: Any = 0.1 * np.arange(len(error))
    gain = 1.04 + 0.03 * float(rng.standard_normal())
    error = error + 0.002 * times
    places: Any = gain * speed_m_s * times + error + 0.004 * rng.standard_normal(len(times))
    return Stretch(times, places, speed_m_s * times, 0), error, gain


def test_the_smoothed_error_is_nearer_to_the_truth_than_the_positions() -> None:
    """The error and the gain agree with the truth as well as a Gaussian process can: the positions
    have an error of 4 mm, and it leaves about 1.5 mm and little of it from one row to the next."""
    off, rough, slopes = [], [], []
    for seed in range(40):
        stretch, error, gain = made(seed)
        found, found_gain = smoothed(stretch, PARTS)
        total = found + found_gain * stretch.commanded_m
        truth = error + gain * stretch.commanded_m
        off.append(np.std(total - truth))
        rough.append(np.std(np.diff(found - error)))
        slopes.append((found_gain - 1.04) / (gain - 1.04))
    assert np.mean(off) < 0.0022
    assert np.mean(rough) < 0.0007  # 5.7 mm in the positions
    assert 0.2 < np.median(slopes) < 1.1


@pytest.mark.parametrize("noise_m_s", [0.006, 0.0])
def test_exact_positions_close_to_each_other_are_the_error(noise_m_s: float) -> None:
    """As in logs of simulated carries, whose covariance is nearly singular, or quite."""
    error = noise_m_s / 0.006 * wandering(1, 6.0, 0.006, 0.5, 1, 0.01)[0]
    times: Any = 0.01 * np.arange(len(error))
    exact = np.array([1.04, 0.0, 0.0, noise_m_s, np.log(0.5), 0.0, 0.0])
    stretch = Stretch(times, 1.04 * 0.06 * times + error, 0.06 * times, 0)
    found, gain = smoothed(stretch, exact)
    assert gain == pytest.approx(1.04)
    np.testing.assert_allclose(found, error - error[0], atol=1e-5)


def test_the_posterior_is_that_of_a_direct_solution() -> None:
    """Least squares over the unknown origin, gain, noise in each step and position errors, each
    divided by its deviation, with the noise as a chain of steps."""
    stretch, _, _ = made(3)
    stretch = Stretch(stretch.times_s[:40], stretch.positions_m[:40], stretch.commanded_m[:40], 0)
    fine = 10  # steps of the chain between two positions
    steps, h = 39 * fine, 0.1 / fine
    memory = np.exp(-h / 0.5)
    rows, right = [], []
    size = 2 + steps  # origin, gain deviation, noise
    for k in range(steps):
        row = np.zeros(size)
        row[2 + k] = 1 / 0.006
        if k:
            row[2 + k] /= np.sqrt(1 - memory**2)
            row[1 + k] = -memory / (0.006 * np.sqrt(1 - memory**2))
        rows.append(row)
        right.append(0.0)
    row = np.zeros(size)
    row[1] = 1 / 0.03
    rows.append(row)
    right.append(0.0)
    for k in range(40):
        row = np.zeros(size)
        row[0], row[1] = 1.0, stretch.commanded_m[k]
        row[2 : 2 + fine * k] = h
        rest = stretch.positions_m[k] - 1.04 * stretch.commanded_m[k] - 0.002 * stretch.times_s[k]
        rows.append(row / 0.004)
        right.append(rest / 0.004)
    solved = np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]
    noise = np.concatenate([[0.0], np.cumsum(solved[2:])])[::fine] * h
    found, gain = smoothed(stretch, PARTS)
    assert found == pytest.approx(noise + 0.002 * stretch.times_s, abs=5e-5)
    assert gain == pytest.approx(1.04 + solved[1], abs=2e-4)


def test_only_stretches_at_the_speeds_of_carries_are_replayed() -> None:
    slow, fast, right = (made(k, speed)[0] for k, speed in enumerate((0.03, 0.09, 0.06)))
    replay = error_replay([slow, right, fast], PARTS, "")
    assert replay.rows.count("\n") == len(right.times_s)
    none = error_replay([slow, fast], PARTS, "")
    assert none.reason == "stretches at 5 to 8 cm/s last 0 s together; it needs 10 s"
    assert SPEEDS_M_S == (0.05, 0.08)


def test_fit_writes_a_recording_that_a_carry_replays(here: Run, tmp_path: Path) -> None:
    commands, positions = recorded(tmp_path, HIDDEN, seed=2, stretches=60)
    words = [str(commands), str(positions), "--out", str(tmp_path / "robot")]
    done = here("fit", "--motion", *words)
    file = tmp_path / "robot" / "robot-errors.csv"
    assert f"--set robot.error_trace={file}" in done.stdout.replace("\n", "")
    part = tmp_path / "robot" / "robot.toml"
    assert 'robot.error_trace = "robot-errors.csv"' in part.read_text()
    own = tmp_path / "robot" / "own.toml"
    own.write_text(part.read_text().replace("[robot]", '[robot]\nerror_trace = "robot-errors.csv"'))
    assert tomllib.loads(own.read_text())["robot"]["error_trace"] == "robot-errors.csv"
    hashes = set()
    for words in ([str(part)], [str(own)], [str(part), "--set", f"robot.error_trace={file}"]):
        carried = here("carry", "paper", "--seeds", "1", "--json", "--with", *words)
        hashes.add(carried.stdout.split('"trace_hash": "')[1][:16])
    assert len(hashes) == 2


def test_fit_writes_the_packets_that_were_lost(here: Run, tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    lost = rng.random(400) < 0.2
    lost[[0, -1]] = False
    index = np.flatnonzero(~lost).astype(float)
    late = rng.uniform(0, 0.02, len(index))
    file = packets_csv(
        tmp_path, "p.csv", "index,time_s,sent_s", index, 0.05 * index + late, 0.05 * index
    )
    here("fit", "--radio", file, "--out", str(tmp_path / "radio"))
    table = np.loadtxt(tmp_path / "radio" / "radio-fates.csv", delimiter=",", skiprows=3)
    assert (table[:, 1] == lost).all()
    assert table[:, 0] == pytest.approx(0.05 * np.arange(400), abs=0.02 * 20)
    assert table[~lost, 2] == pytest.approx(late - late.min(), abs=1e-3)
    given = {"radio.trace": str(tmp_path / "radio" / "radio-fates.csv")}
    links = pb.carry("paper", "resilient", overrides=given).links
    sent, gone = (sum(getattr(one, name) for one in links.values()) for name in ("sent", "lost"))
    assert 0.15 < gone / sent < 0.25
