"""The sections of a scene: every key with its meaning, unit, limits and default.

The defaults are the scene `paper`. Given by the paper (section 5.1): the box with its mass and
centre of mass, the size of the palms, 5° and 15°, 1.5 m at 0.06 m/s. All else is assumed.
A key that ends in ``_deg`` is in degrees, any other in the SI unit of its suffix. Seen from the
side, x points from the left robot to the right one; "outward" is away from the partner.
"""

import math
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, model_validator

from palmbots import _core
from palmbots.path_keys import Path
from palmbots.quantities import Angle, Fraction, Index, Range, Switch, fault, from_list
from palmbots.section import Section
from palmbots.standing import check_standing

__all__ = [
    "SIDES",
    "Bump",
    "Bumps",
    "Control",
    "Direction",
    "Object",
    "Palm",
    "PalmOverride",
    "PalmParameters",
    "Path",
    "Robot",
    "RobotOverride",
    "RobotParameters",
    "Side",
    "Start",
    "Tactile",
    "Task",
    "Zone",
    "friction_limit",
    "other_side",
]

Side = Literal["left", "right"]
Direction = Literal["forward", "backward"]
SIDES: tuple[Side, Side] = ("left", "right")

Size = Annotated[float, BeforeValidator(Range("m", least=0.001, most=10))]
Extent = Annotated[float, BeforeValidator(Range("m", least=0, most=10))]
Place = Annotated[float, BeforeValidator(Range("m", least=-10, most=10))]
Shift = Annotated[float, BeforeValidator(Range("m", least=-1, most=1))]
Jolt = Annotated[float, BeforeValidator(Range("m", least=0, most=1))]
Distance = Annotated[float, BeforeValidator(Range("m", least=0.001, most=10_000))]
Travel = Annotated[float, BeforeValidator(Range("m", least=0, most=10_000))]
Mass = Annotated[float, BeforeValidator(Range("kg", least=0.001, most=1000))]
Friction = Annotated[float, BeforeValidator(Range(least=0.001, most=100))]
SlipAngle = Annotated[float, BeforeValidator(Range("degrees", least=0.1, most=89))]
Turning = Annotated[float, BeforeValidator(Range("degrees/s", least=0.1, most=100_000))]
Speed = Annotated[float, BeforeValidator(Range("m/s", least=0, most=10))]
SpeedError = Annotated[float, BeforeValidator(Range("m/s", least=-1, most=1))]
Noise = Annotated[float, BeforeValidator(Range("m/s", least=0, most=1))]
Acceleration = Annotated[float, BeforeValidator(Range("m/s²", least=0.001, most=1000))]
Memory = Annotated[float, BeforeValidator(Range("s", least=0.001, most=1000))]
Lag = Annotated[float, BeforeValidator(Range("s", least=0, most=1000))]
Period = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=1))]
Moment = Annotated[float, BeforeValidator(Range("s", least=0, most=1_000_000))]
Patience = Annotated[float, BeforeValidator(Range("s", least=0.001, most=1_000_000))]
ClockError = Annotated[
    float, BeforeValidator(Range("parts per million", least=-100_000, most=100_000))
]
Density = Annotated[float, BeforeValidator(Range("bumps per metre", least=0, most=100))]
Coordinates = Annotated[
    tuple[Place, Place], BeforeValidator(from_list("[x, y], two numbers in m", 2, 2))
]
Vertices = Annotated[
    tuple[Coordinates, ...], BeforeValidator(from_list("a list of 3 to 32 points [x, y]", 3, 32))
]
Contacts = Annotated[
    tuple[Index, Index],
    BeforeValidator(from_list("[left, right], two indices into object.vertices_m", 2, 2)),
]


def other_side(side: Side) -> Side:
    """Left for right and right for left."""
    return "right" if side == "left" else "left"


class Object(Section):
    """[object] An extruded polygon seen from the side, in any frame and turned in any way."""

    vertices_m: Vertices = ((0.0, 0.0), (0.25, 0.0), (0.25, 0.16), (0.0, 0.16))
    """The outline: a simple polygon, either way round."""
    contacts: Contacts = (0, 1)
    """The vertices that lie on the left and on the right palm."""
    com_m: Coordinates = (0.125, 0.04)
    """Centre of mass, in the frame of the vertices."""
    mass_kg: Mass = 0.5
    depth_m: Size = 0.1
    """Length of the extrusion, across the direction of travel."""

    @property
    def width_m(self) -> float:
        """Distance of the two contact vertices, about that of the robots' pivots."""
        (lx, ly), (rx, ry) = (self.vertices_m[k] for k in self.contacts)
        return math.hypot(rx - lx, ry - ly)

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_standing(self.vertices_m, self.contacts, self.com_m)
        return self


def friction_limit(*palms_deg: float) -> float:
    """The coefficient that palms at these angles must stay below: friction angle + palm angle 90°.

    There an edge of the friction cone is level, and the contact holds against any force sideways.
    """
    steepest = math.radians(max(map(abs, palms_deg)))
    return 1 / math.tan(steepest) if steepest > 0 else math.inf


class PalmParameters(Section):
    """One palm: a flat plate that turns about a pivot below its middle."""

    length_m: Size = 0.15
    """Along the direction of travel; contacts lie within ± half of it."""
    width_m: Size = 0.07
    """Across the direction of travel; with lips as wide as the object and twice the clearance."""
    lip_height_m: Extent = 0.0
    """Dynamic world: height of the lips along both sides of the palm, which keep the object from
    slipping sideways; 0: none."""
    lip_clearance_m: Extent = 0.01
    """Dynamic world: room between each lip and the object; lips too close jam on curved paths."""
    pivot_offset_m: Shift = 0.0
    """Distance of the palm's surface above its pivot, along the palm's normal."""
    friction: Friction = 0.3
    """Coulomb coefficient between palm and object."""
    slip_deg: SlipAngle | None = None
    """Measured instead: the palm angle at which the object begins to slide. Takes the place of
    `friction`, which is its tangent."""
    shallow_deg: Angle = 5.0
    """Angle of the palm while it is tilted up; an angle > 0 rises outward."""
    steep_deg: Angle = 15.0
    """Angle of the palm normally."""
    rate_deg_s: Turning = 50.0
    """How fast the palm turns."""


class PalmOverride(Section):
    """[palm.left], [palm.right] What is different about one palm."""

    length_m: Size | None = None
    width_m: Size | None = None
    lip_height_m: Extent | None = None
    lip_clearance_m: Extent | None = None
    pivot_offset_m: Shift | None = None
    friction: Friction | None = None
    slip_deg: SlipAngle | None = None
    shallow_deg: Angle | None = None
    steep_deg: Angle | None = None
    rate_deg_s: Turning | None = None


class Palm(PalmParameters):
    """[palm] Both palms."""

    left: PalmOverride = PalmOverride()
    right: PalmOverride = PalmOverride()

    def of(self, side: Side) -> PalmParameters:
        """The palm of one side, with what overrides it applied."""
        override = self.left if side == "left" else self.right
        values = _merged(self, override)
        if override.friction is not None and override.slip_deg is None:
            values["slip_deg"] = None  # this palm's own coefficient, not both palms' slip angle
        if values["slip_deg"] is not None:
            values["friction"] = _core.tangent(values["slip_deg"] * (math.pi / 180))
        return PalmParameters(**values)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for side in SIDES:
            override = self.left if side == "left" else self.right
            palm = self.of(side)
            if palm.steep_deg <= palm.shallow_deg:
                raise fault(
                    palm.steep_deg,
                    f"is not more than shallow_deg, which is {palm.shallow_deg:g}",
                    f"a number in degrees, more than {palm.shallow_deg:g} and less than 80",
                    _key(override, side, "steep_deg"),
                )
            steepest = max(abs(palm.steep_deg), abs(palm.shallow_deg))
            most = friction_limit(steepest)
            if palm.friction >= most:
                raise fault(
                    palm.friction,
                    f"is too large for a palm at {steepest:g} degrees",
                    f"less than {most:g} (friction angle + palm angle below 90 degrees)",
                    _key(override, side, "friction"),
                )
        return self


class RobotParameters(Section):
    """One robot: how it drives."""

    speed_m_s: Speed = 0.06
    """Nominal speed, in the direction of travel."""
    correction_m_s: Speed = 0.03
    """How much faster or slower it drives to correct a contact."""
    acceleration_m_s2: Acceleration = 0.5
    """Limit of its acceleration."""
    max_speed_m_s: Speed = 0.2
    """Limit of its commanded speed, either way."""
    noise_m_s: Noise = 0.01
    """Standard deviation of its speed error (Ornstein-Uhlenbeck)."""
    noise_tau_s: Memory = 0.5
    """Correlation time of that error."""
    bias_m_s: SpeedError = 0.0
    """Constant speed error (calibration); > 0 is faster in the direction of travel."""
    clock_ppm: ClockError = 0.0
    """By how much its clock runs fast. Only the resilient algorithm counts time."""


class RobotOverride(Section):
    """[robot.left], [robot.right] What is different about one robot."""

    speed_m_s: Speed | None = None
    correction_m_s: Speed | None = None
    acceleration_m_s2: Acceleration | None = None
    max_speed_m_s: Speed | None = None
    noise_m_s: Noise | None = None
    noise_tau_s: Memory | None = None
    bias_m_s: SpeedError | None = None
    clock_ppm: ClockError | None = None


class Robot(RobotParameters):
    """[robot] Both robots."""

    left: RobotOverride = RobotOverride()
    right: RobotOverride = RobotOverride()

    def of(self, side: Side) -> RobotParameters:
        """The robot of one side, with what overrides it applied."""
        return RobotParameters(**_merged(self, self.left if side == "left" else self.right))

    @model_validator(mode="after")
    def _check(self) -> Self:
        for side in SIDES:
            override = self.left if side == "left" else self.right
            robot = self.of(side)
            if robot.speed_m_s > robot.max_speed_m_s:
                raise fault(
                    robot.speed_m_s,
                    "is more than max_speed_m_s",
                    f"a number in m/s, from 0 to {robot.max_speed_m_s:g}",
                    _key(override, side, "speed_m_s"),
                )
        return self


class Zone(Section):
    """A switch of the tactile sensor: the contact coordinates at which it reads its sign."""

    sign: Literal["-", "0", "+"]
    from_m: Place
    to_m: Place
    """Both ends belong to the zone."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.to_m <= self.from_m:
            raise fault(
                self.to_m,
                f"is not more than from_m, which is {self.from_m:g}",
                f"a number in m, more than {self.from_m:g} and at most 10",
                "to_m",
            )
        return self


Zones = Annotated[
    tuple[Zone, ...],
    BeforeValidator(from_list('a list of at most 16 tables {sign = "-", from_m, to_m}', 0, 16)),
]


class Tactile(Section):
    """[tactile] The palms' sensors; they tell the sign of the contact coordinate."""

    zero_half_width_m: Extent = 0.005
    """Half width of the zone that reads 0, about the pivot; beyond it the sensor reads - and +."""
    zones: Zones | None = None
    """Another layout instead of that one. Zones may overlap with zones of sign 0, which win; a
    contact in no zone reads 0 (no switch is pressed). Where zones of sign - and + share an end,
    the later one in the list counts there."""
    false_rate: Fraction = 0.0
    """Probability that one reading is false."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        zones = list(enumerate(self.zones or ()))
        for _, minus in zones:
            for k, plus in zones:
                apart = minus.to_m <= plus.from_m or plus.to_m <= minus.from_m
                if (minus.sign, plus.sign) == ("-", "+") and not apart:
                    raise fault(
                        plus.model_dump(),
                        f"overlaps the zone - from {minus.from_m:g} to {minus.to_m:g}",
                        "zones + and - that do not overlap each other",
                        f"zones[{k}]",
                    )
        return self


class Control(Section):
    """[control] The controllers' clock."""

    period_s: Period = 0.01
    """Time between two steps."""
    watchdog_s: Patience = 0.1
    """A robot whose controller has not stepped for so long is brought to rest and restarted."""


class Bump(Section):
    """A sudden shift of one contact, at a place or at a time."""

    robot: Side
    """Whose contact."""
    shift_m: Shift
    """By how much, outward."""
    at_m: Travel | None = None
    """When the pair has come so far."""
    at_s: Moment | None = None
    """At this time."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if (self.at_m is None) == (self.at_s is None):
            problem = "does not say when" if self.at_m is None else "says twice when"
            raise fault(self.model_dump(), problem, "exactly one of at_m and at_s")
        return self


Script = Annotated[
    tuple[Bump, ...],
    BeforeValidator(from_list("a list of at most 64 tables {robot, at_m or at_s, shift_m}", 0, 64)),
]


class Bumps(Section):
    """[bumps] Bumps of the floor."""

    script: Script = ()
    """Bumps that happen in every carry."""
    rate_per_m: Density = 0.0
    """Mean number of random bumps for each metre and robot."""
    max_shift_m: Jolt = 0.004
    """Size of random bumps: uniform, up to this much either way."""


class Start(Section):
    """[start] The contact coordinates at the start."""

    left_m: Place = 0.0
    right_m: Place = 0.0


class Task(Section):
    """[task] What is to be done."""

    distance_m: Distance = 1.5
    """How far the midpoint of the pivots shall come."""
    slope_deg: Angle = 0.0
    """Slope of the floor; > 0 is uphill in the direction of travel."""
    timeout_s: Patience | None = None
    """When to give up; not set: twice the time that the slower robot needs at nominal speed, or
    more where speeding up takes long."""
    direction: Direction = "forward"
    """forward: the right robot leads; backward: the left one does."""
    inertia: Switch = True
    """Whether the accelerations of the pair take part in deciding which contact lets go first;
    false: they are neglected, as the paper assumes."""
    inertia_lag_s: Lag = 0.05
    """Time over which accelerations are averaged (first order) before they count, since wheels,
    palms and contacts give way; 0: those of each control period count as they are."""
    path: Path = Path()


def _merged(base: Section, override: Section) -> dict[str, Any]:
    """The base's values of the keys that `override` has, replaced where it sets them."""
    names = type(override).model_fields
    own = {name: getattr(override, name) for name in names}
    return {name: getattr(base, name) if own[name] is None else own[name] for name in names}


def _key(override: Section, side: str, name: str) -> str:
    """Where a side's value of `name` was given, relative to the section."""
    return name if getattr(override, name) is None else f"{side}.{name}"
