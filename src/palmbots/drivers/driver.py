# SPDX-License-Identifier: Apache-2.0
"""What every driver offers (`Driver`): readings in (`Reading`), commands out (`Drive`).

A driver that can be calibrated also gives access to its hardware as it is (`RawAccess`). Every
driver is opened with `DriverSettings`.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Protocol, Self, runtime_checkable

from palmbots._types import Side
from palmbots.drivers.arm import HOLDS, NEW_ARM, ArmMotion, ArmShape, StoredArm
from palmbots.drivers.hardware import HardwareParameters
from palmbots.errors import PalmbotsError
from palmbots.links.link import to_stderr

WATCHDOG_SHARE = 0.9
"""Part of the watchdog's time after which the wheels are stopped; the rest is for the way of the
command to the motors."""


@dataclass(frozen=True)
class Reading:
    """What a driver reads."""

    sign: int
    """Tactile sign of the contact coordinate p: -1, 0 or 1; p > 0 is outward."""
    palm_at_target: bool
    """The palm has reached the angle last commanded."""
    distance_m: float
    """Distance covered so far in the direction of travel, by odometry. Its value at the start of a
    carry may exceed 0. NaN: the robot has no encoders."""
    battery_v: float | None = None
    """Voltage of the battery; None: not measured."""
    has_contact: bool = True
    """Something lies on the palm; true if the sensor cannot say."""
    arm_there: bool = False
    """The arm has reached the height last commanded."""
    arm_steps: int = 0
    """How many steps of a job the arm is above the height from which they count
    (`palmbots.drivers.arm.ArmMotion.steps`)."""
    stored_arm: StoredArm = NEW_ARM
    """What the robot remembers of its arm over a boot."""
    beneath: bool | None = None
    """The robot has reached its place below an object on a stand. None: the driver does not report
    it, and the distance decides."""
    far_enough: bool = False
    """The distance is covered, whatever the odometry counts; of a simulated world in lockstep."""

    def with_arm(self, arm: ArmMotion) -> Self:
        """The same with what is known of the arm."""
        return replace(
            self, arm_there=arm.is_there(self.palm_at_target), arm_steps=arm.steps,
            stored_arm=arm.stored,
        )  # fmt: skip


@dataclass(frozen=True)
class Drive:
    """A command to palm and wheels, as the controller says it and in physical units."""

    palm: int
    """0: the palm is at its steep angle, 1: at its shallow one."""
    move: int
    """0: nominal speed, 1: away from the partner, 2: closer to it."""
    stop: bool
    """The wheels stop, apart from a correction that `move` demands."""
    wheels: bool
    """The wheels may turn. If false they stop at once, whatever the rest says."""
    palm_rad: float
    """Angle of the palm over the horizontal; it faces the partner."""
    speed_m_s: float
    """Speed in the direction of travel, 0 if the wheels may not turn."""
    arm: int = HOLDS
    """What the arm does in a job on the floor or at a stand (`palmbots.drivers.arm`): the nose of
    the palm rests on the floor, also while the palm turns, or the palm is below the object on a
    stand; the arm reaches up until something presses the palm; it holds its height, rises to the
    height at which the pair carries, or sinks until the nose is on the floor, or the palm below the
    object."""
    arm_ends: bool = False
    """The lowest height of the arm is that at the end of the job."""
    phase: int = 0
    """The phase of a job on the floor, as its table numbers it; for simulated worlds."""


class Driver(Protocol):
    """The hardware of one robot. No method waits for longer than a fraction of a control tick."""

    def read(self) -> Reading | None:
        """The newest reading; None: the hardware has ended the carry, as a simulated world does.

        Raises:
            PalmbotsError: the hardware is lost.
        """
        ...

    @property
    def works(self) -> bool:
        """Readings still come, and commands are taken."""
        ...

    def write(self, drive: Drive) -> None:
        """Command palm and wheels. If no command follows within the time of the watchdog, the
        wheels stop, whatever has become of the program."""
        ...

    def stop(self) -> None:
        """Stop the wheels at once; the palm keeps its angle."""
        ...

    def close(self) -> None:
        """Stop the wheels, and give the hardware back."""
        ...


@dataclass(frozen=True)
class RawReading:
    """What the hardware itself reads, before any calibration."""

    wheel_counts: tuple[float, float] | None
    """Counts of the encoders of the left and the right wheel so far, growing forward; None: the
    robot has no encoders."""
    closed: tuple[bool, ...]
    """Which switches of the palm are closed, in the order of their inputs."""
    servo_rad: float | None = None
    """Angle of the servo; None: it is not measured."""
    battery_v: float | None = None
    """Voltage of the battery; None: not measured."""


@dataclass(frozen=True)
class RawCommand:
    """What the motors themselves are commanded."""

    wheels_rad_s: tuple[float, float]
    """Left and right wheel, forward. 0: the motor brakes."""
    servo_rad: float | None = None
    """Angle of the servo; None: it keeps its own."""
    arm_rad: float | None = None
    """Angle of the servo of the arm; None: it keeps its own, or there is none."""


@runtime_checkable
class RawAccess(Protocol):
    """A driver whose hardware can be calibrated."""

    def read_raw(self) -> RawReading | None:
        """The newest reading; as `Driver.read`."""
        ...

    def write_raw(self, command: RawCommand) -> None:
        """Command the motors. The watchdog holds as for `Driver.write`."""
        ...


@dataclass(frozen=True)
class DriverSettings:
    """What a driver is opened with."""

    side: Side
    """Of the robot."""
    leads: bool
    """The robot travels away from its partner, which is behind it."""
    address: str
    """``driver.address`` of the ``pair.toml``, or the address of this side."""
    period_s: float
    """Time between two commands."""
    watchdog_s: float
    """W: the wheels have to stop when no command has been written for this time."""
    hardware: HardwareParameters = field(default_factory=HardwareParameters)
    """``[hardware]``, of this side."""
    baud: int = 115_200
    """``driver.baud``, for serial lines."""
    options: Mapping[str, Any] = field(default_factory=dict)
    """``[driver.options]``: keys of the driver's own."""
    max_speed_m_s: float = 0.2
    """``limits.max_speed_m_s``. No faster command reaches a driver."""
    epoch: int = 1
    """Number of the robot's boots, for simulated robots."""
    within_s: float = 20.0
    """Time within which the world has to answer, for simulated robots."""
    scene: int = 0
    """A number that is equal for programs with the same scene, for simulated robots."""
    arm: ArmShape | None = None
    """What the job of the scene asks of the arm; None: it begins and ends on the palms."""
    stored_arm: StoredArm = NEW_ARM
    """`Reading.stored_arm` before the boot."""
    table: Any = None
    """The table of this kind of driver in the ``pair.toml``, where there is one."""
    on_line: Callable[[str], None] = to_stderr
    """Called with a line for the operator, such as that the hardware is lost, or back."""


class NoAnswer(PalmbotsError):
    """The hardware stays silent."""


class DriverFailed(PalmbotsError):
    """A driver of another distribution has raised an exception."""

    def __init__(self, kind: str, why: str) -> None:
        super().__init__(f"driver.kind: {kind}: {why}")
        self.why = why
        """The exception, and the place in the driver."""


DriverMaker = Callable[[DriverSettings], Driver]
"""What is registered under a kind: a class whose objects are drivers, or a function that opens one.
Its attribute ``has_watchdog`` states whether the hardware itself stops the wheels when no command
comes within `DriverSettings.watchdog_s`; without it, or if it is false, the driver runs in a guard
process, which does that. ``has_arm`` states whether it moves an arm: without it, or if it is false,
jobs on the floor are refused. It raises `PalmbotsError` if the hardware cannot be used."""


def works(driver: Driver) -> bool:
    """Whether readings still come; true for a driver that does not say so."""
    return bool(getattr(driver, "works", True))


def targets(drive: Drive) -> list[float]:
    """Where a command sends palm and arm. A reading that refers to other targets does not say
    whether they have arrived."""
    return [drive.palm_rad, drive.arm, drive.arm_ends]
