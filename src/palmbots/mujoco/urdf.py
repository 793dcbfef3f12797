# SPDX-License-Identifier: Apache-2.0
"""URDF of one robot, translated from its part of the MJCF model (`palmbots.mujoco.robot_mjcf`).

Links and joints have the names that `palmbots ros2` publishes. The frame `base_link` is on the
floor below the middle of the body: x points to the partner, y to the left of that, z up, [m]. The
position of `palm_joint` is the palm's angle over the horizontal; the arm's is 0 where the model
holds it. Wheels turn forward for > 0. URDF knows no friction of materials and no motors; what it
has is what a robot's own software needs.
"""

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable

from palmbots._types import Side
from palmbots._util.xml_attributes import numbers
from palmbots.mujoco.mjcf import layout
from palmbots.mujoco.robot_mjcf import add_robot
from palmbots.scene.scene import Scene

_STEEPEST = math.radians(85)
Vector = tuple[float, ...]


def robot_urdf(scene: Scene, side: Side) -> str:
    """The text of a URDF file of the robot of one side."""
    keys = scene.mujoco
    fastest = scene.robot_of(side).max_speed_m_s / keys.wheel_radius_m
    # Type, greatest effort [N m] (assumed) and speed [rad/s], and limits of each joint.
    wheel = ("continuous", 2.0, fastest, None)
    joints = {
        "wheel_port": wheel,
        "wheel_starboard": wheel,
        "arm": ("revolute", 10.0, 2.0, (-0.5, 0.5)),
        "palm": ("revolute", 5.0, math.radians(scene.palm_of(side).rate_deg_s),
                 (-_STEEPEST, _STEEPEST)),
    }  # fmt: skip
    model = ET.Element("worldbody")
    add_robot(model, ET.Element("actuator"), scene, side, 0.0, layout(scene).height)
    root = ET.Element("robot", name=f"palmbot_{side}")
    # The x axis of the model points to the right robot, for both.
    half_turn = -1.0 if side == "right" else 1.0
    wheels = ("starboard", "port") if side == "right" else ("port", "starboard")
    own = {"body": "base", wheels[0]: "wheel_port", wheels[1]: "wheel_starboard"}

    def turned(text: str) -> Vector:
        x, y, z = map(float, text.split())
        return half_turn * x, half_turn * y, z

    def add(body: ET.Element, parent: str | None) -> None:
        name = body.attrib["name"].removeprefix(f"{side}_")
        name = own.get(name, name)
        link = ET.SubElement(root, "link", name=f"{name}_link")
        for inertial in body.findall("inertial"):
            part = ET.SubElement(link, "inertial")
            _origin(part, turned(inertial.attrib["pos"]), turned(inertial.get("euler", "0 0 0")))
            ET.SubElement(part, "mass", value=inertial.attrib["mass"])
            moments = inertial.attrib["diaginertia"].split()
            names = dict(zip(("ixx", "iyy", "izz"), moments, strict=True))
            ET.SubElement(part, "inertia", names | {"ixy": "0", "ixz": "0", "iyz": "0"})
        for kind in ("visual", "collision"):
            for geom in body.findall("geom"):
                if geom.get("class") != "touch":
                    _add_shape(ET.SubElement(link, kind), geom, turned)
        if parent is not None:
            kind, effort, velocity, limits = joints[name]
            one = ET.SubElement(root, "joint", name=f"{name}_joint", type=kind)
            # The model's palm is at its steep angle where its joint is at 0.
            _origin(one, turned(body.attrib["pos"]), (0.0, 0.0, 0.0))
            ET.SubElement(one, "parent", link=f"{parent}_link")
            ET.SubElement(one, "child", link=f"{name}_link")
            ET.SubElement(one, "axis", xyz="0 1 0")  # all of them, towards the partner
            bounds = {"effort": numbers(effort), "velocity": numbers(velocity)}
            if limits is not None:
                bounds |= {"lower": numbers(limits[0]), "upper": numbers(limits[1])}
            ET.SubElement(one, "limit", bounds)
        for child in body.findall("body"):
            add(child, name)

    add(model[0], None)
    ET.indent(root)
    return '<?xml version="1.0"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _origin(parent: ET.Element, place: Vector, turn: Vector) -> None:
    ET.SubElement(parent, "origin", xyz=numbers(*place), rpy=numbers(*turn))


def _add_shape(part: ET.Element, geom: ET.Element, turned: Callable[[str], Vector]) -> None:
    """A shape of the model; no shape there is rotated about more than one axis."""
    kind, size = geom.attrib["type"], [float(value) for value in geom.attrib["size"].split()]
    place, turn = turned(geom.get("pos", "0 0 0")), turned(geom.get("euler", "0 0 0"))
    shape = {
        "box": lambda: {"size": numbers(*(2 * edge for edge in size))},
        "sphere": lambda: {"radius": numbers(size[0])},
        "cylinder": lambda: {"radius": numbers(size[0]), "length": numbers(2 * size[1])},
    }
    _origin(part, place, turn)
    ET.SubElement(ET.SubElement(part, "geometry"), kind, shape[kind]())
    if part.tag == "visual":
        colour = geom.attrib["rgba"]
        material = ET.SubElement(part, "material", name=f"colour_{colour.replace(' ', '_')}")
        ET.SubElement(material, "color", rgba=colour)
