# SPDX-License-Identifier: Apache-2.0
"""The clock of a program whose ticks another program grants, one by one.

A test steps world, robots and station in this way: each is the usual process with the usual
sockets, but its time is that of the test. So a fault comes at the same instant in every run, and
the results are the same to the last packet. The variable ``PALMBOTS_STEPS`` holds the address of
the program that steps.

Frames (`palmbots.links.local_connection`), one JSON line each:

- program → stepper: the name of the program, once, when it has booted.
- program → stepper: ``{receiver: packets}`` when it waits for its next tick: how many packets it
  has sent to each receiver so far. The stepper waits until they have arrived.
- stepper → program: ``[time, elapsed, packets]``: a tick at this time [s]; so many ticks of its own
  clock have passed, and so many packets have been sent to it since the last tick.
"""

import os
import time
from collections import Counter

from palmbots._util import process_clock
from palmbots.errors import PalmbotsError
from palmbots.links.link import Link
from palmbots.links.local_connection import connect
from palmbots.wire import Role

_VARIABLE = "PALMBOTS_STEPS"
_WITHIN_S = 60.0  # only a program that hangs takes so long
_POLL_S = 0.0005


def stepper_address() -> str | None:
    """The address of the program that steps this one; None: time passes as usual."""
    return os.environ.get(_VARIABLE)


class SteppedClock:
    """Waits for granted ticks; in place of `palmbots.clocks.control_clock.ControlClock`.

    Args:
        name: of this program.
        address: of the program that steps it.
        stride: granted ticks between two steps of this program.
    """

    is_stepped = True

    def __init__(self, name: str, address: str, stride: int = 1) -> None:
        self._stride = stride
        self._stepper = connect(address, "stepper", _WITHIN_S)
        self._stepper.send(name)
        self._now_s = 0.0
        self._sent: Counter[str] = Counter()
        self.expected = 0
        self.overruns = 0
        self.recent_overruns = 0
        self.jitter = [0] * 6
        process_clock.step_by(lambda: self._now_s)

    def wait(self) -> int:
        """Wait for the next step; returns the number of ticks since the last one.

        Raises:
            PalmbotsError: the program that steps is gone.
        """
        total = 0
        for _ in range(self._stride):
            self._stepper.send(self._sent)
            self._now_s, elapsed, expected = self._stepper.receive()
            self.expected += expected
            total += elapsed
        self.overruns += total // self._stride - 1
        return total

    def run_at(self, rate: float) -> None:
        """As for `ControlClock`: the stepper knows the rate of each clock."""

    def forget(self) -> None:
        """As for `ControlClock`."""

    def link(self, link: Link) -> Link:
        """The same link, in step with the clock."""
        return _SteppedLink(link, self)

    def note_sent(self, receiver: Role) -> None:
        """A packet has been sent."""
        self._sent[receiver] += 1


class _SteppedLink:
    """A link on which every packet of a tick has arrived before the tick is computed."""

    def __init__(self, link: Link, clock: SteppedClock) -> None:
        self._link, self._clock = link, clock

    def send(self, receiver: Role, data: bytes) -> None:
        self._link.send(receiver, data)
        self._clock.note_sent(receiver)

    def receive(self) -> list[bytes]:
        arrived = self._link.receive()
        give_up = time.monotonic() + _WITHIN_S
        while len(arrived) < self._clock.expected:
            if time.monotonic() > give_up:
                raise PalmbotsError("link: packets of the stepper are missing")
            time.sleep(_POLL_S)
            arrived += self._link.receive()
        self._clock.expected = 0
        return arrived

    def close(self) -> None:
        self._link.close()
