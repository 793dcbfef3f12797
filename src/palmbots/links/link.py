# SPDX-License-Identifier: Apache-2.0
"""What every link offers (`Link`), and what it is opened with (`LinkSettings`)."""

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from palmbots.wire import Role


class Link(Protocol):
    """The link of one end. A packet may be lost, repeated, delayed or damaged.

    A link may also have a property ``details``, a table of numbers and texts about itself. It is
    shown with the statistics.
    """

    def send(self, receiver: Role, data: bytes) -> None:
        """Send a packet; never waits. One that cannot be sent is lost."""
        ...

    def receive(self) -> list[bytes]:
        """All packets that have arrived, in order; never waits."""
        ...

    def close(self) -> None:
        """Close the link."""
        ...


def to_stderr(line: str) -> None:
    """Print a line for the operator."""
    print(f"palmbots: {line}", file=sys.stderr, flush=True)


@dataclass(frozen=True)
class LinkSettings:
    """What a link is opened with: the table ``[link]`` of a ``pair.toml``, as one end sees it."""

    role: Role
    """This end."""
    addresses: Mapping[Role, str]
    """``link.left``, ``link.right`` and ``link.station``; their meaning depends on the kind."""
    pair: int = 0
    """Number of the pair; several pairs may use one network."""
    baud: int = 1_000_000
    """``link.baud``, for serial lines."""
    on_line: Callable[[str], None] = to_stderr
    """Called with a line for the operator, such as that the link is lost, or back."""


LinkMaker = Callable[[LinkSettings], Link]
"""What is registered under a kind: a class whose objects are links, or a function that opens one.
It raises `PalmbotsError` if an address is wrong or cannot be used."""
