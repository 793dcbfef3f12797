# SPDX-License-Identifier: Apache-2.0
"""What every link offers (`Link`)."""

from typing import Protocol

from palmbots.wire import Role


class Link(Protocol):
    """The link of one end. A packet may be lost, repeated, delayed or damaged."""

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet; never waits."""
        ...

    def receive(self) -> list[bytes]:
        """All packets that have arrived, in order; never waits."""
        ...

    def close(self) -> None:
        """Close the link."""
        ...
