# SPDX-License-Identifier: Apache-2.0
"""The section `faults` of a scene: what fails in robots, sensors and the station."""

from palmbots._types import Side
from palmbots.scene.core_keys import key, records
from palmbots.scene.section import Section


class Fault(Section):
    """A temporary fault."""

    kind: str = key("faults.script[].kind")
    """reboot: a robot is off and boots. freeze: its controller does not step. stuck: its sensor
    reads `stuck_at`. intermittent: each reading is random with `probability`. station-down: the
    station neither receives nor sends. clock-rate: the clock of a robot runs fast by a further
    `ppm`. clock-jump: it jumps ahead by `duration_s`."""
    robot: Side | None = key("faults.script[].robot")
    """The robot that has the fault; not for station-down."""
    at_s: float = key("faults.script[].at_s")
    duration_s: float = key("faults.script[].duration_s")
    stuck_at: str | None = key("faults.script[].stuck_at")
    """The reading of a stuck sensor."""
    probability: float | None = key("faults.script[].probability")
    """Probability that a reading of an intermittent sensor is random."""
    ppm: float | None = key("faults.script[].ppm")
    """By how much a clock runs fast, in parts per million; < 0: slow."""
    loses_boot_counter: bool | None = key("faults.script[].loses_boot_counter")
    """Only for reboot: true if the robot also loses its boot counter. Its program then refuses to
    start again."""
    limp_deg: float | None = key("faults.script[].limp_deg")
    """Only for reboot: without power the servo does not hold the palm, which turns to this angle at
    its own speed. Not set: the servo holds the palm."""


class Faults(Section):
    """[faults] Faults of robots, sensors and the station."""

    script: tuple[Fault, ...] = records("faults.script")
    """Faults that happen in every carry: a list of tables {kind, robot, at_s, duration_s, stuck_at,
    probability, ppm, loses_boot_counter, limp_deg}."""
    random_reboots: int = key("faults.random_reboots")
    """Number of random reboots in every carry, each of either robot at any time."""
    reboot_s: float = key("faults.reboot_s")
    """Duration of a random reboot."""
