# SPDX-License-Identifier: Apache-2.0
"""Names of topics and types, and the keys of [ros2]."""

import subprocess
import sys
from typing import Any

import pytest
from pydantic import ValidationError

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


@pytest.mark.parametrize(
    "name", ["", "a b", "1st", "a//b", "a/", "a__b", "_a", "/", "ä", "a.b", "~a", 5, "a/2b"]
)
def test_names_that_ros_2_does_not_allow_are_refused(name: Any) -> None:
    with pytest.raises(ValidationError):
        Ros2Table(cmd_vel=name)
    assert Ros2Table(odom="").odom == ""


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ('"cmd_vel"', '"cmd vel"', 'ros2.cmd_vel: "cmd vel" is no name; allowed: a ROS 2 name '),
        ('\nodom = "odom"', '\nodom = "a b"', 'ros2.odom: "a b" is no name; allowed: a ROS 2 name'),
        ("domain_id = -1", "domain_id = 233", "ros2.domain_id: 233 is no domain; allowed: 0 to "),
        ("domain_id = -1", "domain_id = true", "ros2.domain_id: true is no domain; allowed: 0 to "),
        ("rate_hz = 50.0", "rate_hz = 0", "ros2.rate_hz: "),
        ('"TwistStamped"', '"Spin"', "ros2.cmd_vel_type: "),
        ("rate_hz = ", "rate = ", "ros2.rate: 50.0 is the value of an unknown key; did you mean "),
    ],
)
def test_faults_of_the_keys_are_one_line(old: str, new: str, line: str, tmp_path: Any) -> None:
    file = init_pair(tmp_path / "pair.toml")[0]
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(pb.PalmbotsError) as caught:
        load_pair(file)
    assert str(caught.value).startswith(f"{file}: {line}")
    assert "\n" not in str(caught.value)


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
    for text in ("x", "-1", "233", "9" * 5000, "1.5"):
        monkeypatch.setenv("ROS_DOMAIN_ID", text)
        with pytest.raises(pb.PalmbotsError, match=r"^ROS_DOMAIN_ID: value is .*; allowed: 0 to 2"):
            Ros2Table().domain()


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
