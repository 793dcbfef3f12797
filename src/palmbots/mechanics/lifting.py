# SPDX-License-Identifier: Apache-2.0
"""Can a scene's robots pick its object up from the floor or a stand and put it down: by what
margin, and what limits?

`lifting` evaluates the closed forms of `lifting_forces` for a scene whose job begins or ends on the
floor or on a stand; `check_lift` raises an error for a job that cannot work, before anything moves.
Forces are those of the scene's object, masses of the robots are those of the MuJoCo model.
Source: docs/theory/lifting.md.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache, partial

import palmbots._core as _core
from palmbots._types import SIDES, BySide
from palmbots.errors import SceneError
from palmbots.mechanics import lift_refusals
from palmbots.mechanics.hand_over import hand_over
from palmbots.mechanics.lift_margins import PROPERTIES, Lifting, PalmLift
from palmbots.mechanics.lifting_bodies import Plate, Standing, plate_on_floor, standing
from palmbots.mechanics.lifting_forces import (
    Docking,
    docking,
    floor_friction_to_stay,
    least_partner_angle,
)
from palmbots.mechanics.lone import on_one_palm
from palmbots.mechanics.lone_refusals import lone_lift
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec

_G = _core.standard_gravity
_STEEPEST = math.radians(80)
_HALVINGS = 50
_LOWEST_HEEL_M = 1e-4  # any height stops a sharp edge


@lru_cache(maxsize=64)  # of one scene many jobs may be done
def lifting(scene: Scene) -> Lifting | None:
    """The analysis of a scene; None: its job neither begins nor ends on the floor or on a stand, or
    one palm at a time holds the object.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    spec = to_spec(scene, unrolled=True)
    if not spec.uses_floor or on_one_palm(scene):
        return None
    check_stands(spec)
    tops = _tops(scene, spec)
    body = standing(spec, scene.object.mass_kg * _G)
    shallow = tuple(plate_on_floor(palm, palm.shallow) for palm in spec.palms)
    steep = tuple(plate_on_floor(palm, palm.steep) for palm in spec.palms)
    plates = (shallow[0], shallow[1]), (steep[0], steep[1])
    docks = tuple(docking(body, plates[1], side) for side in (0, 1))
    rises, centred = _core.PivotRises(spec), _core.PivotRises(spec, _core.centred_share)
    permitted = centred.permitted_m(PROPERTIES, clear=False)
    kept = rises.permitted_m((0,), clear=False)
    on_floor, level_only = rises.holding(on_floor=True), _core.corrects_level_only(spec)
    may_centre_low = scene.task.ends[0] != "floor" or on_floor == PROPERTIES
    arms = [scene.arm.of(side) for side in SIDES]
    at_rest, late, differ = _core.arms_differ(spec, level_only)
    permitted_rates = [(kept - _core.arms_differ(spec, True)[0]) / late]
    if may_centre_low:
        permitted_rates.append((permitted - _core.arms_differ(spec, False)[0]) / late)
    noses = _core.rise_clear_of_noses(spec)
    result = Lifting(
        picks_up=scene.task.ends[0] == "floor",
        puts_down=scene.task.ends[1] == "floor",
        from_stand_m=tops[0],
        to_stand_m=tops[1],
        palms=BySide.of(_palm(scene, spec, body, plates, docks[k], k) for k in (0, 1)),
        edge_radius_m=body.radii[0],
        floor_friction=scene.floor.friction,
        nose_gap_m=_nose_gap(body, plates[1]),
        held_gap_m=_held_gap(
            body, plates[1], [dock.needs_heel and scene.task.ends[0] == "floor" for dock in docks]
        ),
        on_floor=on_floor,
        in_air=rises.holding(clear=False),
        level_only=level_only,
        permitted_rise_m=permitted,
        kept_rise_m=kept,
        clear_rise_m=centred.permitted_m(PROPERTIES),
        arms_differ_m=differ,
        most_rate_m_per_s=max(permitted_rates),
        clear_of_noses_m=noses,
        clear_rate_m_per_s=(noses - at_rest) / late,
        raised_differ_m=abs(arms[0].carry_height_m - arms[1].carry_height_m)
        + sum(arm.height_error_m for arm in arms),
        refusals=(),
        warnings=(),
        plates=plates,
        body=body,
    )
    return replace(
        result,
        refusals=tuple(lift_refusals.refusals(scene, result)),
        warnings=tuple(lift_refusals.warnings(scene, result)),
    )


def check_lift(scene: Scene) -> tuple[str, ...]:
    """The warnings about a job that begins or ends on the floor or on a stand; none for any other
    job.

    Raises:
        SceneError: the job cannot work.
    """
    found = lone_lift(scene) or hand_over(scene) or lifting(scene)
    if found is None:
        return ()
    if found.refusals:
        raise SceneError(found.refusals[0])
    return found.warnings


def check_stands(spec: _core.Spec) -> None:
    """Raise `SceneError` for an object that does not stand on its two contact vertices."""
    if refusal := _core.standing_refusal(spec):
        raise SceneError(refusal)


def _palm(
    scene: Scene,
    spec: _core.Spec,
    body: Standing,
    plates: tuple[tuple[Plate, Plate], tuple[Plate, Plate]],
    dock: Docking,
    side: int,
) -> PalmLift:
    shallow, steep = plates
    own, palm = steep[side], spec.palms[side]
    push, heaviest = _traction(scene, spec, body, steep, dock, side)
    arm, tops = scene.arm.of(SIDES[side]), _tops(scene, spec)
    heights = partial(_core.stand_heights, spec, side)
    return PalmLift(
        nose_height_m=own.nose,
        thickest_m=body.radii[side] * (1 - math.sin(own.friction)),
        lean_deg=math.degrees(dock.lean),
        squeeze_n=dock.alone,
        second_n=dock.second.squeeze,
        held_n=dock.just_on.held,
        heel_held_n=dock.at_heel.held if steep[1 - side].heel > 0 else dock.just_on.held,
        gets_under=dock.gets_under,
        may_get_under=dock.may_get_under,
        needs_heel=dock.needs_heel,
        least_heel_m=_least_heel(body, steep, side, dock),
        least_partner_deg=math.degrees(least_partner_angle(body, steep, side)),
        push_n=push,
        heaviest_kg=heaviest,
        floor_friction=BySide(
            *(floor_friction_to_stay(body, pair, side) for pair in (shallow, steep))
        ),
        pivot_m=BySide(shallow[side].pivot, own.pivot),
        least_angle_deg=math.degrees(_least_angle(palm, arm.lowest_pivot_m)),
        carry_height_m=arm.carry_height_m,
        below_from_m=None if tops[0] is None else heights(tops[0])[0],
        below_to_m=None if tops[1] is None else heights(tops[1])[0],
        clear_m=max((heights(top)[1] for top in tops if top is not None), default=0.0),
    )


def _tops(scene: Scene, spec: _core.Spec) -> tuple[float | None, float | None]:
    """Heights of the stands on which the job begins and ends."""
    begins, ends = (on == "stand" for on in scene.task.ends)
    return (
        _core.standing_level(spec) if begins else None,
        _core.standing_level(spec, spec.direction * spec.distance) if ends else None,
    )


def _least_heel(body: Standing, plates: tuple[Plate, Plate], side: int, dock: Docking) -> float:
    """The height of the partner's heel with which a nose certainly gets under second; infinite: no
    heel helps."""
    if dock.gets_under and not dock.needs_heel:
        return 0.0
    height = max(body.radii[1 - side], _LOWEST_HEEL_M)
    pair = [replace(plate, heel=height) for plate in plates]
    return height if docking(body, (pair[0], pair[1]), side).gets_under else math.inf


def _traction(
    scene: Scene,
    spec: _core.Spec,
    body: Standing,
    plates: tuple[Plate, Plate],
    dock: Docking,
    side: int,
) -> tuple[float, float]:
    """The most that the robot of a palm can push with while its nose gets under, and the heaviest
    object for which both robots push hard enough."""
    squeeze = dock.squeeze
    lean = dock.lean + plates[side].friction
    load = squeeze / math.tan(lean) if lean > 0 and math.isfinite(squeeze) else 0.5 * body.weight
    pushes, heaviest = [math.inf, math.inf], math.inf
    for k, carried in ((side, load), (1 - side, body.weight - load)):
        nose = -0.5 * spec.palms[k].length
        limit, by_load = _core.push_of_robot(as_given(scene), k, nose, plates[k].pivot)
        most = scene.robot_of(SIDES[k]).force_limit_n
        pushes[k] = max(0.0, limit + by_load * carried)
        if most is not None:
            pushes[k] = min(pushes[k], most)
            heaviest = min(heaviest, most / squeeze if squeeze > 0 else math.inf)
        needed = squeeze - by_load * carried
        if needed > 0:
            heaviest = min(heaviest, max(0.0, limit) / needed)
    return pushes[side], heaviest * scene.object.mass_kg


def _nose_gap(body: Standing, plates: tuple[Plate, Plate]) -> float:
    """Between the noses in the narrowest state of docking."""
    reaches = [plate.half * math.cos(plate.angle) for plate in plates]
    return body.width - max(2 * reaches[0] + reaches[1], reaches[0] + 2 * reaches[1])


def _held_gap(body: Standing, plates: tuple[Plate, Plate], need_heel: list[bool]) -> float:
    """Between the noses in the states through which every job passes."""
    reaches = [plate.half * math.cos(plate.angle) for plate in plates]
    at_heel = [2 * reaches[1 - k] for k in (0, 1) if need_heel[k]]
    return body.width - max(sum(reaches), *at_heel, 0.0)


def _least_angle(palm: _core.PalmSpec, lowest: float) -> float:
    """The least angle at which the pivot of a palm on the floor is at least this high [rad]; 80° if
    none is that high."""
    if palm.lowest_pivot(0.0) >= lowest:
        return 0.0
    low, high = 0.0, _STEEPEST
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if palm.lowest_pivot(middle) >= lowest else (middle, high)
    return high
