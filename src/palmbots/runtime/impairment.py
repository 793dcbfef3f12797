# SPDX-License-Identifier: Apache-2.0
"""A bad radio between real sockets: a proxy that loses, delays, reorders and repeats datagrams.

It needs no special rights and no special kernel. Its random numbers are seeded: if the same packets
arrive in the same order, the same ones are lost. The times of arrival depend on the machine.
"""

import contextlib
import heapq
import random
import selectors
import socket
import threading
import time
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Self

from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.wire import Role

_LARGEST = 2048  # bytes
_IDLE_S = 0.05


@dataclass(frozen=True)
class Impairment:
    """What happens to each packet, independently of the others."""

    loss: float = 0.0
    """Probability that it is lost."""
    delay_ms: float = 0.0
    """Mean delay."""
    jitter_ms: float = 0.0
    """Half the width of the interval around the delay from which each delay is drawn. Packets may
    overtake each other."""
    duplicate: float = 0.0
    """Probability that it arrives twice, each with a delay of its own."""

    @classmethod
    def parse(cls, text: str) -> Self:
        """Read ``"loss=0.2 delay_ms=50 jitter_ms=30"``.

        Raises:
            PalmbotsError: a name or a number is wrong.
        """
        names = [field.name for field in fields(cls)]
        values = {}
        for word in text.split():
            name, equals, number = word.partition("=")
            try:
                values[name] = float(number)
            except ValueError:
                equals = ""
            if not equals or name not in names:
                raise PalmbotsError(
                    f"link: value is {show(text)}; allowed: {', '.join(names)}, each with a number "
                    'as in "loss=0.2 delay_ms=50"'
                )
        made = cls(**values)
        made.check()
        return made

    def check(self) -> None:
        """Raise `PalmbotsError` for a number that is out of range."""
        for name in ("loss", "duplicate"):
            if not 0 <= getattr(self, name) <= 1:
                raise PalmbotsError(f"link: {name} is {getattr(self, name):g}; allowed: 0 to 1")
        if not 0 <= self.jitter_ms <= self.delay_ms <= 10_000:
            raise PalmbotsError(
                f"link: delay_ms is {self.delay_ms:g} and jitter_ms is {self.jitter_ms:g}; "
                "allowed: delay_ms from 0 to 10000, and jitter_ms from 0 to delay_ms"
            )

    def delays_s(self, chance: random.Random) -> list[float]:
        """The delays after which the copies of a packet arrive [s]; empty: it is lost."""
        copies = 0 if chance.random() < self.loss else 1
        copies += copies * (chance.random() < self.duplicate)
        width = self.jitter_ms
        return [1e-3 * (self.delay_ms + chance.uniform(-width, width)) for _ in range(copies)]


class Proxy:
    """Forwards datagrams to each end, impaired; a context manager.

    Args:
        targets: where each end receives, ``HOST:PORT``.
        impairment: what happens to the packets.
        seed: of the random numbers.
    """

    def __init__(self, targets: Mapping[Role, str], impairment: Impairment, seed: int = 0) -> None:
        self._impairment, self._chance = impairment, random.Random(seed)
        self._targets: dict[Role, tuple[str, int]] = {}
        self._sockets: dict[Role, socket.socket] = {}
        for end, address in targets.items():
            host, _, port = address.rpartition(":")
            self._targets[end] = (host, int(port))
            self._sockets[end] = socket.socket(type=socket.SOCK_DGRAM)
            self._sockets[end].setblocking(False)
            self._sockets[end].bind(("127.0.0.1", 0))
        self._ends = threading.Event()
        self._thread = threading.Thread(target=self._forward, daemon=True)

    @property
    def addresses(self) -> dict[Role, str]:
        """The address to which the other ends send their packets for each end."""
        return {end: "{}:{}".format(*one.getsockname()) for end, one in self._sockets.items()}

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ends.set()
        self._thread.join()
        for one in self._sockets.values():
            one.close()

    def _forward(self) -> None:
        under_way: list[tuple[float, int, Role, bytes]] = []
        number = 0
        with selectors.DefaultSelector() as selector:
            for end, one in self._sockets.items():
                selector.register(one, selectors.EVENT_READ, end)
            while not self._ends.is_set():
                now = time.monotonic()
                wait_s = min(_IDLE_S, max(0.0, under_way[0][0] - now)) if under_way else _IDLE_S
                for key, _ in selector.select(wait_s):
                    with contextlib.suppress(OSError):
                        data = self._sockets[key.data].recv(_LARGEST)
                        for delay_s in self._impairment.delays_s(self._chance):
                            number += 1
                            due = time.monotonic() + delay_s
                            heapq.heappush(under_way, (due, number, key.data, data))
                while under_way and under_way[0][0] <= time.monotonic():
                    _, _, end, data = heapq.heappop(under_way)
                    with contextlib.suppress(OSError):
                        self._sockets[end].sendto(data, self._targets[end])
