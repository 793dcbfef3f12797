# SPDX-License-Identifier: Apache-2.0
"""Logs of carries and of robots are fitted: hidden values are found again."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from commands import Run
from logged_pairs import LoggedPair, simulated_clock
from palmbots.fitting.fitted_values import Source
from palmbots.fitting.log_fit import LogFit
from palmbots.fitting.motion_fit import fit_recorded
from palmbots.fitting.recorded_logs import read_carry, stretches_in
from palmbots.logs.mcap_writer import write_log
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air
from sampled import amounts

HIDDEN = {
    "robot.gain": 1.03, "robot.noise_m_s": 0.02, "robot.noise_tau_s": 0.3,
    "robot.white_noise_m_per_sqrt_s": 0.001,
}  # fmt: skip


def logged(folder: Path, number: int, **keys: Any) -> Path:
    """The log of a carry."""
    place = folder / f"{number}.mcap"
    write_log(pb.carry("paper", "shared-sign", seed=number, overrides=HIDDEN | keys), place)
    return place


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("logs")
    keys: dict[str, Any] = {"radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04}
    return [logged(folder, seed, **keys) for seed in range(4)]


def test_carries_are_fitted(logs: list[Path], here: Run, tmp_path: Path) -> None:
    found = pb.fit(logs)
    assert isinstance(found, LogFit) and found.robot is not None and found.radio is not None
    assert found.not_fitted == () and found.carries == 4
    of = {one.key: one for part in found.parts.values() for one in part.estimates}
    for key, value in {**HIDDEN, "radio.loss": 0.1, "radio.latency_s": 0.03}.items():
        one = of[key]
        assert one.is_identified and one.low is not None and one.high is not None
        rest = 0.5 * (one.high - one.low) + 2e-4
        assert one.low - rest <= value <= one.high + rest, key
    assert of["radio.jitter_s"].value == pytest.approx(0.04, rel=0.2)
    assert "needs 50 stretches" in of["robot.gain_sd"].reason

    result = here("fit", *map(str, logs), "--out", str(tmp_path / "fitted"))
    assert result.returncode == 0
    written = {"robot.toml", "robot.png", "radio.toml", "radio.png"}
    assert {file.name for file in (tmp_path / "fitted").iterdir()} == written
    parts = [str(tmp_path / "fitted" / name) for name in ("robot.toml", "radio.toml")]
    with_both = [word for part in parts for word in ("--with", part)]
    assert f"palmbots carry SCENE {' '.join(with_both)}\n" in result.stdout
    assert here("carry", "paper", *with_both, "--seeds", "1").returncode in (0, 1)
    one_of_both = here("fit", "--radio", *map(str, logs), "--out", str(tmp_path / "radio"))
    assert one_of_both.returncode == 0
    assert {file.name for file in (tmp_path / "radio").iterdir()} == {"radio.toml", "radio.png"}


@pytest.mark.parametrize("direction", ["forward", "backward"])
@pytest.mark.parametrize("controller", ["shared-sign", "silent", "centralized"])
def test_without_noise_every_position_follows_from_the_commands(
    direction: str, controller: str
) -> None:
    """Also while robots accelerate and correct, and where they stand between."""
    keys = {"robot.noise_m_s": 0.0, "task.direction": direction, "start.left_m": 0.03}
    carried = pb.carry("paper", controller, overrides=keys | {"robot.right.bias_m_s": 0.004})
    stretches = list(stretches_in(carried, 0))
    assert stretches
    for one in stretches:
        error = one.positions_m - (one.commanded_m - one.commanded_m[0])
        sense = 1 if direction == "forward" else -1
        drift = sense * error[-1] / one.times_s[-1]
        assert drift == pytest.approx(0, abs=1e-9) or drift == pytest.approx(0.004, rel=1e-6)
        np.testing.assert_allclose(error, sense * drift * one.times_s, atol=1e-9)
        assert np.diff(one.times_s).max() < 0.111


@pytest.mark.slow
@pytest.mark.parametrize("fits", amounts(10, 40))
def test_intervals_cover_the_hidden_values(fits: int) -> None:
    """A controller answers to the noise: at positions that are only thinned, the gain is found 0.02
    too low."""
    hits = dict.fromkeys(HIDDEN, 0)
    for number in range(fits):
        carries = (
            pb.carry("paper", "shared-sign", seed=100 * number + k, overrides=HIDDEN)
            for k in range(6)
        )
        stretches = [
            one for run, carried in enumerate(carries) for one in stretches_in(carried, run)
        ]
        for one in fit_recorded(stretches, (Source("", ""),), 6).estimates:
            if one.key in hits:
                assert one.low is not None and one.high is not None
                hits[one.key] += one.low <= HIDDEN[one.key] <= one.high
    assert min(hits.values()) >= fits - 3 - fits // 10, hits


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_logs_of_robots_are_fitted(
    direction: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their packets have the loss and the latency of the simulated radio, and their wheels count
    what was commanded."""
    air = Air(delay_ms=30, loss=0.1, jitter_ms=20, seed=4)
    simulated_clock(monkeypatch)["air"] = air
    keys = {"task.distance_m": 0.3, "task.direction": direction}
    pair = LoggedPair(tmp_path, "shared-sign", air, UP, keys)
    pair.carry()
    folder = pair.written()
    stretches = read_carry(folder, 0).stretches
    assert stretches
    for one in stretches:
        assert one.speed_m_s / one.command_m_s == pytest.approx(1, abs=0.1)
    found = pb.fit([folder])
    assert isinstance(found, LogFit) and found.radio is not None
    print(found)
    of = {one.key: one for one in found.radio.estimates}
    for key, value in {
        "packets_lost": 0.1,
        "radio.latency_s": 0.03,
        "radio.jitter_s": 0.02,
    }.items():
        one = of[key]
        assert one.low is not None and one.high is not None
        assert one.low - 0.01 <= value <= one.high + 0.01, key


def test_what_is_no_such_log_is_refused(logs: list[Path], tmp_path: Path) -> None:
    refused: Callable[..., Any] = pytest.raises
    shutil.copy(logs[0], tmp_path / "one.mcap")
    with refused(pb.PalmbotsError, match="nothing is identified, and nothing is written"):
        pb.fit([tmp_path / "one.mcap"], motion=True)
    curved = pb.carry("paper", "silent", world="mujoco", overrides=CURVE)
    write_log(curved, tmp_path / "curve.mcap")
    with refused(pb.PalmbotsError, match="is of a curved path; expected carries on a straight"):
        pb.fit([tmp_path / "curve.mcap"])


CURVE = {
    "task.path.kind": "arc", "task.path.radius_m": 3.0, "task.path.angle_deg": 5.0,
    "task.distance_m": 0.26,
}  # fmt: skip
