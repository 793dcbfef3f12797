# SPDX-License-Identifier: Apache-2.0
"""Trials on the floor: an object with rounded corners between two plates whose noses are on it.

Random motions of the palms lead to a state of the quasistatic world; half of the trials begin where
both noses touch the object. From the state both palms move on at constant velocities, in MuJoCo as
well, and the motion of the object there is compared with the consistent contact modes. MuJoCo's
model is the side view alone: the object is a ball at each corner, a palm is a box that nothing
stops, the floor a plane. Angles in radians, lengths in metres.

The palms move by some hundredths of a millimetre, because the normal of an arc of some millimetres
turns within tenths of a millimetre, and contacts yield by much less. The palms are slow, because a
contact that slides too fast for its stiffness hops (docs/reference/mujoco-agreement.md, "Contacts
that slide fast hop").
"""

import cmath
import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.xml_attributes import numbers
from palmbots.mechanics.consistent_modes import ConsistentModes, SurfaceContact, consistent_modes
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.engine_settings import DEFAULT, Contact
from palmbots.scene.extrusion import gyration
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_world import FloorState, FloorWorld

Motions = tuple[str, ...]
Velocity = tuple[float, float]

ROUNDED = "rounded corners"
ONE_PALM, BOTH_PALMS = "floor, one palm", "floor, both palms"

SPEED = 5e-5  # m/s
_STEP_S, _SETTLE_S, _RAMP_S, _SEEN_S = 1e-4, 0.05, 0.5, 0.25
_CONTACT = Contact((0.0005, 1.0), (0.9, 0.9, 0.001))
_NEAR = 0.1  # of the speed; velocities of contacts that differ by less agree
_SIZE_M = 0.1
_CLOSE_M = 3e-4  # a state in which another contact is nearer than this is left out
_IMPRATIO = 1000.0  # less creep than in carries
_HEAVY_KG = 1e6
_HEEL_M = 0.005  # thickness of a heel; assumed
_OUT = (-1, 1)
_STREAM = 4300  # of the random numbers; the parameters above were chosen with others


@dataclass(frozen=True)
class FloorTrial:
    """One state, one motion of the palms."""

    state: FloorState
    modes: ConsistentModes
    """All that the quasistatic world permits."""
    seen: tuple[complex, ...]
    """Velocity of the object against the surface at each contact in MuJoCo, as a share of `SPEED`:
    away from the surface + i to the left along it."""
    decisive: bool
    """Whether the consistent modes stay the same if friction angles change by the margin."""

    @property
    def contacts(self) -> str:
        """What touches: `ROUNDED`, `ONE_PALM` or `BOTH_PALMS`."""
        surfaces = {one.surface for one in self.modes.contacts}
        if "floor" not in surfaces:
            return ROUNDED
        return BOTH_PALMS if len(surfaces) == 3 else ONE_PALM

    @property
    def agrees(self) -> bool:
        """Whether MuJoCo shows one of the consistent modes."""
        return any(_describes(mode.motions, self) for mode in self.modes.modes)


class _Unstopped(FloorWorld):
    """Nothing stops a palm, as in MuJoCo's model."""

    def _check_palms(self, *_: Any, **_named: Any) -> None:
        pass


def floor_trial(base: Scene, seed: int, margin: float) -> FloorTrial | None:
    """The trial of a seed; None: the object fell on the way, no contact mode is consistent there,
    or its state has a contact that MuJoCo's balls do not represent."""
    rng = np.random.default_rng((_STREAM, seed))
    radius = float(rng.uniform(0.004, 0.01))
    width = base.object.width_m
    keys: dict[str, Any] = {  # the width and the other keys are those of the scene
        "object.edge_radius_m": radius,
        "object.com_m": [width * float(rng.uniform(0.35, 0.65)), float(rng.uniform(0.02, 0.08))],
        "palm.friction": float(rng.uniform(0.15, 0.6)),
        "palm.thickness_m": radius * float(rng.uniform(0.1, 0.7)),
        "palm.heel_m": float(rng.choice([0.0, 0.012])),
    }
    scene = load_scene(base, keys)
    palms_deg = float(rng.uniform(4, 20)), float(rng.uniform(4, 20))
    gaps_m = float(rng.uniform(0.0, 0.004)), float(rng.uniform(0.0, 0.004))
    world = _Unstopped(
        scene,
        palms_deg=palms_deg,
        gaps_m=gaps_m,
        floor_friction=(floor_friction := float(rng.uniform(0.1, 0.8))),
    )
    far, moves = float(rng.choice([0.008, 0.04])), int(rng.integers(1, 4))
    inward = [-1, 0, 1]
    if rng.random() < 0.5:  # from where both noses touch the object
        left, right = (
            gap + _depth_at_nose(radius, keys["palm.thickness_m"], math.radians(angle))
            for gap, angle in zip(gaps_m, palms_deg, strict=True)
        )
        world.move(left, -right)
        far, moves, inward = 0.004, moves // 2, [-1, 0, 1, 1, 1]
    for _ in range(moves):
        left, right = rng.uniform(-0.25 * far, far, 2)
        up = float(rng.choice([0.0, 0.0, 0.001]))
        moved = world.move(float(left), -float(right), up_m=(up, up))
        if moved.end or moved.falls:
            return None
    first, second = map(float, rng.choice(inward, 2))
    speeds = [SPEED * first, -SPEED * second]
    rises = [SPEED * float(k) for k in rng.choice([-1, 0, 0, 0, 1], 2)]
    if not any(speeds + rises):
        speeds[0] = SPEED
    modes = world.contact_modes(*speeds, up_m_s=(rises[0], rises[1]))
    body = _Body(scene, floor_friction)
    is_close = len(world.contact_modes(within_m=_CLOSE_M).contacts) > len(modes.contacts)
    is_touched = any(one.surface != "floor" for one in modes.contacts)
    if (
        not modes.modes
        or is_close
        or not is_touched
        or not all(body.is_on_arc(world.state, one) for one in modes.contacts)
    ):
        return None
    velocities = (speeds[0], rises[0]), (speeds[1], rises[1])
    state = world.state
    if not _persists(world, modes, velocities):
        return None
    seen = body.seen(state, modes.contacts, velocities)
    return FloorTrial(state, modes, seen, _is_decisive(modes, margin))


def _depth_at_nose(radius: float, thickness: float, angle: float) -> float:
    """How far the upper end of a nose is below an arc, from its widest point, when it touches the
    arc; both stand on the floor."""
    below = radius - thickness * math.cos(angle)
    return radius - math.sqrt(radius**2 - below**2)


def _persists(
    world: FloorWorld, modes: ConsistentModes, velocities: tuple[Velocity, Velocity]
) -> bool:
    """Whether the trial in the quasistatic world ends with the contacts that a consistent mode
    leaves. Moves the world."""
    lasts_s = 0.5 * _RAMP_S + _SEEN_S
    (left, left_up), (right, right_up) = velocities
    end = world.move(left * lasts_s, right * lasts_s, up_m=(left_up * lasts_s, right_up * lasts_s))
    after = sorted(one.surface for one in world.contact_modes().contacts)
    return not end.end and any(
        after
        == sorted(
            one.surface
            for one, motion in zip(modes.contacts, mode.motions, strict=True)
            if motion != "BR"
        )
        for mode in modes.modes
    )


def _describes(motions: Motions, trial: FloorTrial) -> bool:
    """Whether the contacts move in MuJoCo as a mode demands: with the velocities that follow from
    it, or, where the mode leaves them open, in its directions."""
    expected = _velocities(motions, trial.modes.contacts)
    if expected is not None:
        return all(
            abs(seen - known) <= _NEAR * max(1.0, 2.0 * abs(known))
            for seen, known in zip(trial.seen, expected, strict=True)
        )
    return all(
        abs(seen.real) <= _NEAR and (seen.imag > _NEAR if motion == "SL" else seen.imag < -_NEAR)
        for seen, motion in zip(trial.seen, motions, strict=True)
    )


def _velocities(
    motions: Motions, contacts: tuple[SurfaceContact, ...]
) -> tuple[complex, ...] | None:
    """The velocities of a mode as in `FloorTrial.seen`; None: it does not determine them."""
    rows, wanted, ways = [], [], []
    for one, motion in zip(contacts, motions, strict=True):
        x, y = one.point_m
        normal = complex(*one.normal)
        for way, is_given in ((normal, motion != "BR"), (1j * normal, motion == "ST")):
            # In units of the object's size, so that the rank has a scale.
            row = [way.real, way.imag, (x * way.imag - y * way.real) / _SIZE_M]
            ways.append((row, way.real * one.velocity_m_s[0] + way.imag * one.velocity_m_s[1]))
            if is_given:
                rows.append(row)
                wanted.append(ways[-1][1])
    twist, _, rank, _ = np.linalg.lstsq(np.array(rows), np.array(wanted), rcond=1e-6)
    if rank < 3:
        return None
    found = [(float(np.dot(row, twist)) - given) / SPEED for row, given in ways]
    return tuple(complex(a, b) for a, b in zip(found[::2], found[1::2], strict=True))


def _is_decisive(found: ConsistentModes, margin: float) -> bool:
    own = {mode.motions for mode in found.modes}
    surfaces = sorted({one.surface for one in found.contacts})
    for senses in product((-margin, margin), repeat=len(surfaces)):
        by = dict(zip(surfaces, senses, strict=True))
        changed = [
            replace(one, friction=math.tan(math.atan(one.friction) + by[one.surface]))
            for one in found.contacts
        ]
        if {mode.motions for mode in consistent_modes(changed).modes} != own:
            return False
    return True


class _Body:
    """An object with rounded corners, and the plates of its scene."""

    def __init__(self, scene: Scene, floor_friction: float) -> None:
        self._spec = spec = to_spec(scene, unrolled=True)
        self._floor_friction = floor_friction
        com = complex(spec.com_left, spec.com_height)
        self._arcs = [(complex(x, y) - com, radius) for x, y, radius in spec.corners]
        self._mass = scene.object.mass_kg
        self._inertia = self._mass * gyration(spec.silhouette, scene.object.depth_m).yy

    def is_on_arc(self, state: FloorState, contact: SurfaceContact) -> bool:
        """Whether a contact is on an arc of the object: MuJoCo has no other shape of it here."""
        turned = cmath.rect(1, math.radians(state.tilt_deg))
        point, normal = complex(*contact.point_m), complex(*contact.normal)
        return any(
            abs(point + radius * normal - centre * turned) < 1e-2 * radius
            for centre, radius in self._arcs
        )

    def seen(
        self,
        state: FloorState,
        contacts: tuple[SurfaceContact, ...],
        velocities: tuple[Velocity, Velocity],
    ) -> tuple[complex, ...]:
        """How each contact moves in MuJoCo, after the palms have begun to move."""
        mj = mujoco()
        model: Any = mj.MjModel.from_xml_string(self._mjcf(state))
        data: Any = mj.MjData(model)
        poses = []
        for lasts_s, first, last in (
            (_SETTLE_S, 0.0, 0.0),
            (_RAMP_S, 0.0, 1.0),
            (_SEEN_S, 1.0, 1.0),
        ):
            steps = round(lasts_s / _STEP_S)
            for i in range(steps):
                share = first + (last - first) * (i + 1) / steps
                data.qvel[:4] = [share * one for velocity in velocities for one in velocity]
                mj.mj_step(model, data)
            poses.append(data.qpos[4:7].copy())
        x, y, turn = (poses[2] - poses[1]) / _SEEN_S
        return tuple(_slip(contact, complex(x, y), -float(turn)) for contact in contacts)

    def _mjcf(self, state: FloorState) -> str:
        root = ET.Element("mujoco")
        ET.SubElement(root, "compiler", angle="radian")
        ET.SubElement(
            root, "option", timestep=numbers(_STEP_S), cone=DEFAULT.cone, solver=DEFAULT.solver,
            impratio=numbers(_IMPRATIO), gravity=numbers(0, 0, -_core.standard_gravity),
            iterations="200", tolerance="1e-12",
        )  # fmt: skip
        ET.SubElement(ET.SubElement(root, "default"), "geom", contype="0", conaffinity="0")
        world = ET.SubElement(root, "worldbody")
        ET.SubElement(world, "geom", name="floor", type="plane", size="0 0 1")
        plates = []
        for k, (pivot, degrees) in enumerate(
            zip(state.pivots_m.values(), state.palms_deg.values(), strict=True)
        ):
            plates += self._palm(world, k, pivot, math.radians(degrees))
        x, y = state.com_m
        body = ET.SubElement(world, "body", pos=numbers(x, 0, y))
        for axis, kind in (("1 0 0", "slide"), ("0 0 1", "slide"), ("0 1 0", "hinge")):
            ET.SubElement(body, "joint", type=kind, axis=axis)
        ET.SubElement(
            body, "inertial", pos="0 0 0", mass=numbers(self._mass),
            diaginertia=numbers(self._inertia, self._inertia, self._inertia),
        )  # fmt: skip
        pairs = ET.SubElement(root, "contact")
        turned = cmath.rect(1, math.radians(state.tilt_deg))
        for k, (centre, radius) in enumerate(self._arcs):
            at = centre * turned
            ET.SubElement(
                body, "geom", name=f"arc_{k}", type="sphere", size=numbers(radius),
                pos=numbers(at.real, 0, at.imag),
            )  # fmt: skip
            for name, friction in (("floor", self._floor_friction), *plates):
                ET.SubElement(
                    pairs, "pair", geom1=name, geom2=f"arc_{k}", condim="3",
                    friction=numbers(friction, friction, 0.005, 0.0001, 0.0001),
                    solref=numbers(*_CONTACT.solref), solimp=numbers(*_CONTACT.solimp),
                )  # fmt: skip
        return ET.tostring(root, encoding="unicode")

    def _palm(
        self, world: ET.Element, side: int, pivot: tuple[float, float], angle: float
    ) -> list[tuple[str, float]]:
        """A palm; the names of its shapes, with their friction."""
        palm = self._spec.palms[side]
        body = ET.SubElement(
            world, "body", pos=numbers(pivot[0], 0, pivot[1]), gravcomp="1",
            euler=numbers(0, -_OUT[side] * angle, 0),
        )  # fmt: skip
        turned = cmath.rect(1, -_OUT[side] * angle)
        for axis in (turned, turned * 1j):  # the world's axes, seen from the palm
            ET.SubElement(body, "joint", type="slide", axis=numbers(axis.real, 0, axis.imag))
        ET.SubElement(
            body, "inertial", pos="0 0 0", mass=numbers(_HEAVY_KG), diaginertia=numbers(1, 1, 1)
        )
        half, top, nose = palm.length / 2, palm.offset, palm.nose
        boxes = [("plate", (0.0, top - nose / 2), (half, nose / 2))]
        if palm.heel > 0:
            middle = half + _HEEL_M / 2, top + palm.heel / 2
            boxes.append(("heel", middle, (_HEEL_M / 2, palm.heel / 2)))
        names = []
        for kind, (x, y), (along, across) in boxes:
            names.append((f"{SIDES[side]} {kind}", palm.friction))
            ET.SubElement(
                body, "geom", name=names[-1][0], type="box",
                size=numbers(along, 0.1, across), pos=numbers(_OUT[side] * x, 0, y),
            )  # fmt: skip
        return names


def _slip(contact: SurfaceContact, moves: complex, turn: float) -> complex:
    """The velocity of an object against a surface, as in `FloorTrial.seen`."""
    slip = moves + 1j * turn * complex(*contact.point_m) - complex(*contact.velocity_m_s)
    return slip * complex(*contact.normal).conjugate() / SPEED
