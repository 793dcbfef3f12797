# SPDX-License-Identifier: Apache-2.0
"""The section `faults` of a scene: what fails in robots, sensors and the station."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots._types import Side
from palmbots.scene.fields import (
    Angle,
    Fraction,
    Lasting,
    Moment,
    Switch,
    field_error,
    from_list,
    whole,
)
from palmbots.scene.robot_section import ClockError
from palmbots.scene.section import Section

KEYS_OF_KIND: dict[str, frozenset[str]] = {
    "reboot": frozenset({"robot"}),
    "freeze": frozenset({"robot"}),
    "stuck": frozenset({"robot", "stuck_at"}),
    "intermittent": frozenset({"robot", "probability"}),
    "station-down": frozenset(),
    "clock-rate": frozenset({"robot", "ppm"}),
    "clock-jump": frozenset({"robot"}),
}
"""The keys that a fault of each kind needs, besides kind, at_s and duration_s."""
OPTIONAL_KEYS_OF_KIND = {"reboot": frozenset({"loses_boot_counter", "limp_deg"})}
"""The keys that a fault of a kind may have in addition."""

Few = Annotated[int, BeforeValidator(whole(0, 8))]


class Fault(Section):
    """A temporary fault."""

    kind: Literal[
        "reboot", "freeze", "stuck", "intermittent", "station-down", "clock-rate", "clock-jump"
    ]
    """reboot: a robot is off and boots. freeze: its controller does not step. stuck: its sensor
    reads `stuck_at`. intermittent: each reading is random with `probability`. station-down: the
    station neither receives nor sends. clock-rate: the clock of a robot runs fast by a further
    `ppm`. clock-jump: it jumps ahead by `duration_s`."""
    robot: Side | None = None
    """The robot that has the fault; not for station-down."""
    at_s: Moment
    duration_s: Lasting
    stuck_at: Literal["-", "0", "+"] | None = None
    """The reading of a stuck sensor."""
    probability: Fraction | None = None
    """Probability that a reading of an intermittent sensor is random."""
    ppm: ClockError | None = None
    """By how much a clock runs fast, in parts per million; < 0: slow."""
    loses_boot_counter: Switch | None = None
    """Only for reboot: true if the robot also loses its boot counter. Its program then refuses to
    start again."""
    limp_deg: Angle | None = None
    """Only for reboot: without power the servo does not hold the palm, which turns to this angle at
    its own speed. Not set: the servo holds the palm."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        needs = KEYS_OF_KIND[self.kind]
        optional: frozenset[str] = OPTIONAL_KEYS_OF_KIND.get(self.kind, frozenset())
        names = type(self).model_fields.keys() - {"kind", "at_s", "duration_s"} - optional
        given = {name for name in names if getattr(self, name) is not None}
        if given != needs:
            names = ", ".join(sorted(needs)) or "none of robot, stuck_at and probability"
            raise field_error(
                self.model_dump(),
                "has the wrong keys",
                f"with kind {self.kind}, besides at_s and duration_s: {names}",
            )
        return self


FaultScript = Annotated[
    tuple[Fault, ...],
    BeforeValidator(
        from_list("a list of at most 32 tables {kind, robot, at_s, duration_s}", 0, 32)
    ),
]


class Faults(Section):
    """[faults] Faults of robots, sensors and the station."""

    script: FaultScript = ()
    """Faults that happen in every carry: a list of tables {kind, robot, at_s, duration_s, stuck_at,
    probability, ppm, loses_boot_counter, limp_deg}."""
    random_reboots: Few = 0
    """Number of random reboots in every carry, each of either robot at any time."""
    reboot_s: Lasting = 0.5
    """Duration of a random reboot."""
