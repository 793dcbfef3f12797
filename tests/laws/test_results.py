# SPDX-License-Identifier: Apache-2.0
"""Every result has a short text, the same as a table for notebooks, and JSON that fits its schema
exactly. With ``--json`` every command prints one such object and nothing else.

The kinds of results are all that public functions return, and all that commands declare.
"""

import copy
import html
import importlib
import inspect
import json
import pickle
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from typer.main import get_command

import palmbots as pb
from commands import FUNCTIONS, Run
from dds_loopback import dds_environment
from palmbots._util.result_schema import result_schema
from palmbots._util.results import Result
from palmbots.assessment.carried_route import CarriedRoute
from palmbots.cli.declared_commands import commands_of, declared_commands, results_of
from palmbots.cli.json_schemas import schema_of, with_scene
from palmbots.cli.main import build_app
from palmbots.control import bounds_of
from palmbots.fitting.object_fit import fit_object, touch_of
from palmbots.learn import EpisodeResult
from palmbots.mujoco.curve_comparison import CurveComparison
from palmbots.mujoco.curve_trial import CurveTrial
from palmbots.mujoco.drift_budget import DriftBudget
from palmbots.mujoco.route_carry import carry_route
from palmbots.mujoco.validation.speed_limits import Limit, Pace, SpeedLimits
from palmbots.optimum import FrontPoint
from palmbots.optimum.design_law import KEYS, DesignLaw, LawPoint
from palmbots.scene.scene import Scene
from palmbots.simulation.noise_limit import NoiseLimit
from palmbots.simulation.outcome_counts import OutcomeCounts, SceneStatistics
from palmbots.studies.cost_estimate import Cost
from palmbots.studies.points import design_points
from palmbots.views.log_alignment import ClockFit
from palmbots.views.logged_carries import LoggedCarry
from palmbots.views.run_replay import RunReplay, Verified
from recordings import HIDDEN, packets_csv, recorded
from schema_refusals import assert_fits_exactly
from shape_files import svg, written
from short_route import TYPED, short_plan
from short_validation import short_validation
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
    """The results that only commands have."""
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


def sent(folder: Path) -> Path:
    """The log of a carry with many messages."""
    path = folder / "shared-sign.mcap"
    pb.write_log(pb.carry("paper", "shared-sign", overrides={"task.distance_m": 0.5}), path)
    return path


def states() -> Any:
    angles = {"theta_left": 0.2, "theta_right": 0.2, "p_left": 0.0, "p_right": [0.0, 0.01]}
    friction = {"friction_left": 0.3, "friction_right": 0.3}
    return pb.contact_modes_batch(width=0.25, com_x=0.125, com_y=0.04, **angles, **friction)


def speed_limits() -> SpeedLimits:
    limit = Limit(0.3, True, True, "left", 1.0, 1.1)
    pace = Pace(0.06, 4, (4, 3), (0.004, 0.005), (0.01, 0.012))
    return SpeedLimits(Scene(), (limit,), (pace,), 0.5)


DRIFT = DriftBudget(0.035, 0.01, 0.02, 16, 0, 7.2, False)


def curves() -> CurveComparison:
    """One curve that is too tight, one that is refused, and one that was carried."""
    own = CurveTrial("silent", {"task.path.kind": "arc"}, DRIFT, None, "")
    refused = CurveTrial("silent", {"task.path.radius_m": 0.1}, None, None, "too tight")
    carried = CurveTrial("silent", {}, DRIFT, OutcomeCounts("silent", 20, 1, 1), "")
    return CurveComparison(own, (carried, refused), Scene())


def design() -> Any:
    grid: dict[str, Any] = {"angle_range_deg": (5, 15), "resolution_deg": 5}
    return pb.design("paper", maximize="com", overrides=SHORT, **grid)


def study(folder: Path) -> Any:
    plan = pb.studies.load_plan({**SMALL, "set": SHORT, "seeds": {"count": 2}})
    return pb.studies.run_study(plan, folder / "s.study")


def noise_limit() -> NoiseLimit:
    return NoiseLimit(0.02, (0.019, 0.021), 0.01, 3.0, 900, 90, "mujoco", (), "silent", 0, Scene())


# One of each kind of result; `folder` is an empty one.
EXAMPLES: dict[str, Callable[[Path], Any]] = {
    "Analysis": lambda folder: analysis(),
    "Assessment": lambda folder: replace(
        pb.assess("paper", turn_radius_m=0.0, overrides={"task.distance_m": 0.05}),
        curve=curves().others[0],
    ),
    "Bound": lambda folder: replace(
        pb.bound("paper", "corrections", overrides=SHORT), front=(FrontPoint(2.0, 0.1),)
    ),
    "Bounds": lambda folder: bounds_of(Scene()),
    "DriftBudget": lambda folder: DRIFT,
    "Carry": lambda folder: pb.carry("paper", overrides=SHORT),
    "CarriedRoute": lambda folder: CarriedRoute(**vars(carry_route(plan=short_plan()))),
    "Carried": lambda folder: pb.carry_and_report("paper", overrides=SHORT),
    "Certificate": lambda folder: certificate(),
    "CheckResult": checked,
    "Clearance": lambda folder: analysis().clearance,
    "Comparison": lambda folder: pb.compare(values=[0.1], carries=2, overrides=SHORT),
    "ControllerList": lambda folder: pb.controllers(),
    "ConsistentModes": lambda folder: pb.simulation.FloorWorld("plate").contact_modes(0.01),
    "ContactModes": lambda folder: pb.contact_modes("paper"),
    "ContactModesBatch": lambda folder: states(),
    "EndList": lambda folder: pb.ends(),
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
    "CurveComparison": lambda folder: curves(),
    "Design": lambda folder: design(),
    "LogFit": lambda folder: pb.fit([sent(folder)]),
    "LoadLimits": lambda folder: pb.load_limits(),
    "DesignLaw": lambda folder: DesignLaw(
        tuple(LawPoint(key, f, 0.04 * f, 0.041 * f) for key in KEYS for f in (1.0, 2.0)), Scene()
    ),
    "DropRate": lambda folder: pb.estimate_drop_rate(
        relative_half_width=1.0, effort=50, overrides={"robot.noise_m_s": 0.03, **SHORT}
    ),
    "EpisodeResult": lambda folder: EpisodeResult("delivered", 412, 3.75),
    "Exported": lambda folder: pb.export(mjcf=folder / "pair.xml", urdf=folder / "left.urdf"),
    "ImportedObject": lambda folder: pb.import_object(
        written(folder / "box.svg", svg('<rect width="200" height="100"/>'))
    ),
    "KeyList": lambda folder: pb.keys("start"),
    "Log": lambda folder: pb.read_log(logged(folder)),
    "MotionFit": lambda folder: pb.fit(recorded(folder, HIDDEN, seed=1, stretches=6), motion=True),
    "FinalPlace": lambda folder: pb.final_place("lift", jobs=100),
    "NoiseLimit": lambda folder: noise_limit(),
    "OutcomeCounts": lambda folder: OutcomeCounts("silent", 40, 2, 0),
    "ObjectFit": lambda folder: fit_object([touch_of(pb.carry("paper", "shared-sign"), "")], ()),
    "ObjectList": lambda folder: pb.objects(),
    "Probe": lambda folder: pb.probe("paper", com_x_m=(0.12, 0.13), angle_range_deg=(5, 7)),
    "RadioFit": lambda folder: pb.fit(
        [packets_csv(folder, "packets.csv", "index", np.arange(200.0))], radio=True
    ),
    "ReplayResult": lambda folder: pb.replay(logged(folder)),
    "RouteCarry": lambda folder: carry_route(plan=short_plan(), seeds=1),
    "RoutePlan": lambda folder: short_plan(),
    "RunReplay": lambda folder: RunReplay(
        (
            Verified("left-000003.mcap", "left", 3, False, 2500, 2500, None),
            Verified("station-000002.mcap", "station", 2, False, 500, 0, None),
        ),
        (
            ClockFit("left-000003.mcap", 0.0, 1.0, 0.0, 0),
            ClockFit("station-000002.mcap", 0.25, 1.0, 0.004, 480),
        ),
        (LoggedCarry("left", "left-000003.mcap", 1, 3.1, 20.4, 0.8, "stopped by hand"),),
    ),
    "SceneList": lambda folder: pb.scenes(),
    "SceneStatistics": lambda folder: SceneStatistics(
        OutcomeCounts("none", 40, 40, 0), (OutcomeCounts("silent", 40, 2, 0),)
    ),
    "SpeedLimits": lambda folder: speed_limits(),
    "StudyResult": study,
    "Validation": lambda folder: short_validation(),
}


def test_what_public_functions_return_is_a_result() -> None:
    returned = returned_classes()
    assert {name for name, c in returned.items() if not issubclass(c, Result)} == set(NO_RESULTS)


def test_every_result_has_an_example() -> None:
    returned = set(returned_classes()) - set(NO_RESULTS)
    assert returned <= {c.__name__ for c in all_results()} - printed_alone() == set(EXAMPLES)


@pytest.fixture(scope="module", params=EXAMPLES)
def name(request: pytest.FixtureRequest) -> str:
    """A kind of result: its tests follow each other, and share one example."""
    return request.param


@pytest.fixture(scope="module")
def result(name: str, tmp_path_factory: pytest.TempPathFactory) -> Any:
    return EXAMPLES[name](tmp_path_factory.mktemp(name))


def test_text_is_short_and_notebooks_show_the_same(name: str, result: Any) -> None:
    assert isinstance(result, Result)
    assert type(result).__name__ == name
    text, table = repr(result), html.unescape(re.sub("<[^>]*>", " ", result._repr_html_()))
    first, *lines = text.splitlines()
    assert first == result.headline() != name
    assert 1 <= len(lines) <= 60
    assert max(map(len, text.splitlines())) < 220, text
    assert "object at 0x" not in text
    if result.figure is None:
        with pytest.raises(pb.PalmbotsError, match=f"there is no figure of a {name}"):
            result.plot()
    assert set(text.replace("…", "").split()) <= {*table.split(), "and", "more"} | set("0123456789")


def test_schema_fits_the_result_exactly(result: Any) -> None:
    """The schema refuses a missing key, a further key, a missing side, and another type."""
    schema = with_scene(result_schema(type(result)))
    assert_fits_exactly(schema, json.loads(json.dumps(result.summary(), allow_nan=False)))


def test_copies_of_a_result_are_equal_to_it(name: str, result: Any) -> None:
    for twin in (copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        assert twin.summary() == result.summary()
        assert twin == result
        assert {twin} == {result}
    assert result != (pb.keys("start") if name == "SceneList" else pb.scenes())


def test_what_is_public_can_be_sent_to_another_process() -> None:
    for module in public_modules():
        for name in dir(module):
            value = getattr(module, name)
            if not inspect.ismodule(value):
                twin = pickle.loads(pickle.dumps(value))
                # Equal, not the same: typing keeps only its latest unions.
                assert not callable(value) or twin == value, name


ROOT = Path(__file__).parents[2]
NEAR = ("--set", "task.distance_m=0.2")

# Command and arguments; all succeed.
CALLS: list[tuple[str, tuple[str, ...]]] = [
    ("carry", ("--seed", "3", *NEAR)),
    ("carry", ("--world", "mujoco", *NEAR)),
    ("carry", ("around-wall", "-c", "shared-sign", "--seeds", "1", *TYPED)),
    ("route", ("around-wall", "-c", "shared-sign", "--routes", "1", *TYPED)),
    ("analyze", ()),
    ("assess", ("--turn-radius-m", "0", "--set", "task.distance_m=0.05")),
    ("design", ("--resolution-deg", "10", "--angle-range-deg", "5", "15", *NEAR)),
    ("certify", ()),
    (
        "drop-rate",
        ("--set", "robot.noise_m_s=0.03", "--effort", "20", "--relative-error-percent", "100"),
    ),
    ("noise-limit", ("--relative-error-percent", "10", *NEAR)),
    ("bound", ("--speeds", "corrections", *NEAR)),
    ("compare", ("--values", "0,0.2", "-n", "2", *NEAR)),
    ("study", ("STUDY", "--out", "DIR")),
    ("check", ("CERTIFICATE",)),
    ("replay", ("LOG",)),
    ("export", ("--mjcf", "MJCF")),
    ("derive", ("--controllers", "none")),
    ("derive", ("--policy", str(ROOT / "examples" / "policies" / "table-1.toml"))),
    ("scenes", ()),
    ("objects", ()),
    ("controllers", ()),
    ("keys", ()),
    ("import", ("DRAWING", "--out", "OBJECT")),
    ("fit", ("--motion", "COMMANDS", "POSITIONS", "--out", "FITTED")),
    ("init", ("scene", "SCENE")),
    ("init", ("pair", "PAIR")),
    ("view", ("LOG", "--layout", "LAYOUT")),
    ("ros2", ("PAIR", "--side", "left", "--seconds", "0.1")),
    ("schema", ("log",)),
]


# These take long and are tried once, in tests/mujoco (test_validation, test_speed_limits), or need
# other processes (tests/processes), or the files of a pair (tests/cli/test_firmware_commands.py).
ELSEWHERE = {
    "validate", "speed-limits", "curve", "up", "world", "robot", "station", "doctor", "calibrate",
    "firmware", "flash",
}  # fmt: skip
CALLS += [(one.group, ()) for one in FUNCTIONS if one.group not in {*dict(CALLS), *ELSEWHERE}]


@pytest.fixture
def files(here: Run, tmp_path: Path) -> dict[str, str]:
    """Files that commands read and write, by the word in the contract."""
    names = {
        "STUDY": "study.toml", "DIR": "results", "CERTIFICATE": "box.json", "LOG": "log/carry.mcap",
        "MJCF": "scene.xml", "SCENE": "scene.toml", "PAIR": "pair.toml", "LAYOUT": "layout.json",
        "DRAWING": "box.svg", "OBJECT": "box.toml",
        "COMMANDS": "commands.csv", "POSITIONS": "positions.csv", "FITTED": "fitted",
    }  # fmt: skip
    return {word: str(tmp_path / name) for word, name in names.items()}


@pytest.mark.slow
@pytest.mark.parametrize(("command", "arguments"), CALLS, ids=[row[0] for row in CALLS])
def test_json_of_a_command_is_one_object_that_fits_its_schema_exactly(
    command: str,
    arguments: tuple[str, ...],
    here: Run,
    files: dict[str, str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if "STUDY" in arguments:
        Path(files["STUDY"]).write_text(
            'controllers = ["none"]\n[set]\n"task.distance_m" = 0.2\n[vary]\n'
            '"robot.noise_m_s" = [0.02]\n[seeds]\ncount = 2\n'
        )
    if "DRAWING" in arguments:
        written(Path(files["DRAWING"]), svg('<rect width="200" height="100"/>'))
    if "COMMANDS" in arguments:
        recorded(Path(files["COMMANDS"]).parent, HIDDEN, seed=1, stretches=6)
    if "CERTIFICATE" in arguments:
        here("certify", "-o", files["CERTIFICATE"])
    if "LOG" in arguments:
        (folder := Path(files["LOG"]).parent).mkdir()
        assert str(logged(folder)) == files["LOG"]
    if command == "ros2":
        here("init", "pair", files["PAIR"])
        for name, value in dds_environment().items():
            monkeypatch.setenv(name, value)
    result = here(command, *(files.get(word, word) for word in arguments), "--json")
    assert result.returncode == 0, result
    assert result.stdout.count("\n") == 1
    table = json.loads(result.stdout)
    if command == "schema":
        Draft202012Validator(schema_of(command)).validate(table)
    else:
        assert_fits_exactly(schema_of(command), table)


def test_every_command_is_in_the_contract() -> None:
    group: Any = get_command(build_app())
    assert {command for command, _ in CALLS} | ELSEWHERE == set(group.commands)
