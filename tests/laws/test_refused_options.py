# SPDX-License-Identifier: Apache-2.0
"""What every command refuses, whatever it does: unknown options, texts that are no numbers, values
outside the declared limits, wrong values of common options, and outputs that cannot be written.
"""

import importlib
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest
from typer.main import get_command

from commands import FUNCTIONS, Run, assert_refused, required
from palmbots.cli.declared_commands import Declared, commands_of, declared_commands, writer_of
from palmbots.cli.main import build_app
from palmbots.control.registry import shipped_names
from palmbots.errors import PalmbotsError
from palmbots.simulation import world_names

NUMBERS: dict[type, str] = {int: "a whole number", float: "a number"}
COMMON = {  # a wrong value of an option that several commands have, and what is said
    "--controller": ("magic", f'value is "magic"; allowed: {", ".join(shipped_names())}, '
                     "module:Class, FILE.py:Class, FILE.toml, FILE.toml@station"),
    "--world": ("moon", 'value is "moon"; did you mean mujoco? allowed: '
                f'{", ".join(world_names())}'),
    "--precision": ("half", 'value is "half"; allowed: double, float'),
    "--seed": ("-1", "value is -1; allowed: a whole number from 0 to 2^64-1"),
    "--format": ("gif", 'value is "gif"; allowed: png, svg, pdf'),
    "--set": ("radio.los=0.1",
              "radio.los: 0.1 is the value of an unknown key; did you mean radio.loss?"),
}  # fmt: skip
NEEDED = {"export": ("--urdf", "a"), "world": ("--lockstep",), "init": ("new.toml",)}
"""Words without which some of a command's options are not looked at."""


def options(
    group: Any = None, prefix: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Every option of every command, with the words of the command."""
    at: Any = group or get_command(build_app())
    for name, command in at.commands.items():
        if hasattr(command, "commands"):
            yield from options(command, (*prefix, name))
            continue
        for parameter in command.params:
            if parameter.param_type_name == "option":
                yield (*prefix, name), parameter


def numbers_of(option: Any) -> list[type]:
    """The types of the numbers that an option takes; empty: it takes none."""
    kind = option.type_descriptor.annotation
    parts = get_args(kind) or (kind,)
    found = [one for part in parts for one in get_args(part) or (part,)]
    return [one for one in found if one in NUMBERS]


def choices(hint: Any) -> tuple[str, ...]:
    """The words of which a parameter is one; empty: it may be something else."""
    is_choice = get_origin(hint) is Literal
    parts = [hint] if is_choice else [one for one in get_args(hint) if one is not NoneType]
    return get_args(parts[0]) if [get_origin(one) for one in parts] == [Literal] else ()


OPTIONS = list(options())
NUMERIC = [(words, one) for words, one in OPTIONS if numbers_of(one)]
LIMITED = [(one, key, option) for one in FUNCTIONS for key, option in one.options.items()
           if option.least is not None and option.most is not None]  # fmt: skip
PLACES = [(words, name) for words, one in OPTIONS
          if one.metavar in ("DIR", "FILE", "FILE.toml", "LOG", "PROBE")
          for name in one.opts]  # fmt: skip


def test_options_are_found() -> None:
    assert {words[0] for words, _ in NUMERIC} > {"carry", "certify", "doctor", "noise-limit"}
    assert {one.name for one, *_ in LIMITED} >= {"noise-limit", "bound", "drop-rate"}
    places = {(*words, option) for words, option in PLACES}
    assert places > {("carry", "--out"), ("certify", "-o"), ("design", "--from"), ("import", "-o")}
    assert set(COMMON) <= {name for _, one in OPTIONS for name in one.opts}


def test_every_command_refuses_an_unknown_option(here: Run) -> None:
    for words in {words for words, _ in OPTIONS}:
        path = " ".join(words)
        done = here(*words, "--frobnicate")
        assert_refused(done, f"palmbots {path}: No such option: --frobnicate")
        assert done.stderr.endswith(f"; see palmbots {path} --help\n")


def test_every_option_refuses_a_missing_value(here: Run) -> None:
    """The line names the command, as other faults of usage do."""
    for words, option in OPTIONS:
        if not option.is_flag:
            count = f"{option.nargs} arguments" if option.nargs > 1 else "an argument"
            path = " ".join(words)
            line = f"palmbots {path}: Option '{option.opts[0]}' requires {count}; see "
            done = here(*words, option.opts[0])
            assert done.stderr == f"{line}palmbots {path} --help\n", done
            assert_refused(done)


def test_every_number_refuses_what_is_none(here: Run) -> None:
    for words, option in NUMERIC:
        kinds, name = numbers_of(option), option.opts[0]
        for wrong in ("1cm", "", "1.5")[: 3 if kinds[0] is int else 2]:
            fine = [] if len(kinds) == 1 else ["0.1"]
            line = f'palmbots: {name}: value is "{wrong}"; allowed: {NUMBERS[kinds[-1]]}; see '
            done = here(*words, name, *fine, wrong)
            assert done.stderr == f"{line}palmbots {' '.join(words)} --help\n", done
            assert_refused(done)


def test_values_outside_the_declared_limits_are_refused(here: Run) -> None:
    """By the command, and by the function that it calls."""
    for command, key, option in LIMITED:
        function, least, most = command.load(), option.least, option.most
        assert least is not None and most is not None
        scale = 100 if option.percent else 1
        step = 1 if isinstance(least, int) else 1e-4 * max(1, most)
        shown = str if isinstance(least, int) else "{:g}".format
        usual = f"--{key.replace('_', '-')}{'-percent' * option.percent}"
        name = (option.names.split() or [usual])[0]
        parameters = inspect.signature(function).parameters.values()
        needed = {one.name: "paper" for one in parameters if one.default is one.empty}
        for value in (least - step, most + step):
            typed = shown(scale * value)
            limits = f"allowed: {shown(scale * least)} to {shown(scale * most)}"
            done = here(command.name, *required(command), name, typed)
            assert_refused(done, f"palmbots: {name}: value is {typed}; {limits}\n")
            with pytest.raises(PalmbotsError) as error:
                function(**needed, **{key: value})
            limits = f"allowed: {shown(least)} to {shown(most)}"
            assert str(error.value) == f"{key}: value is {shown(value)}; {limits}"


def test_unknown_choices_are_refused(here: Run) -> None:
    """Where the parameter of a function is one of some words."""
    found = 0
    for one in (one for name in declared_commands() for one in commands_of(name)):
        kinds = {key: hint for key, hint in get_type_hints(one.load()).items() if choices(hint)}
        words = tuple(one.name.split())
        typed = {option.name: option.opts[0] for at, option in OPTIONS if at == words}
        for key, hint in kinds.items():
            files = [key for key in required(one) if key not in typed]
            done = here(*words, *files, typed[key], f"{choices(hint)[0]}x")
            line = f'value is "{choices(hint)[0]}x"; did you mean {choices(hint)[0]}? allowed: '
            assert_refused(done, f"palmbots: {typed[key]}: {line}{', '.join(choices(hint))}")
            found += 1
    assert found > 5


@pytest.mark.parametrize("name", COMMON)
def test_common_options_are_refused_alike(
    name: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    wrong, line = COMMON[name]
    between = " " if name == "--set" else ": "
    for words, option in OPTIONS:
        if name in option.opts:
            assert_refused(
                here(*words, *NEEDED.get(words[0], ()), name, wrong),
                f"palmbots: {name}{between}{line}",
            )
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("words", "option"), PLACES)
def test_empty_name_of_a_file_is_refused(
    words: tuple[str, ...], option: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``--out "$DIR"`` with DIR unset must not mean the working directory."""
    monkeypatch.chdir(tmp_path)
    argument = ["study.toml"] if words == ("study",) else []
    assert_refused(here(*words, *argument, option, ""), option, 'value is ""; allowed: a name')
    assert list(tmp_path.iterdir()) == []


def folder_option(one: Declared) -> str | None:
    """The option of a command that names the folder to write its result to."""
    writer = writer_of(one)
    place = None if writer is None else next(iter(writer.options.values()))
    if place is not None and place.metavar == "DIR":
        return place.names.split()[0] if place.names else "--out"
    return "--out" if one.declaration.figure else None


# Command with an output, and the function that does the work.
WORK = {
    **{
        (one.name, *required(one), option): (one.module, one.function_name)
        for one in FUNCTIONS
        if (option := folder_option(one)) is not None
    },
    ("carry", "--out"): ("palmbots.simulation.single", "carry"),
}
PROOF = ("palmbots.stability.certificates.prover", "certify")


def forbid_work(command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    def work(*_: object, **__: object) -> None:
        pytest.fail("worked before the output was checked")

    module, function = WORK.get(command, PROOF)
    monkeypatch.setattr(importlib.import_module(module), function, work)


@pytest.mark.parametrize("command", WORK, ids=" ".join)
def test_impossible_folder_is_refused_before_the_work(
    command: tuple[str, ...], here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A misspelt --out must not cost hours of carries."""
    forbid_work(command, monkeypatch)
    taken = tmp_path / "file"
    taken.write_text("mine")
    assert_refused(here(*command, str(taken)), "file", "cannot be used as a folder")
    assert taken.read_text() == "mine"


@pytest.mark.parametrize("name", ["none/box.json", "file/box.json", ".", "/dev/full"])
def test_impossible_certificate_file_is_refused_before_the_proof(
    name: str, here: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    certify = ("certify", "--out")
    forbid_work(certify, monkeypatch)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("mine")
    assert_refused(here(*certify, name), f"palmbots: {name}: cannot be written: ")
