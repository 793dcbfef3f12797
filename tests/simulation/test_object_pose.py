# SPDX-License-Identifier: Apache-2.0
"""The pose of the object in a trace: where it is in the world, and how it is turned."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.spec import to_spec


def com_from_the_right(carry: pb.simulation.Carry) -> tuple[np.ndarray, np.ndarray]:
    """The COM by way of the right palm, in complex numbers; the product goes by the left one."""
    assert carry.trace is not None
    trace, spec = carry.trace, to_spec(carry.scene)
    palm, p, lift = (trace[name].sel(side="right") for name in ("palm", "contact", "vertex_height"))
    pivot = trace["midpoint"] + trace["separation"] / 2
    radius = spec.corners[spec.contact_right][2]
    across = 1j * (spec.palms[1].offset + radius + lift)
    vertex = pivot.to_numpy() + (p + across).to_numpy() * np.exp(1j * palm.to_numpy())
    seen = complex(spec.com_left - spec.width, spec.com_height)
    com = vertex + seen * np.exp(1j * trace["object"].to_numpy())
    return com.real, com.imag


@pytest.mark.parametrize("keys", [{}, {"object.edge_radius_m": 0.01}, {"palm.shallow_deg": -2}])
def test_the_pose_follows_from_either_palm(keys: dict[str, Any]) -> None:
    carry = pb.carry("paper", overrides={"task.distance_m": 0.3, "object": "plank", **keys})
    assert carry.trace is not None
    x, y = com_from_the_right(carry)
    np.testing.assert_allclose(carry.trace["object_x"], x, atol=1e-9)
    high = carry.trace["object_height"].to_numpy()
    np.testing.assert_allclose(high - high[0], y - y[0], atol=1e-9)
    assert carry.trace["object_x"].attrs["units"] == "m" and high.min() > 0
    assert abs(x[-1] - x[0] - carry.distance_m) < 0.05


def test_on_the_floor_the_height_is_that_of_the_com() -> None:
    carry = pb.carry("lift", overrides={"robot.noise_m_s": 0.0})
    assert carry.trace is not None and carry.floor_job is not None
    spec = to_spec(carry.scene)
    stands = spec.com_height + spec.corners[0][2]
    high = carry.trace["object_height"].to_numpy()
    assert high[0] == pytest.approx(stands, abs=1e-9) and high.max() > stands + 0.02


def test_a_log_gives_the_same_pose_without_storing_it(tmp_path: Path) -> None:
    carry = pb.carry("paper", overrides={"task.distance_m": 0.1})
    pb.write_log(carry, tmp_path / "a.mcap")
    again = pb.read_log(tmp_path / "a.mcap")
    assert carry.trace is not None
    for name in ("object_x", "object_height"):
        np.testing.assert_array_equal(again.trace[name], carry.trace[name])
        assert "log_field" not in again.trace[name].attrs
