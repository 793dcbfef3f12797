# SPDX-License-Identifier: Apache-2.0
"""The controllers: the shipped ones, registered ones, and classes that a program passes.

Every other module asks here which controllers exist and what distinguishes them. A controller is
given by its name, as a class with a ``step`` (`palmbots.control.Controller`), or as the text
``module:Class``, ``FILE.py:Class``, ``FILE.toml`` (the algorithm derived from a global policy) or
``FILE.toml@station`` (the policy itself, run by a station). `resolve` turns each of these into a
`ControllerEntry`.
"""

from __future__ import annotations

import shlex
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, TypeAlias

import palmbots._core as _core
from palmbots._util.arguments import one_of, show
from palmbots._util.named_registry import Registry
from palmbots.control.interface import Controller, make_controller_pair, make_step
from palmbots.control.own_code import name_of, own_code
from palmbots.control.python_source import (
    ControllerSource,
    hash_of_reference,
    load_class,
    source_of,
)
from palmbots.control.resilient_timing import bounds_of
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.scene import Scene

WIDE_ZONE = "a zero zone wider than the overrun that the delay of the radio causes"


@dataclass(frozen=True)
class ControllerEntry:
    """One controller, and what other parts of the package need to know about it."""

    name: str
    description: str
    """One line for people."""
    team: Literal["none", "station", "robots"] = "robots"
    """Who decides: no program, one station for both robots, or each robot."""
    board_number: int | None = None
    """Of its program in the settings of boards; None: no board runs it."""
    uses_radio: bool = True
    uses_clock: bool = False
    """Its robots measure time and start at rest. The others act on messages and contacts alone."""
    messages: tuple[str, ...] = ()
    """The kinds of message that it sends."""
    is_periodic: bool = False
    """Robots repeat what they have to say at fixed intervals. A message is news only if it differs
    from the one before."""
    stops_in_silence: bool = False
    """A robot that hears nothing stops."""
    drives_by_both_signs: bool = False
    """The wheels of both robots follow both signs, so that a motion ends a radio delay late."""
    has_time_bounds: bool = False
    """Relies on the time bounds that `bounds_of` computes, and refuses scenes without any."""
    cases: Mapping[str, str] = field(default_factory=dict)
    """What each case in the trace means."""
    states: Mapping[str, str] = field(default_factory=dict)
    """What a robot does in each state of its program, if the states have names."""
    assisted_cases: tuple[str, ...] = ()
    """Cases in which a robot asks its partner for assistance and may get no answer."""
    maker: Callable[[], Controller] | None = None
    """Makes the controller of one robot; None: it is not a controller in Python."""
    machines: tuple[Any, ...] | None = None
    """The tables of both robots, as the compiled core takes them; None: it is not from a policy."""
    station_rows: tuple[Any, ...] | None = None
    """The rows of a policy that a station runs, as the compiled core takes them."""
    source: ControllerSource | None = None
    """The Python class or the policy file; None: the compiled core has this controller."""
    policy_maker: Callable[[Any], _core.OptimalController | _core.LinearFeedback] | None = None
    """Of a reference, which knows more than robots do: makes what the core runs for a `Spec`. None:
    the controller knows what a robot or station knows."""

    preparation: str = ""
    """What is computed before the first carry of a scene, if that takes seconds."""
    is_unproved: bool = False
    """It is derived from a policy, and the check was skipped."""

    @property
    def spelled(self) -> str:
        """The words that name it on the command line, after ``--controller``."""
        name = self.source.reference if self.source is not None else None
        return shlex.quote(name or self.name) + " --unproved" * self.is_unproved

    @property
    def is_reference(self) -> bool:
        """Whether it reads the state of the simulated world, so that no robot can run it."""
        return self.policy_maker is not None

    @property
    def requirements(self) -> tuple[str, ...]:
        """What the controller needs besides palms and wheels, one line each."""
        alone = self.team == "robots" and not self.uses_radio
        needs = {
            "a sensor on each palm that distinguishes -, 0 and +": (self.team != "none"),
            "a station that both robots can reach by radio": self.team == "station",
            "lockstep where robots are processes: no live station decides": self.team == "station",
            "a radio between the robots": self.uses_radio and self.team == "robots",
            "a time for start and end on which the robots agree": alone,
            "a radio and control period that its time bounds admit": self.has_time_bounds,
            WIDE_ZONE: self.team == "station" or self.drives_by_both_signs,
        }
        return tuple(need for need, applies in needs.items() if applies)

    @property
    def is_compiled(self) -> bool:
        """Whether the compiled core has this controller."""
        return self.maker is None and not self.is_policy

    @property
    def is_policy(self) -> bool:
        """Whether it comes from a policy file."""
        return self.machines is not None or self.station_rows is not None

    @property
    def is_python(self) -> bool:
        """Whether it is written in Python. Such a one is slow and cannot be copied."""
        return self.maker is not None

    @property
    def runs_in_lanes(self) -> bool:
        """Whether many carries run side by side; else they run one after the other."""
        return self.is_compiled and not self.is_reference

    def for_core(self, spec: _core.Spec) -> Any:
        """The argument that the compiled core takes: a name, machines, a policy for this spec, or a
        new step function per robot."""
        if self.machines is not None:
            return _core.Machines(*self.machines)
        if self.station_rows is not None:
            return _core.RowPolicy(list(self.station_rows))
        if self.policy_maker is not None:
            return self.policy_maker(spec)
        return self.name if self.maker is None else make_controller_pair(self.maker)


ControllerLike: TypeAlias = str | type[Controller] | Callable[[], Controller] | ControllerEntry
"""A name, ``module:Class``, ``FILE.py:Class``, ``FILE.toml``, ``FILE.toml@station``, or a class (or
another callable) that makes one."""

POLICY_BOARD_NUMBER: int = _core.runtime.policy_board_number
"""The `board_number` of algorithms derived from a policy; their tables are in the settings, too."""

_CONTROLLERS: Registry[ControllerEntry] = Registry("controller")

_rows: list[dict[str, Any]] = _core.controllers()
for _row in _rows:
    _CONTROLLERS.register(_row["name"], ControllerEntry(**_row))

_SHIPPED = _CONTROLLERS.names()

# Higher rooms provide what makes a controller from a file, by the suffix of the file, and the
# references, which no robot can run.
_LOADERS: Registry[Callable[..., ControllerEntry]] = Registry("controller file")
_REFERENCES: Registry[ControllerEntry] = Registry("reference controller")
_FILES = (".toml", ".toml@station")


def shipped_names(*teams: str) -> tuple[str, ...]:
    """The names of the controllers that the compiled core has; of these `teams` only, if given."""
    return tuple(name for name in _SHIPPED if not teams or _CONTROLLERS.get(name).team in teams)


def controller_names() -> tuple[str, ...]:
    """The names of all controllers, the shipped ones first."""
    return _CONTROLLERS.names()


CONTROLLER = FileKind(
    "a controller", "--controller", "palmbots controllers lists them", names=controller_names
)


def reference_names() -> tuple[str, ...]:
    """The names of the references, which know more than robots do, so that none can run them."""
    return _REFERENCES.names()


def register(name: str, controller: ControllerLike) -> None:
    """Make a controller usable by name, as in ``pb.compare(controllers=["distributed", "mine"])``.

    Args:
        name: the new name, without comma and colon.
        controller: a class with a ``step``, ``module:Class``, ``FILE.py:Class`` or ``FILE.toml``.

    Raises:
        PalmbotsError: the name is taken, or this is no controller.
    """
    if not isinstance(name, str) or not name or not name.isprintable() or set(name) & set(":, "):
        raise PalmbotsError(
            f"controller: name is {show(name)}; allowed: a text without comma, colon and space"
        )
    if name in _REFERENCES:
        raise PalmbotsError(f"controller: {show(name)} is registered already")
    _CONTROLLERS.register(name, _renamed(resolve(controller), name))


def _renamed(entry: ControllerEntry, name: str) -> ControllerEntry:
    if entry.is_policy:
        return replace(entry, name=name)
    if entry.maker is None:
        raise PalmbotsError(f"controller: {entry.name} is shipped; allowed: a class with a step")
    return _python_entry(entry.maker, name, entry.source)


def unregister(name: str) -> None:
    """Remove a registered controller; a shipped one stays."""
    if name not in _SHIPPED:
        _CONTROLLERS.unregister(name)


def resolve(
    controller: Any,
    *,
    called: str = "controller",
    folder: str | None = None,
    unproved: bool = False,
) -> ControllerEntry:
    """The entry of a controller.

    Args:
        controller: a `ControllerLike`.
        called: how messages name the argument.
        folder: where a relative file is looked up; None: the working directory.
        unproved: accept a policy file whose derived algorithm fails its check.

    Raises:
        PalmbotsError: there is no such controller, or its policy fails the check; the message says
            what is allowed.
    """
    if isinstance(controller, ControllerEntry):
        return controller
    if isinstance(controller, str):
        if ":" in controller and controller not in _CONTROLLERS:
            maker, source = load_class(controller, called, folder)
            return _python_entry(maker, None, source)
        suffix = next((end for end in _FILES if controller.endswith(end)), None)
        if suffix is not None and controller not in _CONTROLLERS:
            load = _LOADERS.get(suffix)
            return load(controller, called=called, folder=folder, unproved=unproved)
        if controller in _REFERENCES:
            return _REFERENCES.get(controller)
        files = ("module:Class", "FILE.py:Class", "FILE.toml", "FILE.toml@station")
        one_of(called, controller, (*controller_names(), *files))
        return _CONTROLLERS.get(controller)
    return _python_entry(controller, None, None)


def _python_entry(maker: Any, name: str | None, source: ControllerSource | None) -> ControllerEntry:
    make_step(maker)  # refuses what makes no controller, before anything runs
    called = name or name_of(maker)
    with own_code(f"controller: {called} cannot be used"):
        text = getattr(maker, "__doc__", None)
        lines = text.strip().splitlines() if isinstance(text, str) else []
        return ControllerEntry(
            called,
            lines[0] if lines else f"{called}, a controller in Python",
            cases=_cases(maker),
            assisted_cases=_assisted_cases(maker),
            maker=maker,
            source=source or source_of(maker),
        )


def _cases(maker: Any) -> dict[str, str]:
    cases = getattr(maker, "cases", {})
    if not isinstance(cases, Mapping) or not _are_texts([*cases, *cases.values()]):
        raise PalmbotsError(
            f"controller: cases is {show(cases)}; allowed: a dictionary of strings, as in "
            '{"a": "own p > 0"}'
        )
    return dict(cases)


def _assisted_cases(maker: Any) -> tuple[str, ...]:
    cases = getattr(maker, "assisted_cases", ())
    if not isinstance(cases, Iterable) or not _are_texts(cases := tuple(cases)):
        raise PalmbotsError(
            f"controller: assisted_cases is {show(cases)}; allowed: a list of strings, as in "
            '("a", "c")'
        )
    return cases


def _are_texts(values: Iterable[object]) -> bool:
    return all(isinstance(value, str) for value in values)


def recover(
    name: str, source: ControllerSource | None, folder: str | None = None
) -> ControllerEntry:
    """The controller of a carry that was logged, in the version that the log names.

    Args:
        name: its name in the log.
        source: the Python class or the policy file; None: the controller is a shipped one.
        folder: where a relative file is looked up if the working directory has no such file.

    Raises:
        PalmbotsError: the class cannot be found, or its source has changed since.
    """
    if source is None:
        return resolve(name)
    if source.reference is None or source.sha256 is None:
        raise PalmbotsError(
            f"controller: the log has no file of the class {name}; pass controller={name}"
        )
    for place in (None, folder):
        found = hash_of_reference(source.reference, place)
        if found is not None:
            break
    else:
        raise PalmbotsError(f"controller: {source.reference} is not found; pass controller={name}")
    if found != source.sha256:
        raise PalmbotsError(
            f"controller: {source.reference} has changed since the log was written; pass "
            f"controller={name} to run the present version"
        )
    if source.reference.endswith(_FILES):  # the log says what ran, so it runs again
        return resolve(source.reference, folder=place, unproved=True)
    maker, _ = load_class(source.reference, folder=place)
    return _python_entry(maker, name, source)


def describe(name: str) -> ControllerEntry:
    """The entry of a name for reports and figures; a minimal one if the name is unknown."""
    for registry in (_CONTROLLERS, _REFERENCES):
        if name in registry:
            return registry.get(name)
    return ControllerEntry(name, "a controller in Python")


def refuse_reference(entry: ControllerEntry, where: str) -> None:
    """Raise `PalmbotsError` for a reference, `where` robots or only shipped controllers carry."""
    if entry.is_reference:
        raise PalmbotsError(
            f"controller: {entry.name} is a reference that reads the state of the quasistatic "
            f"world; {where} needs a controller that robots can run"
        )


def refusal(controller: ControllerLike, scene: Scene) -> str | None:
    """Why a controller refuses a scene, in one line; None: it accepts the scene."""
    try:
        if resolve(controller).has_time_bounds:
            bounds_of(scene)
    except SceneError as error:
        return str(error)
    return None


def check_on_robots(entry: ControllerEntry) -> None:
    """Raise `PalmbotsError` for a controller that no robot runs."""
    if entry.is_reference or entry.team == "none":
        why = "reads the state of the world" if entry.is_reference else "has no programs"
        raise PalmbotsError(f"controller: {entry.name} {why}; allowed: a controller of robots")
