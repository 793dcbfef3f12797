# SPDX-License-Identifier: Apache-2.0
"""At least 200 carries of real processes in real time, at up to five times its speed, with faults
at random times. `live_table.py` shows what happened, fault by controller.

A run in which the machine itself held up a process for more than 20 ms is reported separately, and
is no failure: at five times real time that is the watchdog's whole time.
"""

import json
from pathlib import Path

import pytest

from live_carries import CONTROLLERS, FAULTS, LiveRun, run_live_carry
from waiting import locked

pytestmark = pytest.mark.soak
RUNS = 5  # of each fault and controller: 220
RATES = (5.0, 2.0, 5.0, 1.0, 5.0)
RESULTS = Path(__file__).resolve().parent.parent.parent / "build" / "soak" / "live_carries.jsonl"


def keep(run: LiveRun) -> None:
    RESULTS.parent.mkdir(parents=True, exist_ok=True)
    with locked(RESULTS.with_suffix(".lock")), RESULTS.open("a", encoding="utf-8") as file:
        print(json.dumps(run.summary(), ensure_ascii=False), file=file)


@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_at_a_random_time(fault: str, controller: str, soak_seed: int) -> None:
    for number, rate in zip(range(RUNS), RATES, strict=True):
        run = run_live_carry(fault, controller, soak_seed + number, rate)
        keep(run)
        if run.was_held:
            continue
        described = json.dumps(run.summary())
        assert not run.outcome.startswith(("error", "no result", "hangs")), described
        assert run.outcome != "stopped (no reason)", described
        if fault == "world killed":
            assert run.outcome == "void", described
        elif controller == "distributed":  # it may hang, also until it drops, and then says so
            hangs = any("hangs" in line for line in run.says)
            assert run.outcome == "delivered" or run.says or hangs, described
        elif controller == "silent" and fault.startswith(("left", "right")):
            # Its partner can only feel that it stands (docs/theory/sign-controllers.md), sometimes
            # too late; the operator reads why.
            assert run.outcome == "delivered" or run.says, described
        else:
            assert run.outcome != "dropped, avoidable", described
