# SPDX-License-Identifier: Apache-2.0
"""Can one palm pick a small object up against a wall, carry it and put it down: by what margin,
and what limits?

Closed forms for a job with ``task.dock = "alone"``, and for each robot of a job in which one hands
the object to the other (`hand_over`): the palm of its partner is then the wall. φ is the friction
angle of the palm, φ_w that of the wall, and the *far* side of the object the one at the wall. Terms
are those of `lifting_bodies`. Source: docs/theory/lifting.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import SIDES, MaybeNaN, Side
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, verdict, warning
from palmbots._util.text import rounded_down
from palmbots.errors import SceneError
from palmbots.mechanics.lifting_bodies import (
    Plate,
    Standing,
    plate_on_floor,
    squeeze_of,
    standing,
)
from palmbots.mechanics.lifting_forces import floor_friction_to_stay, least_partner_angle
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec

_G = _core.standard_gravity
_LEVEL = math.pi / 2
_STEEP = math.radians(60)  # of the partner's palm; its least lean does not depend on its angle


def on_one_palm(scene: Scene) -> bool:
    """Whether one palm at a time holds the object of a scene."""
    return to_spec(scene, unrolled=True).on_one_palm


@dataclass(frozen=True)
class LoneLift:
    """One robot that picks up, carries and puts down: margins and what limits."""

    robot: Side
    """The one that works."""
    wall_m: float | None
    """Distance of the object from the wall; None: there is no wall behind it, or it is the palm of
    the partner."""
    nose_height_m: float
    """Of the upper edge of the nose above the floor, palm shallow."""
    thickest_m: float
    """The height from which on it does not get under the object's edge: r (1 − sin φ)."""
    push_deg: float
    """ψ + φ, by which the force of the nose leans from the vertical."""
    self_locking: bool
    """Whether the object jams between nose and wall, however hard the robot pushes."""
    wall_friction: float | None
    """Friction of the wall."""
    partner_lean_deg: float | None
    """Lean of the contact on the palm of the partner; None: there is a wall instead."""
    least_partner_lean_deg: float | None
    """The lean from which on that palm is a wall: otherwise the object climbs it."""
    most_wall_friction: MaybeNaN
    """Below this it does not jam: cot(ψ + φ); infinite: it never jams, because the force of the
    nose passes above the far side."""
    squeeze_n: MaybeNaN
    """The most with which the robot has to push to get under it."""
    push_n: MaybeNaN
    """The most with which it can push."""
    heaviest_kg: MaybeNaN
    """The heaviest object that it gets under."""
    width_m: float
    """Between the contact vertices."""
    room_m: float
    """For them on the palm, up to its heel or its outer end."""
    friction_deg: float
    """φ."""
    shallow_deg: float
    steep_deg: float
    topples_deg: float
    """The palm angle at which the object tips over its far vertex."""
    most_acceleration_m_s2: float
    """At which the object does not slide on the shallow palm: g tan(φ − θ)."""
    acceleration_m_s2: float
    """Of the robot."""
    fall_m: float
    """About how far the far vertex slides down with the palm at the friction angle."""
    floor_friction: float
    least_floor_friction: MaybeNaN
    """From which on the object is not pushed away while the palm leaves."""
    most_steep_deg: float
    """Up to which the object does not slide by itself down the palm that leaves."""
    pivot_m: float
    """Height of the pivot with the nose on the floor, palm shallow."""
    refusals: tuple[str, ...]
    """Why the job cannot begin."""
    warnings: tuple[str, ...]
    """What may end it."""

    @derived
    def works(self) -> bool:
        """Whether the job can begin."""
        return not self.refusals

    def verdict_lines(self) -> Iterator[Item]:
        """Whether the job can begin, and why not."""
        how = "alone" if self.partner_lean_deg is None else "against its partner's palm"
        what = f"  the {self.robot} robot {how} picks up and puts down"
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(what))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    def lines(self) -> Iterator[Item]:
        """The margins, and what limits."""
        heads = ("value", "limit")
        rows = [(f"  {name}", value, limit) for name, value, limit, _ in self._margins()]
        yield Table(rows, ("", *heads), right=heads)
        yield from map(warning, self.warnings)

    @property
    def tightest(self) -> tuple[float, str]:
        """The margin that is the least multiple of what the scene uses up of it: the multiple, and
        the margin in words."""
        name, value, limit, times = min(self._margins(), key=lambda row: row[-1])
        return times, f"{name} {value} ({limit})"

    def _margins(self) -> list[tuple[str, str, str, float]]:
        """What limits, its value, its limit, and how many times the value the limit is, or the
        other way round."""
        return [
            (
                "nose above the floor",
                mm(self.nose_height_m),
                f"below {mm(self.thickest_m)}",
                _ratio(self.thickest_m, self.nose_height_m),
            ),
            self._wall_row(),
            (
                "squeeze, at most",
                newtons(self.squeeze_n),
                f"up to {newtons(self.push_n)}",
                _ratio(self.push_n, self.squeeze_n),
            ),
            (
                "width of the object",
                mm(self.width_m),
                f"up to {mm(self.room_m)}",
                _ratio(self.room_m, self.width_m),
            ),
            (
                "shallow palm",
                f"{self.shallow_deg:g}°",
                f"below φ = {self.friction_deg:.1f}°",
                _ratio(self.friction_deg, self.shallow_deg),
            ),
            (
                "acceleration",
                f"{self.acceleration_m_s2:g} m/s²",
                f"up to {self.most_acceleration_m_s2:.2f} m/s²",
                _ratio(self.most_acceleration_m_s2, self.acceleration_m_s2),
            ),
            (
                "steep palm",
                f"{self.steep_deg:g}°",
                f"{self.friction_deg:.1f} to {self.topples_deg:.1f}°",
                min(
                    _ratio(self.steep_deg, self.friction_deg),
                    _ratio(self.topples_deg, self.steep_deg),
                ),
            ),
            (
                "friction of the floor",
                f"{self.floor_friction:g}",
                f"at least {number(self.least_floor_friction)}",
                _ratio(self.floor_friction, self.least_floor_friction),
            ),
        ]

    def _wall_row(self) -> tuple[str, str, str, float]:
        if self.partner_lean_deg is not None:
            assert self.least_partner_lean_deg is not None
            return (
                "lean on the partner's palm",
                f"{self.partner_lean_deg:.1f}°",
                f"at least {self.least_partner_lean_deg:.1f}°",
                _ratio(self.partner_lean_deg, self.least_partner_lean_deg),
            )
        limit = f"below {number(self.most_wall_friction)}"
        return (
            "friction of the wall",
            "no wall" if self.wall_friction is None else f"{self.wall_friction:g}",
            "any" if math.isinf(self.most_wall_friction) else limit,
            _ratio(self.most_wall_friction, self.wall_friction or 0.0),
        )


def _ratio(most: float, least: float) -> float:
    return most / least if least > 0 else math.inf


def check_standing(spec: _core.Spec) -> None:
    """Raise `SceneError` for an object that does not stand on its two contact vertices."""
    if refusal := _core.standing_refusal(spec):
        raise SceneError(refusal)


def height_of(spec: _core.Spec) -> float:
    """The height of the object [m]."""
    return max(y for _, y in spec.silhouette) - min(y for _, y in spec.silhouette)


def lift_with(scene: Scene, spec: _core.Spec, side: int) -> LoneLift:
    """What one robot of a scene needs, without refusals and warnings."""
    palm, radius = spec.palms[side], standing(spec, 1.0).radii[side]
    body = standing(spec, scene.object.mass_kg * _G)
    low, high = (plate_on_floor(palm, angle) for angle in (palm.shallow, palm.steep))
    push = min(_LEVEL, low.nose_lean(radius) + low.friction)
    cotangent = 1 / math.tan(push) if push < _LEVEL else 0.0
    wall = _wall(scene)
    friction = None if wall is None else _friction_of_wall(scene, wall)
    tall, by_partner = height_of(spec), scene.task.dock == "hand-over"
    # The force of the nose meets the wall at this height. Above the far side, the object tilts.
    lean = low.nose_lean(radius)
    meets = radius * (1 - math.cos(lean)) + cotangent * (
        body.width + body.radii[1 - side] + radius * math.sin(lean)
    )
    most = cotangent if meets <= tall else math.inf
    locks = friction is not None and friction >= most
    squeeze = math.inf
    if by_partner:  # no corner carries more than the weight
        squeeze, most, locks = squeeze_of(body.weight, push), math.inf, False
    elif friction is not None and not locks:
        squeeze = _squeeze(body, side, low, tall, friction, scene.floor.friction)
    partner = plate_on_floor(spec.palms[1 - side], spec.palms[1 - side].steep)
    limit, by_load = _core.push_of_robot(as_given(scene), side, -low.half, low.pivot)
    own = scene.robot_of(SIDES[side]).force_limit_n
    load = squeeze * cotangent if math.isfinite(squeeze) else body.weight
    can = max(0.0, limit + by_load * load)
    can = can if own is None else min(can, own)
    needed = squeeze - by_load * load
    heaviest = scene.object.mass_kg * (max(0.0, limit) / needed if needed > 0 else math.inf)
    if by_partner:  # whose wheels hold against it
        holds, _ = _core.push_of_robot(as_given(scene), 1 - side, -partner.half, partner.pivot)
        can = min(can, max(0.0, holds))
        heaviest = min(heaviest, scene.object.mass_kg * max(0.0, holds) / squeeze)
    if own is not None:
        heaviest = min(heaviest, scene.object.mass_kg * own / squeeze)
    far_x, far_y = (spec.com_left, spec.com_right)[1 - side], spec.com_height
    # Along the palm, from the nose at the wall to the far arc, whose side leans on the wall.
    along = (radius + (tall - radius) * math.sin(palm.shallow)) / math.cos(palm.shallow)
    return LoneLift(
        robot=SIDES[side],
        wall_m=None if wall is None else -wall - (-min(x for x, _ in spec.silhouette) + far_x),
        nose_height_m=low.nose,
        thickest_m=radius * (1 - math.sin(low.friction)),
        push_deg=math.degrees(push),
        self_locking=locks,
        wall_friction=friction,
        partner_lean_deg=math.degrees(partner.nose_lean(body.radii[1 - side]))
        if by_partner
        else None,
        least_partner_lean_deg=_least_lean(body, low, spec, side) if by_partner else None,
        most_wall_friction=most,
        squeeze_n=squeeze,
        push_n=can,
        heaviest_kg=heaviest,
        width_m=body.width,
        room_m=low.half + low.at_heel(radius),
        friction_deg=math.degrees(low.friction),
        shallow_deg=math.degrees(palm.shallow),
        steep_deg=math.degrees(palm.steep),
        topples_deg=math.degrees(math.atan2(far_x, far_y)),
        most_acceleration_m_s2=_G * math.tan(max(0.0, low.friction - palm.shallow)),
        acceleration_m_s2=scene.robot_of(SIDES[side]).acceleration_m_s2,
        fall_m=along * math.sin(low.friction),
        floor_friction=scene.floor.friction,
        least_floor_friction=floor_friction_to_stay(body, (high, high), side),
        most_steep_deg=_most_steep_deg(body, palm, side, scene.floor.friction),
        pivot_m=low.pivot,
        refusals=(),
        warnings=(),
    )


def _most_steep_deg(body: Standing, palm: _core.PalmSpec, side: int, floor: float) -> float:
    low, high = math.atan(palm.friction), _STEEP
    for _ in range(40):
        angle = 0.5 * (low + high)
        plate = plate_on_floor(palm, angle)
        stays = floor_friction_to_stay(body, (plate, plate), side) <= floor
        low, high = (angle, high) if stays else (low, angle)
    return math.degrees(low)


def _least_lean(body: Standing, low: Plate, spec: _core.Spec, side: int) -> float:
    other = plate_on_floor(spec.palms[1 - side], _STEEP)
    plates = (low, other) if side == 0 else (other, low)
    return math.degrees(least_partner_angle(body, plates, side))


def _squeeze(
    body: Standing, side: int, plate: Plate, tall: float, wall: float, floor: float
) -> float:
    """The largest horizontal force of a nose whose contact slips up while the object leans on the
    wall and stands on its far vertex, or does not [N]. Not for an object that jams."""
    far, lean = 1 - side, plate.nose_lean(body.radii[side])
    (x, _), r = body.centres[far], body.radii[far]
    face = x - (1, -1)[far] * r
    touched = [((face, y), _LEVEL, wall) for y in (r, tall)] + [((x, 0.0), 0.0, floor)]
    rays = [
        body.ray(far, at, normal + edge * math.atan(friction))
        for at, normal, friction in touched
        for edge in (-1, 1)
    ]
    push = body.ray(side, body.touching(side, lean), lean + plate.friction)
    return max(body.balances(push, rays), default=math.inf) * abs(push[0])


def _wall(scene: Scene) -> float | None:
    """Where the wall behind the object is, in the direction of travel."""
    return next((wall.at_m for wall in scene.floor.walls if wall.at_m < 0), None)


def _friction_of_wall(scene: Scene, at: float) -> float:
    own = next(wall.friction for wall in scene.floor.walls if wall.at_m == at)
    return scene.floor.friction if own is None else own


def mm(value: float) -> str:
    """A length in millimetres."""
    return f"{1e3 * value:.2f} mm"


def newtons(value: float) -> str:
    """A force; infinite: any."""
    return "any" if math.isinf(value) else f"{value:.2f} N"


def number(value: float) -> str:
    """A number, rounded down; infinite: any."""
    return "any" if math.isinf(value) else f"{rounded_down(value, 3):g}"
