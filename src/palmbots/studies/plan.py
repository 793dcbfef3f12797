"""The study file: what is varied, how the points of the design are chosen, which seeds are carried.

A TOML file of the tables below, or the name of a study that comes with the package. `load_plan`
reads it; a `Plan` is complete and valid apart from the scenes at its design points, which
`palmbots.studies.design` makes. The *identity* of a study is what its results depend on; names and
remarks are no part of it.
"""

import difflib
import os
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationError, model_validator

from palmbots.carry import CONTROLLERS
from palmbots.complaints import complaint
from palmbots.errors import PalmbotsError, SceneError, show
from palmbots.lowering import refuse_curved
from palmbots.quantities import Range, fault, from_list, whole
from palmbots.scene import Scene, load_scene
from palmbots.scene_files import read_table
from palmbots.section import Section
from palmbots.studies.axes import Span, axes_of

__all__ = ["Design", "Plan", "Seeds", "Stop", "Study", "load_plan", "ready_studies"]

_KINDS = ("grid", "random", "sobol", "halton", "latin-hypercube", "sobol-indices")
_MOST_SEED = 2**63
_MOST_CARRIES = 10**9


def _one_of(*legal: str) -> BeforeValidator:
    def check(value: object) -> object:
        if value not in legal:
            raise fault(value, "is not known", ", ".join(legal))
        return value

    return BeforeValidator(check)


Controllers = Annotated[
    tuple[Annotated[str, _one_of(*CONTROLLERS)], ...],
    BeforeValidator(from_list(f"a list of one or more of {', '.join(CONTROLLERS)}", 1, 4)),
]


class Design(Section):
    """[design] How the points are chosen."""

    kind: Annotated[str, _one_of(*_KINDS)] = "grid"
    """grid: every combination. random, sobol, halton, latin-hypercube: so many points.
    sobol-indices: Saltelli's points, for Sobol indices; `points` of them for every key, and two
    times more."""
    points: Annotated[int, BeforeValidator(whole(1, 1_000_000))] | None = None
    """How many; not for a grid. A power of 2 for sobol and sobol-indices."""
    seed: Annotated[int, BeforeValidator(whole(0, _MOST_SEED))] = 0
    """Of the random choice of points, not of the carries."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.kind == "grid" and self.points is not None:
            raise fault(self.points, "is given for a grid", "no points with kind grid", "points")
        if self.kind != "grid" and self.points is None:
            raise fault(self.kind, "does not say how many points", "points = N beside it", "kind")
        n = self.points or 1
        if self.kind.startswith("sobol") and n & (n - 1):
            raise fault(n, "is not a power of 2", "2, 4, 8, … with this kind", "points")
        return self


class Seeds(Section):
    """[seeds] The seeds of every cell, the same for all of them."""

    first: Annotated[int, BeforeValidator(whole(0, _MOST_SEED))] = 0
    count: Annotated[int, BeforeValidator(whole(1, _MOST_CARRIES))] = 200
    """Carries a cell; with [stop] the most of them."""


class Stop(Section):
    """[stop] When a cell has been carried often enough. All that are given must hold."""

    block: Annotated[int, BeforeValidator(whole(1, 10**9))]
    """Seeds a cell after which it is looked at, each time; independent of how the work is split."""
    drop_rate: Annotated[float, BeforeValidator(Range(least=1e-6, most=1))] | None = None
    """Half the width of the 95 % interval of the drop rate is at most this."""
    rms: Annotated[float, BeforeValidator(Range(least=1e-6, most=1))] | None = None
    """Half the width of the 95 % interval of the contact rms is at most this share of it."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.drop_rate is None and self.rms is None:
            raise fault(self.block, "has nothing to stop at", "drop_rate or rms beside it", "block")
        return self


class Study(Section):
    """A study file as it is written."""

    about: str = ""
    """One line for people."""
    scene: Any = "paper"
    """A built-in scene, a TOML file (seen from the study file), or a table."""
    set: dict[str, Any] = Field(default={})
    """Scene keys set at every point."""
    controllers: Controllers = ("centralized", "distributed")
    """The first one is what the others are compared with."""
    precision: Literal["double", "float"] = "double"
    vary: Annotated[Any, BeforeValidator(axes_of)] = Field(default={})
    """The keys that differ from point to point."""
    design: Design = Design()
    seeds: Seeds = Seeds()
    stop: Stop | None = None

    @model_validator(mode="after")
    def _check(self) -> Self:
        for controller in self.controllers:
            if self.controllers.count(controller) > 1:
                raise fault(list(self.controllers), "has one twice", "each once", "controllers")
        for key, axis in self.vary.items():
            if not isinstance(axis, Span):
                continue
            if self.design.kind == "grid" and axis.steps is None:
                raise fault(key, "has no steps", "steps in every range of a grid", "vary")
            if self.design.kind != "grid" and axis.steps is not None:
                raise fault(key, "has steps", "no steps where points are chosen", "vary")
        for key in self.vary:
            if key in _dotted(self.set):
                raise fault(key, "is set, and varies", "one of them", "vary")
        if self.design.kind != "grid" and not self.vary:
            raise fault({}, "is empty", "at least one key with this design", "vary")
        return self


def _dotted(table: Mapping[str, Any], inside: str = "") -> set[str]:
    """The keys of a table, and of the tables in it."""
    found = set[str]()
    for key, value in table.items():
        found.add(f"{inside}{key}")
        if isinstance(value, Mapping):
            found |= _dotted(value, f"{inside}{key}.")
    return found


class Plan:
    """A study that has been read: its file's content, the base scene, and its name."""

    def __init__(self, study: Study, base: Scene, name: str, called: str) -> None:
        self.study = study
        self.base = base
        """The scene with [set], before any key is varied."""
        self.name = name
        self.called = called
        """How messages about it begin: the file or the name, and a colon."""

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys that vary."""
        return tuple(self.study.vary)


def ready_studies() -> list[str]:
    """The names of the studies that come with the package, sorted."""
    folder = resources.files("palmbots.studies") / "ready"
    return sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith("toml"))


def load_plan(
    source: str | os.PathLike[str] | Mapping[str, Any], carries: int | None = None
) -> Plan:
    """The study of a name, a TOML file or a table.

    Args:
        source: a name goes before a file of the same name; "./name" is always a file.
        carries: in place of seeds.count.

    Raises `SceneError`, one line that names file, key, value and what is allowed.
    """
    at = Path()
    if isinstance(source, Mapping):
        name, called, table = "study", "study:", dict(source)
    else:
        name, called, table, at = _read(os.fspath(source))
    if carries is not None:
        is_whole = isinstance(carries, int) and not isinstance(carries, bool)
        if not is_whole or not 1 <= carries <= _MOST_CARRIES:
            raise SceneError(f"--carries: {show(carries)}; allowed: 1 to {_MOST_CARRIES}")
        if isinstance(table.get("seeds", {}), Mapping):
            table["seeds"] = {**table.get("seeds", {}), "count": carries}
        stop = table.get("stop")
        if isinstance(stop, Mapping) and isinstance(stop.get("block"), int):
            table["stop"] = {**stop, "block": max(1, min(stop["block"], carries))}
    try:
        study = Study.model_validate(table)
    except ValidationError as error:
        raise SceneError(f"{called} {complaint(error, Study)}") from None
    return Plan(study, _base(study, at, called), name, called)


def _read(source: str) -> tuple[str, str, dict[str, Any], Path]:
    ready = ready_studies()
    if source in ready:
        path = resources.files("palmbots.studies") / "ready" / f"{source}.toml"
        with resources.as_file(path) as file:
            return source, f"{source}:", read_table(str(file), "a study file", []), Path()
    if not os.path.exists(source):
        near = difflib.get_close_matches(source, ready, n=1)
        hint = f"did you mean {near[0]}? " if near else ""
        raise SceneError(
            f"{source}: no such study or file; {hint}ready studies: {', '.join(ready) or 'none'}"
        )
    table = read_table(source, "a study file", [])
    return Path(source).stem, f"{source}:", table, Path(source).parent


def _base(study: Study, at: Path, called: str) -> Scene:
    source = study.scene
    if isinstance(source, str) and source.endswith(".toml"):
        source = at / source
    elif not isinstance(source, str | Mapping | Scene):
        raise SceneError(
            f"{called} scene: {show(source)} is no scene; allowed: a built-in name, a TOML file "
            "or a table"
        )
    try:
        scene = load_scene(source, study.set, called=f"{called} set:")
        refuse_curved(scene)  # before anything is written
        return scene
    except PalmbotsError as error:
        text = str(error)
        text = text.removeprefix("scene: ")  # the key's name here, too
        raise SceneError(text if text.startswith(called) else f"{called} scene: {text}") from None
