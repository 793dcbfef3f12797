"""What a robot decides, packets in and out."""

from collections.abc import Sequence

import palmbots._core


class Robot:
    """The program of one robot."""

    def __init__(self, spec: palmbots._core.Spec, controller: object, side: int, key: bytes, pair: int, epoch: int, is_first: bool, assists: bool) -> None:
        """controller: a name, Machines, or a pair of Python step functions."""

    def step(self, elapsed: int, sign: int, palm_at_target: bool, packets: Sequence[bytes]) -> tuple[int, int, bool, list[tuple[int, bytes, int]], int, bool, int, int, int, bool]:
        """
        One tick; returns palm, move, stop, packets (receiver, bytes, word), case, waits, awaits, packets rejected and late in this tick, and whether the palm assists.
        """

    def greet(self) -> bytes | None:
        """
        A hello to the partner, before the carry; None if the controller has no use for it.
        """

    def hear(self, bytes: bytes) -> None:
        """Takes in a packet before the carry."""

    def count(self, verdict: int) -> int:
        """How many received packets had this verdict."""

def uses_clock(controller: object) -> bool:
    """
    Does it count time, and start at rest? The others act on messages and contacts alone.
    """

class RemoteControllers:
    """Controllers of a carry that run elsewhere (sim/remote_team.hpp)."""

    def __init__(self, exchange: object, has_clocks: bool, starts_at_rest: bool) -> None:
        """
        exchange(tick, left, right, station) gets inputs (elapsed, sign, palm at target, boots, packets) or None, and returns three answers of Robot.step or None.
        """
