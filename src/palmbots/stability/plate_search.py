# SPDX-License-Identifier: Apache-2.0
"""Search for the plate of the palms and the angles whose tightest margin is largest.

The search goes over what can be made: the thickness of the nose, the length of the bevel, the
height of the heel, and both palm angles. A margin is relative to what the scene uses up of it
(`tightest_margins`). The job must begin, all properties must hold anywhere on the palms, and each
nose must certainly get under its edge. Source: docs/theory/lifting.md.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from palmbots._types import SIDES, Interval
from palmbots._util.arguments import ordered_pair
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.stability.analysis import Analysis, analyze
from palmbots.stability.angle_grid import GridLimits

if TYPE_CHECKING:
    import xarray as xr

KEYS = ("palm.nose_m", "palm.bevel_m", "palm.heel_m", "palm.shallow_deg", "palm.steep_deg")
"""What is designed."""

_RANGES_M = {
    "nose_range_m": (0.0002, 0.001),
    "bevel_range_m": (0.0, 0.02),
    "heel_range_m": (0.0, 0.02),
}
_STEPS_M = (0.0001, 0.001, 0.001)
_SHARPNESS = 8  # of the smooth minimum: the tightest margin decides, the others where it is equal
_BETTER = 1e-3  # share of the cost that must be saved: the plate does not change for less
_STRIDES = (4, 2, 1)
_EVALUATIONS = 500  # about; for the progress
_FIRST_DEG = tuple(itertools.product((2.0, 5.0, 8.0, 12.0), (5.0, 10.0, 15.0, 20.0)))

Place = tuple[int, int, int, int, int]
"""The values of `KEYS`, as multiples of their steps."""


@dataclass(frozen=True)
class PlateLimits:
    """The grid of plates and angles.

    Raises:
        PalmbotsError: a range is none.
    """

    ranges: tuple[Interval, ...]
    """Of `KEYS`, in their units."""
    steps: tuple[float, ...]
    angles: GridLimits

    @classmethod
    def of(cls, given: Mapping[str, object], angles: GridLimits) -> PlateLimits:
        """The limits of a design; `given` may have those of the plate."""
        lengths = [
            ordered_pair(name, given.get(name, usual), 0, 0.1) for name, usual in _RANGES_M.items()
        ]
        low, high = angles.range_deg
        turned = (max(low, 0.0), high)  # below 0 the outer end of a palm is its lowest point
        steps = (*_STEPS_M, angles.resolution_deg, angles.resolution_deg)
        return cls((*lengths, turned, turned), steps, angles)

    def values(self, place: Place) -> dict[str, float]:
        """The keys and their values, rounded to a picometre."""
        return {
            key: round(n * step, 12) for key, n, step in zip(KEYS, place, self.steps, strict=True)
        }

    def nearest(self, values: Mapping[str, float]) -> Place:
        """The place of the grid nearest to these values."""
        found = []
        for key, (low, high), step in zip(KEYS, self.ranges, self.steps, strict=True):
            least, most = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
            found.append(min(max(round(values[key] / step), least), most))
        return found[0], found[1], found[2], found[3], found[4]

    def contains(self, place: Place) -> bool:
        """Whether a place is within all ranges, and its angles differ enough."""
        values = list(self.values(place).values())
        inside = all(
            low - 1e-9 <= value <= high + 1e-9
            for value, (low, high) in zip(values, self.ranges, strict=True)
        )
        return inside and values[4] - values[3] >= self.angles.min_difference_deg - 1e-9


def is_on_floor(scene: Scene) -> bool:
    """Whether the job of a scene begins or ends on the floor."""
    return "floor" in scene.task.ends


def own_values_of(scene: Scene) -> dict[str, float]:
    """The values of `KEYS` of the left palm."""
    palm = scene.palm_of(SIDES[0])
    nose = palm.thickness_m if palm.nose_m is None else palm.nose_m
    sizes = (nose, palm.bevel_m, palm.heel_m, palm.shallow_deg, palm.steep_deg)
    return dict(zip(KEYS, sizes, strict=True))


class PlateSearch:
    """A pattern search on the grid of plates and angles.

    It starts from the scene's own plate, and from the best of several pairs of angles. It goes only
    to plates with which a few simulated jobs succeed: closed forms of single states do not show
    that the controllers centre the contacts.
    """

    def __init__(
        self,
        scene: Scene,
        limits: PlateLimits,
        succeeds: Callable[[Scene], bool],
        report: Callable[[float], None],
    ) -> None:
        self._scene, self._limits, self._report = scene, limits, report
        self._succeeds, self._trials = succeeds, dict[Place, bool]()
        self._found: dict[tuple[float, ...], tuple[Analysis | None, str]] = {}

    def analyses(self, values: Mapping[str, float]) -> tuple[Analysis | None, str]:
        """The analysis with these values, and why they do not qualify; None: no valid scene."""
        place = tuple(values.values())
        if place not in self._found:
            self._found[place] = self._analysed(values)
            self._report(min(1.0, len(self._found) / _EVALUATIONS))
        return self._found[place]

    def _analysed(self, values: Mapping[str, float]) -> tuple[Analysis | None, str]:
        try:
            found = analyze(load_scene(self._scene, on_every_side(self._scene, values)))
        except PalmbotsError as error:
            return None, str(error)
        return found, _refusal(found, self._limits.angles.min_clearance_deg)

    def cost(self, values: Mapping[str, float]) -> float:
        """A smooth maximum of what is used up of each margin; infinite: they do not qualify."""
        found, refusal = self.analyses(values)
        if found is None or refusal:
            return math.inf
        shares = [1 / one.times for one in found.ranking if one.times is not None]
        return math.fsum(share**_SHARPNESS for share in shares)

    def improves(self, values: Mapping[str, float], own: Mapping[str, float]) -> bool:
        """Whether a plate is worth the change."""
        return self.cost(values) < self.cost(own) * (1 - _BETTER)

    def best(self, own: Mapping[str, float]) -> Place:
        """The place with the least cost."""
        highest = {key: ends[1] for key, ends in zip(KEYS, self._limits.ranges, strict=True)}
        plates = (own, highest | {KEYS[0]: self._limits.ranges[0][0]})
        turned = [
            self._limits.nearest({**plate, KEYS[3]: shallow, KEYS[4]: shallow + more})
            for plate in plates
            for shallow, more in _FIRST_DEG
        ]
        inside = [place for place in turned if self._limits.contains(place)]
        starts = [self._limits.nearest(own), *self._least(inside)]
        found = self._least([self._descend(start) for start in starts]) or starts
        return self._trimmed(found[0])

    def dataset(self) -> xr.Dataset:
        """The tightest margin of every plate that was tried."""
        import xarray as xr  # here: its import takes longer than a carry

        rows = [(*place, _least_margin(*found)) for place, found in self._found.items()]
        names = [key.removeprefix("palm.") for key in KEYS]
        columns = zip((*names, "least_margin"), zip(*rows, strict=True), strict=True)
        return xr.Dataset({name: ("plate", list(column)) for name, column in columns})

    def _cost_at(self, place: Place) -> float:
        return self.cost(self._limits.values(place))

    def _descend(self, place: Place) -> Place:
        for stride in _STRIDES:
            while True:
                most = self._cost_at(place) * (1 - _BETTER)
                around = [p for p in _around(place, stride) if self._limits.contains(p)]
                better = self._least([p for p in around if self._cost_at(p) < most])
                if not better:
                    break
                place = better[0]
        return place

    def _least(self, places: list[Place]) -> list[Place]:
        """The place with the least cost of those where jobs succeed; empty: there is none."""
        for place in sorted(places, key=self._cost_at):
            if math.isinf(self._cost_at(place)):
                break
            if place not in self._trials:
                values = on_every_side(self._scene, self._limits.values(place))
                self._trials[place] = self._succeeds(load_scene(self._scene, values))
            if self._trials[place]:
                return [place]
        return []

    def _trimmed(self, place: Place) -> Place:
        """The same with the shortest bevel that costs no margin."""
        most = self._cost_at(place) * (1 + 1e-9)
        for shorter in range(place[1]):
            tried = (place[0], shorter, *place[2:])
            if self._limits.contains(tried) and self._cost_at(tried) <= most:
                return tried
        return place


def _least_margin(found: Analysis | None, refusal: str) -> float:
    """The tightest margin; NaN: the plate does not qualify."""
    if found is None or refusal:
        return math.nan
    return min((one.times for one in found.ranking if one.times is not None), default=math.inf)


def _around(place: Place, stride: int) -> Iterator[Place]:
    for moves in (*((k,) for k in range(len(KEYS))), (3, 4)):
        for sense in (-stride, stride):
            moved = [n + sense * (k in moves) for k, n in enumerate(place)]
            yield moved[0], moved[1], moved[2], moved[3], moved[4]


def _refusal(found: Analysis, min_clearance_deg: float) -> str:
    """Why a plate does not qualify; empty: it does."""
    lifting = found.lifting
    if lifting is None:
        return "the job neither begins nor ends on the floor"
    if lifting.refusals:
        return lifting.refusals[0]
    if not found.holds:
        return "a property fails for contacts somewhere on the palms"
    if found.clearance_deg < min_clearance_deg:
        return f"the clearance is {found.clearance_deg:.2f}°"
    if lifting.picks_up and not all(palm.gets_under for palm in lifting.palms.values()):
        return "a nose gets under only if the object does not roll over the partner's heel"
    if any(one.times is not None and one.times <= 0 for one in found.ranking):
        return "a margin is used up"
    return ""
