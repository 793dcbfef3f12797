# SPDX-License-Identifier: Apache-2.0
"""Every result of the public interface has a short text, and a table for notebooks.

The classes come from the public interface itself: all that a public function returns.
"""

import html
import importlib
import inspect
import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

import palmbots as pb
from palmbots._util.result_schema import result_schema
from palmbots._util.results import Result
from palmbots.cli.declared_commands import commands_of, declared_commands, results_of
from palmbots.cli.json_schemas import with_scene
from palmbots.control import bounds_of
from palmbots.learn import EpisodeResult
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.validation.speed_limits import Limit, Pace, SpeedLimits
from palmbots.optimum.design_law import KEYS, DesignLaw, LawPoint
from palmbots.scene.scene import Scene
from palmbots.simulation.noise_limit import NoiseLimit
from palmbots.studies.cost_estimate import Cost
from palmbots.studies.points import design_points
from palmbots.views.log_alignment import ClockFit
from palmbots.views.run_replay import RunReplay, Verified
from schema_refusals import assert_fits_exactly
from study_fixtures import SMALL

SHORT = {"task.distance_m": 0.2}

# What public functions return besides results.
NO_RESULTS = {
    "ControllerEntry": "a row of the registry",
    "Decoded": "a packet",
    "FirstTouch": "a part of an Analysis",
    "Plan": "what a study is asked to do",
    "Points": "what a study is asked to do",
    "Reaction": "arrays for the search of palm angles",
    "Scene": "an input",
    "StabilityProblem": "an input",
}


def public_modules() -> list[Any]:
    rooms = [name for name in dir(pb) if inspect.ismodule(getattr(pb, name))]
    return [pb, *(importlib.import_module(f"palmbots.{room}") for room in rooms)]


def returned_classes() -> dict[str, type]:
    """The classes of the package that a public function returns, by name; lists excepted."""
    classes = {}
    for module in public_modules():
        for name in dir(module):
            function = getattr(module, name)
            if not isinstance(function, FunctionType):
                continue
            text = inspect.formatannotation(inspect.signature(function).return_annotation)
            last = re.fullmatch(r"(?:\w+\.)*(\w+)(?: \| None)?", text.strip("'"))
            home = vars(inspect.getmodule(inspect.unwrap(function)))
            found = home.get(last[1]) if last else None
            if inspect.isclass(found) and found.__module__.startswith("palmbots"):
                classes[found.__name__] = found
    return classes


def all_results(of: type = Result) -> set[type]:
    """Every class of results in the package; `returned_classes` imports the modules of all."""
    direct = {c for c in of.__subclasses__() if c.__module__.startswith("palmbots.")}
    return direct.union(*(all_results(c) for c in direct))


def printed_alone() -> set[str]:
    """The results that only commands have; tests/cli/test_json_contract.py tests them."""
    of_commands = {
        kind.__name__
        for name in declared_commands()
        for one in commands_of(name)
        for kind in results_of(one)
    }
    return of_commands - set(EXAMPLES)


def analysis() -> Any:
    return pb.analyze("paper")


def certificate() -> Any:
    return pb.certify("paper", friction=(0.29, 0.31))


def checked(folder: Path) -> Any:
    certificate().save(folder / "box.json")
    return pb.check(folder / "box.json")


def logged(folder: Path) -> Path:
    path = folder / "carry.mcap"
    pb.write_log(pb.carry("paper", overrides=SHORT), path)
    return path


def states() -> Any:
    angles = {"theta_left": 0.2, "theta_right": 0.2, "p_left": 0.0, "p_right": [0.0, 0.01]}
    friction = {"friction_left": 0.3, "friction_right": 0.3}
    return pb.contact_modes_batch(width=0.25, com_x=0.125, com_y=0.04, **angles, **friction)


def speed_limits() -> SpeedLimits:
    limit = Limit(0.3, True, True, "left", 1.0, 1.1)
    pace = Pace(0.06, 4, (4, 3), (0.004, 0.005), (0.01, 0.012))
    return SpeedLimits(Scene(), (limit,), (pace,), 0.5)


def design() -> Any:
    grid: dict[str, Any] = {"angle_range_deg": (5, 15), "resolution_deg": 5}
    return pb.design("paper", maximize="com", **grid)


def study(folder: Path) -> Any:
    plan = pb.studies.load_plan({**SMALL, "set": SHORT, "seeds": {"count": 2}})
    return pb.studies.run_study(plan, folder / "s.study")


def noise_limit() -> NoiseLimit:
    return NoiseLimit(0.02, (0.019, 0.021), 0.01, 3.0, 900, 90, (), "silent", 0, Scene())


# One of each kind of result; `folder` is an empty one.
EXAMPLES: dict[str, Callable[[Path], Any]] = {
    "Analysis": lambda folder: analysis(),
    "Bound": lambda folder: pb.bound("paper", overrides=SHORT),
    "Bounds": lambda folder: bounds_of(Scene()),
    "DriftBudget": lambda folder: DriftBudget(0.035, 0.01, 0.02, 16, 7.2, False, 0.0),
    "Carry": lambda folder: pb.carry("paper", overrides=SHORT),
    "Certificate": lambda folder: certificate(),
    "CheckResult": checked,
    "Clearance": lambda folder: analysis().clearance,
    "Comparison": lambda folder: pb.compare(values=[0.1], carries=2, overrides=SHORT),
    "ContactModes": lambda folder: pb.contact_modes("paper"),
    "ContactModesBatch": lambda folder: states(),
    "Cost": lambda folder: Cost(
        6,
        12,
        24000,
        24,
        1000,
        65.2,
        2,
        {"silent": 0.4},
        123456,
        8 << 20,
        design_points(pb.studies.load_plan(SMALL)),
    ),
    "Design": lambda folder: design(),
    "DesignLaw": lambda folder: DesignLaw(
        tuple(LawPoint(key, f, 0.04 * f, 0.041 * f) for key in KEYS for f in (1.0, 2.0)), Scene()
    ),
    "DropRate": lambda folder: pb.estimate_drop_rate(
        relative_half_width=1.0, effort=50, overrides={"robot.noise_m_s": 0.03, **SHORT}
    ),
    "EpisodeResult": lambda folder: EpisodeResult("delivered", 412, 3.75),
    "Log": lambda folder: pb.read_log(logged(folder)),
    "NoiseLimit": lambda folder: noise_limit(),
    "ReplayResult": lambda folder: pb.replay(logged(folder)),
    "RunReplay": lambda folder: RunReplay(
        (
            Verified("left-000003.mcap", "left", 3, False, 2500, 2500, None),
            Verified("station-000002.mcap", "station", 2, False, 500, 0, None),
        ),
        (ClockFit("station-000002.mcap", 0.25, 1.0, 0.004, 480),),
    ),
    "SpeedLimits": lambda folder: speed_limits(),
    "StudyResult": study,
    "Validation": lambda folder: pb.validate(pb.load_scene("paper", SHORT), states=3, carries=1),
}


def test_what_public_functions_return_is_a_result() -> None:
    returned = returned_classes()
    assert {name for name, c in returned.items() if not issubclass(c, Result)} == set(NO_RESULTS)


def test_every_result_has_an_example() -> None:
    returned = set(returned_classes()) - set(NO_RESULTS)
    assert returned <= {c.__name__ for c in all_results()} - printed_alone() == set(EXAMPLES)


@pytest.fixture(scope="module")
def examples(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Any]:
    """One of each kind of result, made when it is first needed."""
    return cache(lambda name: EXAMPLES[name](tmp_path_factory.mktemp(name)))


@pytest.mark.parametrize("name", EXAMPLES)
def test_text_is_short_and_notebooks_show_the_same(
    name: str, examples: Callable[[str], Any]
) -> None:
    result = examples(name)
    assert isinstance(result, Result)
    assert type(result).__name__ == name
    text, table = repr(result), html.unescape(re.sub("<[^>]*>", " ", result._repr_html_()))
    first, *lines = text.splitlines()
    assert first == result.headline() != name
    assert 1 <= len(lines) <= 60
    assert max(map(len, text.splitlines())) < 220, text
    assert "object at 0x" not in text
    assert set(text.replace("…", "").split()) <= {*table.split(), "and", "more"} | set("0123456789")


@pytest.mark.parametrize("name", EXAMPLES)
def test_schema_fits_the_result_exactly(name: str, examples: Callable[[str], Any]) -> None:
    """The schema refuses a missing key, a further key, a missing side, and another type."""
    result = examples(name)
    schema = with_scene(result_schema(type(result)))
    assert_fits_exactly(schema, json.loads(json.dumps(result.summary(), allow_nan=False)))
