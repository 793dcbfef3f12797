# SPDX-License-Identifier: Apache-2.0
"""What the commands have in common: the scene, warnings, and the presentation of a result."""

import json
import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palmbots._util.arguments import show
from palmbots._util.plain_values import plain
from palmbots.cli._streams import say
from palmbots.cli._warnings import print_held_warnings, warn
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots._util.report import Item
    from palmbots._util.results import Result
    from palmbots.control.registry import ControllerEntry
    from palmbots.scene.scene import Scene


def check_rate(rate: float) -> float:
    """The rate, if it is one.

    Raises:
        PalmbotsError: it is too small or too large.
    """
    if not 0.01 <= rate <= 100:
        raise PalmbotsError(f"rate: value is {show(rate)}; allowed: a number from 0.01 to 100")
    return rate


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
            say(line)
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


def load(source: str, changes: list[str] | None) -> "Scene":
    """The scene of a command, with the overrides of ``--set``; prints its warnings."""
    from palmbots.scene.overrides import parse_overrides
    from palmbots.scene.scene import load_scene

    overrides = parse_overrides(changes or [])
    return load_scene(source, overrides, called="--set", on_warning=warn)


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


def check_output(out: Path | None) -> None:
    """Check, before the work, that figures can be written to the folder `out`.

    Raises:
        PalmbotsError: `out` cannot be a folder.
    """
    if out is not None:
        from palmbots._util.atomic_files import check_folder

        check_folder(out)


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
        out: the folder for its figure; None: draw none.
        file: name of the figure in the folder.
    """
    if out is not None and file:
        from palmbots._util.atomic_files import folder

        written = [*written, folder(out) / file]
        result.save_figure(written[-1])
    if as_json:
        print_json(result)
    else:
        from palmbots.cli.console import print_report

        print_report([*result.lines(), *after], about, written)


def print_json(result: Any) -> None:
    """Print one JSON object on stdout: a table, or what JSON has of a dataclass."""
    print_held_warnings()
    print(json.dumps(plain(result), allow_nan=False))


def number_list(option: str, text: str) -> list[float]:
    """The numbers of an option such as ``--values 0.1,0.2``."""
    from palmbots._util.arguments import show

    def number(part: str) -> float:
        try:
            return int(part)  # a key for whole numbers rejects 1.0
        except ValueError:
            return float(part)

    try:
        return [number(part) for part in text.split(",")]
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: numbers separated by commas, as in 0.1,0.2"
        ) from None


def interval_or_word(option: str, words: Sequence[str], text: str) -> Any:
    """An option that is a word, or the two ends of an interval, as in ``--region -0.05,0.05``."""
    if text in words:
        return text
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: {', '.join(words)}, or two numbers "
            "separated by a comma, as in -0.05,0.05"
        ) from None
    return low, high


def set_aside_certificate(path: Path) -> None:
    """Rename an older certificate that could be mistaken for the result of this run."""
    from palmbots._util.atomic_files import set_aside

    kept = set_aside(path)
    if kept is not None:
        warn(f"nothing is proved; {path} is from an earlier run and was renamed to {kept}")
