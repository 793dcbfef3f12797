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
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

import palmbots._core as _core
from palmbots._types import SIDES, BySide, MaybeNaN
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, verdict, warning
from palmbots._util.text import millimetres, rounded_down, rounded_up
from palmbots.errors import SceneError
from palmbots.mechanics import lift_refusals
from palmbots.mechanics.lift_refusals import newtons, numbers_of
from palmbots.mechanics.lifting_bodies import Plate, Standing, plate_on_floor, standing
from palmbots.mechanics.lifting_forces import (
    Docking,
    docking,
    floor_friction_to_stay,
    least_partner_angle,
)
from palmbots.mechanics.lone import lone_lift
from palmbots.mechanics.unlevel_pivots import PROPERTIES, PivotRises
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec

_G = _core.standard_gravity
_STEEPEST = math.radians(80)
_HALVINGS = 50
_LOWEST_HEEL_M = 1e-4  # any height stops a sharp edge
_CENTRED = 0.5  # of the usable palm: where contacts are while the arms move


@dataclass(frozen=True)
class PalmLift:
    """What one palm does at the floor. Squeezes are horizontal forces, each palm's on the
    object."""

    nose_height_m: float
    """Of the upper edge of its nose above the floor, palm steep."""
    thickest_m: float
    """The height from which on it does not get under the object's edge: r (1 − sin φ)."""
    lean_deg: float
    """Lean of the contact between nose and edge from the vertical: ψ."""
    squeeze_n: MaybeNaN
    """With which it gets under its edge while the other corner stands on the floor."""
    second_n: MaybeNaN
    """The same when the other palm is under the object already."""
    held_n: MaybeNaN
    """The most that the other palm then holds against it, before its corner climbs on."""
    heel_held_n: MaybeNaN
    """The most that it holds when that corner has climbed to its heel; infinite: any."""
    gets_under: bool
    """Whether it certainly gets under its edge, whichever palm is first."""
    may_get_under: bool
    """Whether statics permit it for some sequence of slip and roll."""
    needs_heel: bool
    """Whether it needs the other palm's heel for that, if it is second."""
    least_heel_m: MaybeNaN
    """The height of the other palm's heel with which it certainly gets under; 0: it needs none."""
    least_partner_deg: float
    """The least angle of the other palm at which it gets under without a heel."""
    push_n: MaybeNaN
    """The most that its robot can push with, while the palm carries its load."""
    heaviest_kg: MaybeNaN
    """The heaviest object under which this nose gets with that push of both robots."""
    floor_friction: BySide[MaybeNaN]
    """Friction of the floor with which the object is not dragged while this palm leaves last; left:
    shallow, right: steep."""
    pivot_m: BySide[float]
    """Height of its pivot with the nose on the floor; left: shallow, right: steep."""
    least_angle_deg: float
    """The least palm angle at which the wrist is not too low."""
    carry_height_m: float
    """Height of its pivot while the pair carries."""
    below_from_m: float | None
    """Height of its pivot below the object on the stand on which the job begins, where the palm
    touches it nowhere; None: there is none."""
    below_to_m: float | None
    """The same where the job ends."""
    clear_m: float
    """Height of its pivot from which on the object touches no stand; 0: there is none."""


@dataclass(frozen=True)
class Lifting:
    """Picking up and putting down: margins and what limits."""

    picks_up: bool
    """From the floor."""
    puts_down: bool
    """On the floor."""
    from_stand_m: float | None
    """Height of the stand on which the job begins; None: there is none."""
    to_stand_m: float | None
    """The same where the job ends."""
    palms: BySide[PalmLift]
    edge_radius_m: float
    floor_friction: float
    nose_gap_m: float
    """Between the noses when one contact is at its heel and the other one at its pivot; negative:
    they meet first."""
    held_gap_m: float
    """The same while the object is docked and centred: with both contacts at their pivots, or with
    one at the heel that its partner needs and the other one at its nose."""
    on_floor: tuple[int, ...]
    """The properties that hold while both noses are on the floor, for contacts anywhere on the
    palms."""
    in_air: tuple[int, ...]
    """The same with level pivots."""
    permitted_rise_m: float
    """The height difference of the pivots in the air up to which all properties hold for contacts
    on the inner half of the usable palms, where they are while the arms move."""
    clear_rise_m: float
    """The same if the object also has to touch the palms nowhere else."""
    arms_differ_m: float
    """The largest height difference of two arms that move together: that of the pivots on the
    floor or at a stand + rate × (lease + delay + tick) + the errors of both."""
    refusals: tuple[str, ...]
    """Why the job cannot begin."""
    warnings: tuple[str, ...]
    """What may end it."""
    plates: tuple[tuple[Plate, Plate], tuple[Plate, Plate]] = field(metadata=NOT_IN_JSON)
    """(left, right), shallow and steep."""
    body: Standing = field(metadata=NOT_IN_JSON)

    @property
    def is_on_floor(self) -> bool:
        """Whether the job begins or ends on the floor."""
        return self.picks_up or self.puts_down

    @property
    def where_centred(self) -> tuple[int, ...]:
        """The properties that hold where both contacts are centred first: on the floor, or in the
        air."""
        return self.on_floor if self.picks_up else self.in_air

    @derived
    def works(self) -> bool:
        """Whether the job can begin."""
        return not self.refusals

    @derived
    def squeeze_n(self) -> MaybeNaN:
        """The least with which the robots have to push; infinite: no push suffices."""
        return max(
            max(palm.squeeze_n, palm.second_n) if palm.may_get_under else math.inf
            for palm in self.palms.values()
        )

    @derived
    def raises_first(self) -> bool:
        """Whether properties hold with level pivots only: then the pair must not correct contacts
        on the floor."""
        return len(self.on_floor) < len(PROPERTIES) == len(self.in_air)

    def verdict_lines(self) -> Iterator[Item]:
        """Whether the job can begin, and why not."""
        ends = (self.picks_up, self.from_stand_m), (self.puts_down, self.to_stand_m)
        places = [
            "the floor" if on_floor else None if top is None else f"a stand of {millimetres(top)}"
            for on_floor, top in ends
        ]
        what = " and ".join(
            f"{does} {place}"
            for does, place in zip(("picks up from", "puts down on"), places, strict=True)
            if place is not None
        )
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(f"  the pair {what}"))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    def lines(self) -> Iterator[Item]:
        """The margins of both palms, and what limits."""
        yield bold("Picking up and putting down")
        heads = ("left", "right")
        yield Table(list(self._rows()), ("", *heads), right=heads)
        on_floor = f"with the noses on the floor: {numbers_of(self.on_floor)}; "
        yield (
            f"properties {on_floor if self.is_on_floor else 'with '}pivots level: "
            f"{numbers_of(self.in_air)}"
        )
        yield (
            f"while both arms move, they differ by up to {millimetres(self.arms_differ_m)}; with "
            "contacts on the inner half of the palms, the properties permit "
            f"{millimetres(self.permitted_rise_m)}, and from {millimetres(self.clear_rise_m)} on "
            "the object may touch a palm elsewhere"
        )
        yield from map(warning, self.warnings)

    def _rows(self) -> Iterator[tuple[str, ...]]:
        def row(name: str, text: Callable[[PalmLift], str]) -> tuple[str, ...]:
            return (f"  {name}", *(text(palm) for palm in self.palms.values()))

        if self.picks_up:
            yield row("nose above the floor", lambda one: _mm(one.nose_height_m))
            yield row("  gets under below", lambda one: _mm(one.thickest_m))
            yield row("  lean of the contact", lambda one: f"{one.lean_deg:.1f}°")
            yield row("squeeze to get under", lambda one: newtons(one.squeeze_n, "none suffices"))
            yield row("  second", lambda one: newtons(one.second_n, "none suffices"))
            yield row("  partner's palm holds", lambda one: newtons(one.held_n))
            yield row("  partner's heel holds", lambda one: newtons(one.heel_held_n))
            yield row("  partner needs a heel of", lambda one: _mm(one.least_heel_m))
            yield row("  or an angle of", lambda one: f"{one.least_partner_deg:.1f}°")
            yield row("robot pushes at most", lambda one: newtons(one.push_n))
            yield row("  heaviest object", lambda one: _kilograms(one.heaviest_kg))
        if self.puts_down:
            yield row("floor friction, leaves steep", lambda one: _number(one.floor_friction.right))
            yield row("  leaves shallow", lambda one: _number(one.floor_friction.left))
        if self.is_on_floor:
            yield row("pivot on the floor, shallow", lambda one: _mm(one.pivot_m.left))
            yield row("  steep", lambda one: _mm(one.pivot_m.right))
        if self.from_stand_m is not None:
            yield row("pivot below the object, at first", lambda one: _mm(one.below_from_m or 0.0))
        if self.to_stand_m is not None:
            yield row("pivot below the object, at last", lambda one: _mm(one.below_to_m or 0.0))
        if (self.from_stand_m, self.to_stand_m) != (None, None):
            yield row("  least on the floor", lambda one: _mm(one.pivot_m.right))
            yield row("pivot when clear of stands", lambda one: _mm(one.clear_m))
            yield row("  while the pair carries", lambda one: _mm(one.carry_height_m))


@lru_cache(maxsize=64)  # of one scene many jobs may be done
def lifting(scene: Scene) -> Lifting | None:
    """The analysis of a scene; None: its job neither begins nor ends on the floor or on a stand, or
    one robot does it alone.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    spec = to_spec(scene, unrolled=True)
    if not spec.uses_floor or scene.task.dock == "alone":
        return None
    check_stands(spec)
    tops = _tops(scene, spec)
    body = standing(spec, scene.object.mass_kg * _G)
    shallow = tuple(plate_on_floor(palm, palm.shallow) for palm in spec.palms)
    steep = tuple(plate_on_floor(palm, palm.steep) for palm in spec.palms)
    plates = (shallow[0], shallow[1]), (steep[0], steep[1])
    docks = tuple(docking(body, plates[1], side) for side in (0, 1))
    rises, centred = PivotRises(spec), PivotRises(spec, _CENTRED)
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
        on_floor=tuple(sorted(rises.on_floor())),
        in_air=tuple(sorted(rises.in_air())),
        permitted_rise_m=centred.permitted_m(clear=False),
        clear_rise_m=centred.permitted_m(),
        arms_differ_m=_arms_differ(scene, spec) + _start_rise(scene, spec, plates),
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
    found = lone_lift(scene) or lifting(scene)
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


def _arms_differ(scene: Scene, spec: _core.Spec) -> float:
    arms = [scene.arm.of(side) for side in SIDES]
    table = _core.transition_table("shared-sign", spec)
    assert table is not None
    lease = table["lease_s"]
    late = lease + spec.longest_delay + scene.control.period_s
    return max(arm.rate_m_per_s for arm in arms) * late + sum(arm.height_error_m for arm in arms)


def _start_rise(
    scene: Scene, spec: _core.Spec, plates: tuple[tuple[Plate, Plate], tuple[Plate, Plate]]
) -> float:
    """The largest height difference of the pivots with which both arms begin to rise; later either
    palm may turn. On the floor noses are level; on a stand contacts are."""
    rises = [0.0]
    if "floor" in scene.task.ends:
        left, right = ([pair[k].pivot for pair in plates] for k in (0, 1))
        rises += [max(left) - min(right), max(right) - min(left)]
    for top in _tops(scene, spec):
        if top is not None:
            low = [_core.stand_heights(spec, k, top)[0] for k in (0, 1)]
            touching = [
                sum(_core.stand_heights(spec, k, top)) / 2 - spec.start[k] * math.sin(palm.steep)
                for k, palm in enumerate(spec.palms)
            ]
            rises += [abs(low[1] - low[0]), abs(touching[1] - touching[0])]
    return max(rises)


def _mm(value: float) -> str:
    return "none helps" if math.isinf(value) else f"{1e3 * value:.2f} mm"


def _kilograms(value: float) -> str:
    return "any" if math.isinf(value) else f"{rounded_down(value, 3):g} kg"


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{rounded_up(value, 3):g}"
