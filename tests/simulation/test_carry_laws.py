# SPDX-License-Identifier: Apache-2.0
"""Laws that hold for whole carries of all kinds of scenes."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import palmbots as pb
from abstract_world import NONE, STEEP
from palmbots._types import SIDES
from palmbots.control.interface import DistributedController, StepInput, StepOutput
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from strategies import scenes
from table2_transcript import Deed, Robot, tick

CONTROLLERS = ("none", "centralized", "distributed")
REASONS = {"off-palm", "sliding", "flush", "tip", "tipping", "jammed", "lifting"}
MESSAGES = (None, "TiltUp", "TiltDown", "Ack")

controllers = st.sampled_from(CONTROLLERS)
precisions = st.sampled_from(("double", "float"))
seeds = st.integers(0, 2**64 - 1)
many = settings(max_examples=75)


def columns(carry: pb.simulation.Carry) -> dict[str, np.ndarray]:
    assert carry.trace is not None
    return {str(name): carry.trace[name].values for name in carry.trace.variables}


def busy(controller: str, seed: int = 0, **keys: object) -> pb.simulation.Carry:
    """The paper's carry with all disturbances switched on."""
    disturbed = {
        "robot.bias_m_s": 0.001,
        "tactile.false_rate": 0.002,
        "radio.jitter_s": 0.03,
        "palm.pivot_offset_m": 0.01,
        "bumps.rate_per_m": 3.0,
    }
    keys = {key.replace("__", "."): value for key, value in keys.items()}
    return pb.carry("paper", controller, seed=seed, overrides=disturbed | keys)


@pytest.mark.slow
@many
@given(scenes(), controllers, precisions, seeds)
def test_any_valid_scene_can_be_run(
    scene: Scene, controller: str, precision: str, seed: int
) -> None:
    check(pb.carry(scene, controller, precision=precision, seed=seed))


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("controller", CONTROLLERS)
def test_disturbed_carries_of_the_paper_obey_the_laws(controller: str, precision: str) -> None:
    for seed in range(10):
        keys = {"bumps.rate_per_m": 3.0, "radio.jitter_s": 0.03, "tactile.false_rate": 0.002}
        check(pb.carry("paper", controller, precision=precision, seed=seed, overrides=keys))


def check(carry: pb.simulation.Carry) -> None:
    """The result of a carry agrees with its trace."""
    scene, rows = carry.scene, columns(carry)
    single = carry.precision == "float"
    ticks = len(rows["time"]) - 1
    period, most = scene.control.period_s, to_spec(scene).timeout_ticks

    assert carry.outcome in ("delivered", "dropped", "stalled")
    assert (carry.reason is not None) == (carry.outcome == "dropped")
    assert carry.reason is None or carry.reason in REASONS
    assert ticks <= most
    assert carry.time_s == rows["time"][-1]
    assert (ticks - 1) * period <= carry.time_s * (1 + 1e-9) + 1e-12
    assert carry.time_s <= ticks * period * (1 + 1e-9)
    if carry.outcome == "delivered":
        assert carry.distance_m >= scene.task.distance_m
    if carry.outcome == "stalled":
        assert ticks == most
    for name in ("contact", "palm", "speed", "separation", "midpoint", "object"):
        assert np.isfinite(rows[name]).all(), name
    assert set(np.unique(rows["sign"])) <= {-1, 0, 1}
    assert set(np.unique(rows["motion"])) <= {-1, 0, 1}

    contact = rows["contact"][:-1]
    # In float the squares of 64 ticks are added up in float, and small ones vanish.
    rel, least = (64 * 2**-24, 1e-19) if single else (1e-9, 1e-150)
    for k, side in enumerate(SIDES):
        rms = math.sqrt(np.mean(contact[:, k] ** 2)) if ticks else 0.0
        # Upon more than its vertices the object touches a palm elsewhere than at its vertex.
        if not carry.contact_events:
            assert carry.contact_rms_m[side] == pytest.approx(rms, rel=rel, abs=least)
            assert carry.contact_peak_m[side] == (np.abs(contact[:, k]).max() if ticks else 0.0)
        assert carry.contact_rms_m[side] <= carry.contact_peak_m[side] * (1 + rel) + least
        assert 0 <= carry.waiting_s[side] <= ticks * period * (1 + 1e-9)

    check_loop(scene, rows, 2e-6 if single else 1e-12)
    check_corrections(carry, rows)
    for message in carry.message_log:
        assert message.kind in MESSAGES[1:]
        assert message.sender != message.receiver
    assert carry.messages_lost <= carry.messages
    if carry.controller == "distributed":
        assert carry.messages == len(carry.message_log)
        assert carry.messages_lost == sum(ltr.received_s is None for ltr in carry.message_log)


def check_loop(scene: Scene, rows: dict[str, np.ndarray], slack: float) -> None:
    """|C_R - C_L| = w at every tick, and the angle of the object is the angle of C_R - C_L."""
    (lx, ly), (rx, ry) = (scene.object.vertices_m[k] for k in scene.object.contacts)
    width = math.hypot(rx - lx, ry - ly)
    outward = np.array([-1, 1])
    angle, p = rows["palm"], rows["contact"]
    offsets = [scene.palm_of(side).pivot_offset_m for side in ("left", "right")]
    offset = np.array(offsets) + rows["vertex_height"]  # of the vertices from the pivots
    x = outward * (p * np.cos(angle) - offset * np.sin(angle))
    y = p * np.sin(angle) + offset * np.cos(angle)
    dx = rows["separation"] + x[:, 1] - x[:, 0]
    dy = y[:, 1] - y[:, 0]
    np.testing.assert_allclose(np.hypot(dx, dy), width, atol=slack)
    np.testing.assert_allclose(np.sin(rows["object"]), dy / width, atol=10 * slack)


def check_corrections(carry: pb.simulation.Carry, rows: dict[str, np.ndarray]) -> None:
    period = carry.scene.control.period_s
    legal = {"none": "", "centralized": "12345678", "distributed": "abd"}[carry.controller]
    for correction in carry.corrections:
        assert correction.case in legal
        assert 0 <= correction.start_s <= correction.end_s <= carry.time_s
        column = 1 if correction.robot == "right" else 0
        start = round(correction.start_s / period)
        shown = rows["case"][start, column]
        assert shown == correction.case or (shown, correction.case) == ("a", "b")
    assert [c.label for c in carry.corrections[:3]] == ["A", "B", "C"][: len(carry.corrections)]
    starts = [c.start_s for c in carry.corrections]
    assert starts == sorted(starts)
    # As many as the cases of the trace begin, an (a) that becomes a (b) counted once.
    begun = 0
    tracks = [rows["case"][:-1, k] for k in (0, 1)][: 1 if carry.controller == "centralized" else 2]
    for track in tracks:
        before = " "
        for now in track:
            begun += now != before and now in legal and (before, now) != ("a", "b")
            before = now
    assert len(carry.corrections) == min(begun, 512)


class FromTable:
    """A controller in Python: Table 2 from tests/support/table2_transcript.py."""

    def __init__(self) -> None:
        self.robot = Robot()

    def step(self, seen: StepInput) -> StepOutput:
        self.robot, deed = tick(
            self.robot, (seen.sign, MESSAGES.index(seen.message), seen.palm_at_target)
        )
        return StepOutput(
            palm=("steep", "shallow")[deed.palm],
            move=("hold", "away", "closer")[deed.move],
            send=MESSAGES[deed.send],
            consume=deed.read,
            case=deed.case,
            waiting=deed.waits,
        )


@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("maker", [FromTable, DistributedController])
def test_python_controller_gives_the_trace_of_the_shipped_one(maker: type, precision: str) -> None:
    keys = {"radio.jitter_s": 0.04, "bumps.rate_per_m": 3.0, "tactile.false_rate": 0.003}
    for seed in range(3):
        arguments: dict[str, Any] = {"precision": precision, "seed": seed, "overrides": keys}
        mine = pb.carry("paper", maker, **arguments)
        shipped = pb.carry("paper", "distributed", **arguments)
        assert mine.trace_hash == shipped.trace_hash
        assert mine.controller == maker.__name__
        assert mine.message_log == shipped.message_log
        assert mine.corrections == shipped.corrections
        assert mine.waiting_s == shipped.waiting_s
        np.testing.assert_array_equal(columns(mine)["case"], columns(shipped)["case"])


def test_trace_and_messages_determine_every_step_of_table_2() -> None:
    """Table 2 gets only the signs, palms and messages of the log. It takes the logged cases,
    commands the logged speeds, sends the logged messages and waits as long."""
    for seed in range(4):
        carry = busy("distributed", seed=seed)
        rows, period = columns(carry), carry.scene.control.period_s
        targets = np.radians([carry.scene.palm.steep_deg, carry.scene.palm.shallow_deg])
        for k, side in enumerate(SIDES):
            post = [ltr for ltr in carry.message_log if ltr.receiver == side]
            inbox = [(round(ltr.received_s / period), ltr.kind) for ltr in post if ltr.received_s]
            sent = [
                (round(ltr.sent_s / period), ltr.kind)
                for ltr in carry.message_log
                if ltr.sender == side
            ]
            robot, deed, waited, result = Robot(), Deed(STEEP), 0, []
            for now in range(len(rows["time"]) - 1):
                message = inbox[0][1] if inbox and inbox[0][0] <= now else None
                turned = abs(rows["palm"][now, k] - targets[deed.palm]) < 1e-12
                seen = (int(rows["sign"][now, k]), MESSAGES.index(message), bool(turned))
                robot, deed = tick(robot, seen)
                if deed.read:
                    inbox.pop(0)
                if deed.send != NONE:
                    result.append((now, MESSAGES[deed.send]))
                waited += deed.waits
                assert rows["case"][now, k] == deed.case
                away = (0.0, 0.03, -0.03)[deed.move] * (-1, 1)[k]
                assert rows["commanded"][now, k] == pytest.approx(0.06 + away, abs=1e-15)
            assert result == sent
            assert carry.waiting_s[side] == pytest.approx(waited * period)


def test_separation_and_midpoint_integrate_the_speeds() -> None:
    """Separation and midpoint are the integral of the speeds."""
    rows = columns(pb.carry("paper", seed=3))
    speed, period = rows["speed"][:-2], 0.01
    steps = np.diff(rows["separation"])[:-1]
    np.testing.assert_allclose(steps, (speed[:, 1] - speed[:, 0]) * period, atol=1e-15)
    steps = np.diff(rows["midpoint"])[:-1]
    np.testing.assert_allclose(steps, speed.mean(axis=1) * period, atol=1e-15)


def test_correction_labels_continue_after_Z() -> None:
    carry = pb.carry("paper", seed=0)
    labels = [c.label for c in carry.corrections]
    assert len(labels) > 27
    assert labels[:2] + labels[25:28] == ["A", "B", "Z", "AA", "AB"]
    assert all(len(a) <= len(b) for a, b in pairwise(labels))
