# SPDX-License-Identifier: Apache-2.0
"""Can one robot pick a small object up against a wall, carry it and put it down: by what margin,
and what limits?

Closed forms for a job with ``task.dock = "alone"``. φ is the friction angle of the palm, φ_w that
of the wall, and the *far* side of the object the one at the wall. Terms are those of
`lifting_bodies`. Source: docs/theory/lifting.md.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import palmbots._core as _core
from palmbots._types import SIDES, MaybeNaN, Side
from palmbots._util.plain_values import derived
from palmbots._util.report import Item, Line, Table, bold, verdict, warning
from palmbots._util.text import millimetres, rounded_down, rounded_up
from palmbots.errors import SceneError
from palmbots.mechanics.lifting_bodies import Plate, Standing, plate_on_floor, standing
from palmbots.mechanics.lifting_forces import floor_friction_to_stay
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec

_G = _core.standard_gravity
_LEVEL = math.pi / 2


@dataclass(frozen=True)
class LoneLift:
    """One robot that picks up, carries and puts down: margins and what limits."""

    robot: Side
    """The one that works."""
    wall_m: float | None
    """Distance of the object from the wall; None: there is no wall behind it."""
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
    """About how far the far vertex falls when the object slides down the palm."""
    most_fall_m: float
    """`world.fall_m`."""
    floor_friction: float
    least_floor_friction: MaybeNaN
    """From which on the object is not pushed away while the palm leaves."""
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
        what = f"  the {self.robot} robot alone picks up and puts down"
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(what))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    def lines(self) -> Iterator[Item]:
        """The margins, and what limits."""
        heads = ("value", "limit")
        rows = [
            ("nose above the floor", _mm(self.nose_height_m), f"below {_mm(self.thickest_m)}"),
            (
                "friction of the wall",
                "no wall" if self.wall_friction is None else f"{self.wall_friction:g}",
                "any"
                if math.isinf(self.most_wall_friction)
                else f"below {_number(self.most_wall_friction)}",
            ),
            ("squeeze, at most", _newtons(self.squeeze_n), f"up to {_newtons(self.push_n)}"),
            ("width of the object", _mm(self.width_m), f"up to {_mm(self.room_m)}"),
            ("shallow palm", f"{self.shallow_deg:g}°", f"below φ = {self.friction_deg:.1f}°"),
            (
                "acceleration",
                f"{self.acceleration_m_s2:g} m/s²",
                f"up to {self.most_acceleration_m_s2:.2f} m/s²",
            ),
            (
                "steep palm",
                f"{self.steep_deg:g}°",
                f"{self.friction_deg:.1f} to {self.topples_deg:.1f}°",
            ),
            ("fall at the end", _mm(self.fall_m), f"up to {_mm(self.most_fall_m)}"),
            (
                "friction of the floor",
                f"{self.floor_friction:g}",
                f"at least {_number(self.least_floor_friction)}",
            ),
        ]
        yield Table([(f"  {name}", *row) for name, *row in rows], ("", *heads), right=heads)
        yield from map(warning, self.warnings)


def lone_lift(scene: Scene) -> LoneLift | None:
    """The analysis of a scene; None: two robots do its job, or it is a carry from palms to palms.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    if scene.task.dock != "alone" or not (spec := to_spec(scene)).uses_floor:
        return None
    if refusal := _core.standing_refusal(spec):
        raise SceneError(refusal)
    side = 1 if spec.direction > 0 else 0
    palm, radius = spec.palms[side], standing(spec, 1.0).radii[side]
    body = standing(spec, scene.object.mass_kg * _G)
    low, high = (plate_on_floor(palm, angle) for angle in (palm.shallow, palm.steep))
    push = min(_LEVEL, low.nose_lean(radius) + low.friction)
    cotangent = 1 / math.tan(push) if push < _LEVEL else 0.0
    wall = _wall(scene)
    friction = None if wall is None else _friction_of_wall(scene, wall)
    tall = max(y for _, y in spec.silhouette) - min(y for _, y in spec.silhouette)
    # The force of the nose meets the wall at this height. Above the far side, the object tilts.
    lean = low.nose_lean(radius)
    meets = radius * (1 - math.cos(lean)) + cotangent * (
        body.width + body.radii[1 - side] + radius * math.sin(lean)
    )
    most = cotangent if meets <= tall else math.inf
    locks = friction is not None and friction >= most
    squeeze = math.inf
    if friction is not None and not locks:
        squeeze = _squeeze(body, side, low, tall, friction, scene.floor.friction)
    limit, by_load = _core.push_of_robot(as_given(scene), side, -low.half, low.pivot)
    own = scene.robot_of(SIDES[side]).force_limit_n
    load = squeeze * cotangent if math.isfinite(squeeze) else body.weight
    can = max(0.0, limit + by_load * load)
    can = can if own is None else min(can, own)
    needed = squeeze - by_load * load
    heaviest = scene.object.mass_kg * (max(0.0, limit) / needed if needed > 0 else math.inf)
    if own is not None:
        heaviest = min(heaviest, scene.object.mass_kg * own / squeeze)
    far_x, far_y = (spec.com_left, spec.com_right)[1 - side], spec.com_height
    # Along the palm, from the nose at the wall to the far arc, whose side leans on the wall.
    along = (radius + (tall - radius) * math.sin(palm.shallow)) / math.cos(palm.shallow)
    result = LoneLift(
        robot=SIDES[side],
        wall_m=None if wall is None else -wall - (-min(x for x, _ in spec.silhouette) + far_x),
        nose_height_m=low.nose,
        thickest_m=radius * (1 - math.sin(low.friction)),
        push_deg=math.degrees(push),
        self_locking=locks,
        wall_friction=friction,
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
        most_fall_m=scene.world.fall_m,
        floor_friction=scene.floor.friction,
        least_floor_friction=floor_friction_to_stay(body, (high, high), side),
        pivot_m=low.pivot,
        refusals=(),
        warnings=(),
    )
    return replace(
        result,
        refusals=tuple(_refusals(scene, spec, result, tall)),
        warnings=tuple(_warnings(result)),
    )


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


def _refusals(scene: Scene, spec: _core.Spec, found: LoneLift, tall: float) -> Iterator[str]:
    """Why the job cannot begin."""
    for key, place in (("from", getattr(scene.task, "from")), ("to", scene.task.to)):
        if place != "floor":
            yield (
                f'task.{key}: value is {place}, but with task.dock = "alone" one robot picks the '
                "object up and puts it down; allowed: floor"
            )
    if spec.slope != 0:
        yield (
            f"task.slope_deg: value is {scene.task.slope_deg:g}, and one robot alone works on a "
            "level floor; allowed: 0"
        )
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
    if found.nose_height_m >= found.thickest_m:
        yield (
            f"palm.nose_m: the upper edge of the nose is {_mm(found.nose_height_m)} above the "
            "floor, and it gets under the edge of the object only below "
            f"{_mm(found.thickest_m)}; allowed: a thinner nose, or a larger object.edge_radius_m"
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
            f"with {_newtons(found.squeeze_n)} to get under it; allowed: at most "
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


def _warnings(found: LoneLift) -> Iterator[str]:
    """What may end it."""
    if found.fall_m > found.most_fall_m:
        yield (
            f"the object falls by some {_mm(found.fall_m)} when it slides down the steep palm, "
            f"more than world.fall_m = {found.most_fall_m:g}"
        )
    if found.floor_friction < found.least_floor_friction:
        yield (
            f"floor.friction is {found.floor_friction:g}: the palm pushes the object away as it "
            f"leaves; it does not at {rounded_up(found.least_floor_friction, 3):g} or more"
        )


def _mm(value: float) -> str:
    return f"{1e3 * value:.2f} mm"


def _newtons(value: float) -> str:
    return "any" if math.isinf(value) else f"{value:.2f} N"


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{rounded_down(value, 3):g}"
