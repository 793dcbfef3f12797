# SPDX-License-Identifier: Apache-2.0
"""`palmbots export`: files that other programs read, and that say the same."""

import json
import math
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palmbots._types import SIDES, Side
from palmbots.cli import main as cli
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.mjcf import mjcf
from palmbots.mujoco.urdf import robot_urdf
from palmbots.pair.ros2_keys import Ros2Table
from palmbots.scene.scene import load_scene

mj = mujoco()
SCENE = load_scene(
    "paper-offset", {"palm.left.steep_deg": 17.0, "mujoco.wheel_radius_mismatch": 0.01}
)


def turned(side: Side) -> np.ndarray:
    """From the frame of the MJCF to that of the URDF, whose x axis points to the partner."""
    return np.diag([-1.0, -1.0, 1.0]) if side == "right" else np.eye(3)


@pytest.mark.parametrize("side", SIDES)
def test_urdf_and_mjcf_describe_the_same_robot(side: Side) -> None:
    """MuJoCo reads both; the robot's masses, inertia and places agree, at any joint angles."""
    whole: Any = mj.MjModel.from_xml_string(mjcf(SCENE))
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, side))
    data, other = mj.MjData(whole), mj.MjData(alone)
    way = turned(side)
    steep = math.radians(SCENE.palm_of(side).steep_deg)
    forward = 1 if side == "left" else -1
    port, starboard = SIDES if side == "left" else SIDES[::-1]
    wheels = {"left": "wheel_port", "right": "wheel_starboard"}
    angles = {
        ("shoulder", "arm"): (0.2, 0.2),
        ("wrist", "palm"): (-0.15, steep - 0.15),
        ("port", wheels[port]): (0.7, 0.7 * forward),
        ("starboard", wheels[starboard]): (-0.4, -0.4 * forward),
    }
    for (name, link), (angle, urdf_angle) in angles.items():
        data.joint(f"{side}_{name}").qpos[0] = angle
        other.joint(f"{link}_joint").qpos[0] = urdf_angle
    mj.mj_forward(whole, data)
    mj.mj_forward(alone, other)
    base = data.body(f"{side}_body").xpos
    bodies = {"shoulder": "arm", "wrist": "palm"}
    for joint, link in angles:
        body = bodies.get(joint, joint)
        one, two = data.body(f"{side}_{body}"), other.body(f"{link}_link")
        assert way @ (one.xpos - base) == pytest.approx(two.xpos, abs=1e-6)
        assert way @ one.xmat.reshape(3, 3) @ way == pytest.approx(two.xmat.reshape(3, 3), abs=1e-6)
        mass = alone.body(f"{link}_link").mass
        assert whole.body(f"{side}_{body}").mass == pytest.approx(mass)
        assert way @ inertia(whole, data, f"{side}_{body}") @ way == pytest.approx(
            inertia(alone, other, f"{link}_link"), rel=1e-5, abs=1e-9
        )


@pytest.mark.parametrize("side", SIDES)
def test_the_base_of_the_urdf_is_the_body_of_the_mjcf(side: Side) -> None:
    """MuJoCo fuses a URDF's base with the world, so its numbers are read from the text."""
    whole: Any = mj.MjModel.from_xml_string(mjcf(SCENE))
    root = ET.fromstring(robot_urdf(SCENE, side))
    part = root.find("link[@name='base_link']/inertial")
    assert part is not None
    inertial = {child.tag: child.attrib for child in part}
    body = whole.body(f"{side}_body")
    assert float(inertial["mass"]["value"]) == pytest.approx(body.mass[0])
    place = [float(x) for x in inertial["origin"]["xyz"].split()]
    assert place == pytest.approx(turned(side) @ body.ipos)
    moments = [float(inertial["inertia"][n]) for n in ("ixx", "iyy", "izz")]
    assert moments == pytest.approx(body.inertia)
    caster = root.find("link[@name='base_link']/collision/geometry/sphere/../../origin")
    assert caster is not None
    place = [float(x) for x in caster.attrib["xyz"].split()]
    assert place == pytest.approx(turned(side) @ whole.geom(f"{side}_caster").pos)
    fastest = root.find("joint[@name='wheel_port_joint']/limit")
    assert fastest is not None
    keys = SCENE.robot_of(side).max_speed_m_s, SCENE.mujoco.wheel_radius_m
    assert float(fastest.attrib["velocity"]) == pytest.approx(keys[0] / keys[1])


@pytest.mark.parametrize("side", SIDES)
def test_names_and_angles_are_those_of_ros_2(side: Side) -> None:
    """What `palmbots ros2` publishes by default moves this robot."""
    table = Ros2Table()
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, side))
    links = {link.get("name") for link in ET.fromstring(robot_urdf(SCENE, side)).iter("link")}
    assert {"base_link", "palm_link"} <= links
    data: Any = mj.MjData(alone)
    data.joint(table.palm_joint).qpos[0] = math.radians(15)
    mj.mj_forward(alone, data)
    normal = data.body("palm_link").xmat.reshape(3, 3)[:, 2]
    assert table.front == "partner"
    assert normal == pytest.approx([math.sin(math.radians(15)), 0, math.cos(math.radians(15))])


def inertia(model: Any, data: Any, body: str) -> np.ndarray:
    """A body's matrix of inertia in the world's frame [kg m²]."""
    turned = data.body(body).ximat.reshape(3, 3)
    return turned @ np.diag(model.body(body).inertia) @ turned.T


def test_the_command_writes_both(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene, robot = tmp_path / "scene.xml", tmp_path / "robot.urdf"
    status = cli.run(
        ["export", "--mjcf", str(scene), "--urdf", str(robot), "--robot", "right", "--json",
         "--set", "object=tray"]
    )  # fmt: skip
    result = json.loads(capsys.readouterr().out)
    assert status == 0
    assert (result["mjcf"], result["urdf"]) == (str(scene), str(robot))
    model: Any = mj.MjModel.from_xml_path(str(scene))
    assert model.body("object").mass[0] == pytest.approx(0.4)
    assert model.nu == 14
    data: Any = mj.MjData(model)
    for _ in range(500):  # without a controller everything stays where it is
        mj.mj_step(model, data)
    assert data.body("object").xpos[2] > 0.2
    assert np.abs(data.qvel).max() < 1e-3
    assert '<robot name="palmbot_right">' in robot.read_text()


def test_wrist_reaches_every_angle_of_a_valid_scene() -> None:
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, "left"))
    low, high = alone.joint("palm_joint").range
    assert low <= math.radians(-80) and high >= math.radians(80)
