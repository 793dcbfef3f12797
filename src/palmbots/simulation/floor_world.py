# SPDX-License-Identifier: Apache-2.0
"""An object that stands on the floor or on a stand, and two palms that the caller drives under it,
raises, lowers and turns.

The world is the exact quasistatic one with floor, walls and stands as further surfaces
(`world/quasistatic_world.hpp`). It has no robots, hence no noise, no sensors and no limit to the
force with which the palms are driven. Source: docs/theory/contacts.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import palmbots._core as _core
from palmbots._types import BySide, Overrides
from palmbots._util.arguments import show
from palmbots.errors import PalmbotsError
from palmbots.mechanics.consistent_modes import (
    MOST_CONTACTS,
    ConsistentModes,
    SurfaceContact,
    consistent_modes,
)
from palmbots.mechanics.lifting import check_stands
from palmbots.scene.scene import SceneLike, load_scene
from palmbots.scene.spec import to_spec
from palmbots.scene.surroundings import blocks_of
from palmbots.simulation.floor_job import Fall

Point = tuple[float, float]
Motion = tuple[tuple[Point, Point], tuple[float, float]]
"""How far the pivots move [m], and the angles to which the palms turn."""

_MOST_DEG = 80.0
_PALMS = ("left palm", "right palm")
_ABSENT_M = 100.0  # how far away a palm is that there is not
_MOST_FALLS = 100
_LONGEST_TURN = math.radians(1.0)  # of a palm that follows the floor, in one piece of a motion


@dataclass(frozen=True)
class FloorState:
    """Where palms and object are. Positions are (along the floor, above it) in metres."""

    end: str
    """Why the last motion ended early: ``jammed``, ``fell`` or ``toppled``; empty: it was
    completed."""
    touched_m: BySide[float | None]
    """Contact coordinate on each palm, outward from its point nearest to the pivot; None: the
    object does not touch this palm."""
    grounds: tuple[str, ...]
    """Which of ``floor``, ``wall`` and ``stand`` the object touches."""
    com_m: Point
    """The centre of mass."""
    tilt_deg: float
    """The angle of the object, anticlockwise."""
    pivots_m: BySide[Point]
    palms_deg: BySide[float]
    falls: tuple[Fall, ...] = ()
    """Falls of the object in the last motion."""
    run_off: tuple[str, ...] = ()
    """The surfaces of the contacts that ran off the end of a surface or of an edge of the object in
    the last motion, where no other contact took their place."""

    @property
    def on_floor(self) -> bool:
        """Whether the object touches the floor."""
        return "floor" in self.grounds


class FloorWorld:
    """Two palms and an object that stands on the floor, or on a stand, between them.

    The object begins with its COM above the origin and both contact vertices at one height: on the
    floor, or on the highest stand under them. The inner end of each palm begins at this height
    beside the object.

    Args:
        scene: the object, the palms (shape, friction, offset of the pivots), and the floor with its
            slope, walls and stands (`floor.walls`, `floor.stands`); the task and the robots of the
            scene do not matter.
        palms_deg: angles of the left and the right palm.
        gaps_m: horizontal distances of the left and the right palm from the object; None: there is
            no such palm (it is far away).
        floor_friction: friction coefficient between object and floor; None: that of the scene.
        overrides: scene keys to set.

    Raises:
        SceneError: the scene cannot be read or is not valid.
        PalmbotsError: an argument is out of range, the object does not stand there, or something is
            in a wall or in a stand.
    """

    def __init__(
        self,
        scene: SceneLike = "paper",
        *,
        palms_deg: tuple[float, float] = (15.0, 15.0),
        gaps_m: tuple[float | None, float | None] = (0.01, 0.01),
        floor_friction: float | None = None,
        overrides: Overrides = None,
    ) -> None:
        chosen = load_scene(scene, overrides)
        self._spec = spec = to_spec(chosen, unrolled=True)
        robots = spec.robots
        for robot in robots:
            robot.motor_limit = robot.traction_limit = math.inf
        spec.robots = robots
        for name, value in (
            *(("gaps_m", gap) for gap in gaps_m),
            ("floor_friction", floor_friction),
        ):
            if value is not None and not 0 <= value < math.inf:
                raise PalmbotsError(
                    f"{name}: value is {show(value)}; allowed: a finite number, at least 0"
                )
        angles = _angles(palms_deg)
        self._end = ""
        self._falls: tuple[Fall, ...] = ()
        self._run_off: tuple[str, ...] = ()
        self._weight = chosen.object.mass_kg * _core.standard_gravity
        if floor_friction is not None:
            spec.floor_friction = floor_friction
        self._world = _core.World(spec, True)
        self._world.set_phase("by_hand", spec.fall)
        check_stands(spec)
        self._is_there = [gap is not None for gap in gaps_m]
        left, right = (_ABSENT_M if gap is None else gap for gap in gaps_m)
        pivots, com = _core.standing_start(spec, angles, (left, right))
        self._world.put(pivots, angles, com, 0.0)
        if blocks_of(spec) and (why := self._world.start_refusal()):
            raise PalmbotsError(why)
        self._check_palms(pivots, angles, (((0, 0), (0, 0)), angles), "at the start")

    def _grounds_near(self) -> list[str]:
        near = _core.contact_tolerance * self._spec.width
        return sorted({kind for kind, side, *_ in self._world.touching(near) if side == 2})

    def _pivot_height(self, side: int, angle: float) -> float:
        """Height of the pivot of a palm whose inner end is on the floor."""
        return self._spec.palms[side].lowest_pivot(angle)

    def move(
        self,
        left_m: float = 0.0,
        right_m: float = 0.0,
        *,
        up_m: tuple[float, float] = (0.0, 0.0),
        palms_deg: tuple[float, float] | None = None,
        follow_floor: bool = False,
    ) -> FloorState:
        """Move both palms at once, at constant rates, until they arrive or the object stops them.

        Args:
            left_m: displacement of the left palm along the floor; positive: towards the right palm.
            right_m: displacement of the right palm, in the same direction; positive: away from the
                left palm.
            up_m: how far the pivots of the left and the right palm rise.
            palms_deg: the angles to which the palms turn; None: they do not turn.
            follow_floor: raise or lower the pivots so that the inner ends keep their heights while
                the palms turn (exactly after each degree). `up_m` is then the rise of the inner
                ends.

        Raises:
            PalmbotsError: an argument is out of range, or a palm would pass through the floor, a
                wall or a stand.
        """
        for name, value in (
            ("left_m", left_m),
            ("right_m", right_m),
            *(("up_m", up) for up in up_m),
        ):
            if not math.isfinite(value):
                raise PalmbotsError(f"{name}: value is {show(value)}; allowed: finite numbers")
        start = self._world.palms
        goal = start if palms_deg is None else _angles(palms_deg)
        turn = max(abs(b - a) for a, b in zip(start, goal, strict=True))
        pieces = max(1, math.ceil(turn / _LONGEST_TURN)) if follow_floor else 1
        motions: list[Motion] = []
        for k in range(pieces):
            before, after = (
                [a + (b - a) * (n / pieces) for a, b in zip(start, goal, strict=True)]
                for n in (k, k + 1)
            )
            rises = [up / pieces for up in up_m]
            if follow_floor:
                for side in (0, 1):
                    heights = (self._pivot_height(side, a[side]) for a in (before, after))
                    rises[side] -= next(heights) - next(heights)
            ways = ((left_m / pieces, rises[0]), (right_m / pieces, rises[1]))
            motions.append((ways, (after[0], after[1])))
        at, angles = self._world.pivots, self._world.palms
        for motion in motions:
            self._check_palms(at, angles, motion, "on the way")
            (one, two), angles = motion
            at = _sum(at[0], one), _sum(at[1], two)
        self._falls = self._run_off = ()
        for ways, after in motions:
            self._end = self._move(ways, after)
            if self._end:
                break
        return self.state

    def _move(self, ways: tuple[Point, Point], after: tuple[float, float]) -> str:
        """Why a motion ends early. After a fall it goes on, at most `_MOST_FALLS` times."""
        for _ in range(_MOST_FALLS):
            end, done, *_ = self._world.move(ways, after)
            self._run_off += tuple(map(_surface, self._world.run_off))
            if end or self._world.fall is None:
                return end
            high, com = self._world.fall
            self._falls += (Fall(high, self._weight * com),)
            left, right = ((x * (1 - done), y * (1 - done)) for x, y in ways)
            ways = left, right
        return "fell"

    def _check_palms(
        self,
        pivots: tuple[Point, Point],
        angles: tuple[float, float],
        motion: Motion,
        when: str,
    ) -> None:
        """Raise `PalmbotsError` if a palm would be in the floor, in a wall or in a stand."""
        left, right = self._is_there
        if why := _core.refusal_of_way(self._spec, (left, right), pivots, angles, *motion, when):
            raise PalmbotsError(why)

    def contact_modes(
        self,
        left_m_s: float = 0.0,
        right_m_s: float = 0.0,
        *,
        up_m_s: tuple[float, float] = (0.0, 0.0),
        turn_deg_s: tuple[float, float] = (0.0, 0.0),
        within_m: float | None = None,
    ) -> ConsistentModes:
        """All contact modes that may occur now if the palms move with these velocities.

        The surfaces are called ``left palm``, ``right palm``, ``floor``, ``wall`` and ``stand``.

        Args:
            left_m_s: velocity of the left palm along the floor; positive: to the right.
            right_m_s: velocity of the right palm, in the same direction.
            up_m_s: velocities at which the pivots rise.
            turn_deg_s: rates at which the palm angles grow.
            within_m: the largest gap of what counts as touching; None: 10⁻⁵ of the distance between
                the contact vertices.

        Raises:
            PalmbotsError: an argument is no finite number, or there are more than 8 contacts.
        """
        numbers = (left_m_s, right_m_s, *up_m_s, *turn_deg_s)
        if not all(map(math.isfinite, numbers)):
            raise PalmbotsError(f"contact_modes: value is {show(numbers)}; allowed: finite numbers")
        x, y, _ = self._world.pose
        velocities = tuple(zip((left_m_s, right_m_s), up_m_s, strict=True))
        found = []
        near = _core.contact_tolerance * self._spec.width if within_m is None else within_m
        for kind, carrier, _, (_, px, py, nx, ny, friction) in self._world.touching(near):
            name, velocity = _surface((carrier, kind)), (0.0, 0.0)
            if carrier < 2:
                # A palm whose angle grows turns clockwise on the left.
                spin = (-1, 1)[carrier] * math.radians(turn_deg_s[carrier])
                pivot, (vx, vy) = self._world.pivots[carrier], velocities[carrier]
                velocity = (vx - spin * (y + py - pivot[1]), vy + spin * (x + px - pivot[0]))
            found.append(SurfaceContact(name, (px, py), (nx, ny), friction, velocity))
        if len(found) > MOST_CONTACTS:
            raise PalmbotsError(f"contact_modes: {len(found)} contacts; allowed: {MOST_CONTACTS}")
        return consistent_modes(found, slope=self._spec.slope)

    @property
    def state(self) -> FloorState:
        """Where palms and object are."""
        world = self._world
        x, y, angle = world.pose
        return FloorState(
            end=self._end,
            touched_m=BySide.of(world.touched),
            # Before the first motion the world knows no contacts: the object stands as put.
            grounds=tuple(world.grounds if world.constraints else self._grounds_near()),
            com_m=(x, y),
            tilt_deg=math.degrees(angle),
            pivots_m=BySide.of(world.pivots),
            palms_deg=BySide.of(map(math.degrees, world.palms)),
            falls=self._falls,
            run_off=self._run_off,
        )


def _surface(contact: tuple[int, str]) -> str:
    carrier, kind = contact
    return _PALMS[carrier] if carrier < 2 else kind


def _sum(one: Point, other: Point) -> Point:
    return one[0] + other[0], one[1] + other[1]


def _angles(palms_deg: tuple[float, float]) -> tuple[float, float]:
    for value in palms_deg:
        if not 0 <= value <= _MOST_DEG:
            raise PalmbotsError(
                f"palms_deg: value is {show(value)}; allowed: from 0 to {_MOST_DEG:g}, because the "
                "inner end of a palm is its lowest point"
            )
    return math.radians(palms_deg[0]), math.radians(palms_deg[1])
