# SPDX-License-Identifier: Apache-2.0
"""Preparing carries: the checks and conversions that come before anything runs, done once."""

from dataclasses import dataclass, replace
from functools import cached_property

import palmbots._core as _core
from palmbots.control.dead_band import warnings_before
from palmbots.control.registry import (
    ControllerEntry,
    ControllerLike,
    check,
    describe,
    refuse_reference,
    resolve,
)
from palmbots.control.resilient_timing import Bounds
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.worlds import WorldEntry, check_scene, world_entry

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

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """The warnings that are known before the carry starts."""
        of_timing = self.timing.warnings if self.timing else ()
        return (*warnings_before(self.scene, self.controller), *of_timing)

    def renamed(self, controller: str) -> "Prepared":
        """The same for a carry that a program stepped from outside, under this name."""
        return replace(self, controller=describe(controller), timing=None)


def prepare(
    scene: Scene | str,
    controller: ControllerLike = "distributed",
    world: str | WorldEntry = "quasistatic",
) -> Prepared:
    """Check a scene against a controller and a world, and convert it for the core.

    Raises:
        SceneError: the scene cannot be read, or the world or the controller refuses it.
        PalmbotsError: there is no such controller or world.
    """
    scene = load_scene(scene)
    place = world_entry(world) if isinstance(world, str) else world
    entry = resolve(controller)
    check_scene(place, scene)
    if not place.supports_references:
        refuse_reference(entry, f"the {place.name} world")
    timing = check(entry, scene)
    spec = to_spec(scene, unrolled=place.supports_curved)
    if not entry.uses_clock:
        # Its robots measure no time: their clocks run like that of the carry, also in programs.
        spec.faults = [
            (kind, side, at, lasts, reads, 0.0 if kind in _CLOCK_FAULTS else value, marks)
            for kind, side, at, lasts, reads, value, marks in spec.faults
        ]
    return Prepared(scene, entry, place, spec, timing)
