# SPDX-License-Identifier: Apache-2.0
"""The dead-band law: how wide the sensor's zero zone must be for corrections to end.

A correction stops when the sign changes. The contact then overruns: for one control period until
the controller sees the sign, for the braking distance, and, where a station decides or both robots
drive by both signs, for the time that messages travel. If the overrun exceeds the width of the zero
zone, the contact leaves it on the other side, the opposite correction begins, and this repeats
forever.
"""

from __future__ import annotations

import math
from itertools import pairwise

from palmbots._types import SIDES, Side
from palmbots._util.text import millimetres as _mm
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.control.table_timing import short_lease_warning
from palmbots.scene.object_section import Object
from palmbots.scene.palm_overlap import overlap_m
from palmbots.scene.robot_section import RobotParameters
from palmbots.scene.scene import Scene


def overrun_m(scene: Scene, controller: str | ControllerEntry) -> float:
    """How far a contact can overrun the edge of the zero zone [m]; 0 without a controller.

    With u the correction speed of a robot, T its control period and D the delay of the radio, a
    contact overruns by u T and the braking distance where one robot drives. Where both drive by
    both signs (shared-sign), the partner learns of the zero only D later: the sum of u (D + T) and
    the braking distance over both robots.
    """
    entry = resolve(controller)
    team = entry.team
    period = scene.control.period_s
    step = period * max(scene.stride_of(side) for side in SIDES)
    steepest = max(math.radians(scene.palm_of(side).steep_deg) for side in SIDES)
    # Along the palm a contact moves a little farther than the robots do.
    along_palm = 1 / math.cos(steepest)
    robots = [scene.robot_of(side) for side in SIDES]
    if team == "none":
        return 0.0
    if team == "station":
        delay = 2 * max(period, scene.radio.longest_delay_s) + step
        distance = sum(0.5 * r.correction_m_s * delay + _braking_m(r, 0.5, period) for r in robots)
        return distance * along_palm
    if entry.drives_by_both_signs:
        delay = max(period, scene.radio.longest_delay_s) + step
        distance = sum(r.correction_m_s * delay + _braking_m(r, 1.0, period) for r in robots)
        return distance * along_palm
    return along_palm * max(r.correction_m_s * step + _braking_m(r, 1.0, period) for r in robots)


def _braking_m(robot: RobotParameters, fraction: float, period: float) -> float:
    """The distance from a correction (a fraction of its speed) back to nominal speed."""
    speed = fraction * robot.correction_m_s
    drop = robot.acceleration_m_s2 * period
    steps = max(0, math.ceil(speed / drop) - 1)
    return period * (steps * speed - drop * steps * (steps + 1) / 2)


def zero_zone_m(scene: Scene) -> float:
    """The width of the zone between − and + in which the sensor reads 0 [m]."""
    low, high = zero_zone_edges_m(scene)
    return high - low


def zero_zone_edges_m(scene: Scene) -> tuple[float, float]:
    """Where the sensor stops reading − and starts reading + [m]; infinite where it never does."""
    zones = scene.tactile.zones
    if zones is None:
        half = scene.tactile.zero_half_width_m
        return -half, half
    if not zones:
        return -math.inf, math.inf
    edges = sorted({edge for zone in zones for edge in (zone.from_m, zone.to_m)})
    pieces = [(-math.inf, edges[0]), *pairwise(edges), (edges[-1], math.inf)]

    def reads(low: float, high: float) -> str:
        if math.isinf(low) or math.isinf(high):
            return "0"
        signs = {z.sign for z in zones if z.from_m <= 0.5 * (low + high) <= z.to_m}
        return "0" if "0" in signs or not signs else signs.pop()

    read = [(low, high, reads(low, high)) for low, high in pieces]
    negative_end = max((high for _, high, sign in read if sign == "-"), default=-math.inf)
    positive_start = min((low for low, _, sign in read if sign == "+"), default=math.inf)
    return negative_end, positive_start


def warnings_before(scene: Scene, controller: str | ControllerEntry) -> tuple[str, ...]:
    """The warnings that are known before a carry starts."""
    entry = resolve(controller)
    zone, overrun = zero_zone_m(scene), overrun_m(scene, entry)
    lines = []
    if entry.is_reference:
        lines.append(
            f"{entry.name} is a reference with full information: it reads the simulated state, and "
            "no robot can run it"
        )
    elif overrun > zone:
        late = entry.team == "station" or entry.drives_by_both_signs
        keys = ", radio.latency_s)" if late else ", control.period_s)"
        lines.append(
            f"the zero zone is {_mm(zone)} wide, but a contact overruns its edge by "
            f"{_mm(overrun)}: corrections may not end (widen tactile.zero_half_width_m or lower "
            f"robot.correction_m_s{keys}"
        )
    if (lease := short_lease_warning(entry, scene)) is not None:
        lines.append(lease)
    if entry.team != "none" and not entry.is_reference:
        lines += [line for side in SIDES if (line := _blind(scene, side))]
    if scene.object.is_upside_down:
        lines.append(
            f"the object rests upside down: its outline is turned by "
            f"{scene.object.rest_angle_deg:.0f}° (object.contacts are upper vertices of "
            "object.vertices_m)"
        )
    usual = Object()
    if scene.object.com_m == usual.com_m and scene.object.vertices_m != usual.vertices_m:
        lines.append(
            f"object.com_m is {list(usual.com_m)}, that of the paper's box, but the outline is "
            "another one (without com_m it is the centroid)"
        )
    if (overlap := overlap_m(scene)) > 0:
        lines.append(
            f"the palms overlap by {_mm(overlap)} under the object and would collide; neither "
            "world models that contact (use a wider object, or a shorter palm.length_m)"
        )
    return tuple(lines)


def _blind(scene: Scene, side: Side) -> str | None:
    """The warning for a palm whose sensor reads 0 up to an end: it cannot foresee a drop there."""
    low, high = zero_zone_edges_m(scene)
    half = scene.palm_of(side).reach_m
    ends = [name for name, sees in (("-", low > -half), ("+", high < half)) if not sees]
    if not ends:
        return None
    return (
        f"the sensor of the {side} palm never reads {' or '.join(ends)}: the zero zone reaches as "
        f"far as the palm, {_mm(half)} from the pivot (tactile.zero_half_width_m, tactile.zones)"
    )
