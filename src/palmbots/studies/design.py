"""The points of a study's design, and the scene at each: all are valid before anything is carried.

A grid keeps its shape, one dimension a key; all other designs have the one dimension ``point``.
Scrambled Sobol and Halton points and Latin hypercubes are scipy's, Saltelli's points for Sobol
indices (Saltelli 2010) are SALib's; all are driven by Philox with the design's seed. The
identity of a study holds the points themselves: another library's other points are noticed.
"""

import hashlib
import itertools
import json
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots.bounds import bounds_of
from palmbots.errors import PalmbotsError, SceneError, show
from palmbots.scene import Scene
from palmbots.scene_at import scene_at
from palmbots.studies.axes import Axis, Span
from palmbots.studies.needs import needed
from palmbots.studies.plan import Plan
from palmbots.version import __version__

__all__ = ["Points", "design", "shares"]

FORMAT = 1
_MOST_POINTS = 1_000_000


@dataclass(frozen=True)
class Points:
    """The design of a study: its points in order, and which the resilient algorithm refuses."""

    plan: Plan
    shape: tuple[int, ...]
    """Of the points: one size a key for a grid, else their number."""
    values: tuple[tuple[Any, ...], ...]
    """Of each key, in the order of `plan.keys`; one tuple a point, the last key fastest."""
    refused: Mapping[int, str]
    """Why the resilient algorithm cannot keep its bounds at a point, where it cannot."""

    def scene(self, point: int) -> Scene:
        """The scene at a point: made anew each time, for many of them would not fit into memory."""
        return _scene(self.plan, self.values, point)

    @property
    def dims(self) -> tuple[str, ...]:
        """The names of the dimensions of the points."""
        return self.plan.keys if self.is_grid and self.plan.keys else ("point",)

    @property
    def is_grid(self) -> bool:
        """Whether every key has a dimension of its own."""
        return self.plan.study.design.kind == "grid"

    def column(self, key: str) -> list[Any]:
        """The values of one key, one a point."""
        at = self.plan.keys.index(key)
        return [point[at] for point in self.values]

    def levels(self, key: str) -> list[Any]:
        """The values of one key of a grid, each once, in order."""
        return list(dict.fromkeys(self.column(key)))

    @cached_property
    def content(self) -> dict[str, Any]:
        """What the results depend on, as a table of plain values."""
        study = self.plan.study
        told = {
            "format": FORMAT,
            "version": __version__,
            "scene": self.plan.base.model_dump(),
            "controllers": study.controllers,
            "precision": study.precision,
            "vary": {key: self.column(key) for key in self.plan.keys},
            "shape": self.shape,
            "design": study.design.model_dump(),
            "seeds": study.seeds.model_dump(),
            "stop": study.stop.model_dump() if study.stop else {},
        }
        return json.loads(json.dumps(_plain(told), allow_nan=False))

    @cached_property
    def identity(self) -> str:
        """A hash of the content."""
        text = json.dumps(self.content, sort_keys=True, allow_nan=False)
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def design(plan: Plan, progress: Callable[[float], None] = lambda _: None) -> Points:
    """The points of a plan, with valid scenes.

    Raises:
        SceneError: the scene at a point makes no sense; the message names the point.
        PalmbotsError: too many points, or a package of the extra `study` is missing.
    """
    axes = plan.study.vary
    kind = plan.study.design.kind
    if kind == "grid":
        levels = [_levels(axis) for axis in axes.values()]
        shape = tuple(len(one) for one in levels) or (1,)
        _at_most(plan, int(np.prod(shape, dtype=float)))
        values = tuple(itertools.product(*levels))
    else:
        unit = shares(kind, len(axes), plan.study.design.points or 1, plan.study.design.seed)
        _at_most(plan, len(unit))
        values = tuple(
            tuple(_at(axis, share) for axis, share in zip(axes.values(), row, strict=True))
            for row in unit.tolist()
        )
        shape = (len(values),)
    refused = {}
    for i in range(len(values)):
        scene = _scene(plan, values, i)
        if "resilient" in plan.study.controllers:
            problem = _refusal(scene)
            if problem is not None:
                refused[i] = problem
        if i % 64 == 0:
            progress(i / len(values))
    return Points(plan, shape, values, refused)


def _scene(plan: Plan, values: tuple[tuple[Any, ...], ...], point: int) -> Scene:
    told = ", ".join(f"{k} = {show(v)}" for k, v in zip(plan.keys, values[point], strict=True))
    called = f"{plan.called} point {point} ({told}):" if told else plan.called
    return scene_at(plan.base, plan.keys, values[point], called)


def shares(kind: str, dims: int, n: int, seed: int) -> NDArray[np.float64]:
    """Points of the unit cube, one row each: n, or n (dims + 2) for ``sobol-indices``."""
    rng = np.random.Generator(np.random.Philox(seed))
    if kind == "random":
        return rng.random((n, dims))
    if kind == "sobol-indices":
        from palmbots.studies.sensitivity import problem_of

        sample = needed("SALib.sample.sobol", "study").sample
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return sample(problem_of(dims), n, calc_second_order=False, seed=seed % 2**32)
    qmc = needed("scipy.stats.qmc", "study")
    engines = {"sobol": qmc.Sobol, "halton": qmc.Halton, "latin-hypercube": qmc.LatinHypercube}
    return engines[kind](dims, rng=rng).random(n)


def _at(axis: Axis, share: float) -> Any:
    if isinstance(axis, Span):
        return axis.at(share)
    return axis[min(int(share * len(axis)), len(axis) - 1)]


def _levels(axis: Axis) -> list[Any]:
    if isinstance(axis, Span):
        assert axis.steps is not None  # the plan has seen to it
        return [axis.at(i / (axis.steps - 1)) for i in range(axis.steps)]
    return [tuple(one) if isinstance(one, list) else one for one in axis]


def _refusal(scene: Scene) -> str | None:
    try:
        bounds_of(scene)
    except SceneError as error:
        return str(error)
    return None


def _at_most(plan: Plan, points: int) -> None:
    if points > _MOST_POINTS:
        raise PalmbotsError(
            f"{plan.called} vary: {points} points in all; allowed: at most {_MOST_POINTS}"
        )


def _plain(value: Any) -> Any:
    """Numbers as floats, so that 0 and 0.0 are one; sequences as lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    return value
