# SPDX-License-Identifier: Apache-2.0
"""The topics of ROS 2, their quality of service, and the keys of ``[ros2]``."""

from collections.abc import Iterable

from palmbots.pair.pair_keys import pair_keys
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.ros2.ros2_topics import (
    COMMANDS,
    OF_THE_BASE,
    PUBLISHED,
    QUALITIES,
    READINGS,
    Topic,
    dds_topic,
    dds_type,
)

_EXAMPLES = (
    ("/left/cmd_vel", "geometry_msgs/msg/TwistStamped"),
    ("/left/joint_states", "sensor_msgs/msg/JointState"),
    ("/tf", "tf2_msgs/msg/TFMessage"),
)


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    settings = Ros2Table()
    published = [["topic", "type", "QoS", "meaning"]]
    published += [
        [_name(topic), _types(topic), topic.quality, _meaning(topic)] for topic in PUBLISHED
    ]
    keyed = [["key", "topic", "type", "QoS", "meaning"]]

    def rows(topics: Iterable[Topic]) -> list[list[str]]:
        names = [(topic, getattr(settings, topic.name)) for topic in topics]
        return [
            [f"`{topic.name}`", f"`{name}`" if name else "none", _types(topic), topic.quality,
             topic.meaning]
            for topic, name in names
        ]  # fmt: skip

    qualities = [["QoS", "reliability", "durability", "history", "meaning"]]
    for name, quality in QUALITIES.items():
        reliability = "reliable" if quality.reliable else "best effort"
        durability = "transient local" if quality.transient_local else "volatile"
        depth = f"keep last {quality.depth}"
        qualities.append([name, reliability, durability, depth, quality.meaning])
    names = [["topic", "type", "topic in DDS", "type in DDS"]]
    names += [
        [f"`{topic}`", f"`{kind}`", f"`{dds_topic(topic)}`", f"`{dds_type(kind)}`"]
        for topic, kind in _EXAMPLES
    ]
    keys = [["key", "default", "meaning"]]
    keys += [
        [f"`{key.name}`", f"`{key.default_text}`", key.meaning]
        for key in pair_keys()
        if key.name.startswith("ros2.")
    ]
    of_the_base = ", ".join(f"`{name}`" for name in (*OF_THE_BASE, "battery_state"))
    return {
        "published topics": _table(published),
        "topics of the base": f"{of_the_base}.",
        "ros2 commands": _table(keyed + rows(COMMANDS)),
        "readings": _table(keyed + rows(READINGS)),
        "qualities": _table(qualities),
        "names in DDS": _table(names),
        "ros2 keys": _table(keys),
    }


def _name(topic: Topic) -> str:
    return f"`{topic.name}`"


def _types(topic: Topic) -> str:
    return " or ".join(f"`{name}`" for name in topic.types)


def _meaning(topic: Topic) -> str:
    return topic.meaning + (" Only where it is measured." if topic.is_optional else "")


def _table(rows: list[list[str]]) -> str:
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:]])
