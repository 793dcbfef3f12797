# SPDX-License-Identifier: Apache-2.0
"""How far a carry has come, by the distance that the driver counts."""

_STEPS = 50
_LEAST_STEP_M = 0.02


class Odometry:
    """The covered distance of one carry after another.

    The driver counts from anywhere, and may count anew after a boot. A carry that goes on after a
    boot continues from what was stored.

    Args:
        goal_m: distance of a carry.
        resumed_m: what a carry had covered that goes on after a boot; None: none goes on.
    """

    def __init__(self, goal_m: float, resumed_m: float | None = None) -> None:
        self._goal_m = goal_m
        self._step_m = max(_LEAST_STEP_M, goal_m / _STEPS)
        self._start_m: float | None = None
        self._newest_m = 0.0
        self._resumed_m = resumed_m
        self.covered_m = 0.0
        """Distance that the carry has covered."""

    def take(self, distance_m: float, carries: bool, counts: bool = True) -> None:
        """The driver counts this distance; `carries`: after the last step the wheels may turn.
        Without `counts` they turn for something else than to cover the distance."""
        if self._start_m is None:  # the first reading after a boot
            self._start_m = distance_m - (self._resumed_m or 0.0)
        elif not carries:
            self._start_m = distance_m
        elif not counts:
            self._start_m += distance_m - self._newest_m
        self._newest_m = distance_m
        self.covered_m = distance_m - self._start_m

    def is_covered(self, share: float = 1.0) -> bool:
        """This share of the distance of the carry is covered."""
        return self.covered_m >= share * self._goal_m

    @property
    def share(self) -> float:
        """The covered part of the distance, 0 to 1."""
        return max(0.0, min(1.0, self.covered_m / self._goal_m))

    @property
    def to_store_m(self) -> float:
        """The covered distance in steps so coarse that it need not be stored often."""
        return round(max(0.0, self.covered_m) // self._step_m * self._step_m, 3)


class Approach(Odometry):
    """Whether a robot has reached its place below an object on a stand.

    It counts from where the job begins. A robot that has been there stays there, whatever its
    corrections, until it drives back to try again.

    Args:
        goal_m: how far that place is away.
        resumed_m: how far the robot had driven before a boot.
    """

    def __init__(self, goal_m: float, resumed_m: float) -> None:
        super().__init__(goal_m, resumed_m)
        self.is_there = resumed_m >= goal_m
        """The robot is there."""

    def drive(self, distance_m: float, carries: bool, backs_off: bool) -> None:
        """As `take`, towards the object; `backs_off`: the robot drives back."""
        self.take(distance_m, carries)
        self.is_there = carries and not backs_off and (self.is_there or self.is_covered())

    @property
    def to_store_m(self) -> float:
        """As for any distance; the whole of it if the robot is there."""
        return self._goal_m if self.is_there else super().to_store_m
