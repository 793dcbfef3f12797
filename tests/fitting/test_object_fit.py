# SPDX-License-Identifier: Apache-2.0
"""Object and palms from logs of simulated carries: hidden values are found again."""

import math
import tomllib
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from commands import Run
from fitted_objects import SHORT, found, object_fitted, touches
from palmbots.errors import PalmbotsError
from palmbots.fitting.fitted_values import Estimate
from palmbots.fitting.object_fit import fit_object, touch_of
from palmbots.fitting.object_slides import FRICTION, slides_in
from palmbots.fitting.palm_readings import palm_estimates, readings_of
from palmbots.logs.mcap_writer import write_log
from palmbots.probing.object_set import ObjectSet, Prior

WIDTH_M = 0.25


def only(com_x_m: float, friction: tuple[float, float]) -> ObjectSet:
    """One object, whose COM is 4 cm high."""
    left, right = ((one, one) for one in friction)
    return ObjectSet(Prior(WIDTH_M, (com_x_m, com_x_m), (0.04, 0.04), (left, right)))


def contains(one: Estimate, value: float) -> bool:
    return one.low is not None and one.high is not None and one.low <= value <= one.high


@pytest.mark.parametrize("controller", ["shared-sign", "distributed", "centralized", "none"])
@pytest.mark.parametrize(
    ("com_x_m", "left", "right", "more"),
    [
        (0.115, 0.27, 0.35, {}),
        (0.14, 0.4, 0.2, {"task.slope_deg": 2.0, "robot.noise_m_s": 0.02}),
        (0.125, 0.3, 0.3, {"task.direction": "backward", "palm.pivot_offset_m": 0.02}),
    ],
)
def test_no_slide_contradicts_the_hidden_object(
    controller: str, com_x_m: float, left: float, right: float, more: dict[str, Any]
) -> None:
    """Every tick of a carry, with accelerations, slopes and turning palms."""
    keys = {"object.com_m": [com_x_m, 0.04], "palm.left.friction": left}
    keys |= {"palm.right.friction": right, **more}
    carried = pb.carry("paper", controller, seed=1, overrides=SHORT | keys)
    slides = slides_in(carried)
    assert len(slides) > 50
    truth = only(com_x_m, (left, right))
    for row in range(len(slides)):
        seen = slides.observation(row)
        assert truth.may_slide(truth.boxes, seen.pose, seen.way)[seen.side].all(), row
    others = only(com_x_m + 0.03, (left, right))
    assert any(
        not others.may_slide(others.boxes, seen.pose, seen.way)[seen.side].all()
        for seen in map(slides.observation, range(len(slides)))
    )


def test_hidden_values_are_found_again() -> None:
    keys: dict[str, Any] = {"object.com_m": [0.115, 0.04], "palm.left.friction": 0.27}
    keys |= {"palm.right.friction": 0.35, "palm.rate_deg_s": 42.0}
    of = found(keys | {"tactile.zero_half_width_m": 0.006, "task.distance_m": 1.5}, carries=3)
    com = of["object.com_m"]
    assert com.is_identified and contains(com, 0.115)
    assert com.low is not None and com.high is not None and com.high - com.low < 0.03
    for side, value in (("left", 0.27), ("right", 0.35)):
        assert contains(of[f"palm.{side}.friction"], value)
        assert of[f"palm.{side}.rate_deg_s"].value == pytest.approx(42.0)
    apart = math.degrees(math.atan(0.35) - math.atan(0.27))
    assert contains(of["friction_angle_difference_deg"], apart)
    edge = of["tactile.zero_half_width_m"]
    assert contains(edge, 0.006)
    assert edge.low is not None and edge.high is not None and edge.high - edge.low < 5e-4


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_the_truth_is_in_every_interval(seed: int) -> None:
    """Of random objects and palms: the intervals are bounds. tests/soak has many."""
    for key, one, value in object_fitted(seed):
        assert contains(one, value) or one.low is None, key


def test_logs_of_two_objects_are_refused() -> None:
    both = [touches({"object.com_m": [x, 0.04]}, 1)[0] for x in (0.112, 0.14)]
    with pytest.raises(PalmbotsError, match="no object explains the slides of all logs"):
        fit_object(both, ())


def test_without_slides_the_reason_is_given() -> None:
    """Without noise no robot closes or opens."""
    carried = pb.carry("paper", "none", overrides={"robot.noise_m_s": 0.0, **SHORT})
    with pytest.raises(PalmbotsError, match="the logs show 0 slides; it needs 100"):
        fit_object([touch_of(carried, "a.mcap")], ())


def test_contacts_that_creep_are_no_slides() -> None:
    touch = touch_of(pb.carry("paper", "distributed", world="mujoco", overrides=SHORT), "a.mcap")
    of = {one.key: one for one in fit_object([touch], ()).estimates}
    assert "contacts creep in MuJoCo" in of["palm.left.friction"].reason
    rate = of["palm.left.rate_deg_s"]
    assert rate.value == pytest.approx(50, rel=0.05)


def test_false_readings_widen_the_zone_little() -> None:
    carried = pb.carry("paper", "distributed", seed=2, overrides={"tactile.false_rate": 0.05})
    edge = palm_estimates([readings_of(carried)])[-1]
    assert edge.low is not None and edge.high is not None
    assert edge.low <= 0.005 <= edge.high < 0.0056


def test_the_files_are_parts_of_a_scene(here: Run, tmp_path: Path) -> None:
    log = tmp_path / "a.mcap"
    write_log(pb.carry("paper", "shared-sign", overrides={"palm.friction": 0.35}), log)
    done = here("fit", str(log), "--out", str(tmp_path / "f"))
    assert done.returncode == 0
    text = (tmp_path / "f" / "object.toml").read_text()
    table = tomllib.loads(text)
    assert set(table) == {"object", "palm", "tactile"}
    assert "# friction: the slides bound it" in text
    assert (tmp_path / "f" / "object.png").stat().st_size > 10000
    assert FRICTION[0] < 0.35 < FRICTION[1]
    words = ("--with", tmp_path / "f" / "object.toml", "--seeds", "1", "--json")
    assert '"rate_deg_s": 50.0' in here("carry", "paper", *words).stdout
