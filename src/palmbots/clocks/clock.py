# SPDX-License-Identifier: Apache-2.0
"""What every clock of a control loop offers (`Clock`): it grants the ticks."""

from collections.abc import Sequence
from typing import Protocol

from palmbots.links.link import Link


class Clock(Protocol):
    """Grants the steps of a loop: as time passes, or as another program decides."""

    is_stepped: bool
    """Another program grants the steps, and waits for what each decides."""
    overruns: int
    """Steps that were missed."""

    @property
    def jitter(self) -> Sequence[int]:
        """How many steps began late by how much (`palmbots.clocks.control_clock.jitter_table`)."""
        ...

    @property
    def recent_overruns(self) -> int:
        """Steps that were missed lately."""
        ...

    def wait(self) -> int:
        """Wait for the next step; returns the number of ticks since the last one."""
        ...

    def run_at(self, rate: float) -> None:
        """Run at this multiple, as the wrong clock of a simulated robot."""
        ...

    def forget(self) -> None:
        """Start the count of `recent_overruns` anew, as a program does at a boot."""
        ...

    def link(self, link: Link) -> Link:
        """The link as this clock needs it."""
        ...
