# SPDX-License-Identifier: Apache-2.0
"""What `palmbots ros2` publishes of a robot whose observations the test makes up."""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dds_loopback import dds_environment
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.robot.observation import Observation, Observer, observation_socket
from palmbots.ros2.ros2_bridge import Bridge, run_bridge
from palmbots.ros2.ros2_node import Ros2Node, Subscriber
from palmbots.ros2.ros2_topics import PUBLISHED
from waiting import wait_until

PALM = math.radians(15)
SEEN = Observation(
    time_s=1.0, mode="carrying", fault="none", sign=-1, has_contact=True, palm_at_target=True,
    palm_rad=PALM, speed_m_s=0.06, distance_m=0.5, battery_v=7.5, overruns=3,
    received={"accepted": 5, "stale": 1},
)  # fmt: skip


class Listener:
    """A bridge, and a node that subscribes to everything it publishes."""

    def __init__(self, folder: Path, side: Any, values: dict[str, object]) -> None:
        pair = load_pair(init_pair(folder / "pair.toml", values=values)[0])
        self.bridge = Bridge(pair, side)
        self.node = Ros2Node(pair.settings.ros2.domain())
        stamped = f"geometry_msgs/msg/{pair.settings.ros2.cmd_vel_type}"
        self.topics: dict[str, Subscriber] = {}
        for topic in PUBLISHED:
            name = topic.name if topic.name.startswith("/") else f"/{side}/{topic.name}"
            kind = stamped if topic.name == "cmd_vel" else topic.types[0]
            quality = "latched" if topic.name == "mode" else "default"
            self.topics[topic.name] = self.node.subscriber(name, kind, quality)
        publishers = self.bridge._publishers.values()
        wait_until(lambda: all(one.subscribers for one in publishers))

    def hear(self, name: str) -> Any:
        wait_until(lambda: self.topics[name].take())
        return self.topics[name].message


Made = Callable[..., Listener]


@pytest.fixture
def made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    for name, value in dds_environment().items():
        monkeypatch.setenv(name, value)
    parts: list[Listener] = []

    def make(side: str = "left", **values: object) -> Listener:
        parts.append(Listener(tmp_path, side, {f"{key}": one for key, one in values.items()}))
        return parts[-1]

    yield make
    for part in parts:
        part.bridge.close()
        part.node.close()


def rotated(q: Any, v: tuple[float, float, float]) -> list[float]:
    """The vector turned by the quaternion, from the definition q v q*."""

    def times(a: list[float], b: list[float]) -> list[float]:
        w, x, y, z = a
        W, X, Y, Z = b
        return [
            w * W - x * X - y * Y - z * Z,
            w * X + x * W + y * Z - z * Y,
            w * Y - x * Z + y * W + z * X,
            w * Z + x * Y - y * X + z * W,
        ]

    turn, back = [q.w, q.x, q.y, q.z], [q.w, -q.x, -q.y, -q.z]
    return times(times(turn, [0.0, *v]), back)[1:]


@pytest.mark.parametrize("front", ["partner", "away"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_what_is_measured(made: Made, side: str, front: str) -> None:
    values = {"ros2.front": front, "ros2.palm_x_m": 0.1, "ros2.palm_z_m": 0.2}
    values |= {"ros2.palm_joint_sign": -1, "ros2.palm_joint_zero_deg": 90.0}
    listener = made(side, **values)
    bridge = listener.bridge
    bridge.take(replace(SEEN, time_s=0.9, distance_m=0.494))
    bridge.take(SEEN)
    bridge.step()
    # Travel is towards the left robot's partner, and away from the right one's.
    ahead = 1 if (side == "left") == (front == "partner") else -1
    velocity = listener.hear("cmd_vel")
    assert velocity.twist.linear.x == pytest.approx(0.06 * ahead)
    assert velocity.header.frame_id == f"{side}/base_link"
    joints = listener.hear("joint_states")
    assert (list(joints.name), list(joints.position)) == (
        ["palm_joint"],
        [pytest.approx(math.radians(75))],
    )
    odometry = listener.hear("odom")
    assert (odometry.header.frame_id, odometry.child_frame_id) == (
        f"{side}/odom",
        f"{side}/base_link",
    )
    assert odometry.pose.pose.position.x == pytest.approx(0.5 * ahead)
    assert odometry.twist.twist.linear.x == pytest.approx(0.06 * ahead)
    diagonal = [odometry.pose.covariance[7 * i] for i in range(6)]
    assert diagonal[0] < 1 < min(diagonal[1:])
    assert abs(odometry.header.stamp.sec - time.time()) < 60
    base, palm = listener.hear("/tf").transforms
    assert (base.header.frame_id, base.child_frame_id) == (f"{side}/odom", f"{side}/base_link")
    assert base.transform.translation.x == pytest.approx(0.5 * ahead)
    assert (palm.header.frame_id, palm.child_frame_id) == (f"{side}/base_link", f"{side}/palm_link")
    assert (palm.transform.translation.x, palm.transform.translation.z) == (0.1, 0.2)
    # The palm's normal leans by 15° towards the partner, which is ahead if the palm is in front.
    normal = rotated(palm.transform.rotation, (0.0, 0.0, 1.0))
    lean = math.sin(PALM) * (1 if front == "partner" else -1)
    assert normal == pytest.approx([lean, 0.0, math.cos(PALM)])
    assert listener.hear("contact").data == -1
    assert listener.hear("contact_present").data is True
    assert listener.hear("battery_state").voltage == pytest.approx(7.5)


def test_a_robot_without_encoders_has_no_odometry(made: Made) -> None:
    listener = made(**{"ros2.cmd_vel_type": "Twist"})
    listener.bridge.take(replace(SEEN, distance_m=None, battery_v=None))
    listener.bridge.step()
    assert listener.hear("cmd_vel").linear.x == pytest.approx(0.06)
    assert [one.child_frame_id for one in listener.hear("/tf").transforms] == ["left/palm_link"]
    assert not listener.topics["odom"].take()
    assert not listener.topics["battery_state"].take()


def test_modes_are_published_when_they_change_and_reach_late_subscribers(made: Made) -> None:
    listener = made()
    bridge = listener.bridge
    bridge.step()
    assert listener.hear("mode").data == "off"
    for mode in ("disarmed", "armed", "armed", "ready", "carrying"):
        bridge.take(replace(SEEN, mode=mode))
    heard: list[str] = []
    wait_until(lambda: heard.extend(m.data for m in listener.topics["mode"].take()) or heard)
    assert heard[-1] == "carrying"
    late = listener.node.subscriber("/left/mode", "std_msgs/msg/String", "latched")
    wait_until(late.take)
    assert late.message.data == "carrying"
    assert bridge.counts()["mode"] == 5


@pytest.mark.parametrize(
    ("mode", "fault", "level", "message"),
    [
        ("carrying", "none", 0, "carrying"),
        ("fault", "battery", 2, "fault: battery"),
        ("stopped", "none", 1, "a stop is in force"),
        ("disarmed", "contact", 1, "disarmed: contact"),
    ],
)
def test_diagnostics(made: Made, mode: Any, fault: Any, level: int, message: str) -> None:
    listener = made("right", **{"pair.number": 77})
    listener.bridge.take(replace(SEEN, mode=mode, fault=fault))
    listener.bridge.step()
    (status,) = listener.hear("/diagnostics").status
    assert (status.level, status.message) == (level, message)
    assert (status.name, status.hardware_id) == ("palmbots: right robot", "palmbots-77-right")
    values = {one.key: one.value for one in status.values}
    assert values["mode"] == mode
    assert values["distance_m"] == "0.5000"
    assert values["battery_v"] == "7.50"
    assert values["packets_accepted"] == "5"


def test_a_silent_robot_is_stale_and_nothing_else_is_published(made: Made) -> None:
    listener = made()
    listener.bridge.take(SEEN)
    listener.bridge._heard_s -= 2
    listener.bridge.step()
    (status,) = listener.hear("/diagnostics").status
    assert (status.level, status.message) == (3, "the robot's program is silent")
    assert listener.hear("mode").data in ("carrying", "off")
    assert listener.bridge._mode == "off"
    counts = listener.bridge.counts()
    assert {name for name, count in counts.items() if count} == {"mode", "/diagnostics"}


def test_beside_the_driver_ros2_only_what_nobody_else_publishes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name, value in dds_environment().items():
        monkeypatch.setenv(name, value)
    file = init_pair(tmp_path / "pair.toml", values={"driver.kind": "ros2"})[0]
    bridge = Bridge(load_pair(file), "left")
    assert set(bridge.counts()) == {"mode", "/diagnostics"}
    bridge.close()


def test_topics_are_published_at_the_rate(made: Made) -> None:
    listener = made(**{"ros2.rate_hz": 10.0})
    for _ in range(100):  # as a robot's program with a period of 10 ms does
        listener.bridge.take(SEEN)
        listener.bridge._fast._next_s -= 0.01
        listener.bridge.step()
    assert 10 <= listener.bridge.counts()["odom"] <= 60  # the loop itself takes time, too


def test_the_program_notices_a_robot_that_comes_and_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from palmbots.ros2 import ros2_bridge

    monkeypatch.setattr(ros2_bridge, "_SILENCE_S", 0.3)
    for name, value in dds_environment().items():
        monkeypatch.setenv(name, value)
    pair = load_pair(init_pair(tmp_path / "pair.toml")[0])
    observer = Observer(observation_socket(pair.state_file("left")))
    lines: list[str] = []
    sent = 0

    class Sending(ros2_bridge.Observations):
        def receive(self, timeout_s: float) -> list[Observation]:
            nonlocal sent
            if sent < 5 and observer.is_watched:
                observer.send(SEEN)
                sent += 1
            return super().receive(timeout_s)

    monkeypatch.setattr(ros2_bridge, "Observations", Sending)
    counts = run_bridge(pair, "left", seconds=1.5, on_change=lines.append)
    assert lines[0] == "left robot: its program is heard"
    assert lines[-1] == "left robot: its program is silent"
    assert counts["cmd_vel"] >= 1
    assert counts["mode"] >= 2
    observer.close()
