# SPDX-License-Identifier: Apache-2.0
"""A bad radio between real sockets: a proxy that loses, delays, reorders and repeats datagrams.

It needs no special rights and no special kernel. Its random numbers are seeded: if the same packets
arrive in the same order, the same ones are lost. The times of arrival depend on the machine.
"""

import contextlib
import heapq
import math
import random
import selectors
import socket
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Self, cast

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
    """Half the width of the interval around the delay from which each delay is drawn."""
    duplicate: float = 0.0
    """Probability that it arrives twice, each with a delay of its own."""
    reorder: float = 1.0
    """Whether it may overtake an earlier one: 0 or 1."""

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
        if self.reorder not in (0, 1):
            raise PalmbotsError(f"link: reorder is {self.reorder:g}; allowed: 0 or 1")
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

    def with_fate(self, kind: int, delay_s: float) -> "Impairment":
        """The same for a packet with a recorded fate (`RecordedFates`)."""
        own = replace(self, loss=1.0 if delay_s < 0 else 0.0)
        if kind == ONLY_LOSSES:
            return own
        latency_ms = 0.0 if kind == WHOLE_DELAYS else self.delay_ms - self.jitter_ms
        return replace(own, delay_ms=latency_ms + 1e3 * max(0.0, delay_s), jitter_ms=0.0)


ONLY_LOSSES, FURTHER_DELAYS, WHOLE_DELAYS = range(3)
"""What a recording of packets has besides losses: nothing, delays beyond the latency, or delays."""


@dataclass(frozen=True)
class RecordedFates:
    """What became of recorded packets, which were sent at equal times."""

    interval_s: float
    kind: int
    delays_s: Sequence[float]
    """Of each packet; negative: it was lost."""


class _Replay:
    """Where in a recording a link is. It begins at a random place. A packet meets the fate of the
    one that was sent as long after that place, or of the next one: none is replayed twice in a
    row."""

    def __init__(self, fates: RecordedFates, now_s: float, chance: random.Random) -> None:
        self._fates, self._start_s = fates, now_s
        self._first = chance.randrange(len(fates.delays_s))
        self._next = 0

    def delay_s(self, now_s: float) -> float:
        fates = self._fates
        at = math.floor((now_s - self._start_s) / fates.interval_s + 1e-6)
        self._next = max(self._next, at) + 1
        return fates.delays_s[(self._first + self._next - 1) % len(fates.delays_s)]


class ImpairedPackets:
    """The packets that are under way on a bad radio, without sockets and without a clock.

    Args:
        impairment: what happens to the packets.
        seed: of the random numbers.
        fates: of recorded packets, which replace losses and, as far as recorded, delays.
    """

    def __init__(
        self, impairment: Impairment, seed: int = 0, fates: RecordedFates | None = None
    ) -> None:
        self._impairment, self._chance = impairment, random.Random(seed)
        self._seed, self._fates = seed, fates
        self._replays: dict[tuple[str, str], _Replay] = {}
        self._under_way: list[tuple[float, int, str, bytes]] = []
        self._number = 0
        self._cut: frozenset[tuple[str, str]] = frozenset()
        self._held: dict[str, float] = {}
        self._last_s: dict[tuple[str, str], float] = {}  # when the newest one arrives

    def cut(self, *links: tuple[str, str]) -> None:
        """From now on lose everything on these links, each a sender and a receiver, and on no
        other."""
        self._cut = frozenset(links)

    def hold(self, delay_s: float, sender: str) -> None:
        """From now on hold back the packets of this sender for so long, as somebody in the middle
        can who does not know the key."""
        self._held = {sender: delay_s}

    def send(self, now_s: float, sender: str, receiver: str, data: bytes) -> None:
        """A packet has been sent. The same packets meet the same fate, whatever is cut."""
        for delay_s in self._one(now_s, sender, receiver).delays_s(self._chance):
            if (sender, receiver) not in self._cut:
                self._number += 1
                at_s = now_s + delay_s + self._held.get(sender, 0.0)
                if not self._impairment.reorder:
                    at_s = max(at_s, self._last_s.get((sender, receiver), at_s))
                self._last_s[sender, receiver] = at_s
                heapq.heappush(self._under_way, (at_s, self._number, receiver, data))

    def _one(self, now_s: float, sender: str, receiver: str) -> Impairment:
        """What happens to the packet that is sent now."""
        if self._fates is None:
            return self._impairment
        link = (sender, receiver)
        if link not in self._replays:
            # Which link begins first does not change the places.
            place = random.Random(f"{self._seed} {sender} {receiver}")
            self._replays[link] = _Replay(self._fates, now_s, place)
        delay_s = self._replays[link].delay_s(now_s)
        return self._impairment.with_fate(self._fates.kind, delay_s)

    def due(self, now_s: float) -> Iterator[tuple[str, bytes]]:
        """Take the packets that have arrived by now, with their receivers, in order."""
        while self._under_way and self._under_way[0][0] <= now_s:
            _, _, receiver, data = heapq.heappop(self._under_way)
            yield receiver, data

    def wait_s(self, now_s: float, longest_s: float) -> float:
        """The time until the next packet arrives, at most `longest_s`."""
        return min(longest_s, max(0.0, self._under_way[0][0] - now_s if self._under_way else 9e9))


class Proxy:
    """Forwards datagrams to each end, impaired; a context manager.

    Args:
        targets: where each end receives, ``HOST:PORT``.
        impairment: what happens to the packets.
        seed: of the random numbers.
        rate: how much faster than usual time passes for the packets.
        fates: of recorded packets.
    """

    def __init__(
        self,
        targets: Mapping[Role, str],
        impairment: Impairment,
        seed: int = 0,
        rate: float = 1.0,
        fates: RecordedFates | None = None,
    ) -> None:
        self.packets = ImpairedPackets(impairment, seed, fates)
        self._rate = rate
        self._targets: dict[str, tuple[str, int]] = {}
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

    def _now_s(self) -> float:
        return self._rate * time.monotonic()

    def _forward(self) -> None:
        ends = {place: end for end, place in self._targets.items()}
        with selectors.DefaultSelector() as selector:
            for end, one in self._sockets.items():
                selector.register(one, selectors.EVENT_READ, end)
            while not self._ends.is_set():
                wait_s = self.packets.wait_s(self._now_s(), self._rate * _IDLE_S) / self._rate
                for key, _ in selector.select(wait_s):
                    with contextlib.suppress(OSError):
                        data, place = self._sockets[key.data].recvfrom(_LARGEST)
                        sender = ends.get(place, "")
                        self.packets.send(self._now_s(), sender, key.data, data)
                for receiver, data in self.packets.due(self._now_s()):
                    with contextlib.suppress(OSError):
                        self._sockets[cast(Role, receiver)].sendto(data, self._targets[receiver])
