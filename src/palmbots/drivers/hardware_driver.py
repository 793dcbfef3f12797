# SPDX-License-Identifier: Apache-2.0
"""The base of drivers for two motors, a servo and switches (`HardwareDriver`).

A driver of your own that derives from it reads and commands the hardware as it is. Calibration,
signs, ramps and odometry are those of ``[hardware]`` in the ``pair.toml``.
"""

import time
from abc import ABC, abstractmethod

from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, RawReading, Reading
from palmbots.drivers.hardware import check_arm_hardware
from palmbots.drivers.hardware_io import HardwareIo
from palmbots.errors import PalmbotsError


class HardwareDriver(ABC):
    """Reads and commands hardware as it is; a subclass does that.

    Args:
        settings: of the driver.

    Raises:
        PalmbotsError: the job of the scene needs an arm or switches that ``[hardware]`` lacks.
    """

    def __init__(self, settings: DriverSettings) -> None:
        self.settings = settings
        self.newest_raw: RawReading | None = None
        """Of the newest `read`."""
        if settings.arm is not None:
            check_arm_hardware(settings.hardware, settings.side, settings.arm)
        self._io = HardwareIo(
            settings.hardware, leads=settings.leads, arm=settings.arm,
            stored_arm=settings.stored_arm,
        )  # fmt: skip

    @abstractmethod
    def read_raw(self) -> RawReading | None:
        """What the hardware reads now; None: it has ended the carry."""

    @abstractmethod
    def write_raw(self, command: RawCommand) -> None:
        """Command the motors now; a speed of 0 brakes."""

    @property
    def works(self) -> bool:
        """Readings still come, and commands are taken."""
        return True

    def read(self) -> Reading | None:
        """The newest reading.

        Raises:
            PalmbotsError: ``[hardware]`` does not fit the switches or the encoders of the driver.
            TypeError: `read_raw` of the subclass returns something else.
        """
        raw = self.newest_raw = self.read_raw()
        if raw is None:
            return None
        if not isinstance(raw, RawReading):
            kind = type(raw).__name__
            raise TypeError(f"read_raw returns {kind}; allowed: a RawReading, or None")
        listed = len(self.settings.hardware.switches)
        if len(raw.closed) != listed:
            raise PalmbotsError(
                f"hardware.switches: {listed} switches are listed; the driver reads "
                f"{len(raw.closed)}"
            )
        counts = self.settings.hardware.encoder_ticks_per_turn
        if raw.wheel_counts is None and counts > 0:
            raise PalmbotsError(
                f"hardware.encoder_ticks_per_turn: value is {counts:g}, but the driver reads no "
                "encoders; allowed: 0"
            )
        return self._io.reading(raw, time.monotonic())

    def write(self, drive: Drive) -> None:
        """Command palm and wheels."""
        self.write_raw(self._io.command(drive, time.monotonic()))

    def stop(self) -> None:
        """Stop the wheels at once; the palm keeps its angle."""
        self.write_raw(RawCommand((0.0, 0.0)))

    def close(self) -> None:
        """Stop the wheels. A subclass also gives the hardware back."""
        self.stop()
