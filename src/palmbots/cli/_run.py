# SPDX-License-Identifier: Apache-2.0
"""What the commands have in common: the scene, warnings, and the presentation of a result."""

import json
import os
import shlex
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.plain_values import plain
from palmbots._util.user_paths import user_path
from palmbots.cli._streams import say, say_interrupted
from palmbots.cli._warnings import print_held_warnings, warn
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots._util.report import Item
    from palmbots._util.results import Result
    from palmbots.control.registry import ControllerEntry
    from palmbots.scene.scene import Scene


class Interrupted(PalmbotsError):
    """Ctrl-C in a command that has printed a line of its own."""


@contextmanager
def interruption_line(line: str) -> Iterator[None]:
    """Print `line` as soon as Ctrl-C arrives: to close files and workers may take seconds.

    Raises:
        Interrupted: after Ctrl-C, when everything is closed.
    """
    printed = False

    def print_line() -> None:
        nonlocal printed
        if not printed:
            say_interrupted(line)
        printed = True

    def handle(*_: object) -> None:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print_line()
        raise KeyboardInterrupt

    is_main = threading.current_thread() is threading.main_thread()
    before = signal.signal(signal.SIGINT, handle) if is_main else None
    try:
        yield
    except KeyboardInterrupt:
        print_line()
        raise Interrupted(line) from None
    finally:
        if is_main:
            signal.signal(signal.SIGINT, before)


def is_file_name(text: str) -> bool:
    """Whether a word that is no KEY=VALUE names a file: a key has neither a slash nor a file of its
    name."""
    return text.endswith(".toml") or os.sep in text or user_path(text).exists()


def load(source: str, changes: list[str] | None) -> "Scene":
    """The scene of a command, with the files of ``--with`` and then the overrides of ``--set``;
    prints its warnings."""
    from palmbots.scene.files import read_table
    from palmbots.scene.overrides import parse_overrides
    from palmbots.scene.scene import SCENE_FILE, beside, empty_tables, load_scene

    files = [one for one in changes or () if "=" not in one and is_file_name(one)]
    overrides = parse_overrides(one for one in changes or () if one not in files)
    scene = load_scene(source, None if files else overrides, called="--set", on_warning=warn)
    for file in files:
        part = read_table(file, SCENE_FILE)
        empty = empty_tables(part)
        for place in empty if len(empty) < len(part) else [""]:
            warn(f"{file}: {place and f'[{place}] '}sets nothing")
        scene = load_scene(scene, beside(file, part), called=f"{file}:")
    if files:
        scene = load_scene(scene, overrides, called="--set")
    scene = scene.model_copy()
    scene.spell(shlex.join([source, *(word for one in changes or () for word in ("--set", one))]))
    return scene


def controller_of(
    name: str, *, unproved: bool = False, called: str = "controller", quiet: bool = False
) -> "ControllerEntry":
    """The controller of a command. If the check of a policy fails, print the run that shows it.

    Raises:
        PalmbotsError: there is no such controller, or the check fails and `unproved` is not set.
    """
    from palmbots.control.registry import controller_names, resolve

    if not name.endswith(".toml") or name in controller_names():
        if unproved:
            raise PalmbotsError(f"--unproved needs a policy file as {called}, as in FILE.toml")
        entry = resolve(name, called=called)
        return entry if quiet or not entry.preparation else _announced(entry)
    from palmbots.cli._progress import progress
    from palmbots.derivation.derived_policy import failure_lines
    from palmbots.derivation.policy_controller import PolicyNotProved, load_policy

    try:
        with progress("checking the policy", quiet) as report:
            entry = load_policy(name, called=called, unproved=unproved, on_progress=report)
    except PolicyNotProved as error:
        found = error.verification
        for line in failure_lines(found, found.fails[:1])[1:]:
            say(line)
        raise
    if unproved:
        warn(f"{called}: the algorithm that was derived from {name} is not checked (--unproved)")
    return entry


def _announced(entry: "ControllerEntry") -> "ControllerEntry":
    """The entry, with a line before its first policy is computed."""
    make = entry.policy_maker
    assert make is not None
    is_first = True

    def maker(spec: Any) -> Any:
        nonlocal is_first
        if is_first:
            say(f"palmbots: {entry.name}: computing {entry.preparation} (seconds per scene)")
        is_first = False
        return make(spec)

    return replace(entry, policy_maker=maker)


def check_output(out: Path | None, *, or_picture: bool = False) -> bool:
    """Check, before the work, that figures can be written to the folder `out`, or that one can be
    written to the file `out` if its name is that of a picture.

    Returns:
        Whether it is the name of a picture.

    Raises:
        PalmbotsError: `out` cannot be written.
    """
    if out is None:
        return False
    from palmbots._util.atomic_files import check_file, check_folder

    if or_picture:
        from palmbots.viz.save_figure import is_picture

        if is_picture(out) and not out.is_dir():
            check_file(out)
            return True
    check_folder(out)
    return False


def print_result(
    result: "Result",
    *,
    as_json: bool,
    about: str = "",
    written: Sequence[Path] = (),
    after: Sequence["Item"] = (),
    out: Path | None = None,
    file: str = "",
) -> None:
    """Print a result: its table as JSON, or its lines and the files that were written.

    Args:
        result: the result.
        as_json: print its table.
        about: of what it is, such as the name of a scene.
        written: the files.
        after: further lines for people.
        out: the folder for its figure, or the figure itself; None: draw none.
        file: name of the figure in the folder.
    """
    if out is not None and file:
        from palmbots._util.atomic_files import folder

        is_picture = check_output(out, or_picture=True)
        written = [*written, out if is_picture else folder(out) / file]
        result.save_figure(written[-1])
    if as_json:
        print_json(result)
    else:
        from palmbots._util.report import written_file
        from palmbots.cli.console import print_report

        print_report([*result.lines(), *after, *map(written_file, written)], about)


def print_json(result: Any) -> None:
    """Print one JSON object on stdout: a table, or what JSON has of a dataclass."""
    print_held_warnings()
    print(json.dumps(plain(result), allow_nan=False))
