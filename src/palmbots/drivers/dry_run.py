# SPDX-License-Identifier: Apache-2.0
"""The driver `dry-run`: it states what the robot would do, and moves nothing.

``[driver.options]`` may have a ``script`` for the sensor: a list of pairs of a time in seconds and
the sign from then on, as in ``script = [[5.0, 1], [7.5, 0]]``. Without it the contact is centred
all the time. There are no encoders, so a carry ends after the time that it takes at nominal speed.
"""

import math
import time
from typing import Any

from palmbots._util.arguments import show
from palmbots.drivers.arm import ARM_WORDS, LONGEST_MOVE_S, ArmMotion
from palmbots.drivers.driver import Drive, DriverSettings, Reading
from palmbots.errors import PalmbotsError

_KEY = "driver.options"
_ALLOWED = "a list of pairs [time in s, sign -1, 0 or 1], in order of time"


class DryRunDriver:
    """Reads a scripted sensor, and states each new command.

    Raises:
        PalmbotsError: an option is wrong.
    """

    has_arm = True

    def __init__(self, settings: DriverSettings) -> None:
        self._arm = None if settings.arm is None else ArmMotion(settings.arm, settings.stored_arm)
        options = dict(settings.options)
        self._script = _script_in(options.pop("script", []))
        for name in options:
            raise PalmbotsError(f"{_KEY}.{name}: is an unknown key; allowed: script")
        self._side, self._on_line = settings.side, settings.on_line
        self._start_s = self._moved_s = time.monotonic()
        self._stated = ""

    def read(self) -> Reading:
        """The scripted sign; the palm is at its target."""
        now_s = time.monotonic() - self._start_s
        sign = 0
        for from_s, value in self._script:
            if now_s >= from_s:
                sign = value
        seen = Reading(sign, True, math.nan, beneath=True)
        return seen if self._arm is None else seen.with_arm(self._arm)

    def write(self, drive: Drive) -> None:
        """State the command, if it is another one than before."""
        speed = drive.speed_m_s if drive.wheels else 0.0
        wheels = f"{speed:.3f} m/s" if speed else "at rest"
        arm = ""
        if self._arm is not None:
            now_s = time.monotonic()
            elapsed_s = min(now_s - self._moved_s, LONGEST_MOVE_S)
            self._arm.move(drive.arm, drive.palm, elapsed_s, ends=drive.arm_ends)
            self._moved_s = now_s
            arm = f", arm {ARM_WORDS[drive.arm]}"
        palm = f"palm at {math.degrees(drive.palm_rad):.1f} degrees"
        self._state(f"{palm}, wheels {wheels}{arm}")

    def _state(self, text: str) -> None:
        if text != self._stated:
            self._stated = text
            self._on_line(f"{self._side} robot, dry run: {text}")

    def stop(self) -> None:
        """State that the wheels stop, if anything has been commanded."""
        if self._stated:
            self._state("wheels at rest")

    def close(self) -> None:
        """The program ends: the wheels stop."""
        self.stop()


def _script_in(script: Any) -> list[tuple[float, int]]:
    """The sensor's script.

    Raises:
        PalmbotsError: it is none.
    """
    steps: list[tuple[float, int]] = []
    for step in script if isinstance(script, list) else [script]:
        is_pair = isinstance(step, list) and len(step) == 2
        if not (is_pair and type(step[0]) in (int, float) and type(step[1]) is int):
            raise PalmbotsError(f"{_KEY}.script: {show(step)} is wrong; allowed: {_ALLOWED}")
        from_s, sign = float(step[0]), step[1]
        earlier = steps[-1][0] if steps else 0.0
        if sign not in (-1, 0, 1) or not earlier <= from_s < math.inf:
            raise PalmbotsError(f"{_KEY}.script: {show(step)} is wrong; allowed: {_ALLOWED}")
        steps.append((from_s, sign))
    return steps
