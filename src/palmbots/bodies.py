"""The section of a scene that only the dynamic world knows: masses, wheels, floor and pressure.

The paper gives the size of the robots ("approximately the size of a 20 cm cube"); all numbers here
are assumed. As in `sections`: every key with its meaning, unit, limits and default.
"""

from typing import Annotated, Self

from pydantic import BeforeValidator, model_validator

from palmbots.quantities import Range, fault, from_list
from palmbots.section import Section
from palmbots.sections import Friction, Mass, Place, Size

__all__ = ["Dynamic", "Ridge"]

Force = Annotated[float, BeforeValidator(Range("N", least=0, most=1000))]
Debounce = Annotated[float, BeforeValidator(Range("s", least=0, most=1))]
Height = Annotated[float, BeforeValidator(Range("m", least=0.0001, most=0.05))]
Step = Annotated[float, BeforeValidator(Range("s", least=0.0001, most=0.005))]
Axle = Annotated[float, BeforeValidator(Range("m", least=0, most=0.25))]
Mismatch = Annotated[float, BeforeValidator(Range(least=-0.2, most=0.2))]


class Ridge(Section):
    """A rounded ridge across the floor, under all wheels one after the other."""

    at_m: Place
    """Where, from the midpoint of the pivots at the start, in the direction of travel."""
    height_m: Height
    length_m: Size = 0.05
    """Along the direction of travel."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.length_m < 2 * self.height_m:
            raise fault(
                self.length_m,
                f"is less than twice height_m, which is {self.height_m:g}",
                f"a number in m, from {2 * self.height_m:g} to 10 (a flat arc)",
                "length_m",
            )
        return self


Ridges = Annotated[
    tuple[Ridge, ...],
    BeforeValidator(from_list("a list of at most 32 tables {at_m, height_m, length_m}", 0, 32)),
]


class Dynamic(Section):
    """[dynamic] What only the dynamic world knows."""

    body_kg: Mass = 3.0
    """Dynamic world: mass of a robot without arm and palm."""
    arm_kg: Mass = 0.2
    """Dynamic world: mass of an arm."""
    palm_kg: Mass = 0.1
    """Dynamic world: mass of a palm."""
    wheel_radius_m: Size = 0.04
    """Dynamic world: radius of the two driven wheels."""
    wheel_mismatch: Mismatch = 0.0
    """Dynamic world: share by which a robot's left wheel is larger than its right one; what holds
    its heading has to make up for it."""
    axle_m: Axle | None = None
    """Dynamic world: how far outward of the palm's pivot the wheels stand; not set: 0.2, and on a
    curved path 0, below the palm, since a robot's axle is what keeps to the path."""
    floor_friction: Friction = 0.8
    """Dynamic world: Coulomb coefficient between wheels and floor."""
    ridges: Ridges = ()
    """Dynamic world: bumps of the floor as geometry, tables {at_m, height_m, length_m}."""
    press_n: Force = 0.1
    """Dynamic world: the least force that closes a switch of the tactile sensor."""
    debounce_s: Debounce = 0.05
    """Dynamic world: a switch stays closed until nothing has pressed for so long."""
    step_s: Step = 0.002
    """Dynamic world: step of the integration; shortened so that control periods are whole steps."""
