# SPDX-License-Identifier: Apache-2.0
"""The trace of a run of robots: what encoders count, not what was commanded."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from logged_pairs import LoggedPair, simulated_clock
from palmbots.fitting.recorded_logs import stretches_in
from palmbots.logs.run_log_reader import RunLog
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air
from palmbots.views.log_alignment import align
from palmbots.views.logged_carries import logged_carries
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run

KEYS = {"task.distance_m": 0.5, "robot.noise_m_s": 0.02, "radio.latency_s": 0.03}


@pytest.fixture(params=["forward", "backward"])
def direction(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def logs(direction: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[RunLog]:
    air = Air(delay_ms=30, seed=4)
    simulated_clock(monkeypatch)["air"] = air
    pair = LoggedPair(tmp_path, "shared-sign", air, UP, KEYS | {"task.direction": direction})
    pair.carry()
    return read_run([pair.written()])


def test_speeds_and_separation_are_measured(logs: list[RunLog]) -> None:
    """The robots have noise of 2 cm/s each. In a carry of the simulation the separation has a
    standard deviation of some millimetres, too."""
    trace: Any = carry_of(logs, align(logs)).trace
    errors = (trace["speed"] - trace["commanded"]).to_numpy()
    smooth = np.mean(errors[: len(errors) // 20 * 20].reshape(-1, 20, 2), axis=1)
    assert (np.std(smooth, axis=0) > 0.01).all()
    assert np.corrcoef(smooth.T)[0, 1] < 0.5
    assert float(trace["separation"].std()) > 0.002


def test_the_robots_move_apart_as_their_speeds_differ(logs: list[RunLog], direction: str) -> None:
    """And the object moves with the mean of both, in the direction of the task."""
    carry = carry_of(logs, align(logs))
    trace: Any = carry.trace
    period_s = float(trace["time"][1] - trace["time"][0])
    ways = period_s * np.cumsum(trace["speed"].to_numpy(), axis=0)[:-1]
    separation = trace["separation"].to_numpy()
    np.testing.assert_allclose(np.diff(ways), (separation[1:] - separation[0])[:, None], atol=1e-9)
    np.testing.assert_allclose(ways.mean(axis=1), trace["midpoint"].to_numpy()[1:], atol=1e-9)
    simulated: Any = pb.carry("paper", "shared-sign", seed=0).trace
    assert separation[0] == pytest.approx(float(simulated["separation"][0]), abs=1e-9)
    sense = 1 if direction == "forward" else -1
    assert sense * float(trace["midpoint"][-1]) == pytest.approx(0.5, abs=0.05)
    assert sense * float(trace["commanded"].mean()) > 0.03
    assert carry.distance_m == pytest.approx(0.5, abs=0.05)


def test_without_encoders_the_time_counts_and_the_separation_is_unknown(
    logs: list[RunLog],
) -> None:
    ticks = round(0.5 / 0.06 / 0.01)
    blind: list[RunLog] = []
    for log in logs:
        if log.end == "station":
            blind.append(log)
            continue
        for _, tick in log.messages["ticks"]:
            tick.progress = 0
        blind.append(replace(log, facts=log.facts | {"settings": {"travel": ticks}}))
    clocks = align(blind)
    carry = carry_of(blind, clocks)
    assert carry.trace is not None and np.isnan(carry.trace["separation"]).all()
    assert carry.distance_m == pytest.approx(0.5, abs=0.1)
    middle = 0.01 * np.cumsum(carry.trace["commanded"].to_numpy().mean(axis=1))
    np.testing.assert_allclose(carry.trace["midpoint"].to_numpy()[1:], middle[:-1], atol=1e-9)
    assert not list(stretches_in(carry, 0))  # nothing to fit
    mixed = [blind[k] if log.end == "left" else log for k, log in enumerate(logs)]
    of_one: Any = carry_of(mixed, clocks).trace
    assert np.isnan(of_one["separation"]).all()
    assert all(0.85 < one.covered <= 1 for one in logged_carries(blind, clocks))
