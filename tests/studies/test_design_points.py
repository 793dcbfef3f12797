# SPDX-License-Identifier: Apache-2.0
"""The points of a study: grids, axes, lists and designs."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import palmbots as pb
from palmbots.studies.designs import DESIGNS
from palmbots.studies.points import Points, design_points
from palmbots.studies.study_file import load_plan


def points(**table: Any) -> Points:
    return design_points(load_plan(table))


def shares(kind: str, dims: int, n: int, seed: int) -> NDArray[np.float64]:
    sample = DESIGNS[kind].sample
    assert sample is not None
    return sample(dims, n, seed)


def test_grid_has_every_combination_with_the_last_key_fastest() -> None:
    found = points(
        vary={
            "radio.latency_s": [0.0, 0.1],
            "robot.noise_m_s": {"from": 0.01, "to": 0.04, "steps": 4},
        }
    )
    assert found.shape == (2, 4)
    assert found.values[:5] == ((0.0, 0.01), (0.0, 0.02), (0.0, 0.03), (0.0, 0.04), (0.1, 0.01))
    assert found.scene(4) == pb.load_scene("paper", {"radio.latency_s": 0.1})
    assert found.dims == ("radio.latency_s", "robot.noise_m_s")


def test_values_may_be_lists_of_lists() -> None:
    outlines = [[[0, 0], [0.25, 0], [0.25, h], [0, h]] for h in (0.07, 0.08)]
    found = points(vary={"object.vertices_m": outlines, "robot.noise_m_s": [0.01, 0.02]})
    assert found.levels("object.vertices_m") == outlines
    assert found.scene(3).object.vertices_m[2] == (0.25, 0.08)


def test_logarithmic_axis_is_geometrically_spaced() -> None:
    span = {"from": 0.001, "to": 0.1, "steps": 5, "scale": "log"}
    found = points(vary={"radio.latency_s": span})
    assert found.column("radio.latency_s") == pytest.approx(np.geomspace(0.001, 0.1, 5), rel=1e-11)


def test_study_without_varied_keys_has_one_point() -> None:
    found = points()
    assert (found.shape, found.values, found.dims) == ((1,), ((),), ("point",))


def test_key_without_effect_at_some_points_only_is_accepted() -> None:
    """Zones of the sensor replace its half width."""
    zones = [{"sign": "+", "from_m": 0, "to_m": 1}]
    widths = [0.004, 0.005]
    vary: dict[str, Any] = {
        "tactile": [{"zones": zones}, {"false_rate": 0.1}], "tactile.zero_half_width_m": widths
    }  # fmt: skip
    assert len(points(vary=vary).values) == 4
    with pytest.raises(pb.PalmbotsError, match=r"study: vary: tactile.zero_half_width_m: no carry"):
        points(vary=vary | {"tactile": [{"zones": zones}]})
    sampled = {"kind": "sobol", "points": 4}
    spans = {key: {"from": 0.1, "to": 0.2} for key in ("robot.noise_m_s", "mujoco.arm_kg")}
    with pytest.raises(pb.PalmbotsError, match=r"study: vary: mujoco.arm_kg: no carry"):
        points(vary=spans, design=sampled)


def test_list_entries_vary_beside_other_keys() -> None:
    """Two entries of one list, the second first, and a key that has nothing to do with it."""
    found = points(
        vary={
            "object.com_m[1]": [0.05, 0.06],
            "robot.noise_m_s": [0.02, 0.03],
            "object.com_m[0]": [0.12, 0.13],
        }
    )
    for i, (height, noise, place) in enumerate(found.values):
        keys = {"robot.noise_m_s": noise, "object.com_m": [place, height]}
        assert found.scene(i) == pb.load_scene("paper", keys)


def test_list_entry_applies_to_the_object_of_the_point() -> None:
    """The other entries of the COM are those of the point's own object."""
    found = points(vary={"object.com_m[1]": [0.02, 0.03], "object": ["box", "l-shape"]})
    coms = set()
    for i, (height, thing) in enumerate(found.values):
        own = pb.load_scene("paper", {"object": thing}).object
        coms.add(own.com_m)
        done = found.scene(i).object
        assert done.com_m == (own.com_m[0], height)
        assert done.vertices_m == own.vertices_m
    assert len({com[0] for com in coms}) == 2


@pytest.mark.parametrize("kind", ["random", "sobol", "halton", "latin-hypercube"])
def test_designs_fill_the_cube_and_keep_their_seed(kind: str) -> None:
    unit = shares(kind, 2, 256, 5)
    assert unit.shape == (256, 2)
    assert (unit >= 0).all() and (unit < 1).all()
    assert (shares(kind, 2, 256, 5) == unit).all()
    assert (shares(kind, 2, 256, 6) != unit).any()
    # Worst difference between the share of points in a corner box and its area.
    grid = np.linspace(0.1, 1, 10)
    off = max(abs(np.mean((unit[:, 0] < a) & (unit[:, 1] < b)) - a * b) for a in grid for b in grid)
    assert off < (0.12 if kind == "random" else 0.06)
    if kind in ("sobol", "latin-hypercube"):
        assert all(np.unique(np.floor(256 * column)).size == 256 for column in unit.T)


def test_halton_points_are_even_in_powers_of_the_bases() -> None:
    """As those of no other design: one point in every 3^5th of the second coordinate."""
    first, second, third = shares("halton", 3, 243, 5).T
    assert np.unique(np.floor(243 * second)).size == 243
    assert np.unique(np.floor(128 * first[:128])).size == 128
    assert np.unique(np.floor(125 * third[:125])).size == 125


def test_saltelli_points_keep_their_seed() -> None:
    one, same, other = (shares("sobol-indices", 3, 64, seed) for seed in (5, 5, 6))
    assert one.shape == (64 * 5, 3)
    assert (one == same).all()
    assert (one != other).any()


def test_design_fills_ranges_and_balances_lists() -> None:
    found = points(
        vary={
            "radio.latency_s": {"from": 0.1, "to": 0.2},
            "palm.friction": {"from": 0.1, "to": 0.4, "scale": "log"},
            "object": ["box", "box-strips"],
        },
        design={"kind": "sobol", "points": 64, "seed": 1},
    )
    assert found.dims == ("point",)
    assert len(found.values) == 64
    latency, friction = (np.array(found.column(k)) for k in found.plan.keys[:2])
    assert 0.1 <= latency.min() < 0.102 < 0.198 < latency.max() <= 0.2
    assert np.count_nonzero(friction < 0.2) == 32
    assert found.column("object").count("box") == 32
