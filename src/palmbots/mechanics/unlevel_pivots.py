# SPDX-License-Identifier: Apache-2.0
"""Do properties 0, 1 and 2 hold while the pivots are at different heights?

Near the floor they are, because each palm keeps its inner end on the floor: a palm at the angle θ
has its pivot ℓ sin θ above the nose's lower edge. In the air two arms differ by their errors, and
while they move.

Palms exert the same forces wherever their pivots are. At given palm angles the properties depend on
the contacts only through their height difference, to which that of the pivots is added. So the two
extreme height differences decide, as with level pivots (`stability/operating_envelope.hpp`). A palm
that turns is evaluated at nine angles, as there. With `clear` a property also demands that the
object touches the palms, as if they were infinitely long, nowhere else.
Source: docs/theory/lifting.md.
"""

from collections.abc import Callable, Collection, Iterator

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.scene.spec import contact_radii

Pair = tuple[float, float]

PROPERTIES = (0, 1, 2)
_TURNS = 8
_HALVINGS = 20


class PivotRises:
    """The properties of a scene's palms for a rise of the right pivot over the left one.

    `share`: of the usable palm, on whose inner part the contacts are.
    """

    def __init__(self, spec: _core.Spec, share: float = 1.0) -> None:
        self._spec = spec
        left, right = (0.5 * share * palm.usable for palm in spec.palms)
        self._contacts = (-left, left), (-right, right)
        friction = [(palm.friction, palm.friction) for palm in spec.palms]
        com_y, slope = (spec.com_height, spec.com_height), (spec.slope, spec.slope)
        self._envelope = _core.OperatingEnvelope(
            spec, com_y, friction, False, slope, self._contacts, 0.0
        )
        self._poses = list(_poses(spec, self._contacts))

    def on_floor(self, more_m: float = 0.0, clear: bool = True) -> frozenset[int]:
        """The properties that hold with both inner ends on the floor, and the right pivot higher by
        a further length. `clear`: they demand clearance."""
        return self._holding((more_m, more_m), self._of_floor, clear)

    def in_air(self, rise_m: float = 0.0, clear: bool = True) -> frozenset[int]:
        """The properties that hold with the right pivot this much higher."""
        return self._holding((rise_m, rise_m), _level, clear)

    def permitted_m(
        self,
        on_floor: bool = False,
        clear: bool = True,
        properties: Collection[int] = PROPERTIES,
    ) -> float:
        """The largest further height difference with which these properties hold, as with all
        smaller ones of either sign; 0: they do not hold without one."""
        base = self._of_floor if on_floor else _level

        def holds(size: float) -> bool:
            return self._holding((-size, size), base, clear).issuperset(properties)

        if not holds(0.0):
            return 0.0
        low, high = 0.0, 0.5 * self._spec.width
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if holds(middle) else (low, middle)
        return low

    def _of_floor(self, angles: Pair) -> float:
        left, right = (
            palm.lowest_pivot(angle) for palm, angle in zip(self._spec.palms, angles, strict=True)
        )
        return right - left

    def _holding(self, more: Pair, base: Callable[[Pair], float], clear: bool) -> frozenset[int]:
        """The properties that hold for all further rises from `more[0]` to `more[1]`."""
        holding = set(PROPERTIES)
        for number, shallow, angles, rise in self._poses:
            of_pivots = base(angles)
            low, high = (z + of_pivots + further for z, further in zip(rise, more, strict=True))
            least, most, clearance = self._envelope.pose(number, shallow, angles, (low, high))
            if not least <= self._spec.com_left <= most or (clear and clearance < 0):
                holding.discard(number)
        return frozenset(holding)


def _level(_: Pair) -> float:
    return 0.0


def _poses(spec: _core.Spec, contacts: tuple[Pair, Pair]) -> Iterator[tuple[int, int, Pair, Pair]]:
    """A property, the shallow palm, the angles, and the extreme height differences of the contacts
    with level pivots."""
    left, right = spec.palms
    radii = contact_radii(spec)
    offsets = left.offset + radii[0], right.offset + radii[1]

    def rise(number: int, shallow: int, angles: Pair) -> Pair:
        return _core.rise_over(number, shallow, contacts, 0.0, angles, offsets)

    for alike in ((left.shallow, right.shallow), (left.steep, right.steep)):
        yield 0, 0, alike, rise(0, 0, alike)
    for k in range(len(SIDES)):
        own = spec.palms[k]
        for step in range(_TURNS):
            angle = own.shallow + (own.steep - own.shallow) * step / _TURNS
            angles = (angle, right.steep) if k == 0 else (left.steep, angle)
            # Palms turn where property 1 or 2 applies, before it or after it.
            for number in (1, 2):
                region = rise(number, k, angles)
                yield 0, k, angles, region
                if step == 0:
                    yield number, k, angles, region
