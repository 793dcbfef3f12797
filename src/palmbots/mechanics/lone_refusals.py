# SPDX-License-Identifier: Apache-2.0
"""Why a job in which one palm holds the object cannot begin and what may end it, in words, from the
closed forms of `palmbots.mechanics.lone`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import palmbots._core as _core
from palmbots._util.text import millimetres, rounded_down, rounded_up
from palmbots.mechanics.lone import (
    LoneLift,
    check_standing,
    height_of,
    lift_with,
    mm,
    newtons,
)
from palmbots.scene.scene import Scene
from palmbots.scene.spec import to_spec


def lone_lift(scene: Scene) -> LoneLift | None:
    """The analysis of a scene; None: two robots do its job, or it is a carry from palms to palms.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    if scene.task.dock != "alone" or not (spec := to_spec(scene)).uses_floor:
        return None
    check_standing(spec)
    found, tall = lift_with(scene, spec, 1 if spec.direction > 0 else 0), height_of(spec)
    refusals = [*refusals_of_lone(scene, spec, found, tall)]
    return replace(found, refusals=tuple(refusals), warnings=tuple(warnings_of(found)))


def refusals_of_lone(scene: Scene, spec: _core.Spec, found: LoneLift, tall: float) -> Iterator[str]:
    """Why the job of one robot against a wall cannot begin."""
    yield from refusals_of_task(scene, spec)
    if found.wall_m is None:
        yield (
            "floor.walls: no wall stands behind the object, so the robot would push it away; "
            "allowed: one with at_m < 0"
        )
        return
    low = next(wall for wall in scene.floor.walls if wall.at_m < 0)
    if low.height_m is not None and low.height_m < tall:
        yield (
            f"floor.walls[].height_m: value is {low.height_m:g}, and the object is "
            f"{millimetres(tall)} high; allowed: at least that"
        )
    yield from refusals_of_palm(scene, found)


def refusals_of_task(scene: Scene, spec: _core.Spec) -> Iterator[str]:
    """Why one palm at a time cannot do this job, whatever the palm is."""
    for key, place in zip(("from", "to"), scene.task.ends, strict=True):
        if place != "floor":
            yield (
                f'task.{key}: value is {place}, but with task.dock = "{scene.task.dock}" one robot '
                "picks the object up and puts it down; allowed: floor"
            )
    if spec.slope != 0:
        yield (
            f"task.slope_deg: value is {scene.task.slope_deg:g}, and one robot alone works on a "
            "level floor; allowed: 0"
        )


def refusals_of_palm(scene: Scene, found: LoneLift) -> Iterator[str]:
    """Why a palm cannot pick the object up, carry it or put it down."""
    if found.nose_height_m >= found.thickest_m:
        yield (
            f"palm.nose_m: the upper edge of the nose is {mm(found.nose_height_m)} above the "
            "floor, and it gets under the edge of the object only below "
            f"{mm(found.thickest_m)}; allowed: a thinner nose, or a larger object.edge_radius_m"
        )
        return
    if found.self_locking:
        yield (
            f"floor.walls[].friction: value is {found.wall_friction:g}, so the object jams between "
            f"nose and wall; allowed: less than {rounded_down(found.most_wall_friction, 3):g}"
        )
    elif found.squeeze_n > found.push_n and scene.object.mass_kg > found.heaviest_kg:
        yield (
            f"object.mass_kg: value is {scene.object.mass_kg:g}, and the robot would have to push "
            f"with {newtons(found.squeeze_n)} to get under it; allowed: at most "
            f"{rounded_down(found.heaviest_kg, 3):g} with the traction of this robot"
        )
    if found.width_m > found.room_m:
        yield (
            f"object.vertices_m: the contact vertices are {millimetres(found.width_m)} apart, and "
            f"the palm has room for {millimetres(found.room_m)}; allowed: at most that, or a "
            "longer palm (palm.length_m)"
        )
    if found.shallow_deg >= found.friction_deg:
        yield (
            f"palm.shallow_deg: value is {found.shallow_deg:g}, so the object slides off the palm; "
            f"allowed: less than the friction angle, {found.friction_deg:.1f}"
        )
    elif found.acceleration_m_s2 > found.most_acceleration_m_s2:
        yield (
            f"robot.acceleration_m_s2: value is {found.acceleration_m_s2:g}, so the object slides "
            "off the palm as the robot starts; allowed: at most "
            f"{rounded_down(found.most_acceleration_m_s2, 3):g}"
        )
    lean, least = found.partner_lean_deg, found.least_partner_lean_deg
    if lean is not None and least is not None and lean < least:
        yield (
            f"palm.steep_deg: the contact on the palm of the partner leans by {lean:.1f}°, so the "
            f"object climbs it while the {found.robot} nose drives under it; allowed: at least "
            f"{rounded_up(least, 3):g}"
        )
    if not found.friction_deg < found.steep_deg < found.topples_deg:
        why = (
            "so the palm takes the object along when it leaves"
            if found.steep_deg <= found.friction_deg
            else "so the object topples off the palm"
        )
        yield (
            f"palm.steep_deg: value is {found.steep_deg:g}, {why}; allowed: more than the friction "
            f"angle, {found.friction_deg:.1f}, and less than {found.topples_deg:.1f}"
        )
    arm, name = scene.arm.of(found.robot), found.robot
    if found.pivot_m < arm.lowest_pivot_m:
        yield (
            f"arm.lowest_pivot_m: value is {arm.lowest_pivot_m:g}, but the pivot of the {name} "
            f"palm is only {millimetres(found.pivot_m)} above the floor; allowed: at most that"
        )


def warnings_of(
    found: LoneLift,
    key: str = "palm.steep_deg",
    may_be: Callable[[float], bool] = lambda _: False,
) -> Iterator[str]:
    """What may end the job. `may_be`: whether the job can begin with this value of the key. The
    default names no angle: one robot alone may not get away from the object at that angle."""
    if found.floor_friction >= found.least_floor_friction:
        return
    remedies = []
    angle = rounded_down(found.most_steep_deg, 3)
    if angle > found.friction_deg and may_be(angle):
        remedies.append(f"with {key} at most {angle:g}")
    if math.isfinite(found.least_floor_friction):
        friction = rounded_up(found.least_floor_friction, 3)
        remedies.append(f"with floor.friction at least {friction:g}")
    remedy = f"; it does not {', or '.join(remedies)}" if remedies else ""
    yield (
        f"{key} is {found.steep_deg:g}, and floor.friction is {found.floor_friction:g}: "
        f"the object slides by itself down the palm that leaves, and may fall{remedy}"
    )
