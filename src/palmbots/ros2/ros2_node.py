# SPDX-License-Identifier: Apache-2.0
"""A participant in DDS that publishes and reads topics as a node of ROS 2 does. Needs ``ros2``."""

import contextlib
import time
from collections.abc import Callable
from typing import Any

from cyclonedds.core import DDSException
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

from palmbots.errors import PalmbotsError
from palmbots.ros2.ros2_messages import MESSAGES, Header, Time
from palmbots.ros2.ros2_topics import QUALITIES, dds_topic

_NANOSECONDS = 1_000_000_000
_MOST_AT_ONCE = 64


def stamp(time_ns: int | None = None) -> Time:
    """The wall clock, or another time since 1970, as ROS 2 writes it."""
    return Time(*divmod(time.time_ns() if time_ns is None else time_ns, _NANOSECONDS))


def header(frame: str) -> Header:
    """A header with the time of now."""
    return Header(stamp(), frame)


class Publisher:
    """Publishes one topic."""

    def __init__(self, writer: Any) -> None:
        self._writer = writer
        self.count = 0
        """Messages so far."""

    def publish(self, message: Any) -> None:
        """Publish a message; never waits. If subscribers do not keep up, the message is dropped."""
        with contextlib.suppress(DDSException):
            self._writer.write(message)
            self.count += 1

    @property
    def subscribers(self) -> int:
        """How many subscribers are known."""
        return len(self._writer.get_matched_subscriptions())


class Subscriber:
    """Reads one topic."""

    def __init__(self, reader: Any, name: str, is_usable: Callable[[Any], bool]) -> None:
        self._reader = reader
        self._is_usable = is_usable
        self.name = name
        """Full name of the topic."""
        self.heard_s = float("-inf")
        """When the newest usable message was read, on the monotonic clock."""
        self.message: Any = None
        """The newest usable message; None: there was none yet."""

    def take(self) -> list[Any]:
        """The usable messages that have arrived, in order; never waits."""
        try:
            taken = self._reader.take(N=_MOST_AT_ONCE)
        except DDSException:
            return []
        # A sample without data says that a publisher has gone.
        messages = [one for one in taken if one.sample_info.valid_data and self._is_usable(one)]
        if messages:
            self.message, self.heard_s = messages[-1], time.monotonic()
        return messages


class Ros2Node:
    """Publishers and subscribers of one program.

    Args:
        domain: number of the domain.

    Raises:
        PalmbotsError: DDS cannot be used, for example because of a fault in ``CYCLONEDDS_URI``.
    """

    def __init__(self, domain: int) -> None:
        try:
            self._participant: Any = DomainParticipant(domain)
        except DDSException:
            raise PalmbotsError(
                f"ros2: DDS cannot be used in domain {domain}; "
                "check the variable CYCLONEDDS_URI and the network"
            ) from None
        self._topics: dict[tuple[str, str], Any] = {}
        self._entities: list[Any] = []

    def publisher(
        self, name: str, message: str, quality: str, lifespan_s: float | None = None
    ) -> Publisher:
        """A publisher.

        Args:
            name: full name of the topic, such as ``/left/odom``.
            message: name of its type, such as ``std_msgs/msg/Bool``.
            quality: key of `QUALITIES`.
            lifespan_s: a message that has not been delivered by then never is.
        """
        policies = _policies(quality)
        if lifespan_s is not None:
            policies.append(Policy.Lifespan(round(lifespan_s * _NANOSECONDS)))
        topic = self._topic(name, message)
        writer: Any = DataWriter(self._participant, topic, qos=Qos(*policies))
        self._entities.append(writer)
        return Publisher(writer)

    def subscriber(
        self,
        name: str,
        message: str,
        quality: str,
        is_usable: Callable[[Any], bool] = lambda _: True,
    ) -> Subscriber:
        """A subscriber.

        Args:
            name: full name of the topic.
            message: name of its type.
            quality: key of `QUALITIES`.
            is_usable: false for messages to ignore.
        """
        topic = self._topic(name, message)
        reader: Any = DataReader(self._participant, topic, qos=Qos(*_policies(quality)))
        self._entities.append(reader)
        return Subscriber(reader, name, is_usable)

    def _topic(self, name: str, message: str) -> Any:
        key = (name, message)
        if key not in self._topics:
            try:
                self._topics[key] = Topic(self._participant, dds_topic(name), MESSAGES[message])
            except DDSException as error:
                raise PalmbotsError(f"ros2: {name}: {error.msg or error}") from None
        return self._topics[key]

    def close(self) -> None:
        """Leave the domain; other nodes learn of it at once."""
        self._entities.clear()
        self._topics.clear()
        self._participant = None  # cyclonedds deletes an entity with its object


def _policies(quality: str) -> list[Any]:
    asked = QUALITIES[quality]
    # A publisher never waits for slow subscribers.
    reliable = Policy.Reliability.Reliable(max_blocking_time=0)
    return [
        reliable if asked.reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if asked.transient_local else Policy.Durability.Volatile,
        Policy.History.KeepLast(asked.depth),
    ]
