# SPDX-License-Identifier: Apache-2.0
"""All figures have one style: the unit stands last on every axis."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

import palmbots as pb
from palmbots import viz
from palmbots.mujoco.validation.speed_limits import Limit, Pace, SpeedLimits
from palmbots.optimum.design_law import KEYS, DesignLaw, LawPoint
from palmbots.scene.scene import Scene
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import run_study
from study_fixtures import SMALL

SHORT = {"task.distance_m": 0.2}
COARSE: dict[str, Any] = {"relative_half_width": 0.1, "overrides": SHORT}
ARC = {"task.path.kind": "arc", "task.path.radius_m": 0.5, **SHORT}

# What labels may state in square brackets, and labels that have no unit.
UNITS = {"%", "cm/s", "m", "m/s", "m/s²", "mm", "s", "weight", "°"}
WITHOUT_UNIT = {
    "correction\n(case)",
    "friction μ",
    "messages per metre",
    "multiple of the scene's value",
    "palm friction",
    "sensor",
    "share of the variance (Sobol index)",
    "tolerance of friction, ±",
}


def speed_limits() -> SpeedLimits:
    """Two frictions and two speeds, as if they had been measured."""
    limits = [
        Limit(friction, closing, forward, "left" if closing else "right", 1.0, 1.1)
        for friction in (0.2, 0.3)
        for closing in (True, False)
        for forward in (True, False)
    ]
    paces = [Pace(speed, 4, (4, 3), (0.004, 0.005), (0.01, 0.012)) for speed in (0.06, 0.12)]
    return SpeedLimits(Scene(), tuple(limits), tuple(paces), 0.5)


def results(folder: Path) -> Iterator[tuple[str, Any]]:
    """A small result for every registered figure; studies have several."""
    carry = pb.carry("paper", overrides=SHORT)
    for name in ("carry", "timeline", "message_sequence", "side_view"):
        yield name, carry
    curved = pb.carry("paper", world="mujoco", overrides=ARC)
    yield "carry", curved  # one more panel
    yield "plan_view", curved
    yield "sweep", pb.compare("paper", values=[0.0, 0.2], carries=2, overrides=SHORT)
    analysis = pb.analyze("paper")
    for name in ("stability-geometry", "friction-cones", "meeting-points", "operating-region",
                 "permitted-com", "tactile-zones"):  # fmt: skip
        yield name, analysis
    for quantity in ("com", "friction"):  # with a unit and without
        angles = {"angle_range_deg": (5, 15), "resolution_deg": 2.5}
        yield "palm-angles", pb.design("paper", maximize=quantity, **angles)
    yield "noise_limit", pb.noise_limit("paper", drop_rate=0.2, **COARSE)
    yield "bound", pb.bound("paper", overrides=SHORT)
    law = [LawPoint(key, f, 0.04 * f, 0.041 * f) for key in KEYS for f in (1.0, 2.0)]
    yield "design-law", DesignLaw(tuple(law), Scene())
    yield "validation", pb.validate(pb.load_scene("paper", SHORT), states=3, carries=1)
    yield "speed_limits", speed_limits()
    ranges = {
        "palm.friction": {"from": 0.2, "to": 0.3},
        "robot.noise_m_s": {"from": 0.0, "to": 0.1},
    }
    sobol = {"vary": ranges, "design": {"kind": "sobol-indices", "points": 8}}
    for k, table in enumerate(({}, {"vary": {"palm.friction": [0.2, 0.3]}}, sobol)):
        plan = load_plan({**SMALL, "set": SHORT, "seeds": {"count": 2}, **table})
        yield "study", run_study(plan, folder / str(k))


@pytest.fixture(scope="module")
def figures(tmp_path_factory: pytest.TempPathFactory) -> list[tuple[str, Figure]]:
    made = results(tmp_path_factory.mktemp("studies"))
    return [(name, viz.FIGURES.get(name)(result)) for name, result in made]


def test_every_registered_figure_is_drawn(figures: list[tuple[str, Figure]]) -> None:
    assert {name for name, _ in figures} == set(viz.FIGURES.names())


def test_the_unit_stands_last_in_square_brackets(figures: list[tuple[str, Figure]]) -> None:
    seen: set[str] = set()
    for name, figure in figures:
        for axes in figure.axes:
            for label in (axes.get_xlabel(), axes.get_ylabel()):
                units = re.findall(r"\[(.*?)\]$", label, re.MULTILINE)
                expected = 0 if label in WITHOUT_UNIT | {""} else 1
                assert label.count("[") == len(units) == expected, (name, label)
                assert set(units) <= UNITS, (name, label)
                seen |= set(units) or {label}
    assert seen >= UNITS  # no unit is listed for nothing
