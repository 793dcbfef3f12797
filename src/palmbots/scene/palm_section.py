# SPDX-License-Identifier: Apache-2.0
"""The section `palm` of a scene: both palms, and what differs on one side."""

from typing import Any

from pydantic import SerializerFunctionWrapHandler, model_serializer

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.scene.core_keys import key
from palmbots.scene.fields import Extent, Size
from palmbots.scene.robot_dimensions import PALM_THICKNESS
from palmbots.scene.section import Section, as_given, override_of, values_of_side


class PalmParameters(Section):
    """One palm: a flat plate that rotates about a pivot below its middle."""

    length_m: float = key("palm.length_m")
    """Length along the direction of travel."""
    usable_m: float | None = key("palm.usable_m")
    """Length of the part in the middle on which a contact may be. Beyond it a contact counts as
    off the palm. Not set: the whole length; on a palm with a heel, the part on which the heel
    cannot touch the object. A contact may then also be farther outward, up to the heel."""
    width_m: Size = 0.07
    """Width across the direction of travel. A palm with lips is as wide as the object plus twice
    `lip_clearance_m` instead."""
    lip_height_m: Extent = 0.0
    """MuJoCo world: height of the lips along both sides of the palm, which keep the object from
    slipping sideways. 0: no lips."""
    lip_clearance_m: Extent = 0.01
    """MuJoCo world: clearance between each lip and the object. If it is too small, the object jams
    on curved paths."""
    pivot_offset_m: float = key("palm.pivot_offset_m")
    """Distance from the pivot to the palm's surface, along the palm's normal."""
    thickness_m: float = key("palm.thickness_m")
    """Thickness of the plate. 0: infinitely thin in the quasistatic world, but 6 mm in pictures
    and in the MuJoCo world."""
    nose_m: float | None = key("palm.nose_m")
    """Thickness at the inner end, where a bevel on the lower side can make the plate thinner. Not
    set: `thickness_m`."""
    bevel_m: float = key("palm.bevel_m")
    """Length of the bevel, measured from the inner end."""
    heel_m: float = key("palm.heel_m")
    """Height of a stop at the outer end, above the surface of the palm. 0: none."""
    friction: float = key("palm.friction")
    """Coulomb coefficient between palm and object."""
    friction_angle_deg: float | None = key("palm.friction_angle_deg")
    """In place of `friction`: the measured palm angle at which the object begins to slide. Its
    tangent is the coefficient."""
    shallow_deg: float = key("palm.shallow_deg")
    """Palm angle while the palm is tilted up. An angle > 0 rises outward."""
    steep_deg: float = key("palm.steep_deg")
    """Palm angle at all other times."""
    rate_deg_s: float = key("palm.rate_deg_s")
    """Angular speed of the palm."""

    @property
    def plate_m(self) -> float:
        """Thickness of the plate where it is drawn and has mass."""
        return self.thickness_m or PALM_THICKNESS

    @property
    def reach_m(self) -> float:
        """How far from the foot of the pivot a contact may be: half of the usable length."""
        return 0.5 * (self.length_m if self.usable_m is None else self.usable_m)


@override_of(PalmParameters)
class PalmOverride(Section):
    """What differs on one side."""


class Palm(PalmParameters):
    """[palm] Both palms; [palm.left] and [palm.right] override keys for one."""

    left: PalmOverride = PalmOverride()
    right: PalmOverride = PalmOverride()

    @model_serializer(mode="wrap")
    def _without_unset(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """As in `Section`; without the coefficient where the angle takes its place."""
        table = self.set_values(dump)
        if "friction_angle_deg" in table:
            del table["friction"]
        return table

    def of(self, side: Side) -> PalmParameters:
        """The palm of one side, with its overrides applied and an angle as its coefficient."""
        override: Any = self.left if side == "left" else self.right
        values = values_of_side(self, override)
        if values["friction_angle_deg"] is not None:
            palm = _core.spec_of_scene({"palm": as_given(self)}).palms[SIDES.index(side)]
            values |= {"friction": palm.friction, "friction_angle_deg": None}
        return PalmParameters(**values)
