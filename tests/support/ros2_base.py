# SPDX-License-Identifier: Apache-2.0
"""Two mobile bases with palms that are nodes of ROS 2, in a simulated world.

    python ros2_base.py PAIR WORLD LOG

Each base listens to cmd_vel and to the trajectories of its palm's joint, and publishes odom,
joint_states and contact. It stops its wheels by its own timeout, control.watchdog_s. The motors are
those of `palmbots world` at the address WORLD, to which the bases connect as the programs of robots
do. LOG gets a line of JSON for each command that arrives, whenever the wheels stop or start, and
for each timeout: `after_s` is the age of the newest command in the step before, when there was none
yet.
"""

import json
import math
import sys
import time
from pathlib import Path
from typing import Any

from palmbots._types import SIDES, Side
from palmbots.drivers.driver import Drive
from palmbots.drivers.simulated import SimulatedDriver
from palmbots.errors import PalmbotsError
from palmbots.links.greeting import scene_number
from palmbots.pair.drive_table import drive_table
from palmbots.pair.pair_file import Pair, load_pair
from palmbots.ros2 import ros2_messages as msg
from palmbots.ros2.ros2_node import Ros2Node, header
from palmbots.scene.scene import load_scene

TRAJECTORY = "trajectory_msgs/msg/JointTrajectory"


class Base:
    """One base and its palm, which faces forward: the right one drives backward in a carry."""

    def __init__(self, pair: Pair, side: Side, world: str, log: Any) -> None:
        scene = load_scene(pair.scene())
        self.side, self.log = side, log
        self.forward = 1 if side == "left" else -1
        self.timeout_s = scene.control.watchdog_s
        self.drives = drive_table(scene, side)
        palm = scene.palm_of(side)
        self.angles = [math.radians(palm.steep_deg), math.radians(palm.shallow_deg)]
        self.driver = SimulatedDriver(world, side, 1, scene=scene_number(scene))
        self.node = node = Ros2Node(pair.settings.ros2.domain())
        stamped = f"geometry_msgs/msg/{pair.settings.ros2.cmd_vel_type}"
        self.cmd_vel = node.subscriber(f"/{side}/cmd_vel", stamped, "default")
        palm_topic = f"/{side}/palm_controller/joint_trajectory"
        self.trajectory = node.subscriber(palm_topic, TRAJECTORY, "default")
        self.joints = node.publisher(
            f"/{side}/joint_states", "sensor_msgs/msg/JointState", "default"
        )
        self.odom = node.publisher(f"/{side}/odom", "nav_msgs/msg/Odometry", "default")
        self.contact = node.publisher(f"/{side}/contact", "std_msgs/msg/Int8", "default")
        self.speed, self.palm, self.commanded_s = 0.0, 0, -math.inf
        self.turned_from, self.moves = self.angles[0], False
        self.stepped_s = time.monotonic()

    def step(self) -> bool:
        """One control period; false: the world has ended."""
        reading = self.driver.read()
        if reading is None:
            return False
        target = self.angles[self.palm]
        angle = target if reading.palm_at_target else 0.5 * (target + self.turned_from)
        base = header(f"{self.side}/base_link")
        self.joints.publish(msg.JointState(base, ["wheel", "palm_joint"], [0.0, angle]))
        pose = msg.PoseWithCovariance(msg.Pose(msg.Point(x=self.forward * reading.distance_m)))
        self.odom.publish(msg.Odometry(header(f"{self.side}/odom"), base.frame_id, pose))
        self.contact.publish(msg.Int8(reading.sign))
        self.obey()
        return True

    def obey(self) -> None:
        """Take commands, and pass them on to the motors."""
        now = time.monotonic()
        for message in self.cmd_vel.take():
            twist = getattr(message, "twist", message)
            self.speed, self.commanded_s = self.forward * twist.linear.x, now
            self.note("command", speed=self.speed)
        if now - self.commanded_s > self.timeout_s:
            if self.speed != 0.0:
                self.note("timeout", after_s=self.stepped_s - self.commanded_s)
            self.speed = 0.0
        self.stepped_s = now
        for message in self.trajectory.take():
            wanted = message.points[-1].positions[list(message.joint_names).index("palm_joint")]
            palm = min((0, 1), key=lambda i: abs(self.angles[i] - wanted))
            if palm != self.palm:
                self.turned_from, self.palm = self.angles[self.palm], palm
        moves = self.speed != 0.0
        if moves != self.moves:
            self.moves = moves
            self.note("moves" if moves else "rests")
        # The world takes the controller's words: those whose speed is the commanded one.
        shapes = [shape for shape in self.drives if shape[0] == self.palm and shape[3] == moves]
        shape = min(shapes, key=lambda s: abs(self.drives[s].speed_m_s - self.speed))
        self.driver.write(Drive(*shape, self.angles[self.palm], self.speed))

    def note(self, event: str, **values: object) -> None:
        """Write a line to the log."""
        line = {"time_s": time.monotonic(), "side": self.side, "event": event} | values
        print(json.dumps(line), file=self.log, flush=True)


def main() -> None:
    """Run both bases until the world ends."""
    pair, world = load_pair(sys.argv[1]), sys.argv[2]
    period_s = load_scene(pair.scene()).control.period_s
    with Path(sys.argv[3]).open("w", encoding="utf-8") as log:
        bases = [Base(pair, side, world, log) for side in SIDES]
        try:
            while all(tuple(base.step() for base in bases)):
                time.sleep(0.5 * period_s)
        except PalmbotsError as error:
            print(error)
        for base in bases:
            base.driver.close()
            base.node.close()


if __name__ == "__main__":
    main()
