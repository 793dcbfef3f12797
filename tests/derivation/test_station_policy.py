# SPDX-License-Identifier: Apache-2.0
"""A station that runs the nine rows of a policy file, compared with the file as one reads it."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import palmbots as pb

POLICIES = sorted((Path(__file__).parents[2] / "examples" / "policies").glob("*.toml"))
SIGN = {-1: "-", 0: "0", 1: "+"}


def drives(commanded: np.ndarray, nominal: float) -> list[list[str]]:
    """What the wheels add to the nominal speed; left moves away backwards."""
    extra = np.rint((commanded - nominal) / 0.03).astype(int) * [-1, 1]
    return [[{-1: "closer", 0: "hold", 1: "away"}[e] for e in row] for row in extra]


@pytest.mark.parametrize("path", POLICIES, ids=lambda path: path.stem)
def test_commands_are_those_of_the_rows(path: Path) -> None:
    rows = tomllib.loads(path.read_text())["rows"]
    ages, seen = 0, set()
    for seed in range(6):
        carried = pb.carry("paper", f"{path}@station", seed=seed)
        assert carried.trace is not None
        trace = carried.trace
        signs = trace["sign"].transpose("time", "side").to_numpy()
        palms = np.rint(
            np.degrees(trace["palm"].transpose("time", "side").to_numpy()),
        )
        moves = drives(trace["commanded"].transpose("time", "side").to_numpy(), 0.06)
        ages = 0
        for k in range(1, len(signs) - 1):
            ages = ages + 1 if (signs[k] == signs[k - 1]).all() else 0
            row = rows[SIGN[signs[k][0]] + SIGN[signs[k][1]]]
            if ages < 60:  # radio there and back, palms, radio there and back again
                continue
            assert [{15: "steep", 5: "shallow"}[a] for a in palms[k]] == row["palms"]
            assert moves[k] == row["drives"]
            seen.add(tuple(signs[k]))
    assert (0, 0) in seen


def test_robots_drive_only_when_the_palms_are_there() -> None:
    """Without noise: where signs change to and fro, the station acts on reports that are old."""
    path = next(p for p in POLICIES if p.stem == "table-1")
    jolts = [
        {"robot": "right", "at_s": 0.5, "shift_m": 0.02},
        {"robot": "left", "at_s": 2.5, "shift_m": -0.03},
    ]
    quiet = {"robot.noise_m_s": 0.0, "bumps.script": jolts, "task.distance_m": 0.4}
    carried = pb.carry("paper", f"{path}@station", overrides=quiet)
    assert carried.trace is not None
    palms = np.degrees(carried.trace["palm"].transpose("time", "side").to_numpy())
    moves = drives(carried.trace["commanded"].transpose("time", "side").to_numpy(), 0.06)
    turning = (np.abs(palms - 15) > 1e-6) & (np.abs(palms - 5) > 1e-6)
    started = [k for k in range(1, len(moves)) if moves[k] != ["hold", "hold"] == moves[k - 1]]
    assert len(started) == 2
    assert not any(turning[k].any() for k in started)


def test_logs_replay(tmp_path: Path) -> None:
    name = f"{POLICIES[-1]}@station"
    scene = pb.load_scene("paper", {"task.distance_m": 0.3})
    pb.write_log(pb.carry(scene, name, seed=2), tmp_path / "carry.mcap")
    assert pb.replay(tmp_path / "carry.mcap").identical
