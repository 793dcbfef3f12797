# SPDX-License-Identifier: Apache-2.0
"""Diagnosis after a drop or a failed start: properties that fail even under the best conditions.

The best conditions are the nominal angles, friction and COM, with contacts that never leave the
zero zone of the sensor. A property that fails there also fails on the whole palm, so
`palmbots analyze` reports the reason.
"""

from palmbots._types import SIDES
from palmbots.control.dead_band import zero_zone_edges_m
from palmbots.control.registry import describe
from palmbots.control.table_timing import transition_table
from palmbots.errors import PalmbotsError
from palmbots.scene.command_text import command_text
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec
from palmbots.stability.problem import Pair, permitted, stability_problem


def missing_properties(scene: Scene, controller: str) -> tuple[int, ...]:
    """The properties (0, 1, 2) that fail with contacts in the zero zone.

    The controller ``none`` turns no palm, so for it only one condition counts, reported as 0: two
    steep palms hold the object. Empty for a scene to which planar mechanics do not apply, such as
    one with a curved path, and for a job in which one palm holds the object: no controller corrects
    it there.
    """
    if to_spec(scene, unrolled=True).on_one_palm:
        return ()
    try:
        problem = stability_problem(scene, _zero_zone(scene))
    except PalmbotsError:
        return ()
    angles, numbers = problem.angles, (0, 1, 2)
    if describe(controller).team == "none":
        (_, left), (_, right) = angles
        angles, numbers = ((left, left), (right, right)), (0,)
    envelope, x = problem.envelope(), problem.com[0]

    def holds(number: int) -> bool:
        ends = (permitted(envelope, number, shallow, angles) for shallow in SIDES)
        return all(low <= x <= high for low, high in ends)

    return tuple(number for number in numbers if not holds(number))


def analyze_hint(scene: Scene, controller: str) -> str | None:
    """One line with the command that reports the reason; None: no property is missing.

    Args:
        scene: the scene of the carry.
        controller: its controller.
    """
    missing = missing_properties(scene, controller)
    if not missing:
        return None
    if describe(controller).team == "none":
        fault = "two steep palms do not hold the object"
    elif len(missing) == 1:
        fault = f"property {missing[0]} does not hold"
    else:
        listed = " and ".join([", ".join(map(str, missing[:-1])), str(missing[-1])])
        fault = f"properties {listed} do not hold"
    return f"{fault}, even with contacts inside the zero zone; run: {_command(scene)}"


def touch_start_hint(scene: Scene, controller: str) -> str | None:
    """One line on why the leader does not feel that the follower starts; None: it can feel that.

    The follower starts with its palm steep and closes in on the leader. The leader's contact slides
    only if property 1 holds with the leader's palm shallow. Arguments as in `analyze_hint`.
    """
    table = transition_table(describe(controller), scene)
    if scene.control.start != "touch" or table is None or not table["starts_by_touch"]:
        return None
    leader = "right" if scene.task.direction == "forward" else "left"
    try:
        problem = stability_problem(scene, _zero_zone(scene))
    except PalmbotsError:
        return None
    low, high = permitted(problem.envelope(), 1, leader, problem.angles)
    if low <= problem.com[0] <= high:
        return None
    return (
        f"start by touch: property 1 does not hold with the {leader} palm shallow, so the leader "
        f"does not feel the follower; run: {_command(scene)}"
    )


def _command(scene: Scene) -> str:
    """The command that analyzes the scene."""
    region = None
    try:
        stability_problem(scene)
    except PalmbotsError:  # the analysis applies to the zero zone, but not to whole palms
        region = [*_zero_zone(scene)]
    return command_text("analyze", scene.spelled, region=region)


def _zero_zone(scene: Scene) -> Pair:
    """The zone in which the sensors read 0, as far as both palms reach [m]."""
    half = min(scene.palm_of(side).reach_m for side in SIDES)
    low, high = zero_zone_edges_m(scene)
    return -min(max(-low, 0.0), half), min(max(high, 0.0), half)
