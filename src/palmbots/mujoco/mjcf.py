# SPDX-License-Identifier: Apache-2.0
"""The MJCF model of a scene: two wheeled robots with arm and palm, the object, the floor.

Frame: x forward (left robot to right one), y to the left of it, z up, metres, radians, kilogrammes;
the floor is z = 0 and x = 0 is halfway between the pivots. A slope tilts gravity, not the floor.
Each robot is a free body with two driven wheels and a caster, an arm with a shoulder joint that is
held, and a palm with a wrist joint. A wrist angle is 0 at the palm's first angle and > 0 outward,
on both sides. The initial state of the model is the start of the carry.

Contacts are explicit pairs of simple shapes, so every contact is a point that MuJoCo computes
exactly: the object touches palms with small balls, two on each of its edges, and palms touch the
object with two balls at each end. The visible shapes touch nothing.
"""

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import TypeAlias

import palmbots._core as _core
from palmbots._core import turn
from palmbots._types import SIDES, Side
from palmbots._util.xml_attributes import numbers, rgb, rgba
from palmbots.mujoco.engine_settings import DEFAULT, FLOOR, Contact, Engine
from palmbots.mujoco.robot_mjcf import TIP, add_robot, lifts, undersides
from palmbots.scene.extrusion import gyration
from palmbots.scene.placement import floor_level
from palmbots.scene.scene import Scene
from palmbots.scene.spec import contact_radii, to_spec
from palmbots.scene.surroundings import blocks_of
from palmbots.scene.unequal_pivots import raise_right_pivot
from palmbots.viz.solids import Prism
from palmbots.viz.style import BACKGROUND, OBJECT, QUIET, SKY, TILES, ZERO

Xz: TypeAlias = tuple[float, float]
Arc: TypeAlias = tuple[float, float, float]  # x, z, radius

_DEEP = 0.5  # m, across the path: of a half of a stand, and half of a wall
_SLAB = 0.004  # m, thickness of the plates along the lower edges of the object


@dataclass(frozen=True)
class Layout:
    """Positions and angles at the start [m], [rad]."""

    spec: _core.Spec
    height: float
    """Height of the pivots above the floor, if they are level."""
    raised: tuple[float, float]
    """Height of each pivot over that."""
    pivots: tuple[float, float]
    """Positions of the pivots along x."""
    vertex: tuple[float, float]
    """The left contact vertex, or the centre of its arc (x, z)."""
    turn: float
    """Angle of the object, anticlockwise as seen from the side."""

    @property
    def contact_vertices(self) -> tuple[int, int]:
        """The corner of the object on the left and on the right palm; a pipe has only one."""
        return 0, self.spec.contact_right if self.spec.width > 0 else 0


def layout(scene: Scene, pivot_heights_m: tuple[float, float] = (0.0, 0.0)) -> Layout:
    """The start of the quasistatic world: palms steep, contacts as in the scene.

    `pivot_heights_m`: of the pivots over where the scene has them.
    """
    spec = to_spec(scene, unrolled=True)
    if scene.task.ends[0] != "palms":
        return _standing(spec)
    height = -floor_level(spec)
    if lifts(scene):
        height = sum(scene.arm.of(side).carry_height_m for side in SIDES) / len(SIDES)
    tilted = to_spec(scene, unrolled=True)
    tilt = raise_right_pivot(tilted, pivot_heights_m[1] - pivot_heights_m[0])
    world = _core.World(tilted)
    half = world.separation * math.cos(tilt) / 2
    palm, p = spec.palms[0], spec.start[0]
    sin, cos = math.sin(palm.steep), math.cos(palm.steep)
    above = palm.offset + contact_radii(spec)[0]
    x = -half - p * cos + above * sin
    z = height + pivot_heights_m[0] + p * sin + above * cos
    dx, dy = world.contact_vector if spec.width > 0 else (1.0, 0.0)
    return Layout(spec, height, pivot_heights_m, (-half, half), (x, z), math.atan2(dy, dx) + tilt)


def _standing(spec: _core.Spec) -> Layout:
    """The start of a job whose object stands on the floor or on a stand."""
    ((left, height), (right, other)), (x, z) = _core.standing_start(spec)
    vertex = x - spec.com_left, z - spec.com_height
    return Layout(spec, height, (0.0, other - height), (left, right), vertex, 0.0)


def camera_height(scene: Scene) -> float:
    """Height at which cameras look at the pair [m]."""
    if lifts(scene):
        return 0.6 * max(scene.arm.of(side).carry_height_m for side in SIDES)
    return layout(scene).height - 0.04


def steps_per_tick(scene: Scene) -> int:
    """Number of integration steps in a control period, none longer than the step of the scene."""
    return max(1, math.ceil(scene.control.period_s / scene.mujoco.step_s - 1e-9))


def mjcf(
    scene: Scene, engine: Engine = DEFAULT, pivot_heights_m: tuple[float, float] = (0.0, 0.0)
) -> str:
    """The scene as the text of an MJCF file, which MuJoCo's viewer opens."""
    at = layout(scene, pivot_heights_m)
    root = ET.Element("mujoco", model="palmbots")
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    slope = math.atan(at.spec.slope)
    gravity = _core.standard_gravity
    ET.SubElement(
        root,
        "option",
        timestep=numbers(scene.control.period_s / steps_per_tick(scene)),
        gravity=numbers(-gravity * math.sin(slope), 0.0, -gravity * math.cos(slope)),
        cone=engine.cone,
        impratio=numbers(engine.impratio),
        integrator=engine.integrator,
        solver=engine.solver,
        noslip_iterations=str(engine.noslip),
    )
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "global", offwidth="1920", offheight="1080")
    ET.SubElement(visual, "headlight", ambient="0.4 0.4 0.4", diffuse="0.25 0.25 0.25")
    ET.SubElement(visual, "quality", offsamples="4", shadowsize="1024")
    ET.SubElement(visual, "map", znear="0.01", force="0.02")
    ET.SubElement(visual, "scale", contactwidth="0.03", contactheight="0.01", forcewidth="0.02")
    _default(root)
    assets = ET.SubElement(root, "asset")
    ET.SubElement(
        assets, "texture", name="grid", type="2d", builtin="checker", width="256", height="256",
        rgb1=rgb(TILES[0]), rgb2=rgb(TILES[1]),
    )  # fmt: skip
    ET.SubElement(
        assets, "texture", type="skybox", builtin="gradient", width="64", height="64",
        rgb1=rgb(BACKGROUND), rgb2=rgb(SKY),
    )  # fmt: skip
    ET.SubElement(
        assets, "material", name="floor", texture="grid", texrepeat="10 10", texuniform="true"
    )
    corners, faces = Prism(tuple(at.spec.silhouette), scene.object.depth_m).mesh()
    ET.SubElement(
        assets, "mesh", name="object", inertia="shell", smoothnormal="false",
        vertex=numbers(*(c for corner in corners for c in corner)),
        face=" ".join(str(i) for face in faces for i in face),
    )  # fmt: skip
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(
        world,
        "light",
        pos="0 -1 3",
        dir="0.2 0.4 -1",
        directional="true",
        castshadow="true",
        diffuse="0.45 0.45 0.45",
        specular="0 0 0",
    )
    ET.SubElement(world, "geom", name="floor", type="plane", size="0 0 1", material="floor")
    ridges = _ridges(world, scene)
    actuators = ET.Element("actuator")
    for k, side in enumerate(SIDES):
        add_robot(world, actuators, scene, side, at.pivots[k], at.height + at.raised[k])
    blocks = _blocks(world, at) if lifts(scene) else {}
    balls, slabs, stands = _object(world, scene, at, bool(blocks))
    contact = ET.SubElement(root, "contact")
    _floor_pairs(contact, scene, ["floor", *ridges])
    lips: dict[Side, tuple[str, ...]] = {
        side: tuple(f"{side}_lip_{end}" for end in ("port", "starboard"))
        for side in SIDES
        if scene.palm_of(side).lip_height_m > 0
    }
    _palm_pairs(contact, at, balls, slabs, lips, engine.lifting if lifts(scene) else engine.palm)
    if lifts(scene):
        _standing_pairs(contact, scene, stands, engine.lifting)
        for name, friction in blocks.items():
            for part in (*stands, *(slab.name for slab in slabs)):
                _pair(contact, name, part, 3, friction, engine.lifting)
            for side in SIDES if scene.task.dock == "alone" else ():  # noses end at walls
                for end in ("near", "far"):
                    _pair(contact, name, f"{side}_inner_{end}", 1, 0.0, engine.lifting)
    if lifts(scene) and scene.task.dock == "hand-over":
        _pair(contact, "left_nose_stop", "right_nose_stop", 1, 0.0, engine.lifting)
    root.append(actuators)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _default(root: ET.Element) -> None:
    """Defaults: shapes touch nothing and have no mass; bodies state their own inertia."""
    default = ET.SubElement(root, "default")
    ET.SubElement(default, "geom", contype="0", conaffinity="0", mass="0")
    touching = ET.SubElement(default, "default", {"class": "touch"})
    ET.SubElement(touching, "geom", group="3", rgba=rgba(ZERO, 0.6))


def _ridges(world: ET.Element, scene: Scene) -> list[str]:
    """The ridges across the floor: the tops of cylinders that lie in it."""
    sense = 1.0 if scene.task.direction == "forward" else -1.0
    names = []
    for k, ridge in enumerate(scene.mujoco.ridges):
        high = ridge.height_m
        radius = (ridge.length_m**2 / 4 + high**2) / (2 * high)
        names.append(f"ridge_{k + 1}")
        ET.SubElement(
            world, "geom", name=names[-1], type="capsule", size=numbers(radius, 0.4),
            pos=numbers(sense * ridge.at_m, 0.0, high - radius), rgba=rgba(QUIET),
            euler=numbers(math.pi / 2, 0.0, 0.0),
        )  # fmt: skip
    return names


def _blocks(world: ET.Element, at: Layout) -> dict[str, float]:
    """Walls and stands as boxes, which touch the object only; their friction by their names. A
    stand with a gap consists of two."""
    dx, dz = at.spec.com_left, at.spec.com_height
    com = at.vertex[0] + dx * math.cos(at.turn) - dz * math.sin(at.turn)
    frictions = {}
    for k, block in enumerate(blocks_of(at.spec)):
        low, high, tall = block.part(1.0, 1.0)
        gap = block.gap_m / 2
        halves = {"": (-_DEEP, _DEEP)}
        if gap > 0:
            halves = {"_starboard": (-gap - _DEEP, -gap), "_port": (gap, gap + _DEEP)}
        for half, (near, far) in halves.items():
            frictions[name := f"block_{k + 1}{half}"] = block.friction
            ET.SubElement(
                world, "geom", {"class": "touch"}, name=name, type="box",
                size=numbers((high - low) / 2, (far - near) / 2, tall / 2), group="0",
                rgba=rgba(QUIET), pos=numbers(com + (low + high) / 2, (near + far) / 2, tall / 2),
            )  # fmt: skip
    return frictions


@dataclass(frozen=True)
class _Ball:
    name: str
    along: float  # x in the object's frame
    height: float


@dataclass(frozen=True)
class _Slab:
    name: str
    low: float  # x of its two ends in the object's frame
    high: float
    height: float  # of its lower end
    faces_down: bool  # so that the end of a palm can touch it; else only a heel can


def _object(
    world: ET.Element, scene: Scene, at: Layout, has_walls: bool
) -> tuple[list[_Ball], list[_Slab], list[str]]:
    """The object, its frame at the left contact vertex; returns its contact shapes.

    A corner is a ball at each end of the palms: of the radius of its arc, or almost a point. On the
    floor it is a capsule across the depth of the object; its name is in the last list. With walls,
    high corners have one, too.
    """
    thing = scene.object
    body = ET.SubElement(
        world, "body", name="object", pos=numbers(at.vertex[0], 0.0, at.vertex[1]),
        euler=numbers(0.0, -at.turn, 0.0),
    )  # fmt: skip
    ET.SubElement(body, "freejoint", name="object")
    r2, m = gyration(at.spec.silhouette, thing.depth_m), thing.mass_kg
    ET.SubElement(
        body, "inertial", pos=numbers(at.spec.com_left, 0.0, at.spec.com_height), mass=numbers(m),
        fullinertia=numbers(m * r2.xx, m * r2.yy, m * r2.zz, 0.0, -m * r2.xz, 0.0),
    )  # fmt: skip
    ET.SubElement(body, "geom", name="object", type="mesh", mesh="object", rgba=rgba(OBJECT))
    ET.SubElement(
        body, "camera", name="side", mode="trackcom", pos="0.0 -1.0 0.15", xyaxes="1 0 0 0 0.15 1"
    )
    widest = max(scene.palm_of(side).width_m for side in SIDES)
    across = 0.49 * min(thing.depth_m, widest)
    reach = max(scene.palm_of(side).length_m for side in SIDES)
    balls, slabs, stands = [], [], []
    outline = [(x, z) for x, _, z, _ in at.spec.outline]
    arcs = at.spec.corners
    heel = max(scene.palm_of(side).heel_m for side in SIDES)
    following = [*range(1, len(outline)), 0] if len(arcs) > 1 else []  # a pipe has no edges
    for k, (x, z, radius) in enumerate(arcs):
        is_convex = turn(outline[k - 1], outline[k], outline[(k + 1) % len(outline)]) > 0
        is_low = z - radius <= reach / 2
        if not (is_low or has_walls) or not is_convex:
            continue
        for end, y in (("near", -across), ("far", across)) if is_low else ():
            balls.append(_Ball(f"vertex_{k}_{end}", x, z))
            ET.SubElement(
                body, "geom", {"class": "touch"}, name=balls[-1].name, type="sphere",
                size=numbers(radius + TIP), pos=numbers(x, y, z),
            )  # fmt: skip
        if lifts(scene):
            round_m = max(radius, TIP)
            stands.append(f"stand_{k}")
            ET.SubElement(
                body, "geom", {"class": "touch"}, name=stands[-1], type="capsule",
                size=numbers(round_m, thing.depth_m / 2 - round_m), pos=numbers(x, 0.0, z),
                euler=numbers(math.pi / 2, 0.0, 0.0),
            )  # fmt: skip
    for k, n in enumerate(following):
        (ax, az), (bx, bz) = _straight_part(outline[k], outline[n], arcs[k], arcs[n])
        long = math.hypot(bx - ax, bz - az)
        faces_down = bx - ax >= 0.01 * long
        faces_heel = heel > 0 and bx - ax > -0.5 * long
        # The edge has no straight part, faces away from the palms, or is too high.
        if long < 2 * TIP or not (faces_down or faces_heel) or min(az, bz) > reach / 2 + heel:
            continue
        inx, inz = -(bz - az) / long * _SLAB / 2, (bx - ax) / long * _SLAB / 2
        slabs.append(_Slab(f"edge_{k}", min(ax, bx), max(ax, bx), min(az, bz), faces_down))
        ET.SubElement(
            body, "geom", {"class": "touch"}, name=slabs[-1].name, type="box",
            size=numbers(long / 2, thing.depth_m / 2, _SLAB / 2),
            pos=numbers((ax + bx) / 2 + inx, 0.0, (az + bz) / 2 + inz),
            euler=numbers(0.0, -math.atan2(bz - az, bx - ax), 0.0),
        )  # fmt: skip
    return balls, slabs, stands


def _straight_part(a: Xz, b: Xz, before: Arc, after: Arc) -> tuple[Xz, Xz]:
    """The ends of the edge from a to b, without what the arcs at both ends take."""
    long = math.hypot(b[0] - a[0], b[1] - a[1])
    out = ((b[1] - a[1]) / long, -(b[0] - a[0]) / long)  # counter-clockwise
    (ax, az), (bx, bz) = ((x + r * out[0], z + r * out[1]) for x, z, r in (before, after))
    return (ax, az), (bx, bz)


def _pair(
    parent: ET.Element, one: str, other: str, condim: int, friction: float, contact: Contact
) -> None:
    ET.SubElement(
        parent, "pair", geom1=one, geom2=other, condim=str(condim),
        friction=numbers(friction, friction, 0.005, 0.0001, 0.0001),
        solref=numbers(*contact.solref), solimp=numbers(*contact.solimp),
    )  # fmt: skip


def _floor_pairs(parent: ET.Element, scene: Scene, floors: list[str]) -> None:
    for side in SIDES:
        for floor in floors:
            for wheel in ("port", "starboard"):
                _pair(parent, floor, f"{side}_{wheel}", 3, scene.mujoco.floor_friction, FLOOR)
            _pair(parent, floor, f"{side}_caster", 1, 0.0, FLOOR)


def _standing_pairs(parent: ET.Element, scene: Scene, stands: list[str], contact: Contact) -> None:
    """The contact pairs of the floor with the object and with the noses, which slide freely."""
    for stand in stands:
        _pair(parent, "floor", stand, 3, scene.floor.friction, contact)
    for side in SIDES:
        for name, *_ in undersides(scene.palm_of(side)):
            for end in ("near", "far"):
                _pair(parent, "floor", f"{side}_{name}_{end}", 1, 0.0, contact)


def _palm_pairs(
    parent: ET.Element,
    at: Layout,
    balls: list[_Ball],
    slabs: list[_Slab],
    lips: dict[Side, tuple[str, ...]],
    contact: Contact,
) -> None:
    """The contact pairs of object and palms."""
    for k, side in enumerate(SIDES):
        palm = at.spec.palms[k]
        foot = 0.0 if k == 0 else at.spec.width
        for ball in balls:
            if abs(ball.along - foot) < palm.length:
                _pair(parent, f"{side}_palm", ball.name, 3, palm.friction, contact)
                if palm.heel > 0:
                    _pair(parent, f"{side}_heel", ball.name, 3, palm.friction, contact)
        for slab in slabs:
            if slab.low - palm.length < foot < slab.high + palm.length:
                if palm.heel > 0:
                    _pair(parent, slab.name, f"{side}_heel", 3, palm.friction, contact)
                if not slab.faces_down:
                    continue
                for end in ("inner", "outer"):
                    for y in ("near", "far"):
                        _pair(parent, slab.name, f"{side}_{end}_{y}", 3, palm.friction, contact)
                for lip in lips.get(side, ()):
                    _pair(parent, slab.name, lip, 3, palm.friction, contact)
