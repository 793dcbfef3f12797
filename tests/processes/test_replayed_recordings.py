# SPDX-License-Identifier: Apache-2.0
"""Processes in real time that replay recordings: the wheels of both robots, and each link."""

from pathlib import Path

import numpy as np
import pytest

import palmbots as pb
from json_output import read_json
from pair_programs import started
from palmbots.fitting.log_fit import LogFit
from traces import error_trace, radio_trace

DISTANCE_M, GAIN, LOSS, LATENCY_S = 0.2, 0.5, 0.25, 0.1


def test_robots_and_links_replay_recordings(tmp_path: Path) -> None:
    """Both robots are slow, and every fourth packet is lost. The fit of the logs finds the losses
    and delays again."""
    slow = error_trace(tmp_path / "slow.csv", [np.zeros(41)] * 3, 0.1, np.full(3, GAIN))
    lost = np.arange(100) % round(1 / LOSS) == 0
    fates = radio_trace(tmp_path / "fates.csv", lost, 0.05, np.full(100, LATENCY_S))
    keys = [f"task.distance_m={DISTANCE_M}", f"robot.error_trace={slow}", f"radio.trace={fates}"]
    keys += ["control.period_s=0.04", "control.watchdog_s=0.4"]  # on a busy machine
    words = [word for key in keys for word in ("--set", key)]
    logs = tmp_path / "logs"
    printed, errors = started(["up", *words, "--json", "--log", str(logs)]).communicate(timeout=100)
    carry = read_json("up", printed)
    assert carry["outcome"] == "delivered", errors
    assert carry["time_s"] > DISTANCE_M / (GAIN * 0.06)
    found = pb.fit([logs], radio=True)
    assert isinstance(found, LogFit) and found.radio is not None
    rows = {one.key: one for one in found.radio.estimates}
    assert rows["packets_lost"].value == pytest.approx(LOSS, abs=0.05)
    assert rows["one_way_delay_median_s"].value == pytest.approx(LATENCY_S, abs=0.04)
