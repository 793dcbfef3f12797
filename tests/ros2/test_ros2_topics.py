# SPDX-License-Identifier: Apache-2.0
"""Names of topics and types, and the keys of [ros2]."""

import subprocess
import sys
from typing import Any

import pytest

import palmbots as pb
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2.ros2_messages import MESSAGES
from palmbots.ros2.ros2_topics import (
    COMMANDS,
    OF_THE_BASE,
    PUBLISHED,
    QUALITIES,
    READINGS,
    dds_topic,
    dds_type,
)

ALL = (*PUBLISHED, *COMMANDS, *READINGS)


def test_names_in_dds_are_those_of_ros_2() -> None:
    assert dds_topic("/left/cmd_vel") == "rt/left/cmd_vel"
    assert dds_topic("/tf") == "rt/tf"
    assert dds_type("sensor_msgs/msg/JointState") == "sensor_msgs::msg::dds_::JointState_"
    for name, message in MESSAGES.items():
        assert message.__idl_typename__ == dds_type(name)


def test_every_topic_has_a_known_type_and_quality() -> None:
    for topic in ALL:
        assert set(topic.types) <= set(MESSAGES)
        assert topic.quality in QUALITIES
    settings = Ros2Table()
    for topic in (*COMMANDS, *READINGS):
        assert isinstance(getattr(settings, topic.name), str)
    assert set(OF_THE_BASE) < {topic.name for topic in PUBLISHED}


def test_topics_are_in_the_namespace_unless_they_are_absolute() -> None:
    settings = Ros2Table(right_namespace="/fleet/b2", cmd_vel="/base/cmd_vel")
    assert settings.topic("right", settings.odom) == "/fleet/b2/odom"
    assert settings.topic("right", settings.cmd_vel) == "/base/cmd_vel"
    assert settings.topic("left", settings.odom) == "/left/odom"


def test_settings_of_ros_2_may_differ_between_the_robots(tmp_path: Any) -> None:
    pair = load_pair(init_pair(tmp_path / "pair.toml")[0])
    scene = pb.load_scene(pair.scene())
    changed = pair.settings.model_copy(update={"ros2": Ros2Table(front="away")})
    assert type(pair)(pair.file, changed, pair.key).fingerprint(scene) == pair.fingerprint(scene)


def test_the_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    assert (Ros2Table().domain(), Ros2Table(domain_id=7).domain()) == (0, 7)
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert (Ros2Table().domain(), Ros2Table(domain_id=7).domain()) == (42, 7)


@pytest.mark.parametrize("command", ["ros2", "robot"])
def test_without_cyclonedds_one_line_states_what_to_install(command: str, tmp_path: Any) -> None:
    init_pair(tmp_path / "pair.toml", values={"driver.kind": "ros2"})
    program = (
        "import sys; sys.modules['cyclonedds'] = None; from palmbots.__main__ import main; "
        f"sys.argv = ['palmbots', '{command}', 'pair.toml', '--side', 'left']; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("palmbots: ros2: the package cyclonedds is missing; run: ")
    assert done.stderr.count("\n") == 1
    assert "cyclonedds>=" in done.stderr
    assert not (tmp_path / "pair-state" / "left.watch").exists()
