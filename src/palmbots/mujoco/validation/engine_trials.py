# SPDX-License-Identifier: Apache-2.0
"""The same trials in pymunk (Chipmunk) and Box2D: kinematic palms, one dynamic object.

Side view, metres, radians. Both engines know convex shapes only, so the object is its convex hull.
Each is used as its users would: 5 ms steps; Box2D keeps a skin of about 1 cm around polygons, so
everything is twenty times as large there.
"""

import importlib
import math
import warnings
from collections.abc import Callable, Iterator
from typing import Any, Protocol

import palmbots._core as _core
from palmbots._core import hull
from palmbots.mujoco.mjcf import layout
from palmbots.scene.extrusion import gyration
from palmbots.scene.object_frame import Point
from palmbots.scene.scene import Scene

_STEP, _THICK = 0.005, 0.01
_SETTLE_S = 0.3
_SCALE = 20.0  # of Box2D's world


class _Engine(Protocol):
    """Two kinematic palms, and an object in its own frame (left vertex, level)."""

    def drive(self, speeds: tuple[float, float]) -> None: ...
    def step(self) -> None: ...
    def palm(self, k: int) -> Point: ...
    def vertex(self, x: float) -> Point: ...


class _Body:
    """The scene as both engines need it."""

    def __init__(self, scene: Scene) -> None:
        at = layout(scene)
        self.spec: _core.Spec = at.spec
        outline = at.spec.silhouette
        self.hull = [outline[k] for k in hull(outline)]
        self.com = (at.spec.com_left, at.spec.com_height)
        self.mass = scene.object.mass_kg
        self.moment = self.mass * gyration(outline, scene.object.depth_m).yy
        self.pivots = at.pivots
        self.height = at.height
        self.start = at.vertex
        self.turn = at.turn
        self.angles = (-at.spec.palms[0].steep, at.spec.palms[1].steep)

    def plate(self, k: int) -> list[Point]:
        palm = self.spec.palms[k]
        half, top = palm.length / 2, palm.offset
        return [(-half, top - _THICK), (half, top - _THICK), (half, top), (-half, top)]


class _Pymunk:
    def __init__(self, body: _Body) -> None:
        pymunk: Any = importlib.import_module("pymunk")
        self.space = pymunk.Space()
        self.space.gravity = (0, -_core.standard_gravity)
        self.space.collision_slop = 1e-5
        self.space.iterations = 30
        self.palms = []
        for k in (0, 1):
            palm = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            palm.position, palm.angle = (body.pivots[k], body.height), body.angles[k]
            shape = pymunk.Poly(palm, body.plate(k))
            shape.friction = body.spec.palms[k].friction
            self.space.add(palm, shape)
            self.palms.append(palm)
        self.com = body.com
        self.thing = pymunk.Body(body.mass, body.moment)
        points = [(x - body.com[0], z - body.com[1]) for x, z in body.hull]
        self.thing.angle = body.turn
        turned = self.thing.local_to_world(body.com) - self.thing.position
        self.thing.position = (body.start[0] + turned.x, body.start[1] + turned.y)
        shape = pymunk.Poly(self.thing, points)
        shape.friction = 1.0  # pymunk multiplies the coefficients of the two shapes
        self.space.add(self.thing, shape)

    def drive(self, speeds: tuple[float, float]) -> None:
        for palm, speed in zip(self.palms, speeds, strict=True):
            palm.velocity = (speed, 0)

    def step(self) -> None:
        self.space.step(_STEP)

    def palm(self, k: int) -> Point:
        return self.palms[k].position.x, self.palms[k].position.y

    def vertex(self, x: float) -> Point:
        at = self.thing.local_to_world((x - self.com[0], -self.com[1]))
        return at.x, at.y


class _Box2d:
    def __init__(self, body: _Body) -> None:
        with warnings.catch_warnings():  # its import would fail where warnings are errors
            warnings.simplefilter("ignore", DeprecationWarning)
            box2d: Any = importlib.import_module("Box2D")

        def large(points: list[Point]) -> list[Point]:
            return [(x * _SCALE, y * _SCALE) for x, y in points]

        self.world = box2d.b2World(gravity=(0, -_core.standard_gravity * _SCALE))
        self.palms = []
        for k in (0, 1):
            place = large([(body.pivots[k], body.height)])[0]
            palm = self.world.CreateKinematicBody(position=place, angle=body.angles[k])
            # Box2D uses the square root of the product of the coefficients.
            palm.CreatePolygonFixture(
                vertices=large(body.plate(k)), friction=body.spec.palms[k].friction
            )
            self.palms.append(palm)
        lifted = (body.start[0], body.start[1] + 0.002)
        self.thing = self.world.CreateDynamicBody(position=large([lifted])[0], angle=body.turn)
        self.thing.CreatePolygonFixture(vertices=large(body.hull), friction=1.0, density=1.0)
        for contact in [*self.palms, self.thing]:
            for fixture in contact.fixtures:
                fixture.friction = math.sqrt(fixture.friction) if contact is not self.thing else 1.0
        data = self.thing.massData
        data.mass, data.center = body.mass, large([body.com])[0]
        arm = body.com[0] ** 2 + body.com[1] ** 2
        data.I = (body.moment + body.mass * arm) * _SCALE**2  # about the body's origin
        self.thing.massData = data
        self.thing.sleepingAllowed = False

    def drive(self, speeds: tuple[float, float]) -> None:
        for palm, speed in zip(self.palms, speeds, strict=True):
            palm.linearVelocity = (speed * _SCALE, 0)

    def step(self) -> None:
        self.world.Step(_STEP, 20, 10)

    def palm(self, k: int) -> Point:
        return self.palms[k].position.x / _SCALE, self.palms[k].position.y / _SCALE

    def vertex(self, x: float) -> Point:
        at = self.thing.GetWorldPoint((x * _SCALE, 0))
        return at.x / _SCALE, at.y / _SCALE


ENGINES: dict[str, tuple[str, Callable[[_Body], _Engine]]] = {
    "pymunk": ("pymunk", _Pymunk),
    "Box2D": ("Box2D", _Box2d),
}
"""By name: the module to import, and the class that builds a scene in it."""


def engine_trials(
    name: str, scene: Scene, speed: float, ramp_s: float, push_s: float
) -> Iterator[tuple[bool, tuple[float, float]]]:
    """As `trials.run_trial`, in another engine: the slides of both contacts [m]."""
    for closing in (True, False):
        body = _Body(scene)
        engine = ENGINES[name][1](body)

        def contacts(engine: _Engine = engine, body: _Body = body) -> tuple[float, float]:
            slides = []
            for k, out in ((0, -1.0), (1, 1.0)):
                px, pz = engine.palm(k)
                x, z = engine.vertex(0.0 if k == 0 else body.spec.width)
                angle = body.angles[k]
                slides.append(out * ((x - px) * math.cos(angle) + (z - pz) * math.sin(angle)))
            return slides[0], slides[1]

        for _ in range(round(_SETTLE_S / _STEP)):
            engine.step()
        before = contacts()
        for tick in range(round((ramp_s + push_s) / _STEP)):
            half = 0.5 * speed * min(1.0, (tick + 1) * _STEP / ramp_s) * (1 if closing else -1)
            engine.drive((half, -half))
            engine.step()
        after = contacts()
        yield closing, (after[0] - before[0], after[1] - before[1])
