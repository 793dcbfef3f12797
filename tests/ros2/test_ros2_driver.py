# SPDX-License-Identifier: Apache-2.0
"""The driver ros2 against a base that the test plays: directions, the palm, silence, faults."""

import math
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import palmbots as pb
from dds_loopback import dds_environment
from palmbots.drivers.driver import Drive
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2 import ros2_driver as ros2
from palmbots.ros2 import ros2_messages as msg
from palmbots.ros2.ros2_driver import Ros2Driver
from palmbots.ros2.ros2_node import Ros2Node, Subscriber
from waiting import wait_until

STEEP, SHALLOW = math.radians(15), math.radians(5)
W = 0.1
FLOAT, ARRAY, TRAJECTORY = (
    "std_msgs/msg/Float64", "std_msgs/msg/Float64MultiArray", "trajectory_msgs/msg/JointTrajectory"
)  # fmt: skip


class Base:
    """What a base publishes, and what it hears."""

    def __init__(self, side: str = "left", **settings: Any) -> None:
        self.settings = Ros2Table(**settings)
        self.node = Ros2Node(self.settings.domain())
        kind = f"geometry_msgs/msg/{self.settings.cmd_vel_type}"
        self.cmd_vel = self.node.subscriber(f"/{side}/cmd_vel", kind, "default")
        palm = {"trajectory": TRAJECTORY, "array": ARRAY, "float": FLOAT}
        command = self.settings.palm_command
        name = "joint_trajectory" if command == "trajectory" else "commands"
        self.palm = self.node.subscriber(
            f"/{side}/palm_controller/{name}", palm[command], "default"
        )
        self.joints = self.node.publisher(
            f"/{side}/joint_states", "sensor_msgs/msg/JointState", "default"
        )
        self.odom = self.node.publisher(f"/{side}/odom", "nav_msgs/msg/Odometry", "default")
        self.contact = self.node.publisher(f"/{side}/contact", "std_msgs/msg/Int8", "default")
        self.present = self.node.publisher(f"/{side}/present", "std_msgs/msg/Bool", "default")
        self.battery = self.node.publisher(
            f"/{side}/battery", "sensor_msgs/msg/BatteryState", "default"
        )

    def say(
        self, angle: float = STEEP, x: float = 0.0, y: float = 0.0, yaw: float = 0.0, sign: int = 0
    ) -> None:
        """Publish what the driver needs."""
        self.joints.publish(msg.JointState(name=["wheel", "palm_joint"], position=[7.0, angle]))
        turn = msg.Quaternion(z=math.sin(yaw / 2), w=math.cos(yaw / 2))
        pose = msg.PoseWithCovariance(msg.Pose(msg.Point(x, y), turn))
        self.odom.publish(msg.Odometry(pose=pose))
        self.contact.publish(msg.Int8(sign))


Made = Callable[..., tuple[Base, Ros2Driver]]


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> Iterator[Made]:
    for name, value in dds_environment().items():
        monkeypatch.setenv(name, value)
    parts: list[Any] = []

    def make(side: Any = "left", direction: str = "forward", **settings: Any) -> Any:
        base = Base(side, **settings)
        driver = Ros2Driver(base.settings, side, (side == "right") == (direction == "forward"), W)
        parts.extend((driver, base.node))
        wait_until(lambda: base.joints.subscribers and base.contact.subscribers)
        wait_until(lambda: driver._velocity.subscribers and driver._palm.subscribers)
        return base, driver

    yield make
    for part in parts:
        part.close()


def drive(speed_m_s: float = 0.06, palm_rad: float = STEEP, *, wheels: bool = True) -> Drive:
    return Drive(0, 0, False, wheels, palm_rad, speed_m_s)


def next_of(subscriber: Subscriber) -> Any:
    wait_until(lambda: subscriber.take())
    return subscriber.message


# The right robot leads a carry forward. A palm at the front faces the partner.
@pytest.mark.parametrize(
    ("side", "direction", "front", "expected"),
    [
        ("left", "forward", "partner", 0.06),  # follows its palm: forward
        ("right", "forward", "partner", -0.06),  # moves away from where its palm faces: backward
        ("left", "backward", "partner", -0.06),
        ("right", "backward", "partner", 0.06),
        ("left", "forward", "away", -0.06),
        ("right", "forward", "away", 0.06),
    ],
)
def test_directions(made: Made, side: str, direction: str, front: str, expected: float) -> None:
    base, driver = made(side, direction, front=front)
    driver.write(drive())
    message = next_of(base.cmd_vel)
    assert message.twist.linear.x == pytest.approx(expected)
    assert (message.twist.linear.y, message.twist.angular.z) == (0.0, 0.0)
    assert message.header.frame_id == f"{side}/base_link"
    assert abs(message.header.stamp.sec - time.time()) < 60
    base.say(x=1.0, y=2.0)
    assert driver.read().distance_m == 0.0
    base.say(x=1.0 + 0.5 * math.copysign(1, expected), y=2.0)
    wait_until(lambda: driver.read().distance_m == pytest.approx(0.5))


def test_distance_is_measured_along_the_first_heading(made: Made) -> None:
    base, driver = made()
    yaw = math.radians(120)
    base.say(x=3.0, y=-1.0, yaw=yaw)
    assert driver.read().distance_m == 0.0
    ahead, aside = 0.4, 0.1
    x = 3.0 + ahead * math.cos(yaw) - aside * math.sin(yaw)
    y = -1.0 + ahead * math.sin(yaw) + aside * math.cos(yaw)
    base.say(x=x, y=y, yaw=yaw + 0.2)
    wait_until(lambda: driver.read().distance_m != 0.0)
    assert driver.read().distance_m == pytest.approx(ahead)


@pytest.mark.parametrize("kind", ["Twist", "TwistStamped"])
def test_wheels_stop(made: Made, kind: str) -> None:
    base, driver = made(cmd_vel_type=kind)

    def speed() -> float:
        message = next_of(base.cmd_vel)
        return (message if kind == "Twist" else message.twist).linear.x

    driver.write(drive(0.05))
    assert speed() == pytest.approx(0.05)
    driver.write(drive(0.05, wheels=False))
    assert speed() == 0.0
    driver.write(drive(0.05))
    assert speed() == pytest.approx(0.05)
    driver.stop()
    assert speed() == 0.0
    driver.write(drive(0.05))
    assert speed() == pytest.approx(0.05)
    driver.close()
    assert speed() == 0.0


@pytest.mark.parametrize("command", ["float", "array"])
def test_palm_positions(made: Made, command: str) -> None:
    base, driver = made(palm_command=command, palm_joint_sign=-1, palm_joint_zero_deg=90.0)
    for _ in range(2):  # in every control period
        driver.write(drive(palm_rad=SHALLOW))
        data = next_of(base.palm).data
        assert (data if command == "float" else data[0]) == pytest.approx(math.radians(85))
    base.say(angle=math.radians(85))
    wait_until(lambda: driver.read().palm_at_target)


def test_palm_trajectories(made: Made) -> None:
    base, driver = made(palm_time_s=0.25)
    base.say(angle=STEEP)
    assert not driver.read().palm_at_target  # nothing is commanded yet
    driver.write(drive(palm_rad=SHALLOW))
    message = next_of(base.palm)
    assert list(message.joint_names) == ["palm_joint"]
    assert list(message.points[-1].positions) == [pytest.approx(SHALLOW)]
    assert message.points[-1].time_from_start == msg.Duration(0, 250_000_000)
    assert message.header.stamp == msg.Time(0, 0)  # at once
    driver.write(drive(palm_rad=SHALLOW))
    assert not base.palm.take()  # the motion goes on
    assert not driver.read().palm_at_target
    # A palm that has not arrived is commanded again, one that has arrived is not.
    driver._sent_s -= 10
    driver.write(drive(palm_rad=SHALLOW))
    next_of(base.palm)
    base.say(angle=SHALLOW + math.radians(0.9))
    wait_until(lambda: driver.read().palm_at_target)
    driver._sent_s -= 10
    driver.write(drive(palm_rad=SHALLOW))
    driver.write(drive(palm_rad=STEEP))
    assert list(next_of(base.palm).points[-1].positions) == [pytest.approx(STEEP)]


def test_readings(made: Made) -> None:
    base, driver = made(contact_present="present", battery_state="battery")
    base.say(sign=1)
    seen = driver.read()
    assert (seen.sign, seen.battery_v, seen.has_contact) == (1, None, False)
    base.present.publish(msg.Bool(True))
    base.battery.publish(msg.BatteryState(voltage=7.5))
    wait_until(lambda: driver.read().has_contact and driver.read().battery_v == 7.5)
    base.battery.publish(msg.BatteryState(voltage=math.nan))
    wait_until(lambda: driver.read().battery_v is None)
    for sent, sign in ((-1, -1), (0, 0), (5, 1), (-128, -1)):
        base.say(sign=sent)
        wait_until(lambda sign=sign: driver.read().sign == sign)


def test_a_base_without_odometry(made: Made) -> None:
    base, driver = made(odom="")
    base.joints.publish(msg.JointState(name=["palm_joint"], position=[STEEP]))
    base.contact.publish(msg.Int8(0))
    assert math.isnan(driver.read().distance_m)
    assert driver.works


def test_unusable_messages_are_ignored(made: Made) -> None:
    base, driver = made()
    base.say(x=1.0, angle=SHALLOW)
    driver.read()
    driver.write(drive(palm_rad=SHALLOW))
    base.joints.publish(msg.JointState(name=["wheel"], position=[1.0]))
    base.joints.publish(msg.JointState(name=["palm_joint"], position=[]))
    base.joints.publish(msg.JointState(name=["palm_joint"], position=[math.nan]))
    lost = msg.PoseWithCovariance(msg.Pose(msg.Point(x=math.nan)))
    base.odom.publish(msg.Odometry(pose=lost))
    base.contact.publish(msg.Int8(-1))
    wait_until(lambda: driver.read().sign == -1)
    assert driver.read().palm_at_target
    assert driver.read().distance_m == 0.0


def test_a_silent_base_is_noticed_and_may_return(made: Made) -> None:
    base, driver = made(silence_s=20.0)
    base.say()
    driver.read()
    assert driver.works
    for silent in (driver._joints, driver._contact, driver._odometry):
        silent.heard_s -= 19.0
        driver.read()
        assert driver.works
        silent.heard_s -= 2.0
        driver.read()
        assert not driver.works
        base.say()
        wait_until(lambda: driver.read() and driver.works)


def test_a_base_that_is_not_there_is_one_line(made: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ros2, "_BASE_STARTS_WITHIN_S", 0.2)
    base, driver = made(domain_id=11)
    with pytest.raises(pb.PalmbotsError) as caught:
        driver.read()
    assert str(caught.value) == (
        "ros2: nothing is heard on /left/joint_states about palm_joint and /left/contact and "
        "/left/odom; does the base run, in domain 11?"
    )
    base.contact.publish(msg.Int8(0))
    base.odom.publish(msg.Odometry())
    base.joints.publish(msg.JointState(name=["wheel"], position=[0.0]))
    with pytest.raises(pb.PalmbotsError, match="heard on /left/joint_states about palm_joint; "):
        driver.read()


def test_a_subscriber_that_does_not_keep_up_does_not_hold_up_the_driver(made: Made) -> None:
    """It reads reliably, and nobody takes what arrives: at most the history of its reader waits."""
    base, driver = made(palm_command="array")
    for _ in range(3000):
        driver.write(drive())
    message = next_of(base.cmd_vel)
    assert message.twist.linear.x == pytest.approx(0.06)


def test_faults_of_dds_are_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CYCLONEDDS_URI", "<none")
    # No other test uses this domain (see dds_environment): DDS configures one only once.
    with pytest.raises(pb.PalmbotsError) as caught:
        Ros2Driver(Ros2Table(domain_id=230), "left", False, W)
    assert str(caught.value) == (
        "ros2: DDS cannot be used in domain 230; check the variable CYCLONEDDS_URI and the network"
    )
