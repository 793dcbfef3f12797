# SPDX-License-Identifier: Apache-2.0
"""What the motor boards of a world in real time are connected to: a `Stage`.

`PerfectStage` has the robots of the scene, whose commands are those of a controller.
`ImperfectStage` has robots with imperfections, whose commands are those of motors.
"""

import math
from dataclasses import replace
from typing import Any, Protocol

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.drivers.arm import ARM_WORDS, FOLLOWS, HOLDS, RISES
from palmbots.drivers.driver import RawCommand, RawReading
from palmbots.errors import PalmbotsError, SceneError
from palmbots.links.local_connection import ConnectionLost
from palmbots.links.reading_frame import ReadingFrame
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.driven_world import DrivenWorld, as_built
from palmbots.simulation.episode import begin_episode
from palmbots.simulation.imperfect_robot import REST, ImperfectRobot
from palmbots.simulation.imperfections import Imperfections
from palmbots.simulation.prepare import prepare
from palmbots.simulation.worlds import world_entry

# The world goes on until the robots stop: neither distance nor time ends it.
_NO_TIMEOUT = {"task.timeout_s": 90_000.0}
_ENDLESS = _NO_TIMEOUT | {"task.distance_m": 10_000.0}


class CommandForm(Protocol):
    """What a motor board knows of the commands of a stage."""

    def greeting(self, side: int) -> list[Any]:
        """Further values of the frame for a program that has just connected; none: no frame."""
        ...

    def command_in(self, frame: Any) -> Any:
        """The command in a frame.

        Raises:
            ConnectionLost: it is none.
        """
        ...

    def rest(self, command: Any) -> Any:
        """The command that stops the wheels and keeps the palm, after this one; None: at first."""
        ...


class Stage(CommandForm, Protocol):
    """A world with two robots, tick by tick."""

    @property
    def midpoint(self) -> float:
        """Displacement of the midpoint of the robots [m]."""
        ...

    @property
    def outcome(self) -> str:
        """``running``, or how it has ended."""
        ...

    @property
    def contacts(self) -> tuple[float, float]:
        """The contact coordinates p after the last step [m]."""
        ...

    @property
    def carried_m(self) -> float:
        """Displacement of the midpoint of the robots while they carried the object."""
        ...

    @property
    def is_put_down(self) -> bool:
        """The object is where it is to be at the end, as far as the height is concerned."""
        ...

    def drop_reason(self) -> str | None:
        """Why the object was dropped; None: it was not."""
        ...

    def frames(self) -> tuple[Any, Any]:
        """The reading of each robot, as a frame."""
        ...

    def step(self, left: Any, right: Any) -> None:
        """One control period with these commands."""
        ...


class PerfectStage:
    """The robots of the scene."""

    def __init__(self, scene: Scene, world: str, seed: int) -> None:
        self._carry = begin_episode(load_scene(scene, _ENDLESS), world, seed)
        self._forward = 1.0 if scene.task.direction == "forward" else -1.0
        self._start_m = self._carry.sight().separation
        self.midpoint = 0.0
        self.contacts: tuple[float, float] = (0.0, 0.0)
        self.is_put_down = True
        self._palms = 0, 0

    @property
    def carried_m(self) -> float:
        """The same as `midpoint`."""
        return self.midpoint

    @property
    def outcome(self) -> str:
        """``running``, or how it has ended."""
        return self._carry.outcome

    def drop_reason(self) -> str | None:
        """The reason of a drop, by its name in results."""
        return self._carry.make_carry("none").reason

    def greeting(self, side: int) -> list[Any]:
        """Nothing."""
        return []

    def frames(self) -> tuple[ReadingFrame, ReadingFrame]:
        """What both robots without arms sense."""
        apart = 0.5 * (self._carry.sight().separation - self._start_m)
        moved = self.midpoint - apart, self.midpoint + apart
        left, right = (
            ReadingFrame(sign, turned, self._forward * x, palm)
            for (sign, turned, *_), x, palm in zip(
                self._carry.seen(), moved, self._palms, strict=True
            )
        )
        return left, right

    def command_in(self, frame: Any) -> tuple[int, int, bool]:
        """Palm, move and stop."""
        if isinstance(frame, list) and [type(value) for value in frame] == [int, int, bool]:
            palm, move, stop = frame
            if palm in (0, 1) and move in (0, 1, 2):
                return palm, move, stop
        raise ConnectionLost("a program: sends no commands")

    def rest(self, command: tuple[int, int, bool] | None) -> tuple[int, int, bool]:
        """Stop; the palm stays."""
        return (0 if command is None else command[0], 0, True)

    def step(self, left: tuple[int, int, bool], right: tuple[int, int, bool]) -> None:
        """One control period."""
        self._palms = left[0], right[0]
        self._carry.stop(left[2], right[2])
        _, _, _, self.midpoint, self.contacts = self._carry.step((*left[:2], 0), (*right[:2], 0), 1)


FloorCommand = tuple[int, int, bool, int, int]
"""Palm, move and stop as a controller commands them, what the arm does, and the phase; phase −1: as
before."""


class FloorStage:
    """The robots of a scene whose job begins or ends on the floor or on a stand."""

    def __init__(self, scene: Scene, world: str, seed: int) -> None:
        refuse_live_floor(scene, world)
        prepared = prepare(load_scene(scene, _NO_TIMEOUT), "none", world)
        self._job = _core.FloorEpisode(prepared.spec, seed)
        self._ends_low = scene.task.to != "palms"
        self._low = getattr(scene.task, "from") != "palms"
        leads = scene.task.direction == "forward"
        self._sides = (int(leads),) if prepared.spec.on_one_palm else (0, 1)
        self._palms = 0, 0

    @property
    def midpoint(self) -> float:
        """Displacement of the midpoint of the robots [m]."""
        return self._job.midpoint

    @property
    def outcome(self) -> str:
        """``running``, or how it has ended."""
        return self._job.outcome

    @property
    def contacts(self) -> tuple[float, float]:
        """The contact coordinates p after the last step [m]."""
        return self._job.contacts

    @property
    def carried_m(self) -> float:
        """What the robots moved while they carried the object, on average. If one palm at a time
        holds it, the robot that leads counts: what it goes ahead is what its partner carries."""
        travelled = self._job.travelled
        return float(sum(travelled[side] for side in self._sides) / len(self._sides))

    @property
    def is_put_down(self) -> bool:
        """The object is on the floor or on a stand alone, if that is what the job is for."""
        return self._job.stands or not self._ends_low

    @property
    def moved_m(self) -> float:
        """Displacement of the centre of mass."""
        return self._job.moved

    @property
    def heights_m(self) -> tuple[float, float]:
        """Heights of the pivots over the floor."""
        return self._job.heights

    def drop_reason(self) -> str | None:
        """The reason of a drop, by its name in results."""
        reason = self._job.reason
        return None if reason is None else str(reason)

    def greeting(self, side: int) -> list[Any]:
        """Nothing."""
        return []

    def frames(self) -> tuple[ReadingFrame, ReadingFrame]:
        """What both robots with arms sense."""
        left, right = (
            ReadingFrame(*values[:3], palm, *values[3:])
            for values, palm in zip(self._job.seen, self._palms, strict=True)
        )
        return left, right

    def command_in(self, frame: Any) -> FloorCommand:
        """Palm, move, stop, arm and phase."""
        if isinstance(frame, list) and [type(v) for v in frame] == [int, int, bool, int, int]:
            palm, move, stop, arm, phase = frame
            is_known = palm in (0, 1) and move in (0, 1, 2) and arm in range(len(ARM_WORDS))
            if is_known and phase in range(self._job.states):
                return palm, move, stop, arm, phase
        raise ConnectionLost("a program: sends no commands")

    def rest(self, command: FloorCommand | None) -> FloorCommand:
        """Stop; the palm stays, and an arm that is up holds."""
        if command is None:
            return 0, 0, True, FOLLOWS if self._low else HOLDS, -1
        palm, _, _, arm, phase = command
        return palm, 0, True, FOLLOWS if arm == FOLLOWS else HOLDS, phase

    def step(self, left: FloorCommand, right: FloorCommand) -> None:
        """One control period. Nobody lays an object that was put down on the palms again, so arms
        that rise without it have no effect."""
        arms = left[3], right[3]
        self._palms = left[0], right[0]
        if self._low or not (RISES in arms and self._job.stands):
            self._job.step(left, right)


def perfect_stage(scene: Scene, world: str, seed: int) -> PerfectStage | FloorStage:
    """The robots of a scene."""
    return (FloorStage if to_spec(scene).uses_floor else PerfectStage)(scene, world, seed)


def refuse_live_floor(scene: Scene, world: str) -> None:
    """Raise `SceneError` for a job on the floor in a world whose robots have arms in lockstep
    only."""
    if to_spec(scene).uses_floor and world != "quasistatic":
        raise SceneError(
            f"task.from, task.to: a job on the floor runs in real time in the quasistatic world "
            f"only; --world is {world}; allowed: quasistatic, or --lockstep"
        )


def raw_frame(reading: RawReading) -> list[Any]:
    """A reading of the hardware as a frame."""
    counts = None if reading.wheel_counts is None else [*reading.wheel_counts]
    return ["raw", counts, [*reading.closed], reading.servo_rad, reading.battery_v]


class RawStage:
    """Commands to motors, as frames.

    Args:
        imperfections: what the robots really are.
    """

    is_put_down = True

    def __init__(self, imperfections: Imperfections) -> None:
        self._clocks = [1 + 1e-6 * imperfections.of(side).clock_ppm for side in SIDES]

    def greeting(self, side: int) -> list[Any]:
        """The rate of the clock of the robot's program, which only its simulation knows."""
        return ["clock", self._clocks[side]]

    def command_in(self, frame: Any) -> RawCommand:
        """The rates of both wheels, and the angles of the servos of palm and arm or null."""
        if isinstance(frame, list) and len(frame) == 5 and frame[0] == "raw":
            left, right, *servos = frame[1:]
            are_numbers = all(servo is None or _is_number(servo) for servo in servos)
            if _is_number(left) and _is_number(right) and are_numbers:
                return RawCommand((float(left), float(right)), *servos)
        raise ConnectionLost("a program: sends no commands")

    def rest(self, command: RawCommand | None) -> RawCommand:
        """Stop the wheels; the servo keeps its angle."""
        return REST if command is None else replace(REST, servo_rad=command.servo_rad)


def _is_number(value: Any) -> bool:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return is_number and math.isfinite(value)


class ImperfectStage(RawStage):
    """Robots with imperfections under an object.

    Args:
        scene: the scene.
        world: its name.
        seed: of the noise.
        imperfections: what the robots really are.
    """

    def __init__(self, scene: Scene, world: str, seed: int, imperfections: Imperfections) -> None:
        driven = world_entry(world).driven
        if driven is None:
            raise PalmbotsError(f"--imperfect: the world {world} cannot have imperfect robots")
        params = [imperfections.of(side) for side in SIDES]
        left, right = (one.pivot_height_m for one in params)
        self._world: DrivenWorld = driven(scene, (left, right))
        self._start = as_built(self._world.rolled())
        super().__init__(imperfections)
        self.contacts: tuple[float, float] = (0.0, 0.0)
        self._robots = [
            ImperfectRobot(one, scene, side, seed) for one, side in zip(params, SIDES, strict=True)
        ]

    @property
    def midpoint(self) -> float:
        """Displacement of the midpoint of the robots [m]."""
        return self._world.advance

    @property
    def carried_m(self) -> float:
        """The same as `midpoint`."""
        return self.midpoint

    @property
    def outcome(self) -> str:
        """``running`` or ``dropped``."""
        return "dropped" if self._world.end else "running"

    def readings(self) -> tuple[RawReading, RawReading]:
        """What the hardware of each robot reads."""
        world = self._world
        rolled = zip(as_built(world.rolled()), self._start, strict=True)
        rims = [(now[0] - start[0], now[1] - start[1]) for now, start in rolled]
        rows = zip(self._robots, rims, world.pressed, world.wrists(), strict=True)
        left, right = (robot.reading(rim, p, palm) for robot, rim, p, palm in rows)
        return left, right

    def frames(self) -> tuple[Any, Any]:
        """The readings as frames."""
        left, right = self.readings()
        return raw_frame(left), raw_frame(right)

    def step(self, left: RawCommand, right: RawCommand) -> None:
        """One control period."""
        one, other = self._robots
        rims = (one.move(left), other.move(right))
        self._world.step(as_built(rims), (one.palm_rad, other.palm_rad))
        # A palm that is pressed too lightly keeps its last contact.
        (p, q), (was, was_other) = self._world.pressed, self.contacts
        self.contacts = (was if p is None else p, was_other if q is None else q)

    def drop_reason(self) -> str | None:
        """The reason of a drop, by its name in results."""
        return self._world.end or None
