"""A scene: everything that a carry depends on but its controller, seed, world and precision.

`load_scene` is the way in: it takes the name of a built-in scene, a TOML file, a table or a scene,
sets overrides on top, and either returns a `Scene` that makes sense as a whole or raises
`SceneError` with one line. The keys, their units, limits and defaults stand in `sections`.
"""

import math
import os
from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ValidationError, model_validator

from palmbots.bodies import Dynamic
from palmbots.breakage import Faults, Radio
from palmbots.complaints import complaint
from palmbots.errors import SceneError, show
from palmbots.object_files import by_name, with_named_object
from palmbots.overrides import merged
from palmbots.quantities import fault
from palmbots.scene_files import read_scene
from palmbots.sections import (
    SIDES,
    Bumps,
    Control,
    Object,
    Palm,
    PalmParameters,
    Robot,
    RobotParameters,
    Section,
    Side,
    Start,
    Tactile,
    Task,
    other_side,
)
from palmbots.toml_text import toml_text

__all__ = ["Scene", "load_scene"]

# The core counts ticks in 32 bits and a radio link holds so many of them.
_MOST_TICKS = 10_000_000
_MOST_DELAY_TICKS = 200


class Scene(Section):
    """A complete, valid scene; `Scene()` is the built-in scene `paper`. Immutable.

    `model_dump()` gives it as a table (without the keys that are not set), which `load_scene`
    takes back. To change something: ``load_scene(scene, {"radio.loss": 0.1})``.
    """

    object: Annotated[Object, BeforeValidator(by_name)] = Object()
    """A table, or the name of an object that comes with the package."""
    palm: Palm = Palm()
    robot: Robot = Robot()
    tactile: Tactile = Tactile()
    control: Control = Control()
    radio: Radio = Radio()
    faults: Faults = Faults()
    bumps: Bumps = Bumps()
    start: Start = Start()
    task: Task = Task()
    dynamic: Dynamic = Dynamic()

    def palm_of(self, side: Side) -> PalmParameters:
        """The palm of one side, `palm.left` or `palm.right` put over `palm`, as wide as its lips
        ask for."""
        palm = self.palm.of(side)
        if palm.lip_height_m > 0:
            wide = self.object.depth_m + 2 * palm.lip_clearance_m
            return palm.model_copy(update={"width_m": wide})
        return palm

    def robot_of(self, side: Side) -> RobotParameters:
        """The robot of one side, `robot.left` or `robot.right` put over `robot`."""
        return self.robot.of(side)

    @property
    def timeout_s(self) -> float:
        """When the carry is given up [s]: `task.timeout_s`, or twice distance / slower speed.

        Where speeding up takes longer than half of the way there is time for that twice, instead.
        """
        if self.task.timeout_s is not None:
            return self.task.timeout_s
        robots = [self.robot_of(side) for side in SIDES]
        slower = min(robot.speed_m_s for robot in robots)
        if slower <= 0:
            return math.inf
        way = self.task.distance_m / slower
        return way + max(way, 2 * max(r.speed_m_s / r.acceleration_m_s2 for r in robots))

    @property
    def timeout_ticks(self) -> int:
        """The same in control periods, at least 1."""
        return max(1, round(self.timeout_s / self.control.period_s))

    def mirrored(self) -> "Scene":
        """The mirror image: left and right exchanged, the travel the other way.

        A slope stays as it is, for uphill is seen in the direction of travel.
        """
        table = self.model_dump()
        thing, task = table["object"], table["task"]
        thing["vertices_m"] = tuple((0.0 - x, y) for x, y in thing["vertices_m"])
        thing["com_m"] = (0.0 - thing["com_m"][0], thing["com_m"][1])
        thing["contacts"] = thing["contacts"][::-1]
        for section in ("palm", "robot"):
            sides = {other_side(s): table[section].pop(s, {}) for s in SIDES}
            table[section] |= sides
        for bump in table["bumps"]["script"]:
            bump["robot"] = other_side(bump["robot"])
        for outage in table["radio"]["outages"]:
            if outage["sender"] != "station":
                outage["sender"] = other_side(outage["sender"])
        for mishap in table["radio"]["script"]:
            mishap["sender"] = other_side(mishap["sender"])
        for broken in table["faults"]["script"]:
            if "robot" in broken:
                broken["robot"] = other_side(broken["robot"])
        table["start"] = {"left_m": self.start.right_m, "right_m": self.start.left_m}
        task["direction"] = "backward" if task["direction"] == "forward" else "forward"
        task["path"] = self.task.path.mirrored().model_dump()
        return Scene.model_validate(table)

    def to_toml(self) -> str:
        """The scene as the text of a scene file."""
        return toml_text(self.model_dump())

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_time()
        self._check_start()
        self._check_path()
        return self

    def _check_path(self) -> None:
        """A radius that no placing of the robots permits; the rest is for `path` to say."""
        radius, least = self.task.path.radius_m, self.object.width_m
        if radius is not None and radius < least:
            raise fault(
                radius,
                f"is too tight for robots that stand {least:g} m apart",
                f"a number in m, from {least:g} to 10000",
                "task.path.radius_m",
            )

    def _check_time(self) -> None:
        period = self.control.period_s
        if math.isinf(self.timeout_s):
            raise fault(
                0.0,
                "sets no time limit",
                "a speed above 0, or a task.timeout_s",
                "robot.speed_m_s",
            )
        if self.timeout_s / period > _MOST_TICKS:
            raise fault(
                self.timeout_s,
                f"is too long for control periods of {period:g} s",
                f"at most {_MOST_TICKS * period:g} (ten million periods)",
                "task.timeout_s",
            )
        radio = self.radio
        if (radio.latency_s + radio.jitter_s) / period > _MOST_DELAY_TICKS:
            raise fault(
                radio.latency_s,
                f"and a jitter_s of {radio.jitter_s:g} are too long for control periods of "
                f"{period:g} s",
                f"latency_s + jitter_s at most {_MOST_DELAY_TICKS * period:g} "
                f"({_MOST_DELAY_TICKS} periods)",
                "radio.latency_s",
            )

    def _check_start(self) -> None:
        heights = []
        for side, place in zip(SIDES, (self.start.left_m, self.start.right_m), strict=True):
            palm = self.palm_of(side)
            half = palm.length_m / 2
            if abs(place) > half:
                raise fault(
                    place,
                    "is not on the palm",
                    f"a number in m, from {-half:g} to {half:g}",
                    f"start.{side}_m",
                )
            angle = math.radians(palm.steep_deg)
            heights.append(place * math.sin(angle) + palm.pivot_offset_m * math.cos(angle))
        width = self.object.width_m
        if abs(heights[1] - heights[0]) > 0.99 * width:
            raise fault(
                [self.start.left_m, self.start.right_m],
                f"puts the contacts at heights {heights[0]:g} and {heights[1]:g} m, too far apart "
                f"for an object that is {width:g} m wide between them",
                "left_m and right_m at more equal heights",
                "start",
            )


def load_scene(
    source: str | os.PathLike[str] | Mapping[str, Any] | Scene,
    overrides: Mapping[str, Any] | None = None,
    *,
    called: str = "overrides:",
) -> Scene:
    """The scene of a built-in name, TOML file, table or other scene, with overrides on top.

    `overrides` has dotted keys, {"radio.loss": 0.1}, nested tables, or both; None as a value
    means "not set". What is not given has its default, the value in the scene `paper`. A name of
    `palmbots.objects` in place of the table `object` stands for that object, in either one.
    Raises `SceneError`, one line that names file, key, value and what is allowed. The
    source has to be valid by itself, so that a complaint blames either it or the overrides, which
    it calls what `called` says.
    """
    if isinstance(source, Scene):
        scene, data = source, source.model_dump()
    elif isinstance(source, Mapping):
        data = dict(source)
        scene = _validated("scene:", data)
    elif isinstance(source, str | os.PathLike):
        name, data = read_scene(source)
        scene = _validated(f"{name}:", data)
    else:
        raise SceneError(
            f"{show(source)}: is no scene; allowed: a built-in name, a path, a table or a Scene"
        )
    if not overrides:
        return scene
    if not isinstance(overrides, Mapping):
        raise SceneError(f"{called} {show(overrides)} is not a table; allowed: {{key: value}}")
    table = merged(with_named_object(data), with_named_object(overrides), called=called)
    return _validated(called, table)


def _validated(called: str, data: dict[str, Any]) -> Scene:
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise SceneError(f"{called} {complaint(error, Scene)}") from None
