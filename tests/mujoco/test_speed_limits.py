# SPDX-License-Identifier: Apache-2.0
"""How hard and how fast the pair may go: the dynamic world against closed forms."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from scipy.optimize import linprog

import palmbots as pb
from json_output import read_json
from palmbots.cli import main as cli
from palmbots.mujoco.validation import speed_limits as speed
from palmbots.mujoco.validation import trials
from palmbots.mujoco.validation.speed_limits import slides_under
from palmbots.mujoco.validation.trials import State
from palmbots.scene.scene import Scene, load_scene


def test_acceleration_acts_like_a_slope() -> None:
    """An acceleration a and a floor whose slope has the tangent a / g: the same squeezes."""
    scene = trials.scene_of(Scene(), State(0.3, 0.125, (5.0, 15.0), (0.0, 0.0)))
    flat = trials.spec_of(scene)
    for degrees in (-12.0, -3.0, 3.0, 8.0, 14.0):
        sloped = trials.spec_of(load_scene(scene, {"task.slope_deg": degrees}))
        for closing in (True, False):
            same = slides_under(flat, closing, 9.80665 * sloped.slope)
            assert same == trials.expected(sloped, closing)
    assert flat.slope == 0.0  # as it was


def held(friction: float, angles_deg: tuple[float, float], acceleration: float) -> bool:
    """By a linear program over the friction cones: any forces that accelerate the box?"""
    columns = []
    for at, out, angle in ((0.0, -1.0, angles_deg[0]), (0.25, 1.0, angles_deg[1])):
        a = np.radians(angle)
        along = np.array([out * np.cos(a), np.sin(a)])
        normal = np.array([-out * np.sin(a), np.cos(a)])
        for edge in (-1.0, 1.0):
            f = normal + edge * friction * along
            arm = np.array([at - 0.125, -0.04])
            columns.append([*f, arm[0] * f[1] - arm[1] * f[0]])
    wanted = np.array([acceleration, 9.80665, 0.0])
    found = linprog(np.zeros(4), A_eq=np.array(columns).T, b_eq=wanted, bounds=[(0, None)] * 4)
    return bool(found.status == 0)


@pytest.mark.parametrize("friction", [0.15, 0.3, 0.4])
def test_accelerating_ends_where_no_forces_hold_the_object(friction: float) -> None:
    limit = speed._limit(Scene(), friction, True, True)
    assert limit.known is not None
    assert held(friction, (5.0, 15.0), limit.known - 0.02)
    assert not held(friction, (5.0, 15.0), limit.known + 0.02)


@pytest.mark.parametrize(
    ("friction", "closing", "forward"),
    [(0.15, True, True), (0.3, True, False), (0.3, False, False), (0.4, False, True)],
)
def test_the_dynamic_world_departs_where_the_closed_form_says(
    friction: float, closing: bool, forward: bool
) -> None:
    limit = speed._limit(Scene(), friction, closing, forward)
    assert limit.known is not None and limit.seen is not None
    assert limit.seen == pytest.approx(limit.known, abs=0.3)
    assert limit.slides == ("left" if closing else "right")


def test_limit_beyond_the_search_range_is_none() -> None:
    assert speed._edge(lambda _: True, 0.5, 5) is None
    assert speed._edge(lambda a: a < 1.234, 0.5, 20) == pytest.approx(1.234, abs=1e-5)
    # What is the same again further on does not hide the first edge.
    assert speed._edge(lambda a: not 1.0 < a < 2.0, 0.4, 20) == pytest.approx(1.0, abs=1e-5)


def remembered(limit: Callable[..., speed.Limit]) -> Callable[..., speed.Limit]:
    """The same function, which searches for each limit once."""
    found: dict[Any, speed.Limit] = {}

    def once(base: Scene, *cell: Any) -> speed.Limit:
        if cell not in found:
            found[cell] = limit(base, *cell)
        return found[cell]

    return once


@pytest.mark.slow
def test_the_command_reports_and_draws(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(speed, "FRICTIONS", (0.3,))
    monkeypatch.setattr(speed, "FACTORS", (1.0, 4.0))
    monkeypatch.setattr(speed, "_limit", remembered(speed._limit))
    short = ["--set", "task.distance_m=0.3", "--carries", "1"]
    assert cli.run(["speed-limits", *short, "--out", str(tmp_path), "--json"]) == 0
    result: dict[str, Any] = read_json("speed-limits", capsys.readouterr().out)
    assert len(result["limits"]) == 4 and len(result["paces"]) == 2
    assert result["paces"][1]["speed_m_s"] == pytest.approx(0.24)
    assert result["max_acceleration_m_s2"] == pb.analyze("paper").max_acceleration_m_s2
    with Image.open(tmp_path / "speed.png") as picture:
        assert picture.width > 1000
        assert len(picture.convert("RGB").getcolors(1 << 20) or ()) > 50
    assert cli.run(["speed-limits", *short]) == 0
    printed = capsys.readouterr().out
    assert "closed form" in printed and "0.24 m/s" in printed
