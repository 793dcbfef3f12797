# SPDX-License-Identifier: Apache-2.0
"""The sections of a scene about the task: `bumps`, `start`, `floor`, `world` and
`task`."""

from palmbots._types import Side
from palmbots.scene.core_keys import key, records
from palmbots.scene.path_section import Path
from palmbots.scene.route_section import Route
from palmbots.scene.section import Section, with_plain_names


class Bump(Section):
    """A sudden shift of one contact, at a given distance or time."""

    robot: Side = key("bumps.script[].robot")
    """The robot whose contact shifts."""
    shift_m: float = key("bumps.script[].shift_m")
    """Size of the shift; > 0 is outward."""
    at_m: float | None = key("bumps.script[].at_m")
    """Distance travelled by the pair at which it happens."""
    at_s: float | None = key("bumps.script[].at_s")
    """Time at which it happens."""


class Push(Section):
    """A time during which something pushes a robot."""

    robot: Side = key("bumps.pushes[].robot")
    """The robot that is pushed."""
    at_s: float = key("bumps.pushes[].at_s")
    """When it begins."""
    duration_s: float = key("bumps.pushes[].duration_s")
    speed_m_s: float = key("bumps.pushes[].speed_m_s")
    """What the push adds to the robot's speed; > 0 is outward, away from the partner. A robot that
    holds its brakes does not move."""


class Bumps(Section):
    """[bumps] Bumps of the floor, which shift the contacts, and pushes of the robots."""

    script: tuple[Bump, ...] = records("bumps.script")
    """Bumps that happen in every carry: a list of tables {robot, at_m or at_s, shift_m}."""
    pushes: tuple[Push, ...] = records("bumps.pushes")
    """Times during which something pushes a robot, in every carry: a list of tables {robot, at_s,
    duration_s, speed_m_s}."""
    rate_per_m: float = key("bumps.rate_per_m")
    """Mean number of random bumps per metre and robot."""
    max_shift_m: float = key("bumps.max_shift_m")
    """Largest size of a random bump. Sizes are uniform from minus to plus this value."""


class Start(Section):
    """[start] The contact coordinates at the start."""

    left_m: float = key("start.left_m")
    """Contact coordinate on the left palm; > 0 is outward of the pivot."""
    right_m: float = key("start.right_m")
    """Contact coordinate on the right palm; > 0 is outward of the pivot."""


class Wall(Section):
    """A vertical face in front of solid ground, on one side of the object."""

    at_m: float = key("floor.walls[].at_m")
    """Its place, from the COM of the object at its start in the direction of travel; < 0: behind
    the object."""
    height_m: float | None = key("floor.walls[].height_m")
    """Height of its upper edge. The ground behind it is level at this height. Not set: endless."""
    friction: float | None = key("floor.walls[].friction")
    """Coulomb coefficient between object and wall. Not set: that of the floor."""


class Stand(Section):
    """A block on the floor with a level top and two edges. An object above one starts on it. With a
    gap it consists of two halves beside the path of the robots."""

    from_m: float = key("floor.stands[].from_m")
    """Where it begins, from the COM of the object at its start in the direction of travel."""
    to_m: float = key("floor.stands[].to_m")
    """Where it ends, in the same direction."""
    height_m: float = key("floor.stands[].height_m")
    """Height of its top above the floor."""
    friction: float | None = key("floor.stands[].friction")
    """Coulomb coefficient between object and stand. Not set: that of the floor."""
    gap_m: float | None = key("floor.stands[].gap_m")
    """Distance between its two halves, across the path. Not set: it has no gap."""


class Floor(Section):
    """[floor] The floor, where the object stands on it, and what is on the floor."""

    friction: float = key("floor.friction")
    """Coulomb coefficient between object and floor."""
    walls: tuple[Wall, ...] = records("floor.walls")
    """Walls, at most one on each side of the object: a list of tables {at_m, height_m,
    friction}."""
    stands: tuple[Stand, ...] = records("floor.stands")
    """Stands: a list of tables {from_m, to_m, height_m, friction,
    gap_m}."""


class World(Section):
    """[world] What the quasistatic world does where mechanics leave it open."""

    ambiguity: str = key("world.ambiguity")
    """Which motion follows where further contacts permit several. rule: that in which all contacts
    slide, else the one with the largest margin, else the one in which the robot in front slides.
    drawn: one of them, each with the same probability; the seed determines which."""
    fall_m: float = key("world.fall_m")
    """How far a contact vertex may fall in a job on the floor, for example off the inner end of a
    palm. Where it slides, the height counts times the share of the energy that friction does not
    take up."""


class _Ends(Section):
    @property
    def ends(self) -> tuple[str, str]:
        """What the object is on before and after the job."""
        return vars(self)["from"], vars(self)["to"]


@with_plain_names
class Task(_Ends):
    """[task] Where the object begins and ends, distance, direction, path, route and slope."""

    from_: str = key("task.from")
    """What the object is on before the job. palms: the job begins when both palms hold it. floor,
    stand: the robots pick it up."""
    to: str = key("task.to")
    """What the object is on after the job. palms: the job ends at its distance. floor, stand: the
    robots put it down there and leave."""
    dock: str = key("task.dock")
    """Which robots begin to pick the object up. together: both. one-first: the one that leads; the
    other one stands with its brakes on until its partner's palm is under the object. After an
    attempt that failed, both dock together. alone: the one that leads does the whole job, against a
    wall behind the object; the other one stands aside. hand-over: the one that follows carries the
    object half of the way on its palm and hands it to the one that leads."""
    distance_m: float = key("task.distance_m")
    """Distance that the midpoint of the pivots has to travel."""
    slope_deg: float = key("task.slope_deg")
    """Slope of the floor. > 0 is uphill in the direction of travel."""
    timeout_s: float | None = key("task.timeout_s")
    """Time limit of the carry. Not set: twice the time that the slower robot needs at nominal
    speed, or more if the robots take long to reach it."""
    direction: str = key("task.direction")
    """forward: the right robot leads. backward: the left robot leads."""
    inertia: bool = key("task.inertia")
    """Whether the accelerations of the pair influence which contact slides first. false: they are
    neglected, as in the paper."""
    inertia_tau_s: float = key("task.inertia_tau_s")
    """Time constant of the first-order filter for these accelerations, because wheels, palms and
    contacts are compliant. 0: no filter."""
    path: Path = Path()
    route: Route = Route()
