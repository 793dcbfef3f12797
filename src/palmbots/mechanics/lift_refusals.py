# SPDX-License-Identifier: Apache-2.0
"""Why a job on the floor or on a stand cannot begin and what may end it, in words, from the closed
forms of `palmbots.mechanics.lifting`."""

from __future__ import annotations

import math
from collections.abc import Iterator

from palmbots._types import SIDES, Side
from palmbots._util.text import millimetres, rounded_down, rounded_up
from palmbots.mechanics.lift_margins import Lifting, newtons
from palmbots.scene.core_keys import ROWS
from palmbots.scene.scene import Scene


def refusals(scene: Scene, found: Lifting) -> Iterator[str]:
    """Why the job cannot begin."""
    for side in SIDES:
        if found.is_on_floor:
            yield from _refusals_of_arm(scene, found, side)
        yield from _refusals_of_stand(scene, found, side)
    yield from _refusals_of_tops(scene, found)
    yield from _refusals_of_moving_arms(scene, found)
    if found.from_stand_m is not None:
        yield from _refusals_of_noses(found)
    if found.picks_up:
        for side in SIDES:
            yield from _refusals_of_dock(scene, found, side)
        yield from _refusals_of_noses(found)
    if found.picks_up or found.from_stand_m is not None:
        keys = "palm.shallow_deg, palm.steep_deg"
        if found.picks_up and 0 not in found.on_floor:
            yield (
                f"{keys}: property 0 does not hold while the noses are on the floor, where the "
                "pivots are at different heights, so the palms lose the object; allowed: pairs of "
                "angles with which it holds"
            )
        for number in (0, 2):
            if number not in found.where_centred:
                yield (
                    f"{keys}: property {number} does not hold {_IN_AIR}, so corrections lose "
                    "the object; allowed: pairs of angles with which it holds"
                )
    taken = [found.palms[side].floor_friction.right for side in _keeping(scene)]
    if found.puts_down and len(taken) == len(SIDES) and found.floor_friction < min(taken):
        yield (
            f"floor.friction: value is {found.floor_friction:g}, so the palm that leaves last "
            f"takes the object along; allowed: at least {rounded_up(min(taken), 3):g}, or "
            "palm.steep_deg nearer to the friction angle"
        )


# Where the properties do not hold on the floor, contacts are centred in the air.
_IN_AIR = "in the air, where the contacts are centred"


def _refusals_of_noses(found: Lifting) -> Iterator[str]:
    if found.held_gap_m < 0:
        width, least = found.body.width, found.body.width - found.held_gap_m
        yield (
            f"object.vertices_m: the contact vertices are {millimetres(width)} apart, and the "
            "noses of the palms meet below the object; allowed: at least "
            f"{millimetres(least)}, or shorter palms (palm.length_m)"
        )


def _keeping(scene: Scene) -> Iterator[Side]:
    """The palms on which the object does not slide by itself: steep, they are below the friction
    angle."""
    for side in SIDES:
        palm = scene.palm_of(side)
        if math.radians(palm.steep_deg) < math.atan(palm.friction):
            yield side


def _refusals_of_arm(scene: Scene, found: Lifting, side: Side) -> Iterator[str]:
    palm, arm, own = scene.palm_of(side), scene.arm.of(side), found.palms[side]
    shallowest = min(palm.shallow_deg, palm.steep_deg)
    if shallowest < 0:
        yield (
            f"palm.shallow_deg: value is {shallowest:g} on the {side} side, where the outer end "
            "of the palm is its lowest point; allowed on the floor: at least 0"
        )
    elif own.pivot_m.left < arm.lowest_pivot_m:
        yield (
            f"arm.lowest_pivot_m: value is {arm.lowest_pivot_m:g}, but the pivot of the {side} "
            f"palm is only {millimetres(own.pivot_m.left)} above the floor at {shallowest:g}°; "
            f"allowed: at most that, or palm angles of at least "
            f"{rounded_up(own.least_angle_deg, 1):g}°"
        )
    if arm.carry_height_m <= own.pivot_m.right:
        yield (
            f"arm.carry_height_m: value is {arm.carry_height_m:g}, which does not raise the "
            f"{side} palm off the floor; allowed: more than {rounded_up(own.pivot_m.right, 4):g}"
        )


def _refusals_of_tops(scene: Scene, found: Lifting) -> Iterator[str]:
    """Arms that are up hold the object at these heights for as long as the pair carries."""
    left, right = (scene.arm.of(side).carry_height_m for side in SIDES)
    apart, permitted = abs(left - right), found.permitted_rise_m
    if apart > permitted > 0:
        yield (
            f"arm.carry_height_m: the left palm is carried at {left:g} m and the right one at "
            f"{right:g} m, and the properties hold only up to a difference of "
            f"{millimetres(permitted)}; allowed: heights that differ by at most that"
        )


def _refusals_of_moving_arms(scene: Scene, found: Lifting) -> Iterator[str]:
    most, rates = found.most_rate_m_per_s, [scene.arm.of(side).rate_m_per_s for side in SIDES]
    if found.kept_rise_m > 0 and max(rates) > most:
        allowed = (
            f"at most {rounded_down(most, 3):g}"
            if most >= ROWS["arm.rate_m_per_s"]["least"]
            else "smaller arm.height_error_m, or palm angles nearer to each other"
        )
        which, limit = max(
            ("property 0 holds", found.kept_rise_m),
            ("the properties hold", found.permitted_rise_m),
            key=lambda one: one[1],
        )
        yield (
            f"arm.rate_m_per_s: value is {max(rates):g}, so the heights of the arms may differ by "
            f"{millimetres(found.arms_differ_m)} while they move, and {which} only up to "
            f"{millimetres(limit)}; allowed: {allowed}"
        )


def _refusals_of_stand(scene: Scene, found: Lifting, side: Side) -> Iterator[str]:
    own, arm = found.palms[side], scene.arm.of(side)
    lowest = max(own.pivot_m.right, arm.lowest_pivot_m)
    tops = found.from_stand_m, found.to_stand_m
    for top, below in zip(tops, (own.below_from_m, own.below_to_m), strict=True):
        if top is not None and below is not None and below < lowest:
            yield (
                f"floor.stands[].height_m: value is {top:g}, and the {side} palm does not fit "
                f"below the object; allowed: at least {rounded_up(top + lowest - below, 4):g}"
            )
    least = own.clear_m + arm.height_error_m
    if own.clear_m > 0 and arm.carry_height_m <= least:
        yield (
            f"arm.carry_height_m: value is {arm.carry_height_m:g}, where the object may still "
            f"touch the stand; allowed on the {side} side: more than {rounded_up(least, 4):g}"
        )


def _refusals_of_dock(scene: Scene, found: Lifting, side: Side) -> Iterator[str]:
    palm, own, partner = scene.palm_of(side), found.palms[side], SIDES[1 - SIDES.index(side)]
    if own.nose_height_m >= own.thickest_m and own.nose_height_m > 0:
        name = "thickness_m" if palm.nose_m is None else "nose_m"
        radius = rounded_up(own.nose_height_m / (1 - math.sin(math.atan(palm.friction))), 4)
        height = millimetres(own.nose_height_m)
        high = f"the upper edge of the {side} nose is {height} above the floor"
        if found.edge_radius_m == 0:
            yield (
                f"object.edge_radius_m: value is 0, but {high}, and no nose gets under a sharp "
                f"edge; allowed: more than {radius:g}, or palm.{name} = 0"
            )
            return
        yield (
            f"palm.{name}: {high}, and the nose gets under an edge with object.edge_radius_m = "
            f"{found.edge_radius_m:g} only below {millimetres(own.thickest_m)}; allowed: a "
            f"thinner nose, or an edge radius of more than {radius:g}"
        )
        return
    if not own.may_get_under:
        heel = scene.palm_of(partner).heel_m
        # No steeper angle of both palms helps: neither then holds against the other one.
        high = rounded_up(own.least_heel_m, 4)
        allowed = "shorter palms (palm.length_m)" if math.isinf(high) else f"at least {high:g}"
        yield (
            f"palm.heel_m: value is {heel:g} on the {partner} side, so the robots jam: the "
            f"{side} nose needs {newtons(own.second_n, 'more than any push')} to get under, and "
            f"the {partner} palm holds {newtons(max(own.held_n, own.heel_held_n))}; "
            f"allowed: {allowed}"
        )
    elif scene.object.mass_kg > own.heaviest_kg:
        yield (
            f"object.mass_kg: value is {scene.object.mass_kg:g}, and the robots would have to "
            f"push with {newtons(max(own.squeeze_n, own.second_n))} to get the {side} nose under "
            f"it; allowed: at most {rounded_down(own.heaviest_kg, 3):g} with the traction of these "
            "robots"
        )


def warnings(scene: Scene, found: Lifting) -> Iterator[str]:
    """What may end it."""
    if (found.picks_up or found.from_stand_m is not None) and 1 not in found.where_centred:
        yield (
            f"property 1 does not hold {_IN_AIR}: corrections may take longer, or never "
            "centre both contacts"
        )
    for side in SIDES if found.picks_up else ():
        own, partner = found.palms[side], SIDES[1 - SIDES.index(side)]
        if own.may_get_under and not own.gets_under:
            yield (
                f"palm.heel_m is {scene.palm_of(partner).heel_m:g} on the {partner} side: the "
                f"object may roll over this heel while the {side} nose gets under; at "
                f"{rounded_up(own.least_heel_m, 4):g} or more it cannot"
            )
    if found.picks_up and found.nose_gap_m < 0:
        yield (
            f"the object is {millimetres(found.body.width)} wide, and the noses may overlap below "
            f"it by {millimetres(-found.nose_gap_m)} when one contact is at its heel"
        )
    if found.puts_down:
        keeping = (found.palms[side].floor_friction.right for side in _keeping(scene))
        needed = max(keeping, default=0.0)
        if found.floor_friction < needed:
            yield (
                f"floor.friction is {found.floor_friction:g}: if the wrong palm leaves last, it "
                f"takes the object along; no palm does at {rounded_up(needed, 3):g} or more"
            )
        keeps = set(_keeping(scene))
        steeper = (found.palms[side].floor_friction.right for side in SIDES if side not in keeps)
        needed = max(steeper, default=0.0)
        if found.floor_friction < needed:
            yield (
                f"floor.friction is {found.floor_friction:g}: the object slides by itself down a "
                "palm that leaves last and is steeper than the friction angle, and may fall; it "
                f"does not at {rounded_up(needed, 3):g} or more"
            )
    if found.level_only and found.arms_differ_m > found.clear_of_noses_m:
        least = ROWS["arm.rate_m_per_s"]["least"]
        rate = found.clear_rate_m_per_s
        slower = f": at {rounded_down(rate, 3):g} m/s it cannot" if rate >= least else ""
        yield (
            f"the heights of the arms may differ by {millimetres(found.arms_differ_m)} while they "
            f"move, and from {millimetres(found.clear_of_noses_m)} on the object may lie on a nose "
            f"and lift off its contact{slower} (arm.rate_m_per_s)"
        )
    if found.raised_differ_m > found.permitted_rise_m > 0:
        yield (
            f"the heights of the arms may differ by {millimetres(found.raised_differ_m)} while the "
            "pair carries, but property 1 holds only up to "
            f"{millimetres(found.permitted_rise_m)}: corrections may never centre both contacts "
            "(arm.height_error_m)"
        )
