# SPDX-License-Identifier: Apache-2.0
"""What commands print that is no result of a function."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from palmbots._types import Side
from palmbots._util.report import Item
from palmbots._util.results import Result


@dataclass(frozen=True, repr=False)
class Published(Result):
    """What the bridge to ROS 2 has published for a robot."""

    side: Side
    published: dict[str, int]
    """Messages by topic."""

    def lines(self) -> Iterator[Item]:
        """The number of messages of each topic."""
        for topic, count in self.published.items():
            yield f"{topic:16} {count:7} messages"


SchemaTable = dict[str, Any]
"""A JSON Schema."""
