# SPDX-License-Identifier: Apache-2.0
"""What two robots can hold: which object is too heavy for their balance, servos and wheels.

The core computes the limits, the refusal and the warning, for the page, too
(`sim/load_states.hpp` has the mechanics).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES, BySide, Overrides, Side
from palmbots._util.command import command
from palmbots._util.named_registry import Registry
from palmbots._util.plain_values import derived
from palmbots._util.report import Item
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.section import as_given

LINES: Registry[Callable[..., Iterator[Item]]] = Registry("lines")
"""The report lines of results that a higher room judges, too."""
_HALVINGS = 20
_NEAR = 5e-4  # [m] from the pivot; two contacts are never both as close as this
MEANINGS: dict[str, tuple[str, str]] = {
    kind: (happens, key) for kind, happens, key in _core.load_meanings
}
"""What happens beyond each limit, and the key that moves it."""
DECISIVE = ("tipping", "servo")  # no carry can begin; wheels that slip only end a squeeze


@dataclass(frozen=True)
class LoadLimit:
    """One limit, and the state in which it binds."""

    kind: str
    """``tipping``, ``servo``, ``traction`` or ``drive``."""
    heaviest_kg: float
    """The heaviest object that this limit allows in every state of the region."""
    at_start_kg: float | None
    """The same at rest, with the contacts where the carry starts; None: any."""
    side: Side
    """The robot at which it binds."""
    p_m: BySide[float]
    theta_deg: BySide[float]
    key: str
    """The scene key that moves it."""

    @derived
    def meaning(self) -> str:
        """What happens beyond it."""
        return MEANINGS[self.kind][0]


@dataclass(frozen=True, repr=False)
class LoadLimits(Result):
    """The heaviest object that two robots can hold."""

    scene: Scene
    mass_kg: float
    """Of the scene's object."""
    limits: tuple[LoadLimit, ...]
    """Those that bind for some mass, the tightest first."""

    @derived
    def heaviest_kg(self) -> float | None:
        """The heaviest object that the robots hold with contacts anywhere in the region, whatever
        the squeeze; None: any."""
        return self.limits[0].heaviest_kg if self.limits else None

    @derived
    def at_start_kg(self) -> float | None:
        """The heaviest object that does not tip a robot, or make a palm sag, with the contacts
        where the carry starts; None: any. A carry beyond it is refused."""
        masses = [one.at_start_kg for one in self.limits if one.kind in DECISIVE]
        return min((mass for mass in masses if mass is not None), default=None)

    @derived
    def holds(self) -> bool:
        """Whether the robots hold the scene's object in the whole region."""
        return self.heaviest_kg is None or self.mass_kg <= self.heaviest_kg

    def lines(self) -> Iterator[Item]:
        """The verdict on palms and robots, and every limit."""
        return LINES.get("load")(self)

    @property
    def reach_m(self) -> float:
        """How far a contact may be from its pivot: half of the usable length of the longer palm."""
        return max(self.scene.palm_of(side).reach_m for side in SIDES)

    @derived
    def held_within_m(self) -> float:
        """With contacts up to this distance from the pivots, the scene's object tips no robot and
        makes no palm sag, whatever the squeeze; at most half of the usable palm, 0: nowhere."""
        low, high = 0.0, self.reach_m
        if self.mass_kg <= self.heaviest_within(high):
            return high
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            is_held = self.mass_kg <= self.heaviest_within(middle)
            low, high = (middle, high) if is_held else (low, middle)
        return low

    def heaviest_within(self, reach_m: float) -> float:
        """The heaviest object that tips no robot and makes no palm sag with contacts up to this
        distance from the pivots, whatever the squeeze [kg]; infinite: any."""
        loads = _heaviest(self.scene, reach_m)
        return min(loads[kind].mass_kg for kind in DECISIVE)

    def limits_within(self, reach_m: float) -> list[tuple[float, str]]:
        """Each mass beyond which something happens with contacts up to this distance from the
        pivots [kg], the least first, and what: a key of `MEANINGS`."""
        loads = _heaviest(self.scene, reach_m)
        found = ((one.mass_kg, kind) for kind, one in loads.items())
        return sorted(one for one in found if math.isfinite(one[0]))

    def within_sentence(self, reach_m: float) -> str:
        """What happens beyond which mass with contacts up to this distance from the pivots."""
        limits = self.limits_within(reach_m)
        if not limits:
            return "no mass is too large"
        beyond = ", ".join(
            f"{MEANINGS[kind][0]} above {mass_text(mass)} kg" for mass, kind in limits
        )
        text = f"{beyond} if the squeeze is as hard as friction permits"
        least = limits[0][0]
        if self.mass_kg > least:
            text += f" (the object has {self.mass_kg / least:.2g} times the least of these)"
        return text

    def refusal(self) -> str | None:
        """Why no carry of the object can begin; None: it can."""
        return refusal_of(self.scene)

    def warning(self) -> str | None:
        """The limit that the object exceeds somewhere in the region; None: none."""
        return _core.load_warning(as_given(self.scene), self.scene.task.path.is_curved) or None

    def sentence(self) -> str:
        """The heaviest object in one line."""
        if not self.limits:
            return "heaviest object: no limit"
        first = self.limits[0]
        return (
            f"heaviest object {mass_text(first.heaviest_kg)} kg with contacts anywhere on the "
            f"palms: beyond it {first.meaning} {_place(first)} ({first.key})"
        )

    def zone_sentence(self) -> str:
        """How far from the pivots the contacts may be, and which other limits are exceeded."""
        within = self.held_within_m
        where = f"up to {millimetres(within)} from the pivots"
        if within == self.reach_m:
            where = "anywhere on the palms"
        text = f"with contacts {where} no robot tips and no palm sags"
        if within < _NEAR:
            text = "a robot may tip, or a palm sag, wherever the contacts are"
        slips = [one for one in self.limits if one.kind not in DECISIVE]
        if beyond := [one.meaning for one in slips if self.mass_kg > one.heaviest_kg]:
            text += f"; with the hardest squeeze that friction permits, {' and '.join(beyond)}"
        return text


@command("load", order=25, example="palmbots load --set object.mass_kg=2")
def load_limits(scene: SceneLike = "paper", *, overrides: Overrides = None) -> LoadLimits:
    """Report the heaviest object that the robots can hold.

    The report compares the balance of the robots, the torque of the palm servos and the traction of
    the wheels with the load, for contacts anywhere on the palms and all palm angles of a carry.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
    """
    chosen = load_scene(scene, overrides)
    everywhere, start = _heaviest(chosen, math.inf), _heaviest(chosen, None)
    found: list[LoadLimit] = []
    for kind, (_, key) in MEANINGS.items():
        most, at_start = everywhere[kind], start[kind].mass_kg
        if math.isinf(most.mass_kg):
            continue
        first = None if math.isinf(at_start) else at_start
        found.append(LoadLimit(kind, most.mass_kg, first, most.side, most.p_m, most.theta_deg, key))
    found.sort(key=lambda limit: limit.heaviest_kg)
    return LoadLimits(chosen, chosen.object.mass_kg, tuple(found))


def refusal_of(scene: Scene) -> str | None:
    """Why no carry of the object can begin; None: it can."""
    return _core.load_refusal(as_given(scene), scene.task.path.is_curved) or None


def check_load(scene: Scene) -> None:
    """Raise `SceneError` for an object that is too heavy for the robots to start with."""
    refusal = refusal_of(scene)
    if refusal is not None:
        raise SceneError(refusal)


@dataclass(frozen=True)
class _Heaviest:
    """The heaviest object that a limit allows, and where it binds."""

    mass_kg: float
    side: Side
    p_m: BySide[float]
    theta_deg: BySide[float]


def _heaviest(scene: Scene, reach_m: float | None) -> dict[str, _Heaviest]:
    """By kind, with contacts up to this distance from the pivots; None: at rest, at the start."""
    loads = _core.heaviest_loads(as_given(scene), reach_m, scene.task.path.is_curved)
    return {
        kind: _Heaviest(mass, SIDES[side], BySide(*p), BySide(*map(math.degrees, theta)))
        for kind, (mass, side, p, theta) in zip(MEANINGS, loads, strict=True)
    }


def mass_text(mass: float) -> str:
    """A mass with three digits, rounded down, so that it is allowed itself."""
    return _core.mass_text(mass)


def _place(limit: LoadLimit) -> str:
    p = limit.p_m[limit.side]
    return f"with the {limit.side} contact at {millimetres(p)}"
