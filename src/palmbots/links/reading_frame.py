# SPDX-License-Identifier: Apache-2.0
"""What the world sends to the program of a simulated robot in each control period."""

from typing import NamedTuple


class ReadingFrame(NamedTuple):
    """A reading (`palmbots.drivers.driver.Reading`), and the command that was in force."""

    sign: int
    palm_at_target: bool
    distance_m: float
    palm: int
    """In force: shallow or steep."""
    has_contact: bool = True
    arm: int | None = None
    """What the arm does; None: the robot has none."""
    arm_there: bool = False
    arm_steps: int = 0
    beneath: bool = False
