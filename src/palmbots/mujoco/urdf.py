# SPDX-License-Identifier: Apache-2.0
"""URDF of one robot: body, two wheels, caster, arm and palm, with masses, inertias and limits.

The frame `base` is on the floor below the middle of the body: x forward, y to its left, z up, [m].
Joints are those of the MJCF (`robot_model`): wheels turn about y, shoulder and wrist are 0 where
the palm is steep and turn outward for > 0. URDF knows no friction of materials and no motors; what
it has is what a robot's own software needs.
"""

import math
import xml.etree.ElementTree as ET

from palmbots._types import Side
from palmbots._util.xml_attributes import numbers, rgba
from palmbots.mujoco.mjcf import layout
from palmbots.mujoco.robot_mjcf import (
    axle_out,
    box_inertia,
    chassis,
    wheel_inertia,
    wheel_kg,
    wheel_radius,
)
from palmbots.mujoco.settings import ARM
from palmbots.scene.robot_dimensions import (
    BODY_SIZE,
    CASTER_RADIUS,
    GROUND_CLEARANCE,
    PALM_THICKNESS,
    WHEEL_WIDTH,
)
from palmbots.scene.scene import Scene
from palmbots.viz.style import HUE, INK, PALE, QUIET

_EFFORT = {"wheel": 2.0, "shoulder": 10.0, "wrist": 5.0}  # N m; assumed


def robot_urdf(scene: Scene, side: Side) -> str:
    """The text of a URDF file of the robot of one side."""
    out = -1.0 if side == "left" else 1.0
    keys, palm = scene.mujoco, scene.palm_of(side)
    frame = chassis(layout(scene).height, axle_out(scene))
    root = ET.Element("robot", name=f"palmbot_{side}")
    base = ET.SubElement(root, "link", name="base")
    cube = 3 * (BODY_SIZE,)
    _inertial(base, keys.body_kg - 2 * wheel_kg(scene), (out * frame.com[0], 0.0, frame.com[1]),
              box_inertia(keys.body_kg, *cube))  # fmt: skip
    middle = (0.0, 0.0, GROUND_CLEARANCE + BODY_SIZE / 2)
    for kind in ("visual", "collision"):
        _shape(base, kind, middle, (0.0, 0.0, 0.0), ("box", {"size": numbers(*cube)}), PALE[side])
        _shape(base, kind, (out * frame.caster, 0.0, CASTER_RADIUS), (0.0, 0.0, 0.0),
               ("sphere", {"radius": numbers(CASTER_RADIUS)}), QUIET)  # fmt: skip

    fastest = scene.robot_of(side).max_speed_m_s / keys.wheel_radius_m
    for name, across in (("port", frame.track / 2), ("starboard", -frame.track / 2)):
        radius = wheel_radius(scene, name)
        wheel = ET.SubElement(root, "link", name=f"wheel_{name}")
        _inertial(wheel, wheel_kg(scene), (0.0, 0.0, 0.0), wheel_inertia(wheel_kg(scene), radius))
        disc = ("cylinder", {"radius": numbers(radius), "length": numbers(WHEEL_WIDTH)})
        for kind in ("visual", "collision"):
            _shape(wheel, kind, (0.0, 0.0, 0.0), (math.pi / 2, 0.0, 0.0), disc, INK)
        place = (out * frame.axle, across, radius)
        _joint(root, f"wheel_{name}", "continuous", "base", place, (0.0, 0.0, 0.0), (0.0, 1.0, 0.0),
               effort=_EFFORT["wheel"], velocity=fastest)  # fmt: skip

    x, z = frame.arm
    long, lean = math.hypot(x, z), math.atan2(z, out * x)
    arm = ET.SubElement(root, "link", name="arm")
    half = (out * x / 2, 0.0, z / 2)
    _inertial(arm, keys.arm_kg, half, box_inertia(keys.arm_kg, long, ARM, ARM), -lean)
    rod = ("box", {"size": numbers(long, 0.04 + ARM, ARM)})
    for kind in ("visual", "collision"):
        _shape(arm, kind, half, (0.0, -lean, 0.0), rod, QUIET)
    place = (out * frame.shoulder[0], 0.0, frame.shoulder[1])
    _joint(root, "arm", "revolute", "base", place, (0.0, 0.0, 0.0), (0.0, -out, 0.0),
           effort=_EFFORT["shoulder"], velocity=2.0, limits=(-0.5, 0.5),
           joint="shoulder")  # fmt: skip

    steep = math.radians(palm.steep_deg)
    plate = ET.SubElement(root, "link", name="palm")
    middle = (0.0, 0.0, palm.pivot_offset_m - PALM_THICKNESS / 2)
    size = (palm.length_m, palm.width_m, PALM_THICKNESS)
    _inertial(plate, keys.palm_kg, middle, box_inertia(keys.palm_kg, *size))
    for kind in ("visual", "collision"):
        _shape(plate, kind, middle, (0.0, 0.0, 0.0), ("box", {"size": numbers(*size)}), HUE[side])
    _joint(root, "palm", "revolute", "arm", (out * x, 0.0, z), (0.0, -out * steep, 0.0),
           (0.0, -out, 0.0), effort=_EFFORT["wrist"], velocity=math.radians(palm.rate_deg_s),
           limits=(math.radians(-85) - steep, math.radians(85) - steep), joint="wrist")  # fmt: skip
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _origin(parent: ET.Element, place: tuple[float, ...], turn: tuple[float, ...]) -> None:
    ET.SubElement(parent, "origin", xyz=numbers(*place), rpy=numbers(*turn))


def _inertial(
    link: ET.Element,
    mass: float,
    com: tuple[float, float, float],
    inertia: tuple[float, float, float],
    pitch: float = 0.0,
) -> None:
    part = ET.SubElement(link, "inertial")
    _origin(part, com, (0.0, pitch, 0.0))
    ET.SubElement(part, "mass", value=numbers(mass))
    names = dict(zip(("ixx", "iyy", "izz"), map(numbers, inertia), strict=True))
    ET.SubElement(part, "inertia", names | {"ixy": "0", "ixz": "0", "iyz": "0"})


def _shape(
    link: ET.Element,
    kind: str,
    place: tuple[float, float, float],
    turn: tuple[float, float, float],
    shape: tuple[str, dict[str, str]],
    colour: str,
) -> None:
    part = ET.SubElement(link, kind)
    _origin(part, place, turn)
    ET.SubElement(ET.SubElement(part, "geometry"), shape[0], shape[1])
    if kind == "visual":
        material = ET.SubElement(part, "material", name=f"colour_{colour[1:]}")
        ET.SubElement(material, "color", rgba=rgba(colour))


def _joint(
    root: ET.Element,
    child: str,
    kind: str,
    parent: str,
    place: tuple[float, float, float],
    turn: tuple[float, float, float],
    axis: tuple[float, float, float],
    *,
    effort: float,
    velocity: float,
    limits: tuple[float, float] | None = None,
    joint: str | None = None,
) -> None:
    one = ET.SubElement(root, "joint", name=joint or child, type=kind)
    _origin(one, place, turn)
    ET.SubElement(one, "parent", link=parent)
    ET.SubElement(one, "child", link=child)
    ET.SubElement(one, "axis", xyz=numbers(*axis))
    bounds = {"effort": numbers(effort), "velocity": numbers(velocity)}
    if limits is not None:
        bounds |= {"lower": numbers(limits[0]), "upper": numbers(limits[1])}
    ET.SubElement(one, "limit", bounds)
