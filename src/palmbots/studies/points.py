# SPDX-License-Identifier: Apache-2.0
"""The design points of a study, and the scene at each. All scenes are validated before any carry.

A grid has one dimension for each key. All other designs have the single dimension ``point``. The
identity of a study includes the points themselves, so a difference between two versions of the
libraries that draw them is noticed.
"""

import hashlib
import itertools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palmbots._util.arguments import show
from palmbots._version import __version__
from palmbots.control.registry import ControllerEntry, refusal
from palmbots.errors import PalmbotsError, SceneError
from palmbots.scene.scene import Scene
from palmbots.scene.variations import have_equal_carries, with_values, without_effect
from palmbots.simulation.worlds import DEFAULT_WORLD
from palmbots.studies.axes import Axis, Span
from palmbots.studies.designs import DESIGNS, GRID
from palmbots.studies.study_file import Plan

_CONTENT_FORMAT = 1
_MAX_POINTS = 1_000_000


@dataclass(frozen=True)
class Points:
    """The design points of a study, and the cells that a controller refuses."""

    plan: Plan
    shape: tuple[int, ...]
    """Of the points: one size for each key of a grid, otherwise their number."""
    values: tuple[tuple[Any, ...], ...]
    """Values of the keys in the order of `plan.keys`, one tuple for each point, the last key
    fastest."""
    rejected_cells: Mapping[tuple[int, int], str]
    """Why a controller refuses a point, by point and place in `plan.controllers`."""

    def scene(self, point: int) -> Scene:
        """The scene at a point. It is not cached: a million scenes would not fit into memory."""
        return _scene(self.plan, self.values, point)

    @property
    def dims(self) -> tuple[str, ...]:
        """The names of the dimensions of the points."""
        return self.plan.keys if self.is_grid and self.plan.keys else ("point",)

    @property
    def is_grid(self) -> bool:
        """Whether every key has a dimension of its own."""
        return self.plan.study.design.kind == GRID

    def column(self, key: str) -> list[Any]:
        """The values of one key, one for each point."""
        at = self.plan.keys.index(key)
        return [point[at] for point in self.values]

    def levels(self, key: str) -> list[Any]:
        """The different values of one key of a grid, in order."""
        return list({repr(value): value for value in self.column(key)}.values())

    def allowed_cells(self) -> NDArray[np.bool_]:
        """[points, controllers]: the cells that no controller refuses."""
        allowed = np.ones((len(self.values), len(self.plan.controllers)), bool)
        for cell in self.rejected_cells:
            allowed[cell] = False
        return allowed

    @property
    def max_carries(self) -> int:
        """The number of carries if no cell stops early."""
        return int(self.allowed_cells().sum()) * self.plan.study.seeds.count

    @cached_property
    def content(self) -> dict[str, Any]:
        """What the results depend on, as a table of plain values."""
        study = self.plan.study
        content = {
            "format": _CONTENT_FORMAT,
            "version": __version__,
            "scene": self.plan.base.model_dump(),
            "controllers": [_identity(controller) for controller in self.plan.controllers],
            "precision": study.precision,
            "vary": {key: self.column(key) for key in self.plan.keys},
            "shape": self.shape,
            "design": study.design.model_dump(),
            "seeds": study.seeds.model_dump(),
            "stop": study.stop.model_dump() if study.stop else {},
        }
        return json.loads(json.dumps(_plain(content), allow_nan=False))

    @cached_property
    def identity(self) -> str:
        """A hash of the content."""
        text = json.dumps(self.content, sort_keys=True, allow_nan=False)
        return hashlib.blake2b(text.encode(), digest_size=8).hexdigest()


def design_points(plan: Plan, on_progress: Callable[[float], None] = lambda _: None) -> Points:
    """The points of a plan. The scene at each of them is validated.

    Raises:
        SceneError: the scene at a point is invalid (the message names the point), or no carry
            depends on one of the keys.
        PalmbotsError: there are too many points, or a package of the extra ``study`` is missing.
    """
    axes, spec = plan.study.vary, plan.study.design
    sample = DESIGNS[spec.kind].sample
    if sample is None:
        levels = [_levels(axis) for axis in axes.values()]
        shape = tuple(len(one) for one in levels) or (1,)
        _check_count(plan, int(np.prod(shape, dtype=float)))
        values = tuple(itertools.product(*levels))
    else:
        shares = sample(len(axes), spec.points or 1, spec.seed)
        _check_count(plan, len(shares))
        values = tuple(
            tuple(_at(axis, share) for axis, share in zip(axes.values(), row, strict=True))
            for row in shares.tolist()
        )
        shape = (len(values),)
    rejected_cells: dict[tuple[int, int], str] = {}
    for i in range(len(values)):
        scene = _scene(plan, values, i)
        for c, controller in enumerate(plan.controllers):
            problem = refusal(controller, scene)
            if problem is not None:
                rejected_cells[i, c] = problem
        if i % 64 == 0:
            on_progress(i / len(values))
    for k, key in enumerate(plan.keys):
        if _is_without_effect(plan, values, k):
            raise without_effect(f"{plan.called} vary:", key, DEFAULT_WORLD)
    return Points(plan, shape, values, rejected_cells)


def _scene(plan: Plan, values: tuple[tuple[Any, ...], ...], point: int) -> Scene:
    pairs = zip(plan.keys, values[point], strict=True)
    place = ", ".join(f"{key} = {show(value)}" for key, value in pairs)
    called = f"{plan.called} point {point} ({place}):" if place else plan.called
    return with_values(plan.base, plan.keys, values[point], called)


def _is_without_effect(plan: Plan, values: tuple[tuple[Any, ...], ...], k: int) -> bool:
    """Whether no carry depends on the key with index `k`: at every point, the next value of the key
    gives the same carries. Points whose changed scene is invalid do not count."""
    levels = {repr(point[k]): point[k] for point in values}
    following = dict(zip(levels, [*levels.values()][1:], strict=False))
    compared = False
    for i, point in enumerate(values):
        # The last value has no next one; it is compared as the next one of the value before.
        if repr(point[k]) not in following:
            continue
        changed = (*point[:k], following[repr(point[k])], *point[k + 1 :])
        try:
            pair = [_scene(plan, values, i), _scene(plan, (changed,), 0)]
        except SceneError:
            continue
        if not have_equal_carries(pair):
            return False
        compared = True
    return compared


def _at(axis: Axis, share: float) -> Any:
    """The value of an axis at a coordinate of the unit cube."""
    if isinstance(axis, Span):
        return axis.at(share)
    return axis[min(int(share * len(axis)), len(axis) - 1)]


def _levels(axis: Axis) -> list[Any]:
    """The values of an axis of a grid."""
    if isinstance(axis, Span):
        assert axis.steps is not None  # `Study` refuses a range without steps in a grid
        return [axis.at(i / (axis.steps - 1)) for i in range(axis.steps)]
    return list(axis)


def _check_count(plan: Plan, points: int) -> None:
    if points > _MAX_POINTS:
        raise PalmbotsError(
            f"{plan.called} vary: {points} points in all; allowed: at most {_MAX_POINTS}"
        )


def _identity(controller: ControllerEntry) -> str:
    """The name of a controller, and the version of the source of one in Python."""
    if controller.is_compiled:
        return controller.name
    digest = controller.source.sha256 if controller.source is not None else None
    return f"{controller.name} (source {digest[:16] if digest else 'unknown'})"


def _plain(value: Any) -> Any:
    """Numbers as floats, so that 0 and 0.0 are equal; sequences as lists."""
    if isinstance(value, Mapping):
        return {str(key): _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, int | float) and not isinstance(value, bool):
        return float(value)
    return value
