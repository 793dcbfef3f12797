# SPDX-License-Identifier: Apache-2.0
"""The registry of controllers: names, classes, references, and what is refused."""

import hashlib
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

import pytest

import palmbots as pb
import palmbots._core as _core
from palmbots.control.interface import (
    MESSAGE_KINDS,
    MOVES,
    PALMS,
    MessageKind,
    Move,
    Palm,
    StepInput,
    StepOutput,
)
from palmbots.control.registry import (
    controller_names,
    describe,
    recover,
    refusal,
    register,
    resolve,
    shipped_names,
    unregister,
)
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.spec import to_spec

SOURCE = '''
from palmbots.control import StepInput, StepOutput


class Silent:
    """Corrects its own contact and sends nothing."""

    cases = {"a": "own p > 0"}

    def step(self, seen: StepInput) -> StepOutput:
        away = seen.sign < 0
        return StepOutput(move="away" if away else "hold", case="a" if away else " ")
'''


class Still:
    """Holds the nominal speed."""

    def step(self, seen: StepInput) -> StepOutput:
        return StepOutput()


@pytest.fixture
def registered() -> Iterator[str]:
    register("still", Still)
    yield "still"
    unregister("still")


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "mine.py"
    path.write_text(SOURCE, encoding="utf-8")
    return path


def test_shipped_controllers_are_those_of_the_core() -> None:
    assert shipped_names() == tuple(row["name"] for row in _core.controllers())
    for name in shipped_names():
        entry = resolve(name)
        assert entry.name == name
        assert entry.is_compiled
        assert entry.source is None
        assert entry.for_core(to_spec(pb.load_scene("paper"))) == name
        carry = pb.carry("paper", name, overrides={"task.distance_m": 0.3}, record=False)
        assert (carry.messages > 0) == entry.uses_radio
        assert (carry.bounds is not None) == entry.has_time_bounds
        cases = {correction.case for correction in carry.corrections}
        assert cases <= set(entry.cases)


def test_registered_controller_is_usable_by_name(registered: str) -> None:
    assert registered in controller_names()
    assert pb.carry("paper", registered, record=False).controller == "still"
    rows = pb.compare(controllers=["none", registered], values=[0.05], carries=3).rows
    # A controller that never corrects is `none`, up to its name.
    assert [(row.drop_rate, row.rms_m) for row in rows][:1] * 2 == [
        (row.drop_rate, row.rms_m) for row in rows
    ]


def test_unregistered_controller_is_gone(registered: str) -> None:
    unregister(registered)
    with pytest.raises(PalmbotsError, match=r"did you mean|allowed: none, centralized"):
        resolve(registered)
    unregister("distributed")  # a shipped one stays
    assert "distributed" in controller_names()


def test_file_reference_gives_the_class_and_the_hash_of_its_file(file: Path) -> None:
    entry = resolve("mine.py:Silent")
    assert entry.name == "Silent"
    assert entry.description == "Corrects its own contact and sends nothing."
    assert entry.cases == {"a": "own p > 0"}
    assert entry.assisted_cases == ()
    assert entry.source is not None
    assert entry.source.reference == "mine.py:Silent"
    assert entry.source.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert resolve("mine.py:Silent").maker is entry.maker  # the same source is the same class
    assert pb.carry("paper", "mine.py:Silent", record=False).controller == "Silent"


def test_folder_of_a_relative_file_may_be_given(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")
    with pytest.raises(PalmbotsError, match=r"mine\.py: cannot be read: No such file"):
        resolve("mine.py:Silent")
    assert resolve("mine.py:Silent", folder=str(tmp_path)).name == "Silent"


def test_module_reference_is_imported(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "mine", raising=False)  # of another test in this process
    assert resolve("palmbots.control:DistributedController").name == "DistributedController"
    entry = resolve("mine:Silent")
    assert entry.source is not None
    assert entry.source.reference == "mine:Silent"
    sys.modules.pop("mine")


def test_controller_that_raises_is_named_and_keeps_its_cause() -> None:
    class Broken:
        def step(self, seen: StepInput) -> StepOutput:
            raise ZeroDivisionError("division by zero")

    with pytest.raises(PalmbotsError, match=r"Broken.step failed: ZeroDivisionError") as caught:
        pb.carry(controller=Broken)
    assert isinstance(caught.value.__cause__, ZeroDivisionError)


def test_only_resilient_has_a_timing_check() -> None:
    late = pb.load_scene("paper", {"radio.latency_s": 0.6})
    for name in ("none", "centralized", "distributed"):
        assert refusal(name, late) is None
    with pytest.raises(SceneError, match=r"radio\.lease_s"):
        bounds_of(late)
    assert "radio.lease_s" in (refusal("resilient", late) or "")
    assert bounds_of(pb.load_scene("paper")) == pb.carry("paper", "resilient", record=False).bounds


def test_python_class_named_like_a_shipped_controller_is_not_mistaken_for_it() -> None:
    mimic = type("resilient", (Still,), {})
    carry = pb.carry("paper", mimic, overrides={"radio.latency_s": 0.6}, record=False)
    assert carry.bounds is None
    assert carry.controller_entry is not None
    assert not carry.controller_entry.is_periodic


def test_unknown_name_is_described_without_properties() -> None:
    entry = describe("learnt")
    assert (entry.name, entry.team, entry.cases) == ("learnt", "robots", {})


def test_class_of_a_script_is_referenced_by_its_file(file: Path) -> None:
    """In a script the class is in ``__main__``; another process finds it in the file."""
    script = file.with_name("script.py")
    script.write_text(
        SOURCE
        + "\nfrom palmbots.control import resolve\nprint(resolve(Silent).source.reference)\n",
        encoding="utf-8",
    )
    command = [sys.executable, str(script)]
    run = subprocess.run(command, capture_output=True, text=True, cwd=file.parent, check=True)
    assert run.stdout == "script.py:Silent\n"


def test_logged_controller_is_found_by_its_reference(file: Path) -> None:
    entry = resolve("mine.py:Silent")
    result = recover("Silent", entry.source)
    assert result.maker is entry.maker
    assert result.source == entry.source
    assert recover("distributed", None) is resolve("distributed")


def test_logged_controller_with_another_source_is_refused_before_it_runs(file: Path) -> None:
    source = resolve("mine.py:Silent").source
    file.write_text("raise SystemExit('this file was executed')\n", encoding="utf-8")
    with pytest.raises(PalmbotsError, match=r"mine\.py:Silent has changed since the log"):
        recover("Silent", source)
    file.unlink()
    with pytest.raises(PalmbotsError, match=r"mine\.py:Silent is not found; pass controller="):
        recover("Silent", source)


def test_local_class_cannot_be_found_again() -> None:
    class Local(Still):
        pass

    source = resolve(Local).source
    assert source is not None
    assert source.reference is None
    with pytest.raises(PalmbotsError, match=r"no file of the class Local; pass controller=Local"):
        recover("Local", source)


def test_class_that_was_defined_without_a_file_carries() -> None:
    """As in ``python -c``: its source is unknown, so a log of it needs ``controller=``."""
    program = f"""
import palmbots as pb
exec({SOURCE!r})
print(pb.carry("paper", Silent, overrides={{"task.distance_m": 0.1}}, record=False).controller)
print(pb.control.resolve(Silent).source)
"""
    run = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert run.stdout.splitlines() == [
        "Silent",
        "ControllerSource(reference='__main__:Silent', sha256=None)",
    ]


def test_names_of_palms_moves_and_messages_are_those_of_the_core() -> None:
    assert get_args(Palm) == PALMS == ("steep", "shallow")
    assert get_args(Move) == MOVES == ("hold", "away", "closer")
    assert (None, *get_args(MessageKind)) == MESSAGE_KINDS
    assert [_core.MessageKind[name] for name in get_args(MessageKind)] == [1, 2, 3]


def test_numbers_on_boards_never_change() -> None:
    numbers = {name: resolve(name).board_number for name in shipped_names()}
    assert numbers.items() >= {
        "none": None, "resilient": 0, "silent": 1, "shared-sign": 2, "distributed": 3,
        "centralized": 5,
    }.items()  # fmt: skip
    assert resolve("examples/policies/table-1.toml").board_number == 4
    assert resolve(Still).board_number is None
