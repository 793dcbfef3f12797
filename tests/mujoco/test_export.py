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
from palmbots.scene.scene import load_scene

mj = mujoco()
SCENE = load_scene(
    "paper-offset", {"palm.left.steep_deg": 17.0, "mujoco.wheel_radius_mismatch": 0.01}
)


@pytest.mark.parametrize("side", SIDES)
def test_urdf_and_mjcf_describe_the_same_robot(side: Side) -> None:
    """MuJoCo reads both; the robot's masses, inertia and places agree, at any joint angles."""
    whole: Any = mj.MjModel.from_xml_string(mjcf(SCENE))
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, side))
    data, other = mj.MjData(whole), mj.MjData(alone)
    at_whole = {
        "shoulder": f"{side}_shoulder",
        "wrist": f"{side}_wrist",
        "wheel_port": f"{side}_port",
        "wheel_starboard": f"{side}_starboard",
    }
    angles = {"shoulder": 0.2, "wrist": -0.15, "wheel_port": 0.7, "wheel_starboard": -0.4}
    for name, value in angles.items():
        data.joint(at_whole[name]).qpos[0] = value
        other.joint(name).qpos[0] = value
    mj.mj_forward(whole, data)
    mj.mj_forward(alone, other)
    base = data.body(f"{side}_body").xpos
    links = ("arm", "palm", "wheel_port", "wheel_starboard")
    for link, body in ((link, link.removeprefix("wheel_")) for link in links):
        one, two = data.body(f"{side}_{body}"), other.body(link)
        assert one.xpos - base == pytest.approx(two.xpos, abs=1e-6)
        assert one.xmat == pytest.approx(two.xmat, abs=1e-6)
        assert whole.body(f"{side}_{body}").mass == pytest.approx(alone.body(link).mass)
        assert inertia(whole, data, f"{side}_{body}") == pytest.approx(
            inertia(alone, other, link), rel=1e-5, abs=1e-9
        )


@pytest.mark.parametrize("side", SIDES)
def test_the_base_of_the_urdf_is_the_body_of_the_mjcf(side: Side) -> None:
    """MuJoCo fuses a URDF's base with the world, so its numbers are read from the text."""
    whole: Any = mj.MjModel.from_xml_string(mjcf(SCENE))
    root = ET.fromstring(robot_urdf(SCENE, side))
    part = root.find("link[@name='base']/inertial")
    assert part is not None
    inertial = {child.tag: child.attrib for child in part}
    body = whole.body(f"{side}_body")
    assert float(inertial["mass"]["value"]) == pytest.approx(body.mass[0])
    assert [float(x) for x in inertial["origin"]["xyz"].split()] == pytest.approx(body.ipos)
    moments = [float(inertial["inertia"][n]) for n in ("ixx", "iyy", "izz")]
    assert moments == pytest.approx(body.inertia)
    caster = root.find("link[@name='base']/collision/geometry/sphere/../../origin")
    assert caster is not None
    place = [float(x) for x in caster.attrib["xyz"].split()]
    assert place == pytest.approx(whole.geom(f"{side}_caster").pos)
    fastest = root.find("joint[@name='wheel_port']/limit")
    assert fastest is not None
    keys = SCENE.robot_of(side).max_speed_m_s, SCENE.mujoco.wheel_radius_m
    assert float(fastest.attrib["velocity"]) == pytest.approx(keys[0] / keys[1])


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


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--mjcf FILE, --urdf FILE or both"),
        (["--urdf", "x.urdf", "--robot", "middle"], "allowed: left, right"),
        (["--urdf", "same", "--mjcf", "same"], "another file"),
        (["--mjcf", "/no/such/folder/scene.xml"], "/no/such/folder/scene.xml: cannot be written"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["export", *arguments]) == 2
    ran = capsys.readouterr()
    assert ran.out == "" and ran.err.count("\n") == 1 and message in ran.err


def test_wrist_reaches_every_angle_of_a_valid_scene() -> None:
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, "left"))
    low, high = alone.joint("wrist").range
    steep = math.radians(17.0)
    assert low + steep <= math.radians(-80) and high + steep >= math.radians(80)
