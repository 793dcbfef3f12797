# SPDX-License-Identifier: Apache-2.0
"""Logs of carries and of robots are fitted: hidden values are found again."""

import re
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from commands import Run
from fitted_carries import HIDDEN, carries_fitted, contains
from logged_pairs import LoggedPair, simulated_clock
from palmbots._util.report import Line
from palmbots.fitting.fit import write_fit
from palmbots.fitting.fitted_values import Source
from palmbots.fitting.log_fit import LogFit
from palmbots.fitting.motion_likelihood import Stretch
from palmbots.fitting.radio_fit import fit_packets
from palmbots.fitting.recorded_logs import Sent, _packets, read_carry, stretches_in
from palmbots.fitting.straight_stretches import thinned
from palmbots.logs.mcap_writer import write_log
from palmbots.pair.launcher import UP
from palmbots.simulation.result import Carry
from palmbots.station.simulated_pair import Air


def logged(folder: Path, number: int, **keys: Any) -> Path:
    """The log of a carry."""
    place = folder / f"{number}.mcap"
    write_log(pb.carry("paper", "shared-sign", seed=number, overrides=HIDDEN | keys), place)
    return place


def whole_stretches(carried: Carry) -> list[Stretch]:
    """Those that are long enough."""
    return [one for one in stretches_in(carried, 0) if not one.is_short]


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

    files = write_fit(found, tmp_path / "fitted")
    written = {"robot.toml", "robot.png", "radio.toml", "radio.png"}
    written |= {"robot-errors.csv", "radio-fates.csv", "object.toml", "object.png"}
    assert {file.name for file in (tmp_path / "fitted").iterdir()} == written
    parts = [
        str(tmp_path / "fitted" / name) for name in ("robot.toml", "radio.toml", "object.toml")
    ]
    with_both = [word for part in parts for word in ("--with", part)]
    notes = [str(one) for one in files if isinstance(one, Line)]
    assert any(f"palmbots carry SCENE {' '.join(with_both)}" in one for one in notes)
    assert here("carry", "paper", *with_both, "--seeds", "1").returncode in (0, 1)
    one_of_both = here("fit", "--radio", str(logs[0]), "--out", str(tmp_path / "radio"))
    assert one_of_both.returncode == 0
    of_radio = {name for name in written if name.startswith("radio")}
    assert {file.name for file in (tmp_path / "radio").iterdir()} == of_radio


@pytest.mark.parametrize("direction", ["forward", "backward"])
@pytest.mark.parametrize("controller", ["shared-sign", "silent", "centralized"])
def test_without_noise_every_position_follows_from_the_commands(
    direction: str, controller: str
) -> None:
    """Also while robots accelerate and correct, and where they stand between."""
    keys = {"robot.noise_m_s": 0.0, "task.direction": direction, "start.left_m": 0.03}
    keys |= {"robot.right.bias_m_s": 0.004, "robot.right.acceleration_m_s2": 0.3}
    carried = pb.carry("paper", controller, overrides=keys)
    stretches = whole_stretches(carried)
    assert stretches
    for one in stretches:
        error = one.positions_m - (one.commanded_m - one.commanded_m[0])
        sense = 1 if direction == "forward" else -1
        drift = sense * error[-1] / one.times_s[-1]
        assert drift == pytest.approx(0, abs=1e-9) or drift == pytest.approx(0.004, rel=1e-6)
        np.testing.assert_allclose(error, sense * drift * one.times_s, atol=1e-9)
        assert np.diff(one.times_s).min() > 0 and np.diff(one.times_s).max() < 0.111


def test_a_way_of_less_than_two_seconds_is_no_stretch() -> None:
    for distance_m, count in ((0.1, 0), (0.15, 2)):  # at 6 cm/s
        keys = {"robot.noise_m_s": 0.0, "task.distance_m": distance_m}
        assert len(whole_stretches(pb.carry("paper", "silent", overrides=keys))) == count


def test_between_positions_the_command_stays_the_same() -> None:
    """With wheels that follow at once each way is one of the speeds, times its duration."""
    keys = {"robot.acceleration_m_s2": 100.0, "start.left_m": 0.03}
    carried = pb.carry("paper", "shared-sign", seed=1, overrides=HIDDEN | keys)
    robot = carried.scene.robot_of("left")
    speeds = robot.speed_m_s + robot.correction_m_s * np.array([-1, 0, 1])
    ways = [np.diff(one.commanded_m) / np.diff(one.times_s) for one in whole_stretches(carried)]
    seen = np.abs(np.concatenate(ways))[:, None] - speeds
    assert (np.abs(seen) < 1e-6).any(axis=1).all()
    assert ((np.abs(seen) < 1e-6).sum(axis=0) > 0).sum() > 1


def test_no_position_is_used_twice() -> None:
    """Two equal ones would show that positions have no noise. The command changes at once here."""
    times = np.arange(30) / 100
    assert thinned(times, np.where(times < 0.015, 0.06, 0.05)) == [0, 1, 2, 12, 22]


def test_delays_of_whole_ticks_have_the_mean_of_the_radio(logs: list[Path]) -> None:
    """The simulation rounds delays up to whole ticks."""
    packets = [one for log in logs for one in read_carry(log, 0).packets]
    delays = np.concatenate([one.delays_s for one in packets])
    assert len(packets) == 8 and len(delays) > 300
    assert delays.mean() == pytest.approx(0.03 + 0.04 / 2, abs=0.003)
    assert delays.std() == pytest.approx(0.04 / np.sqrt(12), abs=0.0015)
    assert 0.03 - 1e-9 < delays.min() < 0.032 and 0.068 < delays.max() < 0.07


@pytest.mark.parametrize("jitter_s", [0.0, 0.004, 0.025, 0.04])
@pytest.mark.parametrize("latency_s", [0.03, 0.0347, 0.0399])
def test_delays_within_a_control_period_are_in_the_intervals(
    latency_s: float, jitter_s: float
) -> None:
    """Packets arrive at any time, and programs notice them at the end of a period of 10 ms."""
    missed = 0
    for seed in range(8):
        late = latency_s + jitter_s * np.random.default_rng(seed).random(200)
        ticks = np.ceil(late / 0.01 - 1e-9) * 0.01
        times = [(0.1 * k, 0.1 * k + float(delay)) for k, delay in enumerate(ticks)]
        packets = _packets(Source("", ""), Sent(times, is_timed=True), 0.01)
        assert packets is not None
        latency, jitter = fit_packets([packets]).estimates[:2]
        for one, value in ((latency, latency_s), (jitter, jitter_s)):
            assert one.low is not None and one.high is not None
            missed += not one.low - 1e-9 <= value <= one.high + 1e-9
    assert missed <= 2


def test_packets_of_a_log_are_numbered_as_sent_and_have_an_interval_if_regular() -> None:
    source = Source("", "")
    regular = [(0.05 * k, None if k % 10 == 3 else 0.05 * k + 0.02) for k in range(100)]
    found = _packets(source, Sent(regular, is_timed=True), 0.01)
    assert found is not None and found.interval_s == pytest.approx(0.05)
    assert found.gaps.sum() == 10 and found.received == 90 and found.reordered == 0
    np.testing.assert_allclose(found.delays_s, 0.02)  # all equal: nothing is rounded
    overtaken = [*regular[:50], (2.5, 2.58), *regular[51:]]
    found = _packets(source, Sent(overtaken, is_timed=True), 0.01)
    assert found is not None and found.reordered == 1 and found.gaps.sum() == 10
    slower = [(0.05 * k + 0.004 * k**1.1, 0.05 * k + 0.004 * k**1.1 + 0.02) for k in range(30)]
    found = _packets(source, Sent(slower, is_timed=True), 0.01)
    assert found is not None and found.interval_s is not None
    steps = np.diff([now for now, _ in slower])
    assert found.interval_s == pytest.approx(float(np.median(steps)))
    bursts = [(0.3 * (k // 3) + 0.02 * (k % 3), 0.3 * (k // 3) + 0.02 * (k % 3)) for k in range(60)]
    irregular = _packets(source, Sent(bursts, is_timed=True), 0.01)
    assert irregular is not None and irregular.interval_s is None
    assert _packets(source, Sent(regular[:21], is_timed=True), 0.01) is None  # 18 of them arrived
    untimed = _packets(source, Sent(regular, is_timed=False), 0.01)
    assert untimed is not None and untimed.gaps.sum() == 10 and not untimed.delays_s.size


@pytest.mark.slow
def test_intervals_cover_the_hidden_values() -> None:
    """Of 5 fits; tests/soak/test_fit_coverage.py makes 400."""
    hits = sum((Counter(covered("shared-sign", number)) for number in range(5)), Counter())
    assert min(hits[key] for key in HIDDEN) >= 2, hits


@pytest.mark.slow
def test_a_controller_that_stops_robots_does_not_shift_the_gain() -> None:
    """It answers to the noise, and stops robots that are too fast. At positions that are only
    thinned, and in stretches that begin with stationary noise, the gain is found 0.08 too low."""
    assert "robot.gain" in covered("silent", 0)


def covered(controller: str, number: int) -> set[str]:
    """The hidden values that lie in their intervals, fitted to six carries."""
    of = carries_fitted(controller, number, 6)
    return {key for key, value in HIDDEN.items() if contains(of[key], value)}


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_logs_of_robots_are_fitted(
    direction: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their packets have the loss and the latency of the simulated radio, from 10 to 50 ms, and
    their wheels count what was commanded."""
    air = Air(delay_ms=30, loss=0.1, jitter_ms=20, seed=4)
    simulated_clock(monkeypatch)["air"] = air
    keys = {"task.distance_m": 0.3, "task.direction": direction}
    pair = LoggedPair(tmp_path, "shared-sign", air, UP, keys)
    pair.carry()
    folder = pair.written()
    wanted = rf"is the log of one program .* take the folder .*, {re.escape(str(folder))}$"
    for file in folder.glob("*.mcap"):
        with pytest.raises(pb.PalmbotsError, match=wanted):
            pb.fit([file])
    stretches = [one for one in read_carry(folder, 0).stretches if not one.is_short]
    assert stretches
    for one in stretches:
        assert one.speed_m_s / one.command_m_s == pytest.approx(1, abs=0.1)
    found = pb.fit([folder])
    assert isinstance(found, LogFit) and found.radio is not None
    of = {one.key: one for one in found.radio.estimates}
    for key, value in {
        "packets_lost": 0.1,
        "radio.latency_s": 0.01,
        "radio.jitter_s": 0.04,
    }.items():
        one = of[key]
        assert one.low is not None and one.high is not None
        assert one.low - 0.01 <= value <= one.high + 0.01, key
    assert of["radio.latency_s"].value == pytest.approx(0.01, abs=0.003)
    assert of["radio.jitter_s"].value == pytest.approx(0.04, abs=0.012)
    assert found.radio.data.model_s[0] == pytest.approx(0.01, abs=0.003)


def test_what_is_no_such_log_is_refused(logs: list[Path], tmp_path: Path) -> None:
    refused: Callable[..., Any] = pytest.raises
    shutil.copy(logs[0], tmp_path / "one.mcap")
    with refused(pb.PalmbotsError, match="nothing is identified, and nothing is written"):
        pb.fit([tmp_path / "one.mcap"], motion=True)
    with refused(pb.PalmbotsError, match="one.mcap has [0-9] straight stretches"):
        pb.fit([tmp_path], motion=True)  # the folder of one carry stands for its log
    with refused(pb.PalmbotsError, match=r"one.mcap: has the content of .*; expected each"):
        pb.fit([logs[0], tmp_path / "one.mcap"])
    curved = pb.carry("paper", "silent", world="mujoco", overrides=CURVE)
    write_log(curved, tmp_path / "curve.mcap")
    with refused(pb.PalmbotsError, match="is of a curved path; expected carries on a straight"):
        pb.fit([tmp_path / "curve.mcap"])


CURVE = {
    "task.path.kind": "arc", "task.path.radius_m": 3.0, "task.path.angle_deg": 5.0,
    "task.distance_m": 0.26,
}  # fmt: skip
