# SPDX-License-Identifier: Apache-2.0
"""Whether a scene's own numbers exceed what properties 1 and 2 allow.

Four quantities of a scene are compared with what the analysis allows: the mass of the object, the
acceleration of the robots, the slope of the floor, and the angle through which a palm turns in one
control period: a palm that is stopped one period late is off by that angle.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import palmbots._core as _core
from palmbots._types import SIDES, Interval, Overrides
from palmbots.errors import PalmbotsError, SceneError
from palmbots.mechanics.load_limits import LoadLimits, load_limits
from palmbots.scene.scene import Scene, SceneLike, load_scene
from palmbots.stability.margins import angle_error, slope_range
from palmbots.stability.problem import Region, StabilityProblem, permitted, stability_problem
from palmbots.stability.tightest_margins import angle_step_deg, fastest_acceleration

FAILING = "{names} {fails} {where}"
"""The warning that properties fail, which the page prints, too (scripts/site_tables.py)."""
SOMEWHERE = "for contacts somewhere on the palms"
_ANYWHERE = "for contacts anywhere on the palms"


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
    try:
        problem = stability_problem(chosen, region_m)
    except SceneError:  # a curved path, to which planar mechanics do not apply
        return ()
    except PalmbotsError as error:
        if region_m != "palm":
            raise
        return (f"properties 1 and 2 cannot hold on the whole palms: {error}",)
    load = load_limits(chosen)
    return limit_warnings(chosen, problem, slope_range(problem), angle_error(problem), load)


def limit_warnings(
    scene: Scene,
    problem: StabilityProblem,
    slope: Interval | None,
    angle: float | None,
    load: LoadLimits,
) -> tuple[str, ...]:
    """The same, from the allowed slopes (tangents, uphill in travel > 0), angle error [rad] and
    masses."""
    heavy = load.warning()
    return (*_warnings(scene, problem, slope, angle), *([heavy] if heavy else []))


def largest_acceleration(problem: StabilityProblem, slope: Interval) -> float:
    """The largest acceleration, in either direction, at which both properties hold [m/s²]."""
    here = problem.slope * problem.spec.direction
    return _core.standard_gravity * min(here - slope[0], slope[1] - here)


def _warnings(
    scene: Scene, problem: StabilityProblem, slope: Interval | None, angle: float | None
) -> Iterator[str]:
    where = _region_text(problem)
    failing = [n for n in (0, 1, 2) if not _holds(problem, n)]
    if slope is None:
        level = slope_range(problem.with_(slope=0.0))
        if scene.task.slope_deg and level is not None:
            low, high = (math.degrees(math.atan(end)) for end in level)
            yield (
                f"task.slope_deg is {scene.task.slope_deg:g}, but properties 1 and 2 hold only "
                f"from {low:.2f} to {high:.2f}° {where}"
            )
            failing = [n for n in failing if n == 0]  # the slope is the reason of the others
    elif scene.task.inertia:
        limit = largest_acceleration(problem, slope)
        value = fastest_acceleration(scene)
        if value > limit:
            yield (
                f"robot.acceleration_m_s2 is {value:g}, but properties 1 and 2 hold only up to "
                f"{math.floor(1e3 * limit) / 1e3:g} m/s² {where}"
            )
    if failing:
        names = " and ".join(f"property {n}" for n in failing)
        fails = "fails" if len(failing) == 1 else "fail"
        place = SOMEWHERE if where == _ANYWHERE else where
        text = FAILING.format(names=names, fails=fails, where=place)
        yield f"{text}; palmbots analyze reports what happens there"
    step_deg = angle_step_deg(scene)
    if angle is not None and step_deg > math.degrees(angle):
        yield (
            f"palm.rate_deg_s turns a palm by {step_deg:.2g}° in one control period, but "
            f"properties 1 and 2 allow an angle error of only ±{math.degrees(angle):.2g}° {where}"
        )


def _holds(problem: StabilityProblem, number: int) -> bool:
    """Whether a property holds with either palm as the shallow one."""
    envelope, x = problem.envelope(), problem.com[0]
    ends = (permitted(envelope, number, shallow, problem.angles) for shallow in SIDES)
    return all(low <= x <= high for low, high in ends)


def _region_text(problem: StabilityProblem) -> str:
    whole = tuple((-half, half) for half in problem.reach)
    if problem.contacts == whole:
        return _ANYWHERE
    low, high = problem.contacts[0]
    return f"for contacts from {1e3 * low:.1f} to {1e3 * high:.1f} mm"
