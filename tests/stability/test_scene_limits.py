# SPDX-License-Identifier: Apache-2.0
"""Warnings about numbers of a scene that exceed what properties 1 and 2 allow."""

import math
from typing import Any

import pytest

import palmbots as pb
from palmbots.stability import self_check

CRATE: dict[str, Any] = {
    "object": {
        "vertices_m": [[0, 0], [0.4, 0], [0.4, 0.06], [0.15, 0.06], [0.15, 0.12], [0, 0.12]],
        "com_m": [0.17, 0.05],
    },
    "palm": {"length_m": 0.06, "friction": 0.4},
}


def box(height_m: float) -> dict[str, Any]:
    """A box of this height, with its centre of mass in the middle."""
    vertices = [[0, 0], [0.25, 0], [0.25, height_m], [0, height_m]]
    return {"object.vertices_m": vertices, "object.com_m": [0.125, height_m / 2]}


@pytest.mark.parametrize("scene", ["paper", "paper-offset", {"object": "plank"}], ids=str)
def test_scenes_within_their_limits_have_no_warning(scene: Any) -> None:
    assert self_check(scene) == ()
    assert pb.analyze(scene).warnings == ()


def test_acceleration_beyond_the_limit_is_reported_by_all() -> None:
    """Robots that accelerate at 0.5 m/s², where the properties hold up to 0.16 m/s²."""
    (warning,) = self_check(CRATE)
    assert "robot.acceleration_m_s2 is 0.5" in warning
    assert "only up to 0.157 m/s²" in warning
    analysis = pb.analyze(CRATE)
    assert analysis.warnings == (warning,)
    assert analysis.summary()["warnings"] == [warning]
    assert f"warning: {warning}" in repr(analysis)


def test_acceleration_limit_is_that_of_an_inclined_floor() -> None:
    """On a floor whose tangent is the limit / g the properties hold; a little steeper they fail."""
    limit = pb.analyze(CRATE).max_acceleration_m_s2
    assert limit is not None
    for share, holds in ((0.999, True), (1.001, False)):
        slope = -math.degrees(math.atan(share * limit / 9.80665))
        analysis = pb.analyze(CRATE, overrides={"task.slope_deg": slope})
        assert all(analysis.properties[n, "left"].holds for n in (1, 2)) == holds
    for share, count in ((0.999, 0), (1.001, 1)):
        changes = {"robot.acceleration_m_s2": share * limit}
        assert len(self_check(CRATE, overrides=changes)) == count


def test_one_fast_robot_is_enough() -> None:
    assert self_check("paper", overrides={"robot.left.acceleration_m_s2": 0.9})


def test_neglected_inertia_has_no_acceleration_limit() -> None:
    assert self_check(CRATE, overrides={"task.inertia": False}) == ()


def test_smaller_region_allows_more() -> None:
    (warning,) = self_check(CRATE, region_m=(-0.005, 0.005))
    assert "only up to 0.292 m/s² for contacts from -5.0 to 5.0 mm" in warning


def test_slope_out_of_range_is_reported() -> None:
    low, high = pb.analyze("paper").slope or (0.0, 0.0)
    (warning,) = self_check("paper", overrides={"task.slope_deg": 6.0})
    assert "task.slope_deg is 6" in warning
    ends = [f"{math.degrees(math.atan(end)):.2f}" for end in (low, high)]
    assert f"from {ends[0]} to {ends[1]}°" in warning
    # Where the properties fail on a level floor too, the slope is not the reason.
    com = {"object.com_m": [0.05, 0.04]}
    (warning,) = self_check("paper", overrides=com | {"task.slope_deg": 6.0})
    assert warning.startswith("property 1 and property 2 fail for contacts somewhere on the palms")


@pytest.mark.parametrize(
    "ray",
    [
        [{"object.com_m": [0.125 + 0.003 * k, 0.04]} for k in range(40)],
        [{"object.com_m": [0.125 - 0.003 * k, 0.04]} for k in range(40)],
        [box(0.1 + 0.05 * k) for k in range(12)],
        [{"palm.friction": 0.3 - 0.01 * k} for k in range(30)],
        [{"palm.length_m": 0.15 + 0.05 * k} for k in range(16)],
        [{"task.slope_deg": 0.5 * k} for k in range(30)],
        [{"robot.acceleration_m_s2": 0.5 + 0.1 * k} for k in range(20)],
    ],
    ids=["right", "left", "high", "friction", "length", "slope", "acceleration"],
)
def test_warnings_do_not_vanish_where_a_scene_gets_worse(ray: list[dict[str, Any]]) -> None:
    """Along each ray, once there is a warning, there is one in every worse scene."""
    counts = []
    for overrides in ray:
        try:
            scene = pb.load_scene("paper", overrides)
        except pb.SceneError:  # refused, which is worse still
            break
        counts.append(len(self_check(scene)))
    assert counts[0] == 0
    first = next(k for k, count in enumerate(counts) if count)
    assert all(counts[first:])


def test_object_that_cannot_span_the_palms_has_a_warning() -> None:
    (warning,) = self_check("paper", overrides={"palm.length_m": 0.9, "palm.steep_deg": 40})
    assert warning.startswith("properties 1 and 2 cannot hold on the whole palms: palm.length_m")


def test_palm_that_turns_farther_in_a_period_than_its_angle_may_err_is_reported() -> None:
    allowed = math.degrees(pb.analyze("paper").angle_error_rad or 0.0)
    period = pb.load_scene("paper").control.period_s
    for share, count in ((0.99, 0), (1.01, 1)):
        warnings = self_check("paper", overrides={"palm.rate_deg_s": share * allowed / period})
        assert len(warnings) == count
        assert all("palm.rate_deg_s" in warning for warning in warnings)


def test_scene_to_which_the_analysis_does_not_apply_has_no_warning() -> None:
    assert self_check("figure8") == ()
