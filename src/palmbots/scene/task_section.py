# SPDX-License-Identifier: Apache-2.0
"""The sections of a scene about the task: `bumps`, `start` and `task`."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots._types import Side
from palmbots.scene.fields import (
    Angle,
    Duration,
    Lasting,
    Moment,
    Place,
    Range,
    Shift,
    Switch,
    field_error,
    from_list,
)
from palmbots.scene.path_section import Path
from palmbots.scene.section import Section

Direction = Literal["forward", "backward"]

Jolt = Annotated[float, BeforeValidator(Range("m", least=0, most=1))]
Distance = Annotated[float, BeforeValidator(Range("m", least=0.001, most=10_000))]
Travel = Annotated[float, BeforeValidator(Range("m", least=0, most=10_000))]
PushSpeed = Annotated[float, BeforeValidator(Range("m/s", least=-1, most=1))]
Lag = Annotated[float, BeforeValidator(Range("s", least=0, most=1000))]
Density = Annotated[float, BeforeValidator(Range("bumps per metre", least=0, most=100))]


class Bump(Section):
    """A sudden shift of one contact, at a given distance or time."""

    robot: Side
    """The robot whose contact shifts."""
    shift_m: Shift
    """Size of the shift; > 0 is outward."""
    at_m: Travel | None = None
    """Distance travelled by the pair at which it happens."""
    at_s: Moment | None = None
    """Time at which it happens."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.at_m is None) == (self.at_s is None):
            problem = "has no place and no time" if self.at_m is None else "has a place and a time"
            raise field_error(self.model_dump(), problem, "exactly one of at_m and at_s")
        return self


Script = Annotated[
    tuple[Bump, ...],
    BeforeValidator(from_list("a list of at most 64 tables {robot, at_m or at_s, shift_m}", 0, 64)),
]


class Push(Section):
    """A time during which something pushes a robot."""

    robot: Side
    """The robot that is pushed."""
    at_s: Moment
    """When it begins."""
    duration_s: Lasting
    speed_m_s: PushSpeed
    """What the push adds to the robot's speed; > 0 is outward, away from the partner. A robot that
    holds its brakes does not move."""


PushScript = Annotated[
    tuple[Push, ...],
    BeforeValidator(
        from_list("a list of at most 16 tables {robot, at_s, duration_s, speed_m_s}", 0, 16)
    ),
]


class Bumps(Section):
    """[bumps] Bumps of the floor, which shift the contacts, and pushes of the robots."""

    script: Script = ()
    """Bumps that happen in every carry: a list of tables {robot, at_m or at_s, shift_m}."""
    pushes: PushScript = ()
    """Times during which something pushes a robot, in every carry: a list of tables {robot, at_s,
    duration_s, speed_m_s}."""
    rate_per_m: Density = 0.0
    """Mean number of random bumps per metre and robot."""
    max_shift_m: Jolt = 0.004
    """Largest size of a random bump. Sizes are uniform from minus to plus this value."""


class Start(Section):
    """[start] The contact coordinates at the start."""

    left_m: Place = 0.0
    """Contact coordinate on the left palm; > 0 is outward of the pivot."""
    right_m: Place = 0.0
    """Contact coordinate on the right palm; > 0 is outward of the pivot."""


class Task(Section):
    """[task] Distance, direction, path and floor."""

    distance_m: Distance = 1.5
    """Distance that the midpoint of the pivots has to travel."""
    slope_deg: Angle = 0.0
    """Slope of the floor. > 0 is uphill in the direction of travel."""
    timeout_s: Duration | None = None
    """Time limit of the carry. Not set: twice the time that the slower robot needs at nominal
    speed, or more if the robots take long to reach it."""
    direction: Direction = "forward"
    """forward: the right robot leads. backward: the left robot leads."""
    inertia: Switch = True
    """Whether the accelerations of the pair influence which contact slides first. false: they are
    neglected, as in the paper."""
    inertia_tau_s: Lag = 0.05
    """Time constant of the first-order filter for these accelerations, because wheels, palms and
    contacts are compliant. 0: no filter."""
    path: Path = Path()
