# SPDX-License-Identifier: Apache-2.0
"""Preparing carries: the checks and conversions that come before anything runs, done once."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import palmbots._core as _core
from palmbots._util.arguments import one_of, show
from palmbots.control.dead_band import warnings_before
from palmbots.control.registry import (
    ControllerEntry,
    ControllerLike,
    describe,
    refuse_reference,
    resolve,
)
from palmbots.control.resilient_timing import Bounds, bounds_of
from palmbots.errors import PalmbotsError, SceneError
from palmbots.mechanics.lifting import check_lift
from palmbots.mechanics.load_limits import check_load
from palmbots.scene.scene import Scene
from palmbots.scene.spec import refuse_floor, refuse_pipe, to_spec
from palmbots.scene.surroundings import refuse_surroundings
from palmbots.simulation.worlds import PRECISIONS, WorldEntry, world_entry, world_names

_CLOCK_FAULTS = (5, 6)  # clock-rate and clock-jump, as the core numbers them


@dataclass(frozen=True)
class Prepared:
    """A scene with a controller and a world, checked and ready to run."""

    scene: Scene
    controller: ControllerEntry
    world: WorldEntry
    spec: _core.Spec
    timing: Bounds | None
    """The time bounds on which the controller relies; None: it relies on none."""
    warnings: tuple[str, ...]
    """Those that are known before the carry starts."""

    def renamed(self, controller: str) -> "Prepared":
        """The same for a carry that a program stepped from outside, under this name."""
        entry = describe(controller)
        warnings = warnings_before(self.scene, entry)
        return replace(self, controller=entry, timing=None, warnings=warnings)


def prepare(
    scene: Scene,
    controller: ControllerLike = "distributed",
    world: str | WorldEntry = "quasistatic",
) -> Prepared:
    """Check a scene against a controller and a world, and convert it for the core.

    Raises:
        SceneError: the world or the controller refuses the scene.
        PalmbotsError: there is no such controller or world.
    """
    place = world_entry(world) if isinstance(world, str) else world
    entry = resolve(controller)
    check_scene(place, scene)
    spec = to_spec(scene, unrolled=place.supports_curved)
    check_load(scene)
    refuse_surroundings(scene, spec)
    lifts = check_lift(scene) if spec.uses_floor else ()
    check_palms(spec)
    if spec.uses_floor:
        refuse_reference(entry, "a job on the floor")
    if not place.supports_references:
        refuse_reference(entry, f"the {place.name} world")
    timing = bounds_of(scene) if entry.has_time_bounds else None
    if not entry.uses_clock:
        # Its robots measure no time: their clocks run like that of the carry, also in programs.
        spec.faults = [
            (kind, side, at, lasts, reads, 0.0 if kind in _CLOCK_FAULTS else value, marks)
            for kind, side, at, lasts, reads, value, marks in spec.faults
        ]
    return Prepared(scene, entry, place, spec, timing, (*warnings_before(scene, entry), *lifts))


def check_palms(spec: _core.Spec) -> None:
    """Raise `SceneError` for palms that would collide under the object at the start."""
    if refusal := _core.palm_refusal(spec):
        raise SceneError(refusal)


def check_precision(world: WorldEntry, precision: str) -> None:
    """Raise `PalmbotsError` for a precision that does not exist, or that this world lacks."""
    one_of("precision", precision, PRECISIONS)
    one_of(f"precision (world {world.name})", precision, world.precisions)


def check_scene(world: WorldEntry, scene: Scene) -> None:
    """Raise `SceneError` for a scene that needs something which this world does not support."""
    if scene.task.route.is_set:
        raise SceneError(
            "task.route: takes several carries, one for each stage; allowed: no route, or the "
            "commands palmbots carry and palmbots route"
        )
    if scene.task.path.is_curved and not world.supports_curved:
        others = _others(lambda entry: entry.supports_curved)
        raise SceneError(
            f"task.path.kind: {show(scene.task.path.kind)} is a curved path, and the {world.name} "
            f"world and its mechanics are planar; allowed: straight{others}"
        )
    if scene.task.path.is_curved:
        refuse_pipe(scene, "a curved path")
    if (scene.bumps.script or scene.bumps.rate_per_m > 0) and not world.supports_bumps:
        others = _others(lambda entry: entry.supports_bumps)
        raise SceneError(
            f"bumps: the {world.name} world cannot shift contacts; allowed: no bumps "
            f"(mujoco.ridges has bumps of the floor){others}"
        )
    if not world.supports_floor:
        refuse_floor(scene, f"the robots of the {world.name} world do")


def _others(supports: Callable[[WorldEntry], bool]) -> str:
    """The worlds that do support it, as the end of a message."""
    names = []
    for name in world_names():
        try:
            if supports(world_entry(name)):
                names.append(name)
        except (ImportError, PalmbotsError):  # a registered world that cannot be loaded here
            continue
    return f", or carry --world {' or '.join(names)}" if names else ""
