# SPDX-License-Identifier: Apache-2.0
"""The object on more than its two contact vertices: MuJoCo's forces against the exact outline."""

from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import palmbots as pb
from palmbots.cli.main import build_app
from palmbots.logs.replaying import replay
from palmbots.mujoco.contact_events import ContactEventTracker, extra_contact
from palmbots.mujoco.mjcf import layout
from palmbots.simulation.result import Carry

POINTED = [[0, 0], [0.02, 0.02], [0.23, 0.02], [0.25, 0], [0.25, 0.16], [0, 0.16]]
"""Stands on two points; its bottom is 20 mm higher."""
QUIET: dict[str, Any] = {"robot.noise_m_s": 0, "task.distance_m": 0.06}
OVER = QUIET | {"palm.shallow_deg": -2, "start.left_m": -0.01}
DOWN = QUIET | {"palm.shallow_deg": -3, "start.left_m": 0.01}
TIP = QUIET | {
    "object": {"vertices_m": POINTED, "contacts": [0, 3], "com_m": [0.125, 0.06]},
    "palm.shallow_deg": -20, "start.left_m": 0.01, "task.distance_m": 0.1,
}  # fmt: skip


def mirrored(keys: dict[str, Any]) -> dict[str, Any]:
    """With what is off on the other side; the objects and palms are symmetric."""
    return {k.replace("start.left", "start.right"): v for k, v in keys.items()}


def in_mujoco(keys: dict[str, Any], **more: Any) -> Carry:
    return pb.carry("paper", world="mujoco", seed=0, overrides=keys, **more)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize(
    ("keys", "kind", "own"), [(OVER, "flush", True), (DOWN, "flush", False), (TIP, "tip", False)]
)
def test_both_worlds_report_the_same_contact_event(
    keys: dict[str, Any], kind: str, own: bool, side: str
) -> None:
    """`own`: it happens at the palm whose contact is off; else at the other, which assists."""
    keys = keys if side == "left" else mirrored(keys)
    known = pb.carry("paper", seed=0, overrides=keys, record=False).contact_events[0]
    seen = in_mujoco(keys, record=False).contact_events[0]
    robot = side if own else {"left": "right", "right": "left"}[side]
    assert (known.robot, known.kind) == (seen.robot, seen.kind) == (robot, kind)
    assert seen.start_s == pytest.approx(known.start_s, abs=0.02)
    assert seen.end_s == pytest.approx(known.end_s, abs=0.05)
    assert known.end_s - known.start_s > 0.3


def test_default_scene_has_no_contact_events_in_both_worlds() -> None:
    assert in_mujoco({}, record=False).contact_events == ()
    assert pb.carry("paper", seed=0, record=False).contact_events == ()


def test_while_it_rests_on_more_the_further_contact_carries() -> None:
    """On the tip of the palm the contact vertex is lifted: the lift of the trace, which is
    geometry, agrees with what forces say."""
    done = in_mujoco(DOWN)
    assert done.trace is not None
    (touch,) = done.contact_events
    lift = done.trace["vertex_height"].sel(side=touch.robot).to_numpy()
    times = done.trace["time"].to_numpy()
    during = (times > touch.start_s + 0.05) & (times < touch.end_s - 0.05)
    assert lift[during].min() > 1e-3
    assert lift[(times < touch.start_s - 0.05) | (times > touch.end_s + 0.05)].max() < 1e-4


def test_log_and_replay_keep_contact_events(tmp_path: Path) -> None:
    done = in_mujoco(OVER)
    pb.write_log(done, tmp_path / "carry.mcap")
    assert pb.read_log(tmp_path / "carry.mcap").contact_events == done.contact_events != ()
    assert replay(tmp_path / "carry.mcap").identical


def test_summary_contains_contact_events() -> None:
    keys = [word for k, v in OVER.items() for word in ("--set", f"{k}={v}")]
    shown = CliRunner().invoke(build_app(), ["carry", "--world", "mujoco", *keys])
    assert "1 period with more than two contacts, " in shown.stdout
    assert "first: flush, left palm, at 0.30 s" in " ".join(shown.stdout.split())


def test_finished_episode_has_contact_events() -> None:
    from palmbots.learn import carry_v0
    from palmbots.learn.baseline_policies import run_episode

    env = carry_v0.parallel_env("paper", world="mujoco", overrides=OVER, record=True)
    run_episode(env, seed=0)
    assert env.carry("mine").contact_events == in_mujoco(OVER, record=False).contact_events


def test_short_interruptions_do_not_split_a_contact_event() -> None:
    tracker = ContactEventTracker()
    seen: list[tuple[float, list[Any]]] = [
        (0.00, []), (0.01, [(1, "tip")]), (0.02, []), (0.05, [(0, "flush")]), (0.11, []),
        (0.20, [(0, "tip"), (1, "tip"), (1, "flush")]), (0.21, [(0, "flush")]),
    ]  # fmt: skip
    for time, found in seen:
        tracker.update(time, found)
    assert tracker.rows(0.205) == [(1, "tip", 0.01, 0.05), (1, "flush", 0.20, 0.205)]


def test_edge_along_the_palm_is_flush_and_slanting_edge_is_tip() -> None:
    scene = pb.load_scene("paper", TIP)
    at = layout(scene)
    level = (1, 0, 0, 0, 1, 0, 0, 0, 1)
    kinds = {
        name: tuple(extra_contact(side, name, at).kind(level, level) for side in (0, 1))
        for name in ("vertex_3_far", "edge_0", "edge_1", "edge_2")
    }
    assert kinds == {
        "vertex_3_far": ("flush", "flush"),
        "edge_0": ("flush", "tip"),  # at the left contact vertex; 45° steep to the right palm
        "edge_1": ("flush", "flush"),  # parallel to level palms
        "edge_2": ("tip", "flush"),
    }


def test_a_heel_stops_the_object_in_both_worlds() -> None:
    """A push closes the pair by 3 cm, from 6 cm outward; the palms end at 7.5 cm."""
    push = {"robot": "left", "at_s": 0.5, "duration_s": 1.0, "speed_m_s": -0.03}
    keys = QUIET | {"task.distance_m": 0.2, "start.left_m": 0.06, "start.right_m": 0.06,
                    "bumps.pushes": [push], "object.box_m": [0.3, 0.16]}  # fmt: skip
    found = {
        (world, high): pb.carry(
            "paper", "none", world=world, seed=0, overrides=keys | {"palm.heel_m": high}
        )
        for world in ("quasistatic", "mujoco")
        for high in (0.0, 0.012)
    }
    assert all(found[world, 0.0].reason == "off-palm" for world in ("quasistatic", "mujoco"))
    known, seen = found["quasistatic", 0.012], found["mujoco", 0.012]
    assert seen.outcome == "delivered"  # the wheels slip
    assert known.reason == "jammed"
    one, other = known.contact_events[0], seen.contact_events[0]
    assert (one.robot, one.kind) == (other.robot, other.kind) == ("left", "tip")
    assert other.start_s == pytest.approx(one.start_s, abs=0.06)
    most = [carry.trace["contact"].values.max() for carry in (known, seen) if carry.trace]
    assert most[1] == pytest.approx(most[0], abs=1.5e-3)  # a heel is compressed, too
