# SPDX-License-Identifier: Apache-2.0
"""Results as labelled datasets and data frames, and the text of a carry."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._util.results import FIGURES, Result
from palmbots.errors import PalmbotsError

SHORT = {"task.distance_m": 0.3}


@pytest.fixture(scope="module")
def comparison() -> pb.simulation.Comparison:
    return pb.compare(
        values=[0.5, 0.05], controllers=["none", "resilient"], carries=5, overrides=SHORT
    )


def states() -> Any:
    return pb.contact_modes_batch(
        width=0.25, com_x=0.125, com_y=[0.02, 0.04], theta_left=0.2, theta_right=0.2,
        p_left=0.0, p_right=[[0.0], [0.01], [0.02]], friction_left=0.3, friction_right=0.3,
    )  # fmt: skip


def test_text_of_a_carry_states_the_outcome() -> None:
    carry = pb.carry("paper", "none", overrides={"robot.noise_m_s": 0.1}, record=False)
    assert repr(carry).startswith(f"DROPPED  {carry.distance_m:.2f} of 1.50 m in ")
    assert "off-palm: a contact left the usable part of its palm" in repr(carry)
    assert f"trace {carry.trace_hash}" in repr(carry)


def test_comparison_as_dataset_has_every_row(comparison: pb.simulation.Comparison) -> None:
    table = comparison.to_xarray()
    assert table.sizes == {"controller": 2, "value": 2, "end": 2}
    assert table["value"].values.tolist() == [0.05, 0.5]
    assert len(comparison.rows) == 3
    for row in comparison.rows:
        cell = table.sel(controller=row.controller, value=row.value)
        assert float(cell["drop_rate"]) == row.drop_rate
        assert float(cell["rms_m"]) == row.rms_m
        assert tuple(cell["drop_rate_interval"].values) == row.interval
        assert tuple(cell["rms_interval_m"].values) == row.rms_interval_m
    (refusal,) = comparison.refusals
    assert (refusal.controller, refusal.value) == ("resilient", 0.5)
    assert np.isnan(table["rms_m"].sel(controller="resilient", value=0.5))
    attrs = {"key": "radio.latency_s", "seed": 0, "carries": 5, "world": "quasistatic"}
    assert table.attrs == attrs


def test_comparison_as_dataframe_has_every_row(comparison: pb.simulation.Comparison) -> None:
    frame = comparison.to_dataframe()
    assert len(frame) == 3
    for i, row in enumerate(comparison.rows):
        line = frame.iloc[i]
        assert (line["controller"], line["value"]) == (row.controller, row.value)
        assert (line["interval_low"], line["interval_high"]) == row.interval


def test_modes_batch_as_dataset_has_the_arrays() -> None:
    batch = states()
    table = batch.to_xarray()
    assert table.sizes == {"dim_0": 3, "dim_1": 2, "side": 2, "end": 2, "mode": 9}
    np.testing.assert_array_equal(table["squeeze"], batch.squeeze)
    np.testing.assert_array_equal(table["feasible"].sel(mode="ST-ST"), batch.feasible[..., 0])


def test_modes_batch_as_dataframe_has_a_line_for_each_state() -> None:
    batch = states()
    frame = batch.to_dataframe()
    assert len(frame) == 6
    for _, line in frame.iterrows():
        state = (line["dim_0"], line["dim_1"])
        assert line["squeeze_right_low"] == batch.squeeze[(*state, 1, 0)]
        assert line["ST-ST"] == batch.feasible[(*state, 0)]
        assert line["opening"] == batch.opening[state]
    assert list(frame.columns[2:4]) == ["squeeze_left_low", "squeeze_left_high"]


def test_figures_are_available_from_results(comparison: pb.simulation.Comparison) -> None:
    carry = pb.carry("paper", overrides=SHORT)
    assert len(carry.plot().axes) >= 7
    assert carry.plot("message_sequence").axes
    assert len(comparison.plot().axes) == 4


def test_figures_of_other_results_are_refused(
    comparison: pb.simulation.Comparison, tmp_path: Path
) -> None:
    """With the figures that this kind of result has; some of them are registered for others."""
    carry = pb.carry("paper", overrides=SHORT)
    for result, figures in (
        (carry, "carry, message_sequence"),
        (comparison, "sweep"),
        (pb.analyze("paper"), "operating-region, stability-geometry, friction-cones"),
    ):
        wrong: set[Any] = {"operating-region", "study", "timeline", "", 5, ("carry",)}
        for name in {"carry", "sweep"} | wrong:
            if name == result.figure:
                continue
            with pytest.raises(PalmbotsError, match=f"^figure: value is .*; .*allowed: {figures}"):
                result.plot(name)
            with pytest.raises(PalmbotsError, match=f"^figure: value is .*; .*allowed: {figures}"):
                result.save_figure(tmp_path / "x.png", name)
    carry.save_figure(tmp_path / "messages.svg", "message_sequence")
    assert [path.name for path in tmp_path.iterdir()] == ["messages.svg"]


def test_figure_from_outside_the_package_is_drawn() -> None:
    class Own(Result):
        figure = "own"

    FIGURES.register("own", lambda result, size=1: (type(result).__name__, size))
    try:
        assert Own().plot(size=3) == ("Own", 3)
    finally:
        FIGURES.unregister("own")
