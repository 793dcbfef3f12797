"""What a robot decides, packets in and out."""

from collections.abc import Sequence

import palmbots._core


class RuntimeSettings:
    """Times in control ticks."""

    def __init__(self, lease: int, station_limit: int, time_limit: int, travel: int, stopping_limit: int, most_overruns: int, has_radio: bool, rejoins: bool, stops_without_station: bool, stops_without_partner: bool, state_period: int, status_period: int, number: int) -> None: ...

    @staticmethod
    def lockstep() -> RuntimeSettings:
        """The controller alone decides, and nothing is sent but what it says."""

class Reading:
    """What a robot reads in a tick."""

    def __init__(self, sign: int, palm_at_target: bool, contact: bool = True, battery_ok: bool = True, driver_ok: bool = True, storage_ok: bool = True, covered: bool = False, stop: bool = False, overruns: int = 0, battery_mv: int = 65535, progress: int = 0, stopping: int = 0) -> None: ...

class Robot:
    """The program of one robot."""

    def __init__(self, spec: palmbots._core.Spec, controller: object, side: int, key: bytes, pair: int, epoch: int, assists: bool, settings: RuntimeSettings, carries: bool = False, stored_carries: bool = False, stored_stop: bool = False) -> None:
        """
        controller: a name, Machines, or a pair of Python step functions. carries: the carry is under way, as in lockstep.
        """

    def step(self, elapsed: int, reading: Reading, packets: Sequence[bytes]) -> tuple[int, int, bool, list[tuple[int, bytes, int]], int, bool, int, int, int, bool]:
        """
        One tick; returns palm, move, stop, packets (receiver, bytes, word), case, waits, awaits, packets rejected and late in this tick, and whether the palm assists.
        """

    @property
    def mode(self) -> str: ...

    @property
    def fault(self) -> str: ...

    @property
    def wheels(self) -> bool:
        """The wheels may turn; otherwise the driver is to stop them at once."""

    @property
    def to_store(self) -> tuple[bool, bool]:
        """
        To be stored when it changes: a carry is under way, a stop is in force.
        """

    def greet(self) -> bytes | None:
        """
        A hello to the partner, before the carry; None if the controller has no use for it.
        """

    def operate(self, operation: int) -> None:
        """
        What the operator wants who presses a button of the robot; for the next step.
        """

    def hear(self, bytes: bytes) -> None:
        """Takes in a packet before the carry."""

    def count(self, verdict: int) -> int:
        """How many received packets had this verdict."""

def times(spec: palmbots._core.Spec, controller: str) -> list[int]:
    """
    The times of a shipped controller [ticks], in the order of its struct Times; [] if it has none.
    """

def uses_clock(controller: object) -> bool:
    """
    True if it counts time and starts at rest. The others act on messages and contacts alone.
    """

class Station:
    """The station that decides for both robots."""

    def __init__(self, key: bytes, pair: int, epoch: int) -> None: ...

    def step(self, packets: Sequence[bytes]) -> tuple[list[tuple[int, bytes, int]], int, int, int]:
        """
        One tick; returns packets (receiver, bytes, word), case, and packets rejected of the left and of the right robot.
        """

    def greet(self, robot: int) -> bytes:
        """A hello to a robot."""

    def hear(self, bytes: bytes) -> None:
        """Takes in a packet before the carry."""

class RemoteControllers:
    """Controllers of a carry that run elsewhere (sim/remote_team.hpp)."""

    def __init__(self, exchange: object, has_clocks: bool, has_station: bool) -> None:
        """
        exchange(tick, left, right, station) gets inputs (elapsed, sign, palm at target, boots, packets) or None, and returns three answers of Robot.step or None.
        """
