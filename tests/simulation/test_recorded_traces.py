# SPDX-License-Identifier: Apache-2.0
"""Carries that replay recordings: they equal carries with the model that the recordings were made
from, or none where the recordings are empty."""

import itertools
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, run_seeds
from palmbots.simulation.result import Carry
from traces import error_trace, radio_trace, wandering

STILL = {"robot.noise_m_s": 0.0}
ZEROS = [np.zeros(41), np.zeros(13)]


def dropped(overrides: dict[str, Any], controller: str, carries: int = 1500) -> tuple[float, float]:
    """The share of carries that drop the object, and its standard deviation."""
    spec = to_spec(load_scene("paper", overrides))
    columns = run_seeds(spec, controller, 0, carries, threads=2)
    share = float(np.mean(columns["outcome"] == DROPPED))
    return share, max(1 / carries, np.sqrt(share * (1 - share) / carries))


def speeds_of(carry: Carry) -> Any:
    """The speeds of both robots in each tick [m/s]."""
    assert carry.trace is not None
    return carry.trace["speed"].values


@pytest.mark.parametrize("world", ["quasistatic", "mujoco"])
@pytest.mark.parametrize("gain", ["carry", "segment"])
def test_a_recording_of_zeros_is_no_noise(world: str, gain: str, tmp_path: Path) -> None:
    """To the last bit, although the scene's model has errors."""
    errors: dict[str, Any] = {
        "robot.error_trace": error_trace(tmp_path / "zeros.csv", ZEROS, 0.1),
        "robot.trace_gain": gain,
        "task.distance_m": 0.3,
    }
    without = pb.carry("paper", overrides=STILL | {"task.distance_m": 0.3}, world=world)
    modelled = {"robot.gain": 1.05, "robot.bias_m_s": 0.01, "robot.gain_sd": 0.02}
    more = {"robot.white_noise_m_per_sqrt_s": 0.01, "robot.standing_noise_m_s": 0.01}
    with_zeros = pb.carry("paper", overrides=errors | modelled | more, world=world)
    assert with_zeros.trace_hash == without.trace_hash


def test_a_recording_without_losses_is_a_plain_radio(tmp_path: Path) -> None:
    for delays, kind in ((None, ""), (np.zeros(60), "later_s"), (np.full(60, 0.05), "delay_s")):
        file = radio_trace(tmp_path / f"{kind}.csv", np.zeros(60), 0.02, delays, kind)
        given = pb.carry("paper", "shared-sign", overrides={"radio.trace": file})
        assert given.trace_hash == pb.carry("paper", "shared-sign").trace_hash


def test_single_carries_and_lanes_and_processes_agree(tmp_path: Path) -> None:
    files = {
        "robot.error_trace": error_trace(
            tmp_path / "errors.csv",
            wandering(9, 3.0, 0.015, 0.5, 1),
            0.01,
            np.linspace(0.9, 1.1, 9),
        ),
        "radio.trace": radio_trace(
            tmp_path / "radio.csv", np.arange(70) % 7 == 0, 0.04, np.linspace(0, 0.1, 70)
        ),
    }
    for gain in ("carry", "segment"):
        spec = to_spec(load_scene("paper", files | {"robot.trace_gain": gain}))
        again = pickle.loads(pickle.dumps(spec))
        assert again.to_bytes() == spec.to_bytes() != to_spec(load_scene("paper")).to_bytes()
        for name in shipped_names():
            columns = run_seeds(spec, name, 0, 6)
            for seed in range(6):
                run = _core.run(again, name, seed, "double", False)
                assert run.time_s == columns["time_s"][seed]
                assert run.distance_m == columns["distance_m"][seed]
                assert run.messages_lost == columns["messages_lost"][seed]


def test_the_mirrored_carry_replays_the_mirrored_recording(tmp_path: Path) -> None:
    file = error_trace(tmp_path / "errors.csv", wandering(5, 4.0, 0.02, 0.5, 2), 0.01)
    scene = load_scene("paper", {"robot.left.error_trace": file})
    one, other = (pb.carry(each, "resilient") for each in (scene, scene.mirrored()))
    assert other.time_s == one.time_s
    assert (other.contact_rms_m.left, other.contact_rms_m.right) == (
        one.contact_rms_m.right,
        one.contact_rms_m.left,
    )


def test_each_robot_has_a_place_of_its_own(tmp_path: Path) -> None:
    """And each seed; one robot may have a recording and the other the model."""
    file = error_trace(tmp_path / "errors.csv", wandering(40, 4.0, 0.02, 0.5, 3), 0.01)
    given = {"robot.error_trace": file}
    carries = [pb.carry("paper", "none", overrides=given, seed=seed) for seed in (0, 1)]
    speeds = [speeds_of(carry)[:150] for carry in carries]
    pairs = [speeds[0][:, 0], speeds[0][:, 1], speeds[1][:, 0], speeds[1][:, 1]]
    assert len({one.tobytes() for one in pairs}) == 4
    alone = pb.carry("paper", "none", overrides={"robot.left.error_trace": file})
    modelled = speeds_of(pb.carry("paper", "none"))
    found = speeds_of(alone)[:150]
    assert (found[:, 0] == speeds[0][:, 0]).all()
    assert (found[:, 1] == modelled[:150, 1]).all()


def test_displacements_are_those_recorded(tmp_path: Path) -> None:
    """A robot that drives at its speed is displaced by the speed, and by what the recording says:
    a saw tooth, of segments with slopes of their own."""
    slopes = [0.004, -0.002, 0.001]
    segments = [slope * 0.25 * np.arange(9) for slope in slopes]
    file = error_trace(tmp_path / "errors.csv", segments, 0.25, [1.0, 1.1, 1.2])
    for gain in ("carry", "segment"):
        given = {"robot.error_trace": file, "robot.trace_gain": gain}
        carry = pb.carry("paper", "none", overrides=given, seed=4)
        found = speeds_of(carry)[30:-1, 0]
        own = [[0.06 * g + slope for slope in slopes] for g in (1.0, 1.1, 1.2)]
        wanted = (
            [own[k][k] for k in range(3)]
            if gain == "segment"
            else min(own, key=lambda one: np.abs(found[0] - np.array(one)).min())
        )
        off = np.abs(found[:, None] - np.array(wanted)).min(axis=1)
        assert off.max() < 1e-12
        ends = np.flatnonzero(np.abs(np.diff(found)) > 1e-9)
        assert all(step % 200 == 0 for step in np.diff(ends))


@pytest.mark.slow
@pytest.mark.parametrize(("controller", "sigma"), [("none", 0.006), ("shared-sign", 0.08)])
def test_recorded_noise_drops_as_often_as_the_noise(
    controller: str, sigma: float, tmp_path: Path
) -> None:
    file = error_trace(tmp_path / "errors.csv", wandering(800, 6.0, sigma, 0.5, 5), 0.01)
    noise, noise_sd = dropped({"robot.noise_m_s": sigma}, controller)
    given = {"robot.noise_m_s": sigma, "robot.error_trace": file}
    replayed, replayed_sd = dropped(given, controller)
    assert 0.05 < noise < 0.95
    assert abs(replayed - noise) < 3.3 * np.hypot(noise_sd, replayed_sd)


@pytest.mark.slow
def test_recorded_losses_drop_as_often_as_independent_ones(tmp_path: Path) -> None:
    loss = 0.04
    lost = np.random.default_rng(6).random(20_000) < loss
    file = radio_trace(tmp_path / "radio.csv", lost, 0.05)
    for controller in ("distributed", "shared-sign"):
        model, model_sd = dropped({"radio.loss": loss}, controller, 3000)
        replayed, replayed_sd = dropped({"radio.trace": file, "radio.loss": 1.0}, controller, 3000)
        assert abs(replayed - model) < 3.3 * np.hypot(model_sd, replayed_sd)


@pytest.mark.parametrize("interval_s", [0.5, 0.001])
def test_a_packet_has_the_fate_of_its_time_and_none_counts_twice(
    interval_s: float, tmp_path: Path
) -> None:
    """Every second recorded packet was lost. A sparse recording loses every second packet; of a
    dense one, packets that are sent every 10 ms all have the same fate."""
    file = radio_trace(tmp_path / "radio.csv", np.arange(60) % 2, interval_s)
    carry = pb.carry("paper", "resilient", overrides={"radio.trace": file})
    for side in ("left", "right"):
        lost = [one.received_s is None for one in carry.message_log if one.sender == side]
        changes = sum(one != other for one, other in itertools.pairwise(lost))
        assert len(lost) > 50
        assert changes == (len(lost) - 1 if interval_s > 0.1 else 0)
