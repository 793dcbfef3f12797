# SPDX-License-Identifier: Apache-2.0
"""Every public function that takes numbers takes those of NumPy, with the same result.

Arrays replace lists and intervals, and numbers that single precision can represent have it.
"""

import importlib
import inspect
import json
import re
from pathlib import Path
from types import FunctionType
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._util.results import Result
from palmbots.mechanics import SurfaceContact
from palmbots.scene.spec import to_spec
from palmbots.studies import load_plan
from sampled import in_soak
from shape_files import prism, stl, written
from short_validation import FEW_LINES
from study_fixtures import SMALL

SHORT = {"task.distance_m": 0.125}
STATE = {
    "width": 0.25, "com_x": 0.125, "com_y": 0.0625, "theta_left": 0.25, "theta_right": 0.25,
    "p_left": 0.0, "p_right": [0.0, 0.015625], "friction_left": 0.3125, "friction_right": 0.3125,
    "offset_left": 0.0, "offset_right": 0.0, "slope": 0.0,
}  # fmt: skip
KEYS = {"object.contacts": [0, 1], "object.com_m": [0.125, 0.0625], "radio.loss": 0.25}
PALMS = {"p_left_m": 0.015625, "p_right_m": -0.03125, "theta_left_deg": 5, "theta_right_deg": 15.0}
ARC = {"task.path.kind": "arc", "task.path.radius_m": 2, "task.distance_m": 0.25}
STUDY = {**SMALL, "set": SHORT, "seeds": {"count": 2}}

# Arguments by function, with every parameter that is a number; a `Path` is a new folder.
CALLS: dict[str, dict[str, Any]] = {
    "analyze": {"region_m": (-0.03125, 0.03125)},
    "assess": {"turn_radius_m": 0.0, "turn_angle_deg": 45, "friction": (0.25, 0.3125),
               "overrides": SHORT},
    "bound": {"speeds": "corrections", "drop_rate": 0.25, "overrides": SHORT},
    "carry": {"seed": 3, "forks": ((1.5, 4), (2, 5)), "overrides": {**SHORT, **KEYS}},
    "carry_and_report": {"seed": 3, "seeds": 3, "forks": ((1.5, 4), (2, 5)), "overrides": SHORT},
    "certify": {"max_boxes": 1000, "region_m": (-0.03125, 0.03125), "beyond_m": 0.0,
                "friction": (0.3125, 0.3125)},
    "compare": {"values": [0, 0.25], "carries": 3, "seed": 2, "overrides": SHORT},
    "consistent_modes": {"slope": 0.125},
    "contact_modes": PALMS,
    "contact_modes_batch": STATE,
    "contacts": PALMS,
    "design": {"maximize": "com", "seed": 1, "friction": (0.25, 0.3125),
               "com_y_m": (0.0625, 0.0625), "slope_deg": (0, 1), "region_m": (-0.03125, 0.03125),
               "angle_range_deg": (5, 15), "resolution_deg": 5, "overrides": SHORT},
    "estimate_drop_rate": {"relative_half_width": 1.0, "effort": 50, "seed": 1, "threads": 1,
                           "budget": 2000,
                           "overrides": {**SHORT, "robot.noise_m_s": 0.03125}},
    "export": {"seeds": 2, "parquet": Path("made"), "overrides": SHORT},
    "feasible_contact_modes": STATE,
    "import_object": {"scale": 0.5, "cut": 0.25, "tolerance_mm": 1.5, "depth_mm": 100.0,
                      "density_kg_m3": 200.0, "mass_kg": 0.5, "com_mm": (60.0, 40.0),
                      "unit": "mm"},
    "learn.run_episode": {"seed": 3},
    "mujoco.forecast_drift": {"seeds": 1, "scene": pb.load_scene("paper", ARC)},
    "final_place": {"jobs": 100},
    "noise_limit": {"drop_rate": 0.25, "relative_half_width": 0.0625, "seed": 1, "threads": 1,
                    "overrides": SHORT},
    "probe": {"com_x_m": (0.1171875, 0.1328125), "com_y_m": (0.03125, 0.046875),
              "friction": (0.25, 0.375), "angle_error_deg": 0.25, "angle_range_deg": (5, 45),
              "seed": 1},
    "simulation.count_outcomes": {"seeds": 3, "overrides": SHORT},
    "simulation.run_batch": {"specs": [to_spec(pb.load_scene("paper", SHORT))],
                             "spec_index": [0, 0], "seeds": [1, 2], "threads": 1},
    "simulation.run_seeds": {"spec": to_spec(pb.load_scene("paper", SHORT)), "first": 1, "n": 2,
                             "threads": 1},
    "stability.reaction": {"scene": pb.load_scene("paper"), "shallow": [0.0625, 0.125],
                           "steep": [0.25, 0.25]},
    "stability.self_check": {"region_m": (-0.03125, 0.03125)},
    "stability.stability_problem": {"scene": pb.load_scene("paper"), "beyond_m": 0.015625,
                                    "region_m": (-0.03125, 0.03125)},
    "studies.load_plan": {"source": STUDY, "carries": 3},
    "studies.run_study": {"out": Path(), "threads": 1, "chunk_size": 4},
    "study": {"source": STUDY, "out": Path(), "carries": 2, "threads": 1, "chunk_size": 4},
    "validate": {"states": 1, "carries": 1,
                 "scene": pb.load_scene("paper", {"task.distance_m": 0.03125})},
    "viz.draw_carry": {"window": (0, 1.5)},
    "viz.draw_message_sequence": {"window": (0, 1.5)},
    "viz.draw_side_view": {"time_s": 0.5},
    "viz.draw_timeline": {"window": (0, 1.5)},
    "viz.save_animation": {"fps": 2},
}  # fmt: skip
CALLS["simulation.run_batch"]["controller"] = CALLS["simulation.run_seeds"]["controller"] = "silent"
ELSEWHERE = {
    "mujoco.compare_on_curve": "takes a minute",
    "mujoco.carry_route": "takes a minute",
    "mujoco.find_speed_limits": "takes minutes",
    "mujoco.plan_route": "takes a minute",
    "mujoco.save_still": "needs a screen or EGL",
    "mujoco.save_video": "needs a screen or EGL",
    "optimum.compare_with_law": "takes minutes",
    "studies.estimate_cost": "measures a time",
    "wire.decode": "bytes",
}
OF_A_RUN = {"output", "parquet", "seconds"}
NUMBERS = {"int", "float", "Interval", "Range", "Region", "FloatArray", "ArrayLike"}


def public_functions() -> dict[str, FunctionType]:
    rooms = [name for name in dir(pb) if inspect.ismodule(getattr(pb, name))]
    modules = {"": pb} | {f"{room}.": importlib.import_module(f"palmbots.{room}") for room in rooms}
    return {
        f"{prefix}{name}": found
        for prefix, module in modules.items()
        for name in dir(module)
        if isinstance(found := getattr(module, name), FunctionType)
    }


def number_parameters(function: FunctionType) -> set[str]:
    """The parameters that are numbers; those about progress are functions."""
    found = set()
    for name, parameter in inspect.signature(function).parameters.items():
        words = set(re.findall(r"\w+", inspect.formatannotation(parameter.annotation)))
        if words & NUMBERS and "Callable" not in words:
            found.add(name)
    return found


def as_numpy(value: Any) -> Any:
    if isinstance(value, bool | str | Path):
        return value
    if isinstance(value, int):
        return np.int32(value)
    if isinstance(value, float):
        return np.float32(value) if np.float32(value) == value else np.float64(value)
    if isinstance(value, dict):
        return {key: as_numpy(inner) for key, inner in value.items()}
    if isinstance(value, list) and isinstance(value[0], int | float):
        return np.array(value)
    if isinstance(value, tuple) and all(isinstance(inner, float) for inner in value):
        return np.array(value)
    if isinstance(value, tuple):
        return tuple(map(as_numpy, value))
    return value


def shown(result: Any) -> Any:
    """What two results must have in common."""
    if isinstance(result, Result):
        return {key: value for key, value in result.summary().items() if key not in OF_A_RUN}
    if hasattr(result, "axes"):  # a figure
        return [(panel.get_xlim(), len(panel.lines)) for panel in result.axes]
    if isinstance(result, dict):
        return {key: shown(value) for key, value in result.items()}
    if hasattr(result, "to_dict"):  # a dataset
        return json.loads(json.dumps(result.to_dict(), default=str))
    if hasattr(result, "tolist"):
        return result.tolist()
    if hasattr(result, "_asdict"):
        return {key: shown(value) for key, value in result._asdict().items()}
    return re.sub(r"np\.float32\((.*?)\)", r"\1", repr(result))


def completed(name: str, given: dict[str, Any], folder: Path) -> tuple[list[Any], dict[str, Any]]:
    """The arguments, with what a call needs besides numbers."""
    given = {
        key: folder / "made" if isinstance(value, Path) else value for key, value in given.items()
    }
    if name == "studies.run_study":
        return [load_plan(STUDY)], given
    if name == "import_object":
        box = prism([(0, 0), (250, 0), (250, 160), (0, 160)], 100)
        return [written(folder / "box.stl", stl(box))], given
    if name == "consistent_modes":
        return [[SurfaceContact("floor", (x, -0.1), (0, 1), 0.25) for x in (-0.1, 0.1)]], given
    if name == "learn.run_episode":
        from palmbots.learn.carry_v0 import parallel_env

        return [parallel_env("paper", overrides=SHORT)], given
    if name.startswith("viz."):
        carry = pb.carry("paper", overrides=SHORT)
        return [carry, *([folder / "film.gif"] if "save" in name else [])], given
    return [], given


def test_every_public_function_with_numbers_is_called() -> None:
    numbers = {name: number_parameters(one) for name, one in public_functions().items()}
    assert {name for name, found in numbers.items() if found} == {*CALLS, *ELSEWHERE}
    for name, given in CALLS.items():
        assert numbers[name] - {"local_cluster"} <= set(given), name  # it starts processes


# They call the others, and take long.
LONG = ("assess", "validate")


@pytest.mark.parametrize("name", [in_soak(name) if name in LONG else name for name in CALLS])
def test_numbers_of_numpy_give_the_same(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for constant, value in FEW_LINES.items():
        monkeypatch.setattr(constant, value)
    for part in ("load", "changes"):  # of assess; no number of the caller gets there
        monkeypatch.setattr(f"palmbots.assessment.assess.try_{part}", lambda *given: None)
    function: Any = public_functions()[name]
    found = []
    for k, given in enumerate((CALLS[name], as_numpy(CALLS[name]))):
        (folder := tmp_path / str(k)).mkdir()
        first, others = completed(name, given, folder)
        found.append(shown(function(*first, **others)))
    assert found[0] == found[1]
