# SPDX-License-Identifier: Apache-2.0
"""A carry as a bag of ROS 2, with the topics that ``palmbots ros2`` publishes while robots carry.

The messages are the same, and are made by the same code; their times are those of the carry.
Topics ``said`` and ``heard`` of each robot have the kinds of the messages between the robots.
Needs the extra ``rosbag``.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from palmbots._types import SIDES, Side
from palmbots._util.atomic_files import new_folder
from palmbots._util.optional_imports import require
from palmbots.interchange.distances import distances
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2.robot_messages import RobotMessages
from palmbots.ros2.ros2_topics import PUBLISHED, type_of
from palmbots.simulation.floor_job import contacts_on_palms
from palmbots.simulation.result import Carry

_NANOSECONDS = 1_000_000_000
_VERSION = 9  # of the format: that of ROS 2 Jazzy, which later ones read


@dataclass(frozen=True)
class _Tick:
    """What a robot reads and commands: a `palmbots.ros2.robot_messages.Reading`."""

    sign: int
    has_contact: bool
    palm_rad: float
    speed_m_s: float
    distance_m: float | None


def write_bag(carries: Iterator[Carry], path: Path) -> None:
    """Write the first of these carries to a new folder, the bag.

    Raises:
        PalmbotsError: a package is missing, the folder exists, or it cannot be written.
    """
    rosbag2 = require("rosbags.rosbag2", "rosbag")
    typesys = require("rosbags.typesys", "rosbag")
    made: Any = require("palmbots.ros2.ros2_messages", "rosbag")
    store = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    storage = rosbag2.StoragePlugin.MCAP
    with new_folder(path) as place:
        place.rmdir()  # the writer makes it
        with rosbag2.Writer(place, version=_VERSION, storage_plugin=storage) as writer:
            bag = _Bag(writer, store)
            for message in _messages(next(carries), made):
                bag.write(*message)


class _Bag:
    """The writer of a bag, and its connections, one for each topic."""

    def __init__(self, writer: Any, store: Any) -> None:
        self._writer, self._store = writer, store
        self._connections: dict[str, Any] = {}

    def write(self, now_ns: int, topic: str, kind: str, message: Any) -> None:
        if topic not in self._connections:
            self._connections[topic] = self._writer.add_connection(
                topic, kind, typestore=self._store
            )
        self._writer.write(self._connections[topic], now_ns, message.serialize())


def _messages(carry: Carry, made: Any) -> Iterator[tuple[int, str, str, Any]]:
    """Time [ns], topic, type and message, in the order of time."""
    settings, kinds = Ros2Table(), {topic.name: topic for topic in PUBLISHED}
    now_ns = 0

    def header(frame: str) -> Any:
        return made.Header(made.Time(*divmod(now_ns, _NANOSECONDS)), frame)

    robots = [
        (side, RobotMessages(settings, side, carry.scene.task.direction, header), _ticks(carry, k))
        for k, side in enumerate(SIDES)
    ]
    words = _words(carry)
    word = next(words, None)
    assert carry.trace is not None
    for time_s, *readings in zip(
        carry.trace["time"].to_numpy(), *(ticks for _, _, ticks in robots), strict=True
    ):
        now_ns = round(float(time_s) * _NANOSECONDS)
        while word is not None and word[0] <= time_s:
            topic, text = settings.topic(word[1], word[2]), made.String(word[3])
            yield round(word[0] * _NANOSECONDS), topic, "std_msgs/msg/String", text
            word = next(words, None)
        for (side, robot, _), reading in zip(robots, readings, strict=True):
            robot.take_distance(float(time_s), reading.distance_m)
            for name, message in robot.of(reading):
                kind = type_of(kinds[name], settings)
                yield now_ns, settings.topic(side, name), kind, message


def _words(carry: Carry) -> Iterator[tuple[float, Side, str, str]]:
    """Time [s], robot, topic and text of what is said and heard, in the order of time."""
    found: list[tuple[float, Side, str, str]] = []
    for message in carry.message_log:
        found.append((message.sent_s, message.sender, "said", message.kind))
        if message.received_s is not None:
            found.append((message.received_s, message.receiver, "heard", message.kind))
    yield from sorted(found)


def _ticks(carry: Carry, k: int) -> list[_Tick]:
    """What a robot reads and commands in each tick."""
    trace = carry.trace
    assert trace is not None
    columns = (trace[name].to_numpy()[:, k] for name in ("sign", "palm", "commanded"))
    touches = np.isfinite(contacts_on_palms(carry.scene, trace)[:, k])
    if np.isnan(trace["contact"].to_numpy()[:, k]).all():
        touches[:] = True  # logs of robots do not show it
    return [
        _Tick(int(sign), bool(touch), float(palm), float(speed), float(covered))
        for sign, palm, speed, touch, covered in zip(
            *columns, touches, distances(carry)[:, k], strict=True
        )
    ]
