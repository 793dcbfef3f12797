# SPDX-License-Identifier: Apache-2.0
"""Controllers in Python as part of a study."""

import contextlib
import functools
import socket
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

import palmbots as pb
from palmbots import control
from palmbots.control.registry import shipped_names
from palmbots.errors import PalmbotsError
from palmbots.studies.cost_estimate import estimate_cost
from palmbots.studies.points import design_points
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import layout_of, run_study

TABLE: dict[str, Any] = {
    "set": {"task.distance_m": 0.2},
    "vary": {"robot.noise_m_s": [0.02, 0.05]},
    "seeds": {"first": 3, "count": 4},
}


class Table2:
    """The shipped distributed controller, called from Python."""

    def __init__(self) -> None:
        self._shipped = control.DistributedController()

    def step(self, seen: control.StepInput) -> control.StepOutput:
        return self._shipped.step(seen)


class Still:
    """A controller that corrects nothing."""

    def step(self, seen: control.StepInput) -> control.StepOutput:
        return control.StepOutput()


def carry_values(found: xr.Dataset, controller: str) -> dict[str, Any]:
    one = found.sel(controller=controller).load()
    names = ("outcome", "reason", "time_s", "contact_rms_m", "contact_peak_m", "messages")
    return {name: one[name].values for name in (*names, "waiting_s", "corrections")}


def test_controller_in_python_has_the_results_of_the_compiled_one(tmp_path: Path) -> None:
    """Bit for bit in every variable; in every chunk size."""
    found = pb.study({**TABLE, "controllers": ["distributed", Table2]}, tmp_path / "study")
    compiled, python = (carry_values(found, name) for name in ("distributed", "Table2"))
    for name, values in compiled.items():
        np.testing.assert_array_equal(python[name], values, err_msg=name)
    assert (compiled["corrections"] > 0).any()
    assert (found.drop_rate_difference.sel(controller="Table2") == 0).all()
    again = run_study(
        load_plan({**TABLE, "controllers": ["distributed", Table2]}), tmp_path / "2", chunk_size=3
    )
    assert again.hash == found.attrs["hash"]


def test_any_number_of_controllers_is_allowed(tmp_path: Path) -> None:
    """All shipped ones and two classes."""
    shipped = shipped_names()
    result = run_study(
        load_plan({**TABLE, "controllers": [*shipped, Table2, Still]}), tmp_path / "s"
    )
    names = result.dataset().controller.values.tolist()
    assert names == [*shipped, "Table2", "Still"]
    values = carry_values(result.dataset(), "Still")
    expected = carry_values(result.dataset(), "none")
    np.testing.assert_array_equal(values["contact_rms_m"], expected["contact_rms_m"])
    assert result.plot().axes


def test_figure_gives_controllers_in_python_different_looks(tmp_path: Path) -> None:
    result = run_study(load_plan({**TABLE, "controllers": [Table2, Still]}), tmp_path / "study")
    lines = result.plot().axes[0].lines
    assert len({line.get_color() for line in lines}) == 2
    assert len({line.get_marker() for line in lines}) == 2


FILE = """
from palmbots import control

class Mine:
    def step(self, seen):
        return control.StepOutput(palm="steep")
"""


def test_controller_of_a_file_is_found_beside_the_study_file(tmp_path: Path) -> None:
    """The name in the results is that of the class."""
    (tmp_path / "mine.py").write_text(FILE)
    (tmp_path / "study.toml").write_text(
        'controllers = ["none", "mine.py:Mine"]\n[set]\ntask.distance_m = 0.2\n[seeds]\ncount = 3\n'
    )
    found = pb.study(tmp_path / "study.toml", tmp_path / "study").load()
    assert found.controller.values.tolist() == ["none", "Mine"]
    np.testing.assert_array_equal(found.contact_rms_m[:, 0], found.contact_rms_m[:, 1])


def test_other_source_is_another_study(tmp_path: Path) -> None:
    """The folder of a study is refused once the file of a controller has changed."""
    file = tmp_path / "mine.py"
    file.write_text(FILE)
    table = {**TABLE, "controllers": [f"{file}:Mine"]}
    pb.study(table, tmp_path / "study")
    file.write_text(FILE.replace("steep", "shallow"))
    with pytest.raises(PalmbotsError, match=r"another study: controllers is .*Mine \(source"):
        pb.study(table, tmp_path / "study")
    file.write_text(FILE)
    pb.study(table, tmp_path / "study")


def test_cost_of_a_controller_in_python_is_measured_by_single_carries() -> None:
    points = design_points(load_plan({**TABLE, "controllers": ["distributed", Table2]}))
    cost = estimate_cost(points, layout_of(points, None), 1)
    assert cost.ms_a_carry["Table2"] > 3 * cost.ms_a_carry["distributed"]


@pytest.mark.slow
def test_cluster_carries_controllers_in_python(tmp_path: Path) -> None:
    """Also a class that is defined in a function, and one in a file that workers cannot import."""

    class Local(Table2):
        pass

    (tmp_path / "mine.py").write_text(FILE)
    plan = load_plan({**TABLE, "controllers": ["none", Local, f"{tmp_path}/mine.py:Mine"]})
    with contextlib.ExitStack() as held:
        with contextlib.suppress(OSError):  # then it is in use already
            held.enter_context(socket.create_server(("", 8787)))  # Dask's default port
        cluster = run_study(plan, tmp_path / "cluster", local_cluster=1)
    assert cluster.hash == run_study(plan, tmp_path / "here").hash


def test_cluster_refuses_a_controller_that_cannot_be_pickled(tmp_path: Path) -> None:
    """Before anything is written or a worker starts."""

    class Locked(Still):
        def __init__(self, lock: Any) -> None:
            self.lock = lock

    maker = functools.partial(Locked, threading.Lock())
    plan = load_plan({**TABLE, "controllers": [maker]})
    with pytest.raises(PalmbotsError, match=r"cannot be sent to the workers .*pickle") as caught:
        run_study(plan, tmp_path / "study", local_cluster=1)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "study").exists()
    assert run_study(plan, tmp_path / "study").carries == 8, "on this machine it is allowed"


def test_controller_that_fails_ends_the_study_in_one_line(tmp_path: Path) -> None:
    class Broken:
        def step(self, seen: control.StepInput) -> control.StepOutput:
            return control.StepOutput(palm="sideways")  # ty: ignore[invalid-argument-type]  # is refused

    with pytest.raises(PalmbotsError, match="sideways"):
        pb.study({**TABLE, "controllers": ["none", Broken]}, tmp_path / "study")
    assert not (tmp_path / "study").exists(), "nothing was carried, so nothing is kept"
