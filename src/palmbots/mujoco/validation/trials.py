# SPDX-License-Identifier: Apache-2.0
"""Trials that compare MuJoCo with the quasistatic world, state by state.

A state is a pair of palm angles, two contacts, a friction and a COM. From it the palms are driven
together (closing) or apart, slowly, and it is seen which contact slides. The quasistatic world says
which one must; a state is *decisive* where it says the same with the friction angle of either palm
up to `MARGIN` larger or smaller. Angles in radians, lengths in metres.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any, Literal

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.mujoco.engine_settings import DEFAULT, Engine
from palmbots.mujoco.world import MujocoWorld
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.sides import on_every_side
from palmbots.scene.spec import contact_radii, to_spec

Slides = Literal["left", "right", "both", "none"]

MARGIN = math.radians(1.0)
SPEED = 0.005  # m/s, of the palms towards each other or apart
RAMP_S, PUSH_S = 0.05, 0.4
_MOVED = 5e-4  # m; a contact that moves less sticks
_SHARE = 0.2  # fraction of the total slide; a contact with less sticks


@dataclass(frozen=True)
class State:
    """The state from which the palms are driven."""

    friction: float
    com_x: float
    """Position of the COM from the left contact vertex [m]."""
    angles_deg: tuple[float, float]
    contacts: tuple[float, float]
    radius: float = 0.0
    """Of the corners of the object, which roll on the palms [m]."""


def grid(width: float) -> list[State]:
    """Frictions × COMs × angles × contacts, for an object of this width between its contacts."""
    places = (-0.04, 0.0, 0.04)
    return [
        State(friction, width / 2 + off, angles, (left, right))
        for friction, off, angles, left, right in product(
            (0.15, 0.25, 0.35, 0.5, 0.65),
            (-0.03, -0.01, 0.005, 0.02),
            ((5.0, 15.0), (15.0, 5.0), (15.0, 15.0), (12.0, 15.0)),
            places,
            places,
        )
    ]


def rolling_grid(width: float) -> list[State]:
    """The same with rounded corners: contacts that stick roll."""
    return [
        State(friction, width / 2 + off, angles, (place, 0.01), radius)
        for friction, off, angles, place, radius in product(
            (0.15, 0.25, 0.35, 0.5, 0.65),
            (-0.03, -0.01, 0.005, 0.02),
            ((5.0, 15.0), (15.0, 5.0), (12.0, 15.0)),
            (-0.03, 0.0, 0.03),
            (0.005, 0.02),
        )
    ]


def scene_of(base: Scene, state: State) -> Scene:
    """The scene that starts in this state, without noise."""
    left, right = state.angles_deg
    changes: dict[str, Any] = {
        **on_every_side(base, {"palm.friction": state.friction, "robot.noise_m_s": 0.0}),
        "object.com_m": [state.com_x, base.object.com_m[1]],
        "start.left_m": state.contacts[0],
        "start.right_m": state.contacts[1],
    }
    if state.radius > 0:
        changes["object.edge_radius_m"] = state.radius
    for side, angle in (("left", left), ("right", right)):
        changes[f"palm.{side}.steep_deg"] = angle
        changes[f"palm.{side}.shallow_deg"] = angle - 1.0
    return load_scene(base, changes)


def expected(
    spec: _core.Spec, closing: bool, by: tuple[float, float] = (0.0, 0.0)
) -> Slides | None:
    """The contact that slides in the quasistatic world, with friction angles larger by `by`; None:
    the object is not held."""
    palms = list(spec.palms)
    before = [palm.friction for palm in palms]
    for palm, friction, angle in zip(palms, before, by, strict=True):
        palm.friction = math.tan(math.atan(friction) + angle)
    spec.palms = (palms[0], palms[1])
    world = _core.World(spec)
    held = world.check() == ""
    motion = world.advance(-1e-6 if closing else 1e-6, world.palms)[2:4] if held else (0, 0)
    for palm, friction in zip(palms, before, strict=True):
        palm.friction = friction
    spec.palms = (palms[0], palms[1])
    return _named(motion[0] != 0, motion[1] != 0) if held else None


def is_decisive(spec: _core.Spec, closing: bool, margin: float = MARGIN) -> bool:
    """Whether the same contact slides if either friction angle changes by up to `margin`."""
    nominal = expected(spec, closing)
    return nominal in SIDES and all(
        expected(spec, closing, (left, right)) == nominal
        for left, right in product((-margin, margin), repeat=2)
    )


def _named(left: bool, right: bool) -> Slides:
    if left and right:
        return "both"
    return "left" if left else ("right" if right else "none")


def slide_name(moved: tuple[float, float]) -> Slides:
    """The contacts that have slid, from their motions [m]."""
    left, right = map(abs, moved)
    whole = left + right
    return _named(
        left > _MOVED and left > _SHARE * whole, right > _MOVED and right > _SHARE * whole
    )


def run_trial(
    scene: Scene, engine: Engine = DEFAULT, directions: tuple[bool, ...] = (True, False)
) -> Iterator[tuple[bool, tuple[float, float]]]:
    """The slide of each contact in MuJoCo, for closing and then for opening: how far it has moved
    along its palm, less what it has rolled [m]."""
    world = MujocoWorld(scene, engine)
    radii = contact_radii(world.layout.spec)
    thing = world.model.body("object").id

    def runs() -> tuple[float, float]:
        matrix = world.data.xmat[thing]
        turn = math.atan2(float(matrix[6]), float(matrix[0]))
        left, right = (
            p + radius * (out * turn - palm)
            for p, radius, out, palm in zip(
                world.contacts, radii, (-1, 1), world.wrists(), strict=True
            )
        )
        return left, right

    start = world.state()
    angles = world.wrists_set
    period = scene.control.period_s
    for closing in directions:
        world.restore(start)
        sense = 1.0 if closing else -1.0
        before = runs()
        for tick in range(round((RAMP_S + PUSH_S) / period)):
            speed = 0.5 * SPEED * sense * min(1.0, (tick + 1) * period / RAMP_S)
            world.move((speed, -speed), angles)
        after = runs()
        yield closing, (after[0] - before[0], after[1] - before[1])


def creep(engine: Engine = DEFAULT, seconds: float = 25.0) -> tuple[float, float]:
    """The creep of the two contacts at rest at 5° and 15° [m]; ideal friction has none."""
    state = State(0.3, 0.125, (5.0, 15.0), (0.0, 0.0))
    scene = scene_of(Scene(), state)
    world = MujocoWorld(scene, engine)
    angles = world.wrists_set
    before = world.contacts
    for _ in range(round(seconds / scene.control.period_s)):
        world.move((0.0, 0.0), angles)
    after = world.contacts
    return after[0] - before[0], after[1] - before[1]


def tilted(
    scene: Scene, side: int, engine: Engine = DEFAULT
) -> tuple[tuple[float, float], tuple[float, float]]:
    """The contacts after one palm has turned from steep to shallow with the robots at rest, in
    MuJoCo and in the quasistatic world [m]."""
    spec = to_spec(scene)
    world, known = MujocoWorld(scene, engine), _core.World(spec)
    palm = spec.palms[side]
    period = scene.control.period_s
    angles = list(world.wrists_set)
    while angles[side] > palm.shallow:
        angles[side] = max(palm.shallow, angles[side] - palm.rate * period)
        world.move((0.0, 0.0), (angles[0], angles[1]))
        known.advance(0.0, (angles[0], angles[1]))
    for _ in range(round(0.2 / period)):
        world.move((0.0, 0.0), (angles[0], angles[1]))
    return world.contacts, known.contacts


def spec_of(scene: Scene) -> _core.Spec:
    """The spec of the core, with the pair at rest."""
    spec = to_spec(scene)
    spec.inertia = False
    return spec
