# SPDX-License-Identifier: Apache-2.0
"""Can a scene's robots pick its object up from the floor and put it down: by what margin, and what
limits?

`lifting` evaluates the closed forms of `lifting_forces` for a scene whose job begins or ends on the
floor; `check_lift` raises an error for a job that cannot work, before anything moves. Forces are
those of the scene's object, masses of the robots are those of the MuJoCo model.
Source: docs/theory/lifting.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import palmbots._core as _core
from palmbots._types import SIDES, BySide, MaybeNaN, Side
from palmbots._util.arguments import show
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.report import Item, Line, Table, bold, verdict, warning
from palmbots._util.text import millimetres
from palmbots.errors import SceneError
from palmbots.mechanics.lifting_forces import (
    Docking,
    Plate,
    Standing,
    docking,
    floor_friction_to_stay,
    least_partner_angle,
    plate_on_floor,
    standing,
)
from palmbots.mechanics.unlevel_pivots import PROPERTIES, PivotRises
from palmbots.scene.scene import Scene
from palmbots.scene.section import as_given
from palmbots.scene.spec import to_spec

_G = _core.standard_gravity
_STEEPEST = math.radians(80)
_HALVINGS = 50
_CENTRED = 0.5  # of the usable palm: where contacts are while the arms move


@dataclass(frozen=True)
class PalmLift:
    """What one palm does at the floor. Squeezes are horizontal forces, each palm's on the
    object."""

    nose_height_m: float
    """Of the upper edge of its nose over the floor, palm steep."""
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


@dataclass(frozen=True)
class Lifting:
    """Picking up and putting down: margins and what limits."""

    picks_up: bool
    puts_down: bool
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
    """The largest height difference of two arms that move together: rate × (lease + delay + tick),
    and the errors of both."""
    refusals: tuple[str, ...]
    """Why the job cannot begin."""
    warnings: tuple[str, ...]
    """What may end it."""
    plates: tuple[tuple[Plate, Plate], tuple[Plate, Plate]] = field(metadata=NOT_IN_JSON)
    """(left, right), shallow and steep."""
    body: Standing = field(metadata=NOT_IN_JSON)

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
        what = {(True, True): "picks up and puts down", (True, False): "picks up"}.get(
            (self.picks_up, self.puts_down), "puts down"
        )
        yield Line(verdict(self.works, "LIFTS", "FAILS"), bold(f"  the pair {what} on the floor"))
        for refusal in self.refusals:
            yield Line(refusal, indent=2)

    def lines(self) -> Iterator[Item]:
        """The margins of both palms, and what limits."""
        yield bold("Picking up and putting down")
        heads = ("left", "right")
        yield Table(list(self._rows()), ("", *heads), right=heads)
        yield (
            f"properties with the noses on the floor: {_names(self.on_floor)}; pivots level: "
            f"{_names(self.in_air)}"
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
            yield row("nose over the floor", lambda one: _mm(one.nose_height_m))
            yield row("  gets under below", lambda one: _mm(one.thickest_m))
            yield row("  lean of the contact", lambda one: f"{one.lean_deg:.1f}°")
            yield row("squeeze to get under", lambda one: _newtons(one.squeeze_n, "none suffices"))
            yield row("  second", lambda one: _newtons(one.second_n, "none suffices"))
            yield row("  partner's palm holds", lambda one: _newtons(one.held_n))
            yield row("  partner's heel holds", lambda one: _newtons(one.heel_held_n))
            yield row("  partner needs a heel of", lambda one: _mm(one.least_heel_m))
            yield row("  or an angle of", lambda one: f"{one.least_partner_deg:.1f}°")
            yield row("robot pushes at most", lambda one: _newtons(one.push_n))
            yield row("  heaviest object", lambda one: _kilograms(one.heaviest_kg))
        if self.puts_down:
            yield row("floor friction, leaves steep", lambda one: _number(one.floor_friction.right))
            yield row("  leaves shallow", lambda one: _number(one.floor_friction.left))
        yield row("pivot on the floor, shallow", lambda one: _mm(one.pivot_m.left))
        yield row("  steep", lambda one: _mm(one.pivot_m.right))


def lifting(scene: Scene) -> Lifting | None:
    """The analysis of a scene; None: its job neither begins nor ends on the floor.

    Raises:
        SceneError: the path is curved, or the object does not stand on its contact vertices.
    """
    spec = to_spec(scene)
    if not spec.uses_floor:
        return None
    check_stands(spec)
    begins, ends = (getattr(scene.task, key) == "floor" for key in ("from", "to"))
    body = standing(spec, scene.object.mass_kg * _G)
    shallow = tuple(plate_on_floor(palm, palm.shallow) for palm in spec.palms)
    steep = tuple(plate_on_floor(palm, palm.steep) for palm in spec.palms)
    plates = (shallow[0], shallow[1]), (steep[0], steep[1])
    docks = tuple(docking(body, plates[1], side) for side in (0, 1))
    rises, centred = PivotRises(spec), PivotRises(spec, _CENTRED)
    result = Lifting(
        picks_up=begins,
        puts_down=ends,
        palms=BySide.of(_palm(scene, spec, body, plates, docks[k], k) for k in (0, 1)),
        edge_radius_m=body.radii[0],
        floor_friction=scene.floor.friction,
        nose_gap_m=_nose_gap(body, plates[1]),
        held_gap_m=_held_gap(body, plates[1], [dock.needs_heel for dock in docks]),
        on_floor=tuple(sorted(rises.on_floor())),
        in_air=tuple(sorted(rises.in_air())),
        permitted_rise_m=centred.permitted_m(clear=False),
        clear_rise_m=centred.permitted_m(),
        arms_differ_m=_arms_differ(scene, spec),
        refusals=(),
        warnings=(),
        plates=plates,
        body=body,
    )
    return replace(
        result,
        refusals=tuple(_refusals(scene, result)),
        warnings=tuple(_warnings(scene, result)),
    )


def check_lift(scene: Scene) -> tuple[str, ...]:
    """The warnings about a job that begins or ends on the floor; none for any other job.

    Raises:
        SceneError: the job cannot work.
    """
    found = lifting(scene)
    if found is None:
        return ()
    if found.refusals:
        raise SceneError(found.refusals[0])
    return found.warnings


def check_stands(spec: _core.Spec) -> None:
    """Raise `SceneError` for an object that does not stand on its two contact vertices."""
    radii = tuple(spec.outline[k][3] for k in (0, spec.contact_right))
    height = spec.com_height + max(radii)
    lowest = min(y for _, y in spec.silhouette) + height - spec.com_height
    # Where the line of action meets the floor: a force towards −x moves it back.
    back = spec.slope * height
    inside = -spec.com_right < back < spec.com_left
    if lowest < -1e-9 or radii[0] != radii[1] or not inside:
        raise SceneError(
            f"object.vertices_m: the outline does not stand on its contact vertices "
            f"{show(spec.outline[0][0])} and {show(spec.outline[spec.contact_right][0])}; "
            "allowed: an object whose two contact vertices are its lowest, with equal radii, "
            "and whose weight acts on the floor between them"
        )


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
    arm = scene.arm.of(SIDES[side])
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
    )


def _least_heel(body: Standing, plates: tuple[Plate, Plate], side: int, dock: Docking) -> float:
    """The height of the partner's heel with which a nose certainly gets under second; infinite: no
    heel helps."""
    if dock.gets_under and not dock.needs_heel:
        return 0.0
    radius = body.radii[1 - side]
    pair = [replace(plate, heel=max(radius, 1e-9)) for plate in plates]
    return radius if docking(body, (pair[0], pair[1]), side).gets_under else math.inf


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
        most = scene.mujoco.drive_force_n
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


def _refusals(scene: Scene, found: Lifting) -> Iterator[str]:
    for side in SIDES:
        yield from _refusals_of_arm(scene, found, side)
    if found.picks_up:
        for side in SIDES:
            yield from _refusals_of_dock(scene, found, side)
        if found.held_gap_m < 0:
            width, least = found.body.width, found.body.width - found.held_gap_m
            yield (
                f"object.vertices_m: the contact vertices are {millimetres(width)} apart, and the "
                "noses of the palms meet below the object; allowed: at least "
                f"{millimetres(least)}, or shorter palms (palm.length_m)"
            )
        missing = [n for n in (0, 2) if n not in found.on_floor]
        if missing:
            yield (
                f"palm.shallow_deg, palm.steep_deg: property {_names(missing)} does not hold while "
                "the noses are on the floor, where the pivots of the palms are at different "
                "heights, so corrections lose the object; allowed: pairs of angles with which it "
                "holds"
            )
    taken = [found.palms[side].floor_friction.right for side in _keeping(scene)]
    if found.puts_down and len(taken) == len(SIDES) and found.floor_friction < min(taken):
        yield (
            f"floor.friction: value is {found.floor_friction:g}, so the palm that leaves last "
            f"takes the object along; allowed: at least {_up(min(taken), 3):g}, or palm.steep_deg "
            "nearer to the friction angle"
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
            f"palm is only {millimetres(own.pivot_m.left)} over the floor at {shallowest:g}°; "
            f"allowed: at most that, or palm angles of at least {_up(own.least_angle_deg, 1):g}°"
        )
    if arm.carry_height_m <= own.pivot_m.right:
        yield (
            f"arm.carry_height_m: value is {arm.carry_height_m:g}, which does not raise the "
            f"{side} palm off the floor; allowed: more than {_up(own.pivot_m.right, 4):g}"
        )


def _refusals_of_dock(scene: Scene, found: Lifting, side: Side) -> Iterator[str]:
    palm, own, partner = scene.palm_of(side), found.palms[side], SIDES[1 - SIDES.index(side)]
    if own.nose_height_m >= own.thickest_m and own.nose_height_m > 0:
        name = "thickness_m" if palm.nose_m is None else "nose_m"
        radius = _up(own.nose_height_m / (1 - math.sin(math.atan(palm.friction))), 4)
        height = millimetres(own.nose_height_m)
        high = f"the upper edge of the {side} nose is {height} over the floor"
        if found.edge_radius_m == 0:
            yield (
                f"object.edge_radius_m: value is 0, but {high}, and no nose gets under a sharp "
                f"edge; allowed: more than {radius:g}, or palm.{name} = 0"
            )
            return
        yield (
            f"palm.{name}: {high}, and gets under an edge with object.edge_radius_m = "
            f"{found.edge_radius_m:g} only below {millimetres(own.thickest_m)}; allowed: a "
            f"thinner nose, or an edge radius of more than {radius:g}"
        )
        return
    if not own.may_get_under:
        heel = scene.palm_of(partner).heel_m
        angle = f"palm.steep_deg of at least {_up(own.least_partner_deg, 1):g}"
        high = _up(own.least_heel_m, 4)
        allowed = angle if math.isinf(high) else f"at least {high:g}, or {angle}"
        yield (
            f"palm.heel_m: value is {heel:g} on the {partner} side, so the robots jam: the "
            f"{side} nose needs {_newtons(own.second_n, 'more than any push')} to get under, and "
            f"the {partner} palm holds {_newtons(max(own.held_n, own.heel_held_n))}; "
            f"allowed: {allowed}"
        )
    elif scene.object.mass_kg > own.heaviest_kg:
        yield (
            f"object.mass_kg: value is {scene.object.mass_kg:g}, and the robots would have to "
            f"push with {_newtons(max(own.squeeze_n, own.second_n))} to get the {side} nose under "
            f"it; allowed: at most {_down(own.heaviest_kg, 3):g} with the traction of these robots"
        )


def _warnings(scene: Scene, found: Lifting) -> Iterator[str]:
    if found.raises_first:
        missing = [n for n in PROPERTIES if n not in found.on_floor]
        yield (
            f"property {' and '.join(map(str, missing))} does not hold while the noses are on the "
            "floor, where the pivots are at different heights: corrections may lose the object"
        )
    for side in SIDES if found.picks_up else ():
        own, partner = found.palms[side], SIDES[1 - SIDES.index(side)]
        if own.may_get_under and not own.gets_under:
            yield (
                f"palm.heel_m is {scene.palm_of(partner).heel_m:g} on the {partner} side, over "
                f"which the object may roll while the {side} nose gets under; it is a stop from "
                f"{_up(own.least_heel_m, 4):g} on"
            )
    if found.picks_up and found.nose_gap_m < 0:
        yield (
            f"the noses may meet below the object, which is {millimetres(found.body.width)} wide, "
            f"by {millimetres(-found.nose_gap_m)}, when one contact is at its heel"
        )
    if found.puts_down:
        keeping = (found.palms[side].floor_friction.right for side in _keeping(scene))
        needed = max(keeping, default=0.0)
        if found.floor_friction < needed:
            yield (
                f"floor.friction is {found.floor_friction:g}: if the wrong palm leaves last, it "
                f"takes the object along; none does from {_up(needed, 3):g} on"
            )
    if found.in_air == PROPERTIES and found.arms_differ_m > found.permitted_rise_m:
        yield (
            f"the arms may differ by {millimetres(found.arms_differ_m)} while they move, and the "
            f"properties hold up to {millimetres(found.permitted_rise_m)} (arm.rate_m_per_s, "
            "arm.height_error_m, radio.lease_s)"
        )


def _up(value: float, digits: int) -> float:
    return math.ceil(value * 10**digits) / 10**digits if math.isfinite(value) else value


def _down(value: float, digits: int) -> float:
    return math.floor(value * 10**digits) / 10**digits if math.isfinite(value) else value


def _names(numbers: tuple[int, ...] | list[int]) -> str:
    return ", ".join(map(str, numbers)) or "none"


def _mm(value: float) -> str:
    return "none helps" if math.isinf(value) else f"{1e3 * value:.2f} mm"


def _newtons(value: float, infinite: str = "any") -> str:
    return infinite if math.isinf(value) else f"{value:.2f} N"


def _kilograms(value: float) -> str:
    return "any" if math.isinf(value) else f"{_down(value, 3):g} kg"


def _number(value: float) -> str:
    return "any" if math.isinf(value) else f"{_up(value, 3):g}"
