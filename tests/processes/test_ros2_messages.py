# SPDX-License-Identifier: Apache-2.0
"""The bytes of every message, in both directions, against the definitions of ROS 2 in rosbags."""

import random
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from palmbots.ros2.ros2_messages import MESSAGES
from palmbots.ros2.ros2_topics import COMMANDS, PUBLISHED, READINGS

STORES = (Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY, Stores.ROS2_KILTED)
# A byte of a DiagnosticStatus: rosbags takes it for signed, and its values are 0 to 3.
LIMITS = {"int8": (-128, 127), "uint8": (0, 255), "byte": (0, 127), "int32": (-(2**31), 2**31 - 1)}
LIMITS |= {"uint32": (0, 2**32 - 1), "octet": (0, 255)}


def drawn(store: Any, node: Any, random: random.Random) -> Any:
    """A random value of a field, by the definitions of the type store."""
    kind, detail = node
    if kind == Nodetype.NAME:
        return message(store, detail, random)
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        inner, length = detail
        count = length if kind == Nodetype.ARRAY else random.randrange(4)
        values = [drawn(store, inner, random) for _ in range(count)]
        is_number = inner[0] == Nodetype.BASE and inner[1][0] != "string"
        return np.array(values, dtype=inner[1][0]) if is_number else values
    name = detail[0]
    if name == "string":
        return "".join(random.choices("abcäß€ /_", k=random.randrange(9)))
    if name == "bool":
        return random.random() < 0.5
    if name.startswith("float"):
        return float(np.float32(random.uniform(-1e3, 1e3)))
    return random.choice((*LIMITS[name], random.randint(*LIMITS[name])))


def message(store: Any, name: str, random: random.Random) -> Any:
    """A random message of the type store."""
    values = {key: drawn(store, node, random) for key, node in store.fielddefs[name][1]}
    return store.types[name](**values)


def plain(value: Any) -> Any:
    """A message of either side as lists, texts and numbers."""
    if is_dataclass(value):
        # The type store adds the name of the message, and its constants, in capitals.
        names = (field.name for field in fields(value))
        shown = [name for name in names if name.islower() and not name.startswith("__")]
        return {name: plain(getattr(value, name)) for name in shown}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [plain(one) for one in value]
    return value.item() if isinstance(value, np.generic) else value


@pytest.mark.parametrize("stored", STORES, ids=lambda store: store.value)
@pytest.mark.parametrize("name", MESSAGES)
def test_bytes_are_those_of_ros_2(name: str, stored: Stores) -> None:
    store = get_typestore(stored)
    names = [key for key, _ in store.fielddefs[name][1]]
    assert [field.name for field in fields(MESSAGES[name])] == names
    for seed in range(20):
        theirs = message(store, name, random.Random(seed))
        data = bytes(store.serialize_cdr(theirs, name))
        ours = MESSAGES[name].deserialize(data)
        assert plain(ours) == plain(theirs)
        assert ours.serialize() == data
        assert plain(store.deserialize_cdr(ours.serialize(), name)) == plain(ours)


def test_every_message_of_a_topic_is_compared() -> None:
    used = {name for topic in (*PUBLISHED, *COMMANDS, *READINGS) for name in topic.types}
    assert used <= set(MESSAGES)
