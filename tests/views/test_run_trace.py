# SPDX-License-Identifier: Apache-2.0
"""The trace of a run of robots: what encoders count, not what was commanded."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from logged_pairs import LoggedPair, simulated_clock
from palmbots.logs.run_log_reader import RunLog
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air
from palmbots.views.log_alignment import align
from palmbots.views.logged_carries import logged_carries
from palmbots.views.run_figures import carry_of
from palmbots.views.run_replay import read_run

KEYS = {"task.distance_m": 0.5, "robot.noise_m_s": 0.02, "radio.latency_s": 0.03}


@pytest.fixture
def logs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[RunLog]:
    air = Air(delay_ms=30, seed=4)
    simulated_clock(monkeypatch)["air"] = air
    pair = LoggedPair(tmp_path, "shared-sign", air, UP, KEYS)
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
    assert all(0.85 < one.covered <= 1 for one in logged_carries(blind, clocks))
