# SPDX-License-Identifier: Apache-2.0
"""The heaviest object that two robots hold in given states: balance, servos and wheels.

Each robot is a rigid body on two wheels and a caster without friction, in the plane of travel. The
object presses on its palm with the forces of `contact_modes`: a share of the weight, and any
squeeze that friction allows. All forces of the object grow with its mass, so each condition is
linear in the mass, and the heaviest object of a state has a closed form. An acceleration of the
robots counts as a slope, as everywhere in the mechanics; the start is at rest. Slopes, angles and
squeezes are taken at their ends. Source: docs/theory/stability.md.
"""

import math
from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from palmbots._types import SIDES, BySide, Side
from palmbots.mechanics.acting_object import acting_object
from palmbots.mechanics.contact_modes import contact_modes_batch
from palmbots.scene.chassis import axle_out, chassis, wheel_kg
from palmbots.scene.placement import floor_level
from palmbots.scene.scene import Scene

Array = NDArray[np.float64]
_Force: TypeAlias = tuple[Array, Array]  # of the object on a palm: down, outward

_G = _core.standard_gravity


class LoadStates:
    """All states with some contacts, at the ends of angles, slopes and squeezes in which friction
    holds the object; forces on the palms in units of the object's weight."""

    def __init__(
        self,
        scene: Scene,
        spec: _core.Spec,
        places: list[Array],
        acceleration: float,
        pivot_height_m: float | None = None,
    ) -> None:
        self._scene, self._spec = scene, spec
        height = -floor_level(spec) if pivot_height_m is None else pivot_height_m
        self._chassis = chassis(height, axle_out(scene))
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
        acting = acting_object(spec, self._theta, self._p)
        reaches = np.isfinite(acting.dx)
        dx, dy, width, com_left, com_right, com_height = (
            np.where(reaches, one, 1.0) for one in vars(acting).values()
        )
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

    def push(self, i: int) -> tuple[float, float]:
        """How hard a robot's palm can push inward while it carries the vertical force V [N]: in
        every state at least a + b V, a pair (a, b). The push itself presses the wheels down."""
        keys, none = self._scene.mujoco, np.zeros_like(self._slope)
        tilt = self._slope * (1.0 if i == 0 else -1.0)
        one = none + 1.0
        (own, _), _, (along, _) = self._supports(i, tilt, none, none)
        by_load, by_push = (
            self._supports(i, tilt, *force)[0][1] for force in ((one, none), (none, one))
        )
        friction = keys.floor_friction
        room = 1.0 - friction * by_push
        if float(room.min()) <= 0:
            return math.inf, 0.0
        wheels, each = (friction * own - np.abs(along)) / room, friction * by_load / room
        return float(wheels.min()), float(each.min())

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

    def _plate_middle(self, i: int) -> float:
        """Height of the middle of the plate over the pivot, along the palm's normal [m]."""
        palm = self._spec.palms[i]
        return palm.offset - palm.plate_thickness / 2

    def _palm_moment(self, i: int, tilt: Array) -> Array:
        """Moment of the palm's own weight about its pivot [N m]."""
        middle = self._plate_middle(i)
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
        middle = self._plate_middle(i)
        turn = self._theta[i]
        yield (
            keys.palm_kg,
            at.pivot[0] - middle * np.sin(turn),
            at.pivot[1] + middle * np.cos(turn),
        )
