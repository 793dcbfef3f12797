# SPDX-License-Identifier: Apache-2.0
"""The MJCF model of one robot: body on two wheels and a caster, arm, palm, and their motors.

`palmbots.scene.chassis` states where they are. The visible shapes are those of
`palmbots.viz.solids`; bodies state their mass and inertia.
"""

import math
import xml.etree.ElementTree as ET

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots._util.xml_attributes import numbers, rgba
from palmbots.mujoco.engine_settings import ARM, MAST, SHOULDER, WHEEL, WRIST, Servo
from palmbots.scene.chassis import Chassis, axle_out, chassis, wheel_kg
from palmbots.scene.mujoco_section import PALM_TORQUE
from palmbots.scene.palm_section import PalmParameters
from palmbots.scene.robot_dimensions import (
    BODY_SIZE,
    CASTER_RADIUS,
    WHEEL_WIDTH,
)
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.viz import solids
from palmbots.viz.style import HUE, INK, QUIET

NOSE_STOP = 0.0005  # m, radius of the shape that stops at the nose of the partner
LIP = 0.004  # m, thickness of the lips along the sides of a palm
TIP = 1e-4  # m, radius of the contact balls: almost a point
_SPARE = 0.01  # m, of an arm beyond its greatest height
STRONGEST_N = 1e4  # of the motor of an arm
_ORIGIN = (0.0, 0.0, 0.0)


def wheel_servo(scene: Scene) -> Servo:
    """Gains of the motor of one wheel, for half of the robot."""
    keys = scene.mujoco
    carried = keys.body_kg + keys.arm_kg + keys.palm_kg + 0.5 * scene.object.mass_kg
    inertia = 0.5 * carried * keys.wheel_radius_m**2 + WHEEL.armature
    return Servo(WHEEL.kp * inertia, WHEEL.kv * inertia, WHEEL.armature)


def wrist_servo(scene: Scene) -> Servo:
    """Gains of the motor of a palm: as stiff as the torque that it holds demands."""
    strength = scene.mujoco.palm_torque_n_m / PALM_TORQUE
    return Servo(WRIST.kp * strength, WRIST.kv * math.sqrt(strength), WRIST.armature)


def first_angle(scene: Scene, side: Side) -> float:
    """The angle of a palm where a carry or a job begins [rad]."""
    return _core.first_angles(to_spec(scene, unrolled=True))[SIDES.index(side)]


def arm_weight(scene: Scene) -> float:
    """The weight that an arm carries without the object [N]."""
    return (scene.mujoco.arm_kg + scene.mujoco.palm_kg) * _core.standard_gravity


def lifts(scene: Scene) -> bool:
    """Whether the arms of a scene rise and sink: its job begins or ends on the floor or on a
    stand."""
    return scene.task.ends != ("palms", "palms")


def box_inertia(mass: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """The diagonal of the inertia matrix of a box [kg m²]."""
    return (
        mass * (y * y + z * z) / 12,
        mass * (x * x + z * z) / 12,
        mass * (x * x + y * y) / 12,
    )


def add_robot(
    world: ET.Element, actuators: ET.Element, scene: Scene, side: Side, pivot: float, height: float
) -> None:
    """Add the robot of one side whose pivot is at x = `pivot` [m], `height` [m] above the floor."""
    out = -1.0 if side == "left" else 1.0
    keys, frame = scene.mujoco, chassis(height, axle_out(scene))
    body = ET.SubElement(
        world, "body", name=f"{side}_body", pos=numbers(pivot - out * frame.pivot[0], 0.0, 0.0)
    )
    ET.SubElement(body, "freejoint", name=f"{side}_body")
    ET.SubElement(
        body, "inertial", pos=numbers(out * frame.com[0], 0.0, frame.com[1]),
        mass=numbers(keys.body_kg - 2 * wheel_kg(scene)),
        diaginertia=numbers(*box_inertia(keys.body_kg, BODY_SIZE, BODY_SIZE, BODY_SIZE)),
    )  # fmt: skip
    _draw(body, solids.body(side, -height), (out * -frame.pivot[0], 0.0, -height), f"{side}_body")
    ET.SubElement(
        body, "geom", name=f"{side}_caster", type="sphere", size=numbers(CASTER_RADIUS),
        pos=numbers(out * frame.caster, 0.0, CASTER_RADIUS), rgba=rgba(QUIET),
    )  # fmt: skip
    _wheels(body, actuators, scene, side, out * frame.axle, frame.track)
    arm = _arm(body, actuators, scene, side, out, frame)
    _palm(arm, actuators, scene, side, out, frame)


def _wheels(
    body: ET.Element, actuators: ET.Element, scene: Scene, side: Side, axle: float, track: float
) -> None:
    """Two wheels: discs that touch the floor with a ball, in one point."""
    servo, mass = wheel_servo(scene), wheel_kg(scene)
    for name, across in (("port", track / 2), ("starboard", -track / 2)):
        radius = wheel_radius(scene, name)
        wheel = ET.SubElement(
            body, "body", name=f"{side}_{name}", pos=numbers(axle, across, radius)
        )
        joint = ET.SubElement(
            wheel, "joint", name=f"{side}_{name}", type="hinge", axis="0 1 0",
            armature=numbers(servo.armature),
        )  # fmt: skip
        force = scene.robot_of(side).force_limit_n
        if force is not None:
            most = 0.5 * force * radius
            joint.set("actuatorfrcrange", numbers(-most, most))
        ET.SubElement(
            wheel, "inertial", pos="0 0 0", mass=numbers(mass),
            diaginertia=numbers(*wheel_inertia(mass, radius)),
        )  # fmt: skip
        _draw(wheel, solids.wheel(side, _ORIGIN, radius), _ORIGIN)
        ET.SubElement(  # a mark that makes the rotation visible
            wheel, "geom", type="box", size=numbers(radius * 0.8, WHEEL_WIDTH / 2 + 0.001, 0.003),
            rgba=rgba(QUIET),
        )  # fmt: skip
        ET.SubElement(
            wheel, "geom", {"class": "touch"}, name=f"{side}_{name}", type="sphere",
            size=numbers(radius),
        )  # fmt: skip
        if abs(axle) > BODY_SIZE / 2 + radius:  # the wheel is beside the body: a fork holds it
            inner = math.copysign(BODY_SIZE / 2, axle)
            ET.SubElement(
                body, "geom", type="box", rgba=rgba(QUIET),
                size=numbers(abs(axle - inner) / 2 + 0.008, 0.004, 0.008),
                pos=numbers((axle + inner) / 2, across - math.copysign(0.016, across), radius),
            )  # fmt: skip
        _drive(actuators, f"{side}_{name}", servo)


def _arm(
    body: ET.Element, actuators: ET.Element, scene: Scene, side: Side, out: float, frame: Chassis
) -> ET.Element:
    x, z = frame.arm
    mass = scene.mujoco.arm_kg
    arm = ET.SubElement(
        body,
        "body",
        name=f"{side}_arm",
        pos=numbers(out * frame.shoulder[0], 0.0, frame.shoulder[1]),
    )
    if lifts(scene):
        # The whole arm slides. It could sink until its pivot is on the floor.
        top = scene.arm.of(side).carry_height_m + scene.arm.of(side).height_error_m
        ET.SubElement(
            arm, "joint", name=f"{side}_arm", type="slide", axis="0 0 1",
            armature=numbers(MAST.armature),
            range=numbers(-frame.pivot[1], top - frame.pivot[1] + _SPARE),
        )  # fmt: skip
        _mast(body, out * frame.shoulder[0], frame.shoulder[1] + top - frame.pivot[1])
        height = _drive(actuators, f"{side}_arm", MAST, arm_weight(scene))
        height.set("forcerange", numbers(-STRONGEST_N, STRONGEST_N))
    else:
        ET.SubElement(
            arm, "joint", name=f"{side}_shoulder", type="hinge", axis=numbers(0.0, -out, 0.0),
            armature=numbers(SHOULDER.armature),
        )  # fmt: skip
        ET.SubElement(
            actuators, "position", name=f"{side}_shoulder", joint=f"{side}_shoulder",
            kp=numbers(SHOULDER.kp), kv=numbers(SHOULDER.kv),
        )  # fmt: skip
    lean, long = math.atan2(z, out * x), math.hypot(x, z)
    ET.SubElement(
        arm, "inertial", pos=numbers(out * x / 2, 0.0, z / 2), mass=numbers(mass),
        euler=numbers(0.0, -lean, 0.0), diaginertia=numbers(*box_inertia(mass, long, ARM, ARM)),
    )  # fmt: skip
    begins_x, begins_z = solids.shoulder(side, -frame.pivot[1])
    for bar in solids.arm(side, -frame.pivot[1]):
        _draw(arm, bar, (begins_x, 0.0, begins_z))
    return arm


def _mast(body: ET.Element, x: float, top: float) -> None:
    """Draw the bar along which an arm slides."""
    ET.SubElement(
        body, "geom", type="box", rgba=rgba(QUIET), size=numbers(ARM / 2, ARM / 2, top / 2),
        pos=numbers(x, 0.0, top / 2),
    )  # fmt: skip


def _palm(
    arm: ET.Element, actuators: ET.Element, scene: Scene, side: Side, out: float, frame: Chassis
) -> None:
    """The plate; the model has it at the angle at which it begins; the wrist angle is 0 there."""
    palm, mass = scene.palm_of(side), scene.mujoco.palm_kg
    first = first_angle(scene, side)
    body = ET.SubElement(
        arm, "body", name=f"{side}_palm", pos=numbers(out * frame.arm[0], 0.0, frame.arm[1]),
        euler=numbers(0.0, -out * first, 0.0),
    )  # fmt: skip
    ET.SubElement(
        body, "joint", name=f"{side}_wrist", type="hinge", axis=numbers(0.0, -out, 0.0),
        armature=numbers(WRIST.armature),
    )  # fmt: skip
    half, wide, offset = palm.length_m / 2, palm.width_m / 2, palm.pivot_offset_m
    thick = palm.plate_m
    middle = (0.0, 0.0, offset - thick / 2)
    ET.SubElement(
        body, "inertial", pos=numbers(*middle), mass=numbers(mass),
        diaginertia=numbers(*box_inertia(mass, 2 * half, 2 * wide, thick)),
    )  # fmt: skip
    for solid, name in zip(solids.plate(side, palm), ("plate", "stop"), strict=False):
        _draw(body, solid, _ORIGIN, f"{side}_{name}")
    # The contact plate is thicker, so that no shape can pass through it, and lies lower by the
    # radius of a ball, so that a vertex is on the surface of the palm when its ball touches. It is
    # wider, too: MuJoCo pushes a ball that is inside a box out through the nearest face, and for a
    # ball near the side of the palm a heavy object would make that the side.
    deep = 0.02
    ET.SubElement(
        body, "geom", {"class": "touch"}, name=f"{side}_palm", type="box",
        rgba=rgba(HUE[side], 0.0), size=numbers(half, wide + deep, deep / 2),
        pos=numbers(0.0, 0.0, offset - TIP - deep / 2),
    )  # fmt: skip
    for end, x in (("inner", -out * half), ("outer", out * half)):
        for name, y in (("near", -0.98 * wide), ("far", 0.98 * wide)):
            ET.SubElement(
                body, "geom", {"class": "touch"}, name=f"{side}_{end}_{name}", type="sphere",
                size=numbers(TIP), pos=numbers(x, y, offset - TIP),
            )  # fmt: skip
    if lifts(scene):
        for name, along, below in undersides(palm):
            for end, y in (("near", -0.98 * wide), ("far", 0.98 * wide)):
                ET.SubElement(
                    body, "geom", {"class": "touch"}, name=f"{side}_{name}_{end}", type="sphere",
                    size=numbers(TIP), pos=numbers(out * along, y, offset - below + TIP),
                )  # fmt: skip
    if scene.task.dock == "hand-over":
        # Noses that meet stop each other. They are thin, so a taller shape stands for each; it is
        # round, and its axis is the edge of the nose, so that it presses along the floor.
        ET.SubElement(
            body, "geom", {"class": "touch"}, name=f"{side}_nose_stop", type="capsule",
            size=numbers(NOSE_STOP, wide), euler=numbers(math.pi / 2, 0.0, 0.0),
            pos=numbers(-out * half, 0.0, offset),
        )  # fmt: skip
    if palm.heel_m > 0:
        high = palm.heel_m / 2
        ET.SubElement(
            body, "geom", {"class": "touch"}, name=f"{side}_heel", type="box",
            rgba=rgba(HUE[side], 0.0), size=numbers(deep / 2, wide + deep, high),
            pos=numbers(out * (half + TIP + deep / 2), 0.0, offset + high),
        )  # fmt: skip
    if palm.lip_height_m > 0:
        high = palm.lip_height_m / 2
        for name, y in (("starboard", -wide - LIP / 2), ("port", wide + LIP / 2)):
            ET.SubElement(
                body, "geom", {"class": "touch"}, name=f"{side}_lip_{name}", type="box",
                size=numbers(half, LIP / 2, high), pos=numbers(0.0, y, offset + high),
                rgba=rgba(HUE[side], 0.5), group="1",
            )  # fmt: skip
    ET.SubElement(body, "site", name=f"{side}_pivot", size="0.004", rgba=rgba(INK), group="1")
    _drive(actuators, f"{side}_wrist", wrist_servo(scene))


def undersides(palm: PalmParameters) -> list[tuple[str, float, float]]:
    """Where the lower side of a plate can touch the floor: its inner end, and the outer edge of its
    bevel. Name, place outward of the foot of the pivot and distance below the surface [m]."""
    tip = palm.thickness_m if palm.nose_m is None else min(palm.nose_m, palm.thickness_m)
    half = palm.length_m / 2
    bevel = [("bevel", palm.bevel_m - half, palm.thickness_m)] if palm.bevel_m > 0 else []
    return [("nose", -half, tip), *bevel]


def _drive(actuators: ET.Element, joint: str, servo: Servo, constant: float = 0.0) -> ET.Element:
    """A motor that follows a speed command and holds its integral: two actuators, one command.

    `constant`: a force that it exerts always. Returns the first of them.
    """
    held = ET.SubElement(
        actuators, "general", name=f"{joint}_angle", joint=joint, dyntype="integrator",
        gainprm=numbers(servo.kp), biastype="affine", biasprm=numbers(constant, -servo.kp, 0.0),
    )  # fmt: skip
    ET.SubElement(actuators, "velocity", name=f"{joint}_speed", joint=joint, kv=numbers(servo.kv))
    return held


def _draw(body: ET.Element, solid: solids.Solid, origin: solids.Vector, name: str = "") -> None:
    """Add a visible solid to a body whose origin is there in the frame of the solid."""
    shape = solid.shape
    if isinstance(shape, solids.Box):
        kind, size = "box", [edge / 2 for edge in shape.size]
        turn = (0.0, -shape.turn, 0.0)
    else:
        assert isinstance(shape, solids.Cylinder)
        kind, size, turn = "cylinder", [shape.radius, shape.length / 2], (math.pi / 2, 0.0, 0.0)
    place = (a - b for a, b in zip(shape.centre, origin, strict=True))
    ET.SubElement(
        body, "geom", {"name": name} if name else {}, type=kind, size=numbers(*size),
        pos=numbers(*place), euler=numbers(*turn), rgba=rgba(solid.colour),
    )  # fmt: skip


def wheel_radius(scene: Scene, name: str) -> float:
    """Radius of the left (``port``) or right (``starboard``) wheel of a robot [m]."""
    error = 0.5 * scene.mujoco.wheel_radius_mismatch * (1 if name == "port" else -1)
    return scene.mujoco.wheel_radius_m * (1 + error)


def wheel_inertia(mass: float, radius: float) -> tuple[float, float, float]:
    """The inertia of a disc with its axle along y [kg m²]."""
    across = mass * (3 * radius**2 + WHEEL_WIDTH**2) / 12
    return across, mass * radius**2 / 2, across
