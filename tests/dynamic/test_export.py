"""`palmbots export`: files that other programs read, and that say the same."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palmbots import cli
from palmbots.dynamic.engine import mujoco
from palmbots.dynamic.model import mjcf
from palmbots.dynamic.urdf import robot_urdf
from palmbots.scene import load_scene
from palmbots.sections import SIDES, Side

mj = mujoco()
SCENE = load_scene("paper-offset", {"palm.left.steep_deg": 17.0, "dynamic.wheel_mismatch": 0.01})


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
    }
    for name, value in (("shoulder", 0.2), ("wrist", -0.15), ("wheel_port", 0.7)):
        data.joint(at_whole[name]).qpos[0] = value
        other.joint(name).qpos[0] = value
    mj.mj_forward(whole, data)
    mj.mj_forward(alone, other)
    base = data.body(f"{side}_body").xpos
    for link, body in (("arm", "arm"), ("palm", "palm"), ("wheel_port", "port")):
        one, two = data.body(f"{side}_{body}"), other.body(link)
        assert one.xpos - base == pytest.approx(two.xpos, abs=1e-6)
        assert one.xmat == pytest.approx(two.xmat, abs=1e-6)
        assert whole.body(f"{side}_{body}").mass == pytest.approx(alone.body(link).mass)
        assert inertia(whole, data, f"{side}_{body}") == pytest.approx(
            inertia(alone, other, link), rel=1e-5, abs=1e-9
        )


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
    told = json.loads(capsys.readouterr().out)
    assert status == 0
    assert (told["mjcf"], told["urdf"]) == (str(scene), str(robot))
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
    ("arguments", "told"),
    [
        ([], "--mjcf FILE, --urdf FILE or both"),
        (["--urdf", "x.urdf", "--robot", "middle"], "allowed: left, right"),
        (["--urdf", "same", "--mjcf", "same"], "another file"),
        (["--mjcf", "/no/such/folder/scene.xml"], "/no/such/folder/scene.xml: cannot be written"),
    ],
)
def test_bad_input_is_one_line(
    arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.run(["export", *arguments]) == 2
    ran = capsys.readouterr()
    assert ran.out == "" and ran.err.count("\n") == 1 and told in ran.err


def test_the_wrist_reaches_every_angle_that_a_scene_may_have() -> None:
    alone: Any = mj.MjModel.from_xml_string(robot_urdf(SCENE, "left"))
    low, high = alone.joint("wrist").range
    steep = math.radians(17.0)
    assert low + steep <= math.radians(-80) and high + steep >= math.radians(80)
