# SPDX-License-Identifier: Apache-2.0
"""The study file: what is varied, how the design points are chosen, and which seeds are carried.

A study is a TOML file with the tables below, or the name of a study that comes with the package.
`load_plan` reads it. A `Plan` is complete and valid, except for the scenes at its design points,
which `palmbots.studies.points` validates.
"""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from palmbots._util.arguments import show, whole_number
from palmbots._util.user_paths import user_path
from palmbots.control.registry import ControllerEntry, refuse_reference, resolve
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.error_messages import validation_message
from palmbots.scene.fields import OneOf, Range, field_error, from_list, whole
from palmbots.scene.file_kinds import FileKind, other_kind
from palmbots.scene.files import read_table
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.section import Section
from palmbots.scene.spec import refuse_curved
from palmbots.studies.axes import Span, axes_of
from palmbots.studies.designs import DESIGNS, GRID

StudyLike = str | os.PathLike[str] | Mapping[str, Any]
"""The name of a study that comes with the package, a TOML file, or a table."""

_MAX_SEED = 2**63
_MAX_CARRIES = 10**9


class Design(Section):
    """[design] How the points are chosen."""

    kind: Annotated[str, BeforeValidator(OneOf(tuple(DESIGNS)))] = GRID
    """grid: every combination. random, sobol, halton, latin-hypercube: `points` of them.
    sobol-indices: Saltelli's points for Sobol indices, `points` × (keys + 2) of them."""
    points: Annotated[int, BeforeValidator(whole(1, 1_000_000))] | None = None
    """Number of points; not for a grid. A power of 2 for sobol and sobol-indices."""
    seed: Annotated[int, BeforeValidator(whole(0, _MAX_SEED))] = 0
    """Random seed of the choice of points; the carries have their own seeds."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.kind == GRID and self.points is not None:
            raise field_error(
                self.points, "is given for a grid", "no points with kind grid", "points"
            )
        if self.kind != GRID and self.points is None:
            raise field_error(
                self.kind, "does not say how many points", "points = N beside it", "kind"
            )
        n = self.points or 1
        if DESIGNS[self.kind].needs_power_of_two and n & (n - 1):
            raise field_error(n, "is not a power of 2", "2, 4, 8, … with this kind", "points")
        return self


class Seeds(Section):
    """[seeds] The seeds of the carries. All cells have the same ones."""

    first: Annotated[int, BeforeValidator(whole(0, _MAX_SEED))] = 0
    count: Annotated[int, BeforeValidator(whole(1, _MAX_CARRIES))] = 200
    """Carries per cell; with [stop] at most this many."""


class Stop(Section):
    """[stop] When a cell has enough carries. All the conditions that are given must hold."""

    block: Annotated[int, BeforeValidator(whole(1, 10**9))]
    """The conditions are checked after every block of this many seeds per cell."""
    drop_rate: Annotated[float, BeforeValidator(Range(least=1e-6, most=1))] | None = None
    """Half the width of the 95 % interval of the drop rate is at most this."""
    rms: Annotated[float, BeforeValidator(Range(least=1e-6, most=1))] | None = None
    """Half the width of the 95 % interval of the contact rms is at most this share of the rms."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.drop_rate is None and self.rms is None:
            raise field_error(
                self.block, "has nothing to stop at", "drop_rate or rms beside it", "block"
            )
        return self


class Study(Section):
    """The content of a study file."""

    about: str = ""
    """One line for people."""
    scene: Any = "paper"
    """A built-in scene, a TOML file (relative to the study file), or a table."""
    set: dict[str, Any] = Field(default={})
    """Scene keys that are set at every point."""
    controllers: Annotated[
        tuple[Any, ...], BeforeValidator(from_list("a list of one or more controllers", 1))
    ] = ("centralized", "distributed")
    """Names, ``module:Class``, ``FILE.py:Class`` (relative to the study file), or classes. The
    others are compared with the first one."""
    precision: Literal["double", "float"] = "double"
    vary: Annotated[Any, BeforeValidator(axes_of)] = Field(default={})
    """The keys that differ from point to point."""
    design: Design = Design()
    seeds: Seeds = Seeds()
    stop: Stop | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        for key, axis in self.vary.items():
            if not isinstance(axis, Span):
                continue
            if self.design.kind == GRID and axis.steps is None:
                raise field_error(key, "has no steps", "steps in every range of a grid", "vary")
            if self.design.kind != GRID and axis.steps is not None:
                raise field_error(key, "has steps", "no steps where points are chosen", "vary")
        for key in self.vary:
            if key in _dotted(self.set):
                raise field_error(key, "is set, and varies", "one of them", "vary")
        if self.design.kind != GRID and not self.vary:
            raise field_error({}, "is empty", "at least one key with this design", "vary")
        return self


def _dotted(table: Mapping[str, Any], prefix: str = "") -> set[str]:
    """The keys of a table and of the tables in it."""
    keys = set[str]()
    for key, value in table.items():
        keys.add(f"{prefix}{key}")
        if isinstance(value, Mapping):
            keys |= _dotted(value, f"{prefix}{key}.")
    return keys


@dataclass(frozen=True)
class Plan:
    """A study that was read: the content of its file, its controllers and its base scene."""

    study: Study
    controllers: tuple[ControllerEntry, ...]
    base: Scene
    """The scene with [set], before any key is varied."""
    name: str
    called: str
    """How messages about it begin: the file or the name, and a colon."""

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that vary."""
        return tuple(self.study.vary)

    @cached_property
    def controller_names(self) -> tuple[str, ...]:
        """The names of the controllers, in order."""
        return tuple(controller.name for controller in self.controllers)


def built_in_studies() -> list[str]:
    """The names of the studies that come with the package, sorted."""
    folder = resources.files("palmbots.studies") / "data"
    return sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith("toml"))


STUDY_FILE = FileKind(
    "a study file",
    "palmbots study",
    'it names its scene: scene = "FILE"',
    keys=Study.model_fields,
    names=built_in_studies,
)


def load_plan(
    source: "StudyLike",
    carries: int | None = None,
    *,
    unproved: bool = False,
    on_warning: "Callable[[str], None] | None" = None,
) -> Plan:
    """The study of a name, a TOML file or a table.

    Args:
        source: a name takes precedence over a file of the same name; "./name" is always a file.
        carries: carries per cell, in place of seeds.count.
        unproved: accept policy files whose derived algorithms fail their check.
        on_warning: called with a line if the study or its scene sets nothing.

    Raises:
        SceneError: the study is invalid; one line names file, key, value and what is allowed.
    """
    folder = Path()
    if isinstance(source, Mapping):
        name, called, table = "study", "study:", dict(source)
        if problem := other_kind("", table, STUDY_FILE):
            raise SceneError(f"study: {problem}")
    elif isinstance(source, str | os.PathLike):
        name, called, table, folder = _read(os.fspath(source))
    elif isinstance(source, Scene):
        raise SceneError(f"study: is a scene; allowed: {STUDY_FILE.in_words}")
    else:
        raise SceneError(
            f"study: value is {show(source)}; allowed: the name of a study, a TOML file, a table"
        )
    if not table and on_warning is not None:
        on_warning(f"{called} nothing is set; this study runs the scene paper")
    if carries is not None:
        table = _with_carries(table, carries)
    try:
        study = Study.model_validate(table)
    except ValidationError as error:
        raise SceneError(f"{called} {validation_message(error, Study)}") from None
    controllers = _controllers(study, folder, called, unproved)
    return Plan(study, controllers, _base(study, folder, called, on_warning), name, called)


def _with_carries(table: Mapping[str, Any], carries: int) -> dict[str, Any]:
    """The table of a study with this number of carries per cell."""
    try:
        carries = whole_number("carries", carries, 1, _MAX_CARRIES)
    except PalmbotsError as error:
        raise SceneError(str(error)) from None
    changed = dict(table)
    if isinstance(table.get("seeds", {}), Mapping):
        changed["seeds"] = {**table.get("seeds", {}), "count": carries}
    stop = table.get("stop")
    if isinstance(stop, Mapping) and isinstance(stop.get("block"), int):
        changed["stop"] = {**stop, "block": max(1, min(stop["block"], carries))}
    return changed


def _read(source: str) -> tuple[str, str, dict[str, Any], Path]:
    names = built_in_studies()
    if source in names:
        path = resources.files("palmbots.studies") / "data" / f"{source}.toml"
        with resources.as_file(path) as file:
            return source, f"{source}:", read_table(str(file), STUDY_FILE), Path()
    if not source:
        raise SceneError(f'study: value is ""; allowed: a TOML file or one of {", ".join(names)}')
    table = read_table(source, STUDY_FILE, names)
    return Path(source).stem, f"{source}:", table, user_path(source).parent


def _controllers(
    study: Study, folder: Path, called: str, unproved: bool
) -> tuple[ControllerEntry, ...]:
    """The controllers of a study; their files are relative to the study file."""
    controllers: list[ControllerEntry] = []
    for k, one in enumerate(study.controllers):
        try:
            controller = resolve(
                one, called=f"controllers[{k}]", folder=str(folder), unproved=unproved
            )
            refuse_reference(controller, "a study")
        except PalmbotsError as error:
            raise SceneError(f"{called} {error}") from None
        if controller.name in (other.name for other in controllers):
            raise SceneError(
                f"{called} controllers: {show(controller.name)} is given twice; allowed: each once"
            )
        controllers.append(controller)
    return tuple(controllers)


def _base(
    study: Study, folder: Path, called: str, on_warning: Callable[[str], None] | None = None
) -> Scene:
    source = study.scene
    if isinstance(source, str) and source.endswith(".toml"):
        source = folder / source
    elif not isinstance(source, str | Mapping | Scene):
        raise SceneError(
            f"{called} scene: value is {show(source)}; allowed: a built-in name, a TOML file or a "
            "table"
        )
    try:
        scene = load_scene(source, study.set, called=f"{called} set:", on_warning=on_warning)
        refuse_curved(scene)  # before anything is written
        return scene
    except PalmbotsError as error:
        text = str(error).removeprefix("scene: ")  # the study's own key has this name too
        raise SceneError(text if text.startswith(called) else f"{called} scene: {text}") from None
