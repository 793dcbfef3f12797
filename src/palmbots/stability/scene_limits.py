# SPDX-License-Identifier: Apache-2.0
"""Whether a scene's own numbers exceed what properties 1 and 2 allow.

The core makes the warnings, for the page, too (`sim/limit_warnings.hpp`).
"""

from __future__ import annotations

import palmbots._core as _core
from palmbots._types import Interval, Overrides, Region
from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.scene.section import as_given
from palmbots.stability.problem import Pair, StabilityProblem, stability_problem


def self_check(
    scene: SceneLike = "paper", *, region_m: Region = "palm", overrides: Overrides = None
) -> tuple[str, ...]:
    """Warnings about numbers of a scene that exceed what properties 1 and 2 allow.

    Args:
        scene: a built-in name, a file, a table or a `Scene`.
        region_m: the contacts for which the properties have to hold: the whole palm, what the
            scene implies, or an interval [m].
        overrides: scene keys to set.

    Returns:
        One sentence for each quantity, and one where a property fails; none for a curved path, to
        which the analysis does not apply.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: the region is not on the palms, or the object cannot span it.
    """
    chosen = load_scene(scene, overrides)
    if chosen.task.path.is_curved:
        return ()
    if isinstance(region_m, str) and region_m == "palm":
        return limit_warnings(chosen)
    try:
        problem = stability_problem(chosen, region_m)
    except SceneError:  # planar mechanics do not apply
        return ()
    return limit_warnings(chosen, problem.contacts)


def limit_warnings(scene: Scene, contacts: tuple[Pair, Pair] | None = None) -> tuple[str, ...]:
    """The same on a straight path, for contacts that the object can span; None: the whole palms."""
    return tuple(_core.limit_warnings(as_given(scene), contacts))


def largest_acceleration(problem: StabilityProblem, slope: Interval) -> float:
    """The largest acceleration, in either direction, at which both properties hold [m/s²]."""
    here = problem.slope * problem.spec.direction
    return _core.standard_gravity * min(here - slope[0], slope[1] - here)
