# SPDX-License-Identifier: Apache-2.0
"""The section `palm` of a scene: both palms, and what differs on one side."""

import math
from typing import Annotated, Any, Self

from pydantic import (
    BeforeValidator,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util.arguments import show
from palmbots.scene.fields import Angle, Extent, Friction, Range, Shift, Size, field_error
from palmbots.scene.section import Section, key_of_side, values_of_side

SlipAngle = Annotated[float, BeforeValidator(Range("degrees", least=0.1, most=89))]
Turning = Annotated[float, BeforeValidator(Range("degrees/s", least=0.1, most=100_000))]


def friction_limit(*palms_deg: float) -> float:
    """Upper limit of the friction coefficient on palms at these angles.

    At the limit the friction angle and the palm angle add up to 90°: an edge of the friction cone
    is level, and the contact holds against any horizontal force.
    """
    steepest = math.radians(max(map(abs, palms_deg)))
    return 1 / math.tan(steepest) if steepest > 0 else math.inf


class PalmParameters(Section):
    """One palm: a flat plate that rotates about a pivot below its middle."""

    length_m: Size = 0.15
    """Length along the direction of travel. Contacts lie within ± half of it."""
    width_m: Size = 0.07
    """Width across the direction of travel. A palm with lips is as wide as the object plus twice
    `lip_clearance_m` instead."""
    lip_height_m: Extent = 0.0
    """MuJoCo world: height of the lips along both sides of the palm, which keep the object from
    slipping sideways. 0: no lips."""
    lip_clearance_m: Extent = 0.01
    """MuJoCo world: clearance between each lip and the object. If it is too small, the object jams
    on curved paths."""
    pivot_offset_m: Shift = 0.0
    """Distance from the pivot to the palm's surface, along the palm's normal."""
    friction: Friction = 0.3
    """Coulomb coefficient between palm and object."""
    friction_angle_deg: SlipAngle | None = None
    """In place of `friction`: the measured palm angle at which the object begins to slide. Its
    tangent is the coefficient."""
    shallow_deg: Angle = 5.0
    """Palm angle while the palm is tilted up. An angle > 0 rises outward."""
    steep_deg: Angle = 15.0
    """Palm angle at all other times."""
    rate_deg_s: Turning = 50.0
    """Angular speed of the palm."""


def _check_friction_is_given_once(data: Any) -> Any:
    """Refuse a table that gives both a friction coefficient and a friction angle."""
    if isinstance(data, dict) and None not in (
        data.get("friction"),
        data.get("friction_angle_deg"),
    ):
        raise field_error(
            data["friction_angle_deg"],
            f"is given beside friction, which is {show(data['friction'])}",
            "one of the two",
            "friction_angle_deg",
        )
    return data


class PalmOverride(Section):
    """[palm.left], [palm.right] Overrides for one palm."""

    length_m: Size | None = None
    width_m: Size | None = None
    lip_height_m: Extent | None = None
    lip_clearance_m: Extent | None = None
    pivot_offset_m: Shift | None = None
    friction: Friction | None = None
    friction_angle_deg: SlipAngle | None = None
    shallow_deg: Angle | None = None
    steep_deg: Angle | None = None
    rate_deg_s: Turning | None = None

    _friction_is_given_once = model_validator(mode="before")(_check_friction_is_given_once)


class Palm(PalmParameters):
    """[palm] Both palms."""

    left: PalmOverride = PalmOverride()
    right: PalmOverride = PalmOverride()

    _friction_is_given_once = model_validator(mode="before")(_check_friction_is_given_once)

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As in `Section`; without the coefficient where the angle takes its place."""
        table = self.set_values(dump)
        if "friction_angle_deg" in table:
            del table["friction"]
        return table

    def of(self, side: Side) -> PalmParameters:
        """The palm of one side, with its overrides applied."""
        override = self.left if side == "left" else self.right
        values = values_of_side(self, override)
        if override.friction is not None and override.friction_angle_deg is None:
            values["friction_angle_deg"] = (
                None  # this palm's own coefficient replaces the angle of both palms
            )
        if values["friction_angle_deg"] is not None:
            values["friction"] = _core.tangent(values["friction_angle_deg"] * (math.pi / 180))
        return PalmParameters(**values)

    @model_validator(mode="after")
    def _check(self) -> Self:
        for side in SIDES:
            override = self.left if side == "left" else self.right
            palm = self.of(side)
            if palm.steep_deg <= palm.shallow_deg:
                raise field_error(
                    palm.steep_deg,
                    f"is not more than shallow_deg, which is {palm.shallow_deg:g}",
                    f"a number in degrees, more than {palm.shallow_deg:g} and less than 80",
                    key_of_side(override, side, "steep_deg"),
                )
            steepest = max(abs(palm.steep_deg), abs(palm.shallow_deg))
            most = friction_limit(steepest)
            if palm.friction >= most:
                raise field_error(
                    palm.friction,
                    f"is too large for a palm at {steepest:g} degrees",
                    f"less than {most:g} (friction angle + palm angle below 90 degrees)",
                    key_of_side(override, side, "friction"),
                )
        return self
