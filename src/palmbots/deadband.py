"""The dead-band law: how wide the sensor's zero zone must be for corrections to end.

A correction stops when the sign changes, and the contact runs on a little: one control period
until the sign is seen, the way it takes to brake, and, where a station decides, the time its
messages travel. If that is more than the zero zone is wide, the contact comes out at the other
side, and the opposite correction begins: for ever. Source: PROTOCOL, "Dead band".
"""

import math
from itertools import pairwise

from palmbots.between import overlap_m
from palmbots.geometry import SIDES, Side
from palmbots.scene import Scene
from palmbots.sections import RobotParameters

__all__ = ["overrun_m", "warnings_before", "zero_zone_edges_m", "zero_zone_m"]


def overrun_m(scene: Scene, controller: str) -> float:
    """How far a contact can run on past the edge of the zero zone [m]; 0 for ``none``."""
    period = scene.control.period_s
    steepest = max(math.radians(scene.palm_of(side).steep_deg) for side in ("left", "right"))
    # Along the palm a contact moves a little farther than the robots do.
    along_palm = 1 / math.cos(steepest)
    robots = [scene.robot_of(side) for side in ("left", "right")]
    if controller == "none":
        return 0.0
    if controller == "centralized":
        delay = 2 * max(period, scene.radio.latency_s + scene.radio.jitter_s) + period
        way = sum(0.5 * r.correction_m_s * delay + _braking_m(r, 0.5, period) for r in robots)
        return way * along_palm
    return along_palm * max(r.correction_m_s * period + _braking_m(r, 1.0, period) for r in robots)


def _braking_m(robot: RobotParameters, share: float, period: float) -> float:
    """The way from a correction (a share of its speed) back to nominal speed, tick by tick."""
    speed = share * robot.correction_m_s
    drop = robot.acceleration_m_s2 * period
    steps = max(0, math.ceil(speed / drop) - 1)
    return period * (steps * speed - drop * steps * (steps + 1) / 2)


def zero_zone_m(scene: Scene) -> float:
    """The width of the stretch between − and + where the sensor reads 0 [m]."""
    low, high = zero_zone_edges_m(scene)
    return high - low


def zero_zone_edges_m(scene: Scene) -> tuple[float, float]:
    """Where the sensor ceases to read − and begins to read + [m]; infinite where it never does."""
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


def warnings_before(scene: Scene, controller: str) -> tuple[str, ...]:
    """What can be told before the carry starts."""
    zone, run = zero_zone_m(scene), overrun_m(scene, controller)
    told = []
    if run > zone:
        told.append(
            f"the zero zone is {_mm(zone)} wide, but a contact runs on by {_mm(run)}: corrections "
            "may not end (widen tactile.zero_half_width_m or lower robot.correction_m_s"
            + (", radio.latency_s)" if controller == "centralized" else ", control.period_s)")
        )
    if controller != "none":
        told += [line for side in SIDES if (line := _blind(scene, side))]
    if (overlap := overlap_m(scene)) > 0:
        told.append(
            f"the palms reach past each other by {_mm(overlap)} under the object and would "
            "collide, which no world here sees (a wider object, or a shorter palm.length_m)"
        )
    return tuple(told)


def _blind(scene: Scene, side: Side) -> str | None:
    """A palm whose sensor reads 0 up to an end of it is not told of a drop."""
    low, high = zero_zone_edges_m(scene)
    half = 0.5 * scene.palm_of(side).length_m
    ends = [name for name, sees in (("-", low > -half), ("+", high < half)) if not sees]
    if not ends:
        return None
    return (
        f"the {side} palm never reads {' or '.join(ends)}: the zero zone reaches as far as "
        f"the palm, {_mm(half)} from the pivot (tactile.zero_half_width_m, tactile.zones)"
    )


def _mm(metres: float) -> str:
    return f"{1e3 * metres:.1f} mm"
