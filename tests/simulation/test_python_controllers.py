# SPDX-License-Identifier: Apache-2.0
"""Python controllers in sweeps, batches and drop rates: equal to the compiled one, or refused."""

import dataclasses
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.control.interface import DistributedController, StepInput, StepOutput
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_batch, run_seeds

LOSSY = {"task.distance_m": 0.4, "radio.loss": 0.3, "tactile.false_rate": 0.002}


@pytest.mark.parametrize("precision", ["double", "float"])
def test_python_controller_gives_the_columns_of_the_compiled_one(precision: str) -> None:
    specs = [to_spec(load_scene("paper", LOSSY | {"radio.latency_s": s})) for s in (0.05, 0.3)]
    index, seeds = [0, 1, 1, 0, 0], [4, 4, 5, 6, 2**64 - 1]
    mine = run_batch(specs, index, seeds, DistributedController, precision)
    shipped = run_batch(specs, index, seeds, "distributed", precision)
    assert mine.keys() == shipped.keys()
    for name, column in shipped.items():
        np.testing.assert_array_equal(mine[name], column, err_msg=name)
        assert mine[name].shape == column.shape
    assert shipped["messages_lost"].any()
    assert shipped["corrections"].any()


@pytest.mark.parametrize(
    ("keys", "outcome", "reason"),
    [
        ({}, "delivered", None),
        ({"robot.noise_m_s": 0.1}, "dropped", "off-palm"),
        ({"palm.friction": 0.05}, "dropped", "sliding"),
        ({"task.timeout_s": 1.0}, "stalled", None),
    ],
)
def test_outcomes_and_reasons_have_the_codes_of_the_compiled_columns(
    keys: dict[str, Any], outcome: str, reason: str | None
) -> None:
    scene = load_scene("paper", {"task.distance_m": 0.3} | keys)
    carry = pb.carry(scene, "distributed", record=False)
    assert (carry.outcome, carry.reason) == (outcome, reason)
    mine = run_seeds(to_spec(scene), DistributedController, 0, 1)
    shipped = run_seeds(to_spec(scene), "distributed", 0, 1)
    assert (mine["outcome"], mine["reason"]) == (shipped["outcome"], shipped["reason"])


def test_compare_accepts_a_class_beside_names() -> None:
    options: dict[str, Any] = {"values": [0.0, 0.2], "carries": 4, "overrides": LOSSY}
    result = pb.compare(controllers=["distributed", DistributedController], **options)
    shipped, mine = result.rows[:2], result.rows[2:]
    assert [row.controller for row in mine] == 2 * ["DistributedController"]
    assert [dataclasses.replace(row, controller="distributed") for row in mine] == list(shipped)


def test_progress_of_a_python_controller_grows_within_a_cell() -> None:
    seen: list[float] = []
    pb.compare(
        values=[0.05], controllers=[DistributedController], carries=4, on_progress=seen.append,
        overrides={"task.distance_m": 0.1},
    )  # fmt: skip
    assert seen == sorted(seen)
    assert len(set(seen)) >= 4
    assert seen[-1] == 1.0


def test_ctrl_c_keeps_the_finished_carries_of_a_python_controller() -> None:
    def stop(finished: int) -> None:
        if finished == 2:
            raise KeyboardInterrupt

    spec = to_spec(load_scene("paper", {"task.distance_m": 0.1}))
    with pytest.raises(KeyboardInterrupt) as caught:
        run_seeds(spec, DistributedController, 0, 5, watch=stop)
    columns = caught.value.args[0]
    assert columns["finished"].tolist() == [True, True, False, False, False]
    whole = run_seeds(spec, "distributed", 0, 2)
    np.testing.assert_array_equal(columns["time_s"][:2], whole["time_s"])


class StopsAsFollower:
    """The follower stands and corrects; the leader travels."""

    def step(self, seen: StepInput) -> StepOutput:
        return StepOutput(stop=not seen.leads, move="hold" if seen.leads else "closer")


def test_controller_learns_whether_it_leads_and_can_stop() -> None:
    for direction, leader in (("forward", "right"), ("backward", "left")):
        keys = {"task.direction": direction, "task.distance_m": 0.03}
        trace = pb.carry("paper", StopsAsFollower, overrides=keys).trace
        assert trace is not None
        sense = 1 if direction == "forward" else -1
        follower = "left" if leader == "right" else "right"
        commanded = trace["commanded"].isel(time=slice(1, 20))
        assert commanded.sel(side=leader).to_numpy() == pytest.approx(0.06 * sense)
        assert commanded.sel(side=follower).to_numpy() == pytest.approx(0.03 * sense)
