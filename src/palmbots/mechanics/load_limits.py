# SPDX-License-Identifier: Apache-2.0
"""What two robots can hold: which object is too heavy for their balance, servos and wheels.

Each robot is a rigid body on two wheels and a caster without friction, in the plane of travel. The
object presses on its palm with the forces of `contact_modes`: a share of the weight, and any
squeeze that friction allows. All forces of the object grow with its mass, so each condition is
linear in the mass, and the heaviest object of a state has a closed form. An acceleration of the
robots counts as a slope, as everywhere in the mechanics; the start is at rest. Slopes, angles and
squeezes are taken at their ends, contacts on a grid over the region. Source:
docs/theory/stability.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES, BySide, Overrides, Side
from palmbots._util.command import command
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, verdict
from palmbots._util.results import Result
from palmbots._util.text import millimetres
from palmbots.errors import SceneError
from palmbots.mechanics.contact_modes import contact_modes_batch
from palmbots.scene.chassis import axle_out, chassis, wheel_kg
from palmbots.scene.placement import floor_level
from palmbots.scene.robot_dimensions import PALM_THICKNESS
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.spec import contact_radii, to_spec

Array = NDArray[np.float64]
_Force: TypeAlias = tuple[Array, Array]  # of the object on a palm: down, outward

_CONTACTS = 9  # places on each palm
_HALVINGS = 20
_NEAR = 5e-4  # [m] from the pivot; two contacts are never both as close as this
_G = _core.standard_gravity
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


def _everywhere(scene: Scene, reach_m: float = math.inf) -> _States:
    """All states of a carry with contacts up to this distance from the pivots."""
    spec = to_spec(scene, unrolled=True)
    ends = [min(reach_m, scene.palm_of(side).reach_m) for side in SIDES]
    grid = [np.linspace(-end, end, _CONTACTS) for end in ends]
    fastest = max(robot.acceleration for robot in spec.robots) if spec.inertia else 0.0
    return _States(scene, spec, grid, fastest)


def _start(scene: Scene, spec: _core.Spec) -> _States:
    """The start of the carry, at rest."""
    return _States(scene, spec, [np.array([p]) for p in spec.start], 0.0)


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


class _States:
    """All states with some contacts, at the ends of angles, slopes and squeezes in which friction
    holds the object; forces on the palms in units of the object's weight."""

    def __init__(
        self, scene: Scene, spec: _core.Spec, places: list[Array], acceleration: float
    ) -> None:
        self._scene, self._spec = scene, spec
        self._chassis = chassis(-floor_level(spec), axle_out(scene))
        a = acceleration / _G
        slopes = [spec.slope - a, spec.slope + a] if a else [spec.slope]
        angles = [np.array([palm.shallow, palm.steep]) for palm in spec.palms]
        grid = np.meshgrid(*places, *angles, np.array(slopes), indexing="ij")
        p_l, p_r, t_l, t_r, s = (axis.ravel() for axis in grid)
        palms = spec.palms
        self._p, self._theta = np.stack([p_l, p_r]), np.stack([t_l, t_r])
        offset = np.array([[palm.offset] for palm in palms])
        # From the pivot, outward and up.
        self._arm_x = self._p * np.cos(self._theta) - offset * np.sin(self._theta)
        self._arm_z = self._p * np.sin(self._theta) + offset * np.cos(self._theta)
        # The point at which a rounded vertex touches depends on the state. In each state the
        # vertex acts like a sharp one at that point.
        radius = np.array(contact_radii(spec))[:, np.newaxis]
        down_x, down_z = radius * np.sin(self._theta), radius * np.cos(self._theta)
        rise = np.diff(self._arm_z + down_z, axis=0)[0]  # between the centres of the arcs
        reaches = np.abs(rise) < spec.width
        run = np.sqrt(np.where(reaches, spec.width**2 - rise**2, 1.0))
        dx, dy = run + down_x.sum(axis=0), self._arm_z[1] - self._arm_z[0]
        x = (spec.com_left * run - spec.com_height * rise) / spec.width + down_x[0]
        z = (spec.com_left * rise + spec.com_height * run) / spec.width + down_z[0]
        width = np.hypot(dx, dy)
        com_left, com_height = (x * dx + z * dy) / width, (z * dx - x * dy) / width
        com_right = width - com_left
        squeeze = contact_modes_batch(
            width=width, com_x=com_left, com_y=com_height,
            theta_left=t_l, theta_right=t_r, p_left=p_l, p_right=p_r,
            friction_left=palms[0].friction, friction_right=palms[1].friction,
            offset_left=palms[0].offset, offset_right=palms[1].offset, slope=s,
        ).squeeze  # fmt: skip
        low, high = squeeze[..., 0].max(axis=-1), squeeze[..., 1].min(axis=-1)
        held = reaches & (low <= high)
        ends = np.stack([low, high])
        self._valid = held & np.isfinite(ends)  # a wedged contact has no end: the wheels slip first
        ends = np.where(self._valid, ends, 0.0)
        # Wheels that lose their load slip, and end a pull inward: the least squeeze remains.
        calm = np.broadcast_to(np.clip(0.0, *ends), ends.shape)
        self._slope = s
        # Vertical forces on the palms: the balance of moments about the other contact.
        tilt = com_height + s * 0.5 * (com_left - com_right)
        level = (com_right + s * com_height, com_left - s * com_height)
        self._forces: list[tuple[_Force, _Force]] = []
        for side, sense in ((0, 1.0), (1, -1.0)):
            arm = (level[side] * dx + sense * tilt * dy) / width
            worst, least = (
                ((arm + sense * h * dy) / dx, h + sense * 0.5 * s) for h in (ends, calm)
            )
            self._forces.append((worst, least))

    def heaviest(self, kind: str) -> tuple[float, Side, int]:
        """The heaviest object that a limit allows [kg], with robot and state."""
        best: tuple[float, Side, int] = (math.inf, "left", 0)
        for i, side in enumerate(SIDES):
            for own, by_load in self._conditions(kind, i):
                own = np.broadcast_to(own, by_load.shape)
                with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
                    weight = np.where(by_load < 0, np.maximum(own, 0.0) / -by_load, np.inf)
                weight = np.where(self._valid, weight, np.inf)
                k = int(weight.argmin())
                mass = float(weight.ravel()[k]) / _G
                if mass < best[0]:
                    best = (mass, side, k % self._p.shape[1])
        return best

    def state(self, k: int) -> tuple[BySide[float], BySide[float]]:
        """Contacts [m] and palm angles [°] of a state."""
        p, theta = self._p[:, k], np.degrees(self._theta[:, k])
        return BySide(*map(float, p)), BySide(*map(float, theta))

    def _conditions(self, kind: str, i: int) -> Iterator[tuple[Array, Array]]:
        """Pairs (a, b): the limit allows a weight W where a + b W ≥ 0."""
        keys = self._scene.mujoco
        (down, out), relieved = self._forces[i]
        tilt = self._slope * (1.0 if i == 0 else -1.0)  # sideways specific force, outward
        if kind == "servo":
            own = self._palm_moment(i, tilt)
            by_load = -(self._arm_x[i] * down + self._arm_z[i] * out)
            for sign in (1.0, -1.0):
                yield keys.palm_torque_n_m - sign * own, -sign * by_load
            return
        wheels, caster, push = self._supports(i, tilt, down, out)
        if kind == "tipping":
            yield self._supports(i, tilt, *relieved)[0]
            yield caster
            return
        for sign in (1.0, -1.0):
            if kind == "traction":
                friction = keys.floor_friction
                yield friction * wheels[0] - sign * push[0], friction * wheels[1] - sign * push[1]
            elif keys.drive_force_n is not None:
                yield keys.drive_force_n - sign * push[0], -sign * push[1]

    def _palm_moment(self, i: int, tilt: Array) -> Array:
        """Moment of the palm's own weight about its pivot [N m]."""
        middle = self._spec.palms[i].offset - PALM_THICKNESS / 2
        x, z = -middle * np.sin(self._theta[i]), middle * np.cos(self._theta[i])
        return -self._scene.mujoco.palm_kg * _G * (x + z * tilt)

    def _supports(
        self, i: int, tilt: Array, down: Array, out: Array
    ) -> tuple[tuple[Array, Array], tuple[Array, Array], tuple[Array, Array]]:
        """Load of the wheels, load of the caster, and force of the wheels along the floor: each of
        the robot's own weight [N], and of the object [its weight]."""
        at = self._chassis
        base = at.axle - at.caster
        weight, moment = 0.0, np.zeros_like(tilt)  # about the caster, outward side down
        for mass, x, z in self._masses(i):
            weight += mass * _G
            moment = moment + mass * _G * ((x - at.caster) + tilt * z)
        x = at.pivot[0] + self._arm_x[i] - at.caster
        by_load = (x * down + (at.pivot[1] + self._arm_z[i]) * out) / base
        wheels = moment / base, by_load
        return wheels, (weight - wheels[0], down - by_load), (-tilt * weight, -out)

    def _masses(self, i: int) -> Iterator[tuple[float, Any, Any]]:
        """The parts of a robot: mass, and place relative to the middle of the body on the floor."""
        keys, at = self._scene.mujoco, self._chassis
        wheel = wheel_kg(self._scene)
        yield keys.body_kg - 2 * wheel, *at.com
        yield 2 * wheel, at.axle, keys.wheel_radius_m
        yield keys.arm_kg, at.shoulder[0] + at.arm[0] / 2, at.shoulder[1] + at.arm[1] / 2
        middle = self._spec.palms[i].offset - PALM_THICKNESS / 2
        turn = self._theta[i]
        yield (
            keys.palm_kg,
            at.pivot[0] - middle * np.sin(turn),
            at.pivot[1] + middle * np.cos(turn),
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
