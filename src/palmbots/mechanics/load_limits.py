# SPDX-License-Identifier: Apache-2.0
"""What two robots can hold: which object is too heavy for their balance, servos and wheels.

The mechanics are in `palmbots.mechanics.load_states`. Contacts are taken on a grid over the region.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import palmbots._core as _core
from palmbots._types import SIDES, BySide, Overrides, Side
from palmbots._util.command import command
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, verdict
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots.errors import SceneError
from palmbots.mechanics.load_states import LoadStates
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import to_spec

_CONTACTS = 9  # places on each palm
_HALVINGS = 20
_NEAR = 5e-4  # [m] from the pivot; two contacts are never both as close as this
MEANINGS = {
    "tipping": ("a robot tips over", "mujoco.body_kg"),
    "servo": ("a palm sags", "mujoco.palm_torque_n_m"),
    "traction": ("the wheels of a robot slip", "mujoco.floor_friction"),
    "drive": ("the motors of a robot are too weak", "mujoco.drive_force_n"),
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
        return _first_at_start(self._at_start())[1]

    @derived
    def holds(self) -> bool:
        """Whether the robots hold the scene's object in the whole region."""
        return self.heaviest_kg is None or self.mass_kg <= self.heaviest_kg

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
        states = _everywhere(self.scene, reach_m)
        return min(states.heaviest(kind)[0] for kind in DECISIVE)

    def refusal(self) -> str | None:
        """Why no carry of the object can begin; None: it can."""
        return _refusal(self.mass_kg, self._at_start())

    def warning(self) -> str | None:
        """The limit that the object exceeds somewhere in the region; None: none."""
        if self.holds:
            return None
        first = self.limits[0]
        return (
            f"object.mass_kg is {self.mass_kg:g}, but the robots certainly hold only "
            f"{mass_text(first.heaviest_kg)} kg {_place(first)}: beyond it {first.meaning} "
            f"({first.key})"
        )

    def sentence(self) -> str:
        """The heaviest object in one line."""
        if not self.limits:
            return "heaviest object: no limit"
        first = self.limits[0]
        return (
            f"heaviest object {mass_text(first.heaviest_kg)} kg with contacts anywhere on the "
            f"palms: beyond it {first.meaning} {_place(first)} ({first.key})"
        )

    def lines(self) -> Iterator[Item]:
        """The verdict, and every limit."""
        can = self.refusal() is None
        yield Line(
            verdict(self.holds, "HOLDS", "MAY FAIL" if can else "FAILS"),
            bold(f"  an object of {self.mass_kg:g} kg"),
        )
        if not can:
            yield str(self.refusal())
        elif not self.holds:
            yield self.zone_sentence()
        yield self.sentence()
        half = _everywhere(self.scene, 0.5 * self.reach_m)
        rows = [
            (
                f"  {limit.meaning}",
                *map(_mass, (limit.heaviest_kg, half.heaviest(limit.kind)[0], limit.at_start_kg)),
                limit.key,
            )
            for limit in self.limits
        ]
        numbers = ("anywhere\n[kg]", "inner half\n[kg]", "at start\n[kg]")
        yield Table(rows, ("", *numbers, "key"), right=numbers)

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

    def _at_start(self) -> dict[str, float]:
        return {
            limit.kind: limit.at_start_kg for limit in self.limits if limit.at_start_kg is not None
        }


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
    everywhere = _everywhere(chosen)
    start = _start(chosen, to_spec(chosen, unrolled=True))
    found: list[LoadLimit] = []
    for kind, (_, key) in MEANINGS.items():
        mass, side, k = everywhere.heaviest(kind)
        if math.isinf(mass):
            continue
        at_start = start.heaviest(kind)[0]
        p, theta = everywhere.state(k)
        found.append(
            LoadLimit(kind, mass, None if math.isinf(at_start) else at_start, side, p, theta, key)
        )
    found.sort(key=lambda limit: limit.heaviest_kg)
    return LoadLimits(chosen, chosen.object.mass_kg, tuple(found))


def check_load(scene: Scene, spec: _core.Spec) -> None:
    """Raise `SceneError` for an object that is too heavy for the robots to start with."""
    start = _start(scene, spec)
    refusal = _refusal(scene.object.mass_kg, {k: start.heaviest(k)[0] for k in DECISIVE})
    if refusal is not None:
        raise SceneError(refusal)


def _everywhere(scene: Scene, reach_m: float = math.inf) -> LoadStates:
    """All states of a carry with contacts up to this distance from the pivots."""
    spec = to_spec(scene, unrolled=True)
    ends = [min(reach_m, scene.palm_of(side).reach_m) for side in SIDES]
    grid = [np.linspace(-end, end, _CONTACTS) for end in ends]
    fastest = max(robot.acceleration for robot in spec.robots) if spec.inertia else 0.0
    return LoadStates(scene, spec, grid, fastest)


def _start(scene: Scene, spec: _core.Spec) -> LoadStates:
    """The start of the carry, at rest."""
    return LoadStates(scene, spec, [np.array([p]) for p in spec.start], 0.0)


def _first_at_start(masses: dict[str, float]) -> tuple[str, float | None]:
    """The limit that ends a carry before it begins, and its mass [kg]."""
    decisive = {kind: masses[kind] for kind in DECISIVE if masses.get(kind, math.inf) < math.inf}
    first = min(decisive, key=lambda kind: decisive[kind], default="")
    return first, decisive.get(first)


def _refusal(mass_kg: float, masses: dict[str, float]) -> str | None:
    kind, most = _first_at_start(masses)
    if most is None or mass_kg <= most:
        return None
    meaning, key = MEANINGS[kind]
    return (
        f"object.mass_kg: value is {mass_kg:g}, and {meaning} where the carry starts; allowed: at "
        f"most {mass_text(most)} kg with these robots ({key})"
    )


def mass_text(mass: float) -> str:
    """A mass with three digits, rounded down, so that it is allowed itself."""
    unit = 10.0 ** (math.floor(math.log10(mass)) - 2) if mass > 0 else 1.0
    return f"{math.floor(mass / unit * (1 + 1e-12)) * unit:.3g}"


def _mass(mass: float | None) -> str:
    return "any" if mass is None or math.isinf(mass) else mass_text(mass)


def _place(limit: LoadLimit) -> str:
    p = limit.p_m[limit.side]
    return f"with the {limit.side} contact at {millimetres(p)}"
