# SPDX-License-Identifier: Apache-2.0
"""Margins, ranked by how often they contain what the scene uses up of them.

A scene uses up a margin in three ways, each of which is defined here once. Noise moves the contacts
over the carry. The slope of the floor and the acceleration of the robots tilt the weight. A palm is
at a wrong angle between two control steps. Each margin is compared with the part of that which acts
on it, in its own unit. A job on the floor uses up further margins: those of its noses, of what
holds against them, and of arms that move together.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots._util.plain_values import derived
from palmbots._util.text import millimetres, rounded_down
from palmbots.mechanics.lift_margins import Lifting
from palmbots.mechanics.load_limits import MEANINGS, mass_text
from palmbots.scene.scene import Scene
from palmbots.scene.sides import on_every_side

if TYPE_CHECKING:
    from palmbots.stability.analysis import Analysis


@dataclass(frozen=True)
class RankedMargin:
    """A margin, and what the scene uses up of it."""

    quantity: str
    """``contact``, ``clearance``, ``palm angle``, ``slope``, ``com``, ``friction`` or ``mass``; of
    a job on the floor also ``nose``, ``heel``, ``partner``, ``floor friction`` or ``rise``."""
    allowed: float
    """< 0: a property fails already."""
    used: float
    unit: str
    """Of both: ``m``, ``deg``, ``kg``, ``N`` or ``1``."""
    limit: str
    """How much is allowed, and what happens beyond it, in words."""
    use: str
    """What uses it up, in words."""
    keys: tuple[str, ...]
    """The scene keys that move it."""

    @derived
    def times(self) -> float | None:
        """How often the margin contains what the scene uses up; None: it uses nothing up."""
        return self.allowed / self.used if self.used > 0 else None

    def sentence(self) -> str:
        """The margin in words."""
        times = self.times
        digits = 0 if times is None or times >= 10 else 1 if times >= 1 else 2
        share = "" if times is None or times < 0 else f" (margin: {times:.{digits}f} times that)"
        return f"{self.limit}; {self.use}{share}; keys: {', '.join(self.keys)}"


def noise_over_carry_m(scene: Scene) -> float:
    """How far noise, unequal gains and unequal biases move a contact in the nominal time of the
    carry if no robot corrects it: what lasts, and one standard deviation of the rest [m].

    The integral of an Ornstein-Uhlenbeck process over T has the variance
    2σ²τ (T − τ (1 − e^(−T/τ))).
    """
    robots = [scene.robot_of(side) for side in SIDES]
    slowest = min(robot.speed_m_s for robot in robots)
    time_s = scene.task.distance_m / slowest if slowest > 0 else scene.timeout_s
    variance = 0.0
    for robot in robots:
        tau = robot.noise_tau_s
        lasting = time_s + tau * math.expm1(-time_s / tau)
        variance += 2 * robot.noise_m_s**2 * tau * max(lasting, 0.0)
        variance += robot.white_noise_m_per_sqrt_s**2 * time_s
        variance += (robot.gain_sd * robot.speed_m_s * time_s) ** 2
    one, other = (robot.bias_m_s + (robot.gain - 1) * robot.speed_m_s for robot in robots)
    return math.sqrt(variance) + abs(one - other) * time_s


def fastest_acceleration(scene: Scene) -> float:
    """The acceleration that counts as a slope, in either direction [m/s²]; 0 without inertia."""
    robots = map(scene.robot_of, SIDES)
    return max(robot.acceleration_m_s2 for robot in robots) if scene.task.inertia else 0.0


def angle_step_deg(scene: Scene) -> float:
    """How far a palm turns between two control steps, and so may be wrong [°]."""
    return scene.control.period_s * max(scene.palm_of(side).rate_deg_s for side in SIDES)


def ranked_margins(analysis: Analysis) -> tuple[RankedMargin, ...]:
    """All margins, the tightest first; those of which the scene uses nothing up last."""
    found = [
        replace(one, keys=tuple(on_every_side(analysis.scene, dict.fromkeys(one.keys))))
        for one in _margins(analysis)
    ]
    return tuple(sorted(found, key=lambda one: math.inf if one.times is None else one.times))


def _margins(analysis: Analysis) -> Iterator[RankedMargin]:
    scene, problem = analysis.scene, analysis.problem
    noise, step = noise_over_carry_m(scene), angle_step_deg(scene)
    tilt = fastest_acceleration(scene) / _core.standard_gravity
    turning = f"a palm turns by {step:.2g}° in one control period"
    yield _contact(analysis, noise)
    clearance = analysis.clearance_deg
    touch = f"a palm touches the object after a turn of {clearance:.2f}°"
    if clearance <= 0:
        touch = f"a palm touches the object already, by {-clearance:.2f}°"
    keys = ("object.vertices_m", "palm.shallow_deg", "palm.steep_deg")
    yield RankedMargin("clearance", clearance, step, "deg", touch, turning, keys)
    if (error := analysis.angle_error_deg) is not None:
        limit = f"the palm angles may be wrong by ±{error:.1f}°"
        keys = ("palm.rate_deg_s", "control.period_s")
        yield RankedMargin("palm angle", error, step, "deg", limit, turning, keys)
    if analysis.slope_deg is not None:
        yield _slope(analysis.slope_deg, scene.task.slope_deg, tilt)
    if analysis.com_x_m is not None:
        low, high = analysis.com_x_m
        x = problem.vertex_com[0]
        room, shift = min(x - low, high - x), problem.com[1] * tilt
        limit = f"the COM may be {millimetres(room)} farther to one side"
        if room < 0:
            limit = f"the COM is {millimetres(-room)} too far to one side"
        use = f"acceleration acts like a shift of {millimetres(abs(shift))}"
        yield RankedMargin("com", room, abs(shift), "m", limit, use, ("object.com_m",))
    errors = [report.margins.friction for report in analysis.properties.values() if report.number]
    if known := [error for error in errors if error is not None]:
        # A palm that is wrong by an angle tilts the friction cone by it.
        wrong = max((1 + mu**2) * math.radians(step) for mu in problem.friction)
        limit = f"the friction may be wrong by ±{min(known):.3f}"
        use = f"a palm that turns for one control period acts like an error of {wrong:.2g}"
        yield RankedMargin("friction", min(known), wrong, "1", limit, use, ("palm.friction",))
    farthest = max(abs(end) for ends in problem.contacts for end in ends)
    for heaviest, kind in analysis.load.limits_within(farthest)[:1]:
        happens, key = MEANINGS[kind]
        mass = scene.object.mass_kg
        limit = f"with more than {mass_text(heaviest)} kg {happens}"
        use = f"this object has {mass:g} kg"
        yield RankedMargin("mass", heaviest, mass, "kg", limit, use, (key,))
    if analysis.lifting is not None:
        yield from _lifting(scene, analysis.lifting)


def _lifting(scene: Scene, found: Lifting) -> Iterator[RankedMargin]:
    """What the floor adds, of the palm that has less of it."""
    palms = tuple(found.palms.values())
    if found.picks_up:
        nose = min(palms, key=lambda one: one.thickest_m / max(one.nose_height_m, 1e-12))
        limit = f"a nose gets under the edge below {1e3 * nose.thickest_m:.2f} mm"
        use = f"it is {1e3 * nose.nose_height_m:.2f} mm above the floor"
        keys = ("palm.nose_m", "palm.bevel_m", "object.edge_radius_m")
        yield RankedMargin("nose", nose.thickest_m, nose.nose_height_m, "m", limit, use, keys)
        yield from _holding(scene, found)
        mass, heaviest = scene.object.mass_kg, min(one.heaviest_kg for one in palms)
        if math.isfinite(heaviest):
            limit = f"a nose gets under at most {rounded_down(heaviest, 3):g} kg"
            use = f"this object has {mass:g} kg"
            yield RankedMargin(
                "mass", heaviest, mass, "kg", limit, use, ("palm.nose_m", "object.mass_kg")
            )
    if found.puts_down:
        needed = max(one.floor_friction.right for one in palms)
        limit = f"the floor has a friction of {found.floor_friction:g}"
        use = f"a steep palm that leaves last drags the object below {needed:.2g}"
        keys = ("floor.friction", "palm.steep_deg")
        yield RankedMargin("floor friction", found.floor_friction, needed, "1", limit, use, keys)
    permitted = found.kept_rise_m if found.level_only else found.permitted_rise_m
    limit = f"the arms may differ by {millimetres(permitted)} in height"
    use = f"while they move, they differ by up to {millimetres(found.arms_differ_m)}"
    keys = ("arm.rate_m_per_s", "arm.height_error_m", "radio.lease_s")
    yield RankedMargin("rise", permitted, found.arms_differ_m, "m", limit, use, keys)


def _holding(scene: Scene, found: Lifting) -> Iterator[RankedMargin]:
    """What holds against the second nose: the other palm, or its heel."""
    for k, side in enumerate(SIDES):
        own, partner = found.palms[side], SIDES[1 - k]
        if own.needs_heel:
            heel, least = scene.palm_of(partner).heel_m, own.least_heel_m
            limit = f"the {partner} heel is {millimetres(heel)} high"
            use = f"the {side} nose certainly gets under against {millimetres(least)}"
            yield RankedMargin("heel", heel, least, "m", limit, use, ("palm.heel_m",))
        elif math.isfinite(own.held_n):
            limit = f"the {partner} palm holds {own.held_n:.2f} N"
            use = f"the {side} nose needs {own.second_n:.2f} N"
            keys = ("palm.steep_deg", "palm.nose_m")
            yield RankedMargin("partner", own.held_n, own.second_n, "N", limit, use, keys)


def _contact(analysis: Analysis, noise: float) -> RankedMargin:
    """How far a contact may move: to the end of its palm, or until a property fails."""
    scene = analysis.scene
    starts = (scene.start.left_m, scene.start.right_m)
    reach, k = min(
        (half - abs(p), k)
        for k, (half, p) in enumerate(zip(analysis.problem.reach, starts, strict=True))
    )
    travels = [report.margins.travel_m for report in analysis.properties.values()]
    short = min([0.0, *(travel for travel in travels if travel is not None)])
    allowed = reach + short
    has_heel = analysis.problem.spec.palms[k].stops
    end = "gets near a heel" if has_heel else "leaves its palm"
    if short != 0:
        end = "makes a property fail"
    limit = f"a contact {end} after {millimetres(allowed)}"
    if allowed <= 0:
        limit = "a property fails wherever the contacts are"
    use = (
        f"noise moves it by {millimetres(noise)} (one standard deviation) over the carry if no "
        "robot corrects it"
    )
    is_part = any(scene.palm_of(side).usable_m for side in SIDES)
    of_palm = "palm.usable_m" if is_part else "palm.length_m"
    keys = ("palm.heel_m" if has_heel else of_palm, "robot.noise_m_s")
    return RankedMargin("contact", allowed, noise, "m", limit, use, keys)


def _slope(range_deg: tuple[float, float], slope_deg: float, tilt: float) -> RankedMargin:
    """The slope in the direction, uphill or downhill, in which the scene uses more of it."""
    here = math.tan(math.radians(slope_deg))
    sides = []
    for sense, limit_deg in ((-1.0, -range_deg[0]), (1.0, range_deg[1])):
        sides.append((limit_deg, math.degrees(math.atan(sense * here + tilt))))
    allowed, used = min(sides, key=lambda side: side[0] / side[1] if side[1] > 0 else math.inf)
    limit = f"the floor may slope by {allowed:.2f}°"
    use = f"slope and acceleration act like a slope of {used:.2g}°"
    keys = ("task.slope_deg", "robot.acceleration_m_s2")
    return RankedMargin("slope", allowed, max(used, 0.0), "deg", limit, use, keys)
