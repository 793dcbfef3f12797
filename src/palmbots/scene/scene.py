# SPDX-License-Identifier: Apache-2.0
"""A scene: everything that a carry depends on except controller, seed, world and precision.

`load_scene` reads the name of a built-in scene, a TOML file, a table or a scene, and sets overrides
on top. It returns a valid `Scene` or raises `SceneError` with one line. The keys with their
meanings, units, limits and defaults stand in the modules `*_section`, one for each topic.
"""

import math
import os
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Self, TypeAlias

from pydantic import BeforeValidator, ValidationError, model_validator

from palmbots._types import SIDES, Overrides, Side
from palmbots._util.arguments import show
from palmbots._util.toml_writer import toml_text
from palmbots.errors import SceneError
from palmbots.scene.error_messages import validation_error
from palmbots.scene.faults_section import Faults
from palmbots.scene.fields import field_error
from palmbots.scene.files import read_scene
from palmbots.scene.mujoco_section import MujocoParameters
from palmbots.scene.object_library import by_name, is_object_file, with_named_object
from palmbots.scene.object_section import Object
from palmbots.scene.overrides import merged, without_superseded
from palmbots.scene.palm_section import Palm, PalmParameters
from palmbots.scene.radio_section import Radio
from palmbots.scene.robot_section import Control, Robot, RobotParameters, Tactile
from palmbots.scene.section import Section, key_of_side
from palmbots.scene.task_section import Bumps, Start, Task

# Limits of the core: a carry counts its ticks in 32 bits, and a link buffers this many of them.
_MOST_TICKS = 10_000_000
MOST_DELAY_TICKS = 200
# Most of the distance between its contacts by which an object may rise from one to the other.
MOST_LEAN = 0.99


class Scene(Section):
    """A complete, valid scene; `Scene()` is the built-in scene `paper`. Immutable.

    `model_dump()` returns it as a table without the keys that are not set; `load_scene` reads such
    a table. To change a key: ``load_scene(scene, {"radio.loss": 0.1})``.
    """

    object: Annotated[Object, BeforeValidator(by_name)] = Object()
    """A table, the name of an object of the package, or a TOML file with the table [object]."""
    palm: Palm = Palm()
    robot: Robot = Robot()
    tactile: Tactile = Tactile()
    control: Control = Control()
    radio: Radio = Radio()
    faults: Faults = Faults()
    bumps: Bumps = Bumps()
    start: Start = Start()
    task: Task = Task()
    mujoco: MujocoParameters = MujocoParameters()

    def palm_of(self, side: Side) -> PalmParameters:
        """The palm of one side: `palm` with the overrides of `palm.left` or `palm.right`.

        A palm with lips is as wide as the lips require.
        """
        palm = self.palm.of(side)
        if palm.lip_height_m > 0:
            wide = self.object.depth_m + 2 * palm.lip_clearance_m
            return palm.model_copy(update={"width_m": wide})
        return palm

    def robot_of(self, side: Side) -> RobotParameters:
        """The robot of one side: `robot` with the overrides of `robot.left` or `robot.right`."""
        return self.robot.of(side)

    @property
    def timeout_s(self) -> float:
        """The time limit of the carry [s]: `task.timeout_s`, or what `_time_limit` returns."""
        if self.task.timeout_s is not None:
            return self.task.timeout_s
        robots = [self.robot_of(side) for side in SIDES]
        speed = min(robot.speed_m_s for robot in robots)
        speedup_s = max(robot.speed_m_s / robot.acceleration_m_s2 for robot in robots)
        return _time_limit(self.task.distance_m, speed, speedup_s)

    @property
    def timeout_ticks(self) -> int:
        """The time limit in control periods, at least 1."""
        return max(1, round(self.timeout_s / self.control.period_s))

    def mirrored(self) -> "Scene":
        """The mirror image: left and right exchanged, the direction of travel reversed.

        A slope keeps its sign, because uphill is defined in the direction of travel.
        """
        table = self.model_dump()
        item, task = table["object"], table["task"]
        item["vertices_m"] = tuple((0.0 - x, y) for x, y in item["vertices_m"])
        item["com_m"] = (0.0 - item["com_m"][0], item["com_m"][1])
        item["contacts"] = item["contacts"][::-1]
        for section in ("palm", "robot", "radio"):
            sides = {_other(s): table[section].pop(s, {}) for s in SIDES}
            table[section] |= sides
        for bump in table["bumps"]["script"]:
            bump["robot"] = _other(bump["robot"])
        for push in table["bumps"]["pushes"]:
            push["robot"] = _other(push["robot"])
        for outage in table["radio"]["outages"]:
            if outage["sender"] != "station":
                outage["sender"] = _other(outage["sender"])
        for fault in table["radio"]["script"]:
            end = "receiver" if fault["sender"] == "station" else "sender"
            fault[end] = _other(fault[end])
        for fault in table["faults"]["script"]:
            if "robot" in fault:
                fault["robot"] = _other(fault["robot"])
        table["start"] = {"left_m": self.start.right_m, "right_m": self.start.left_m}
        task["direction"] = "backward" if task["direction"] == "forward" else "forward"
        task["path"] = self.task.path.mirrored().model_dump()
        return Scene.model_validate(table)

    def to_toml(self) -> str:
        """The scene as the text of a scene file."""
        return toml_text(self.model_dump())

    def stride_of(self, side: Side) -> int:
        """The control periods of the scene between two steps of a robot's program."""
        own_s = self.robot_of(side).period_s
        return 1 if own_s is None else max(1, round(own_s / self.control.period_s))

    @model_validator(mode="after")
    def _check(self) -> Self:
        self._check_time()
        self._check_periods()
        self._check_start()
        self._check_path()
        return self

    def _check_path(self) -> None:
        """Refuse a radius smaller than the robots' distance; `path_curve` checks the rest."""
        radius, least = self.task.path.radius_m, self.object.width_m
        if radius is not None and radius < least:
            raise field_error(
                radius,
                f"is too tight for robots {least:g} m apart",
                f"a number in m, from {least:g} to 10000",
                "task.path.radius_m",
            )

    def _check_periods(self) -> None:
        """Refuse a robot's period between two ticks, or longer than its motors wait."""
        tick_s, watchdog_s = self.control.period_s, self.control.watchdog_s
        for side in SIDES:
            own_s = self.robot_of(side).period_s
            if own_s is None:
                continue
            ratio = own_s / tick_s
            is_whole = ratio > 0.5 and abs(ratio - round(ratio)) < 1e-6
            if not is_whole or own_s > watchdog_s * (1 + 1e-9):
                override = self.robot.left if side == "left" else self.robot.right
                raise field_error(
                    own_s,
                    f"is not a whole multiple of control.period_s, which is {tick_s:g}"
                    if not is_whole
                    else f"is longer than control.watchdog_s, which is {watchdog_s:g}",
                    f"whole multiples of {tick_s:g} s up to {watchdog_s:g} s",
                    f"robot.{side}.period_s" if override.period_s is not None else "robot.period_s",
                )

    def _check_time(self) -> None:
        period = self.control.period_s
        if math.isinf(self.timeout_s):
            raise field_error(
                0.0,
                "sets no time limit",
                "a speed above 0, or a task.timeout_s",
                self._slower_key(),
            )
        if self.timeout_s / period > _MOST_TICKS:
            key, value = self._cause_of_timeout()
            limit = f"at most {_MOST_TICKS * period:g} s (ten million periods)"
            if key == "task.timeout_s":
                problem = f"is too long for control periods of {period:g} s"
                raise field_error(value, problem, limit, key)
            raise field_error(
                value,
                f"leads to a time limit of {self.timeout_s:g} s, which is too long for control "
                f"periods of {period:g} s",
                f"a time limit of {limit}, or a task.timeout_s",
                key,
            )
        radio = self.radio
        if radio.longest_delay_s / period > MOST_DELAY_TICKS:
            for sender in ("left", "right", "station"):
                own = radio.of(sender)
                if (own.latency_s + own.jitter_s) / period > MOST_DELAY_TICKS:
                    break
            is_own = radio.latency_s + radio.jitter_s < radio.longest_delay_s
            raise field_error(
                own.latency_s,
                f"and a jitter_s of {own.jitter_s:g} are too long for control periods of "
                f"{period:g} s",
                f"latency_s + jitter_s at most {MOST_DELAY_TICKS * period:g} "
                f"({MOST_DELAY_TICKS} periods)",
                f"radio.{sender}.latency_s" if is_own else "radio.latency_s",
            )

    def _slower_key(self) -> str:
        """The key that sets the speed of the slower robot."""
        slower = min(SIDES, key=lambda side: self.robot_of(side).speed_m_s)
        override = self.robot.left if slower == "left" else self.robot.right
        return f"robot.{key_of_side(override, slower, 'speed_m_s')}"

    def _cause_of_timeout(self) -> tuple[str, float]:
        """The key to blame for a time limit that is too long, and its value.

        It is the first one whose default would make the limit short enough.
        """
        if self.task.timeout_s is not None:
            return "task.timeout_s", self.task.timeout_s
        robots, default = [self.robot_of(side) for side in SIDES], RobotParameters()
        speed = min(robot.speed_m_s for robot in robots)
        speedup_s = max(robot.speed_m_s / robot.acceleration_m_s2 for robot in robots)
        distance, period = self.task.distance_m, self.control.period_s
        with_default_speed = _time_limit(distance, default.speed_m_s, speedup_s)
        with_default_distance = _time_limit(Task().distance_m, speed, speedup_s)
        causes = (
            (self._slower_key(), speed, with_default_speed / period),
            ("task.distance_m", distance, with_default_distance / period),
            ("control.period_s", period, self.timeout_s / Control().period_s),
        )
        for key, value, ticks in causes:
            if ticks <= _MOST_TICKS:
                return key, value
        return self._slower_key(), speed

    def _check_start(self) -> None:
        heights = []
        for side, place in zip(SIDES, (self.start.left_m, self.start.right_m), strict=True):
            palm = self.palm_of(side)
            half = palm.length_m / 2
            if abs(place) > half:
                raise field_error(
                    place,
                    "is not on the palm",
                    f"a number in m, from {-half:g} to {half:g}",
                    f"start.{side}_m",
                )
            angle = math.radians(palm.steep_deg)
            heights.append(place * math.sin(angle) + palm.pivot_offset_m * math.cos(angle))
        width = self.object.width_m
        if abs(heights[1] - heights[0]) > MOST_LEAN * width:
            raise field_error(
                [self.start.left_m, self.start.right_m],
                f"puts the contacts at heights {heights[0]:g} and {heights[1]:g} m, too far apart "
                f"for an object that is {width:g} m wide between them",
                "left_m and right_m at more equal heights",
                "start",
            )


SceneLike: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Scene
"""Whatever `load_scene` accepts as a scene: a built-in name, a TOML file, a table or a `Scene`."""


def _time_limit(distance_m: float, speed_m_s: float, speedup_s: float) -> float:
    """The default time limit [s]: twice the time at the slower speed.

    The second half is at least twice the time in which the robots reach their speed.
    """
    if speed_m_s <= 0:
        return math.inf
    nominal_s = distance_m / speed_m_s
    return nominal_s + max(nominal_s, 2 * speedup_s)


def _other(side: Side) -> Side:
    return "right" if side == "left" else "left"


def load_scene(
    source: "SceneLike",
    overrides: "Overrides" = None,
    *,
    called: str = "overrides:",
    on_warning: "Callable[[str], None] | None" = None,
) -> Scene:
    """The scene of a built-in name, TOML file, table or other scene, with overrides on top.

    Args:
        source: the scene. It must be valid by itself, so that a message blames either it or the
            overrides. A key that is not given has its default, the value in the scene `paper`.
        overrides: keys to set, dotted (``{"radio.loss": 0.1}``), as nested tables, or both; None
            as a value unsets a key. `object` may be the name of an object or a file.
        called: what messages call the overrides.
        on_warning: called with a line for each part of the source that sets nothing.

    Raises:
        SceneError: one line that names file, key, value and what is allowed.
    """
    if isinstance(source, Scene) and overrides is None and on_warning is None:
        return source
    if isinstance(source, Scene):
        scene, data = source, source.model_dump()
    elif isinstance(source, Mapping):
        data = dict(source)
        scene = _validated("scene:", data)
    elif isinstance(source, str | os.PathLike):
        name, data = read_scene(source)
        data = _beside(name, data)
        scene = _validated(f"{name}:", data)
    else:
        raise SceneError(
            f"{show(source)}: is not a scene; allowed: a built-in name, a path, a table or a Scene"
        )
    if on_warning is not None:
        name = "scene" if isinstance(source, Mapping | Scene) else os.fspath(source)
        for line in _empty_parts(data):
            on_warning(f"{name}: {line}")
    if not overrides:
        return scene
    if not isinstance(overrides, Mapping):
        raise SceneError(f"{called} {show(overrides)} is not a table; allowed: {{key: value}}")
    data, changes = with_named_object(data), with_named_object(overrides, called)
    data = without_superseded(data, changes, called)
    return _validated(called, merged(data, changes, called=called))


def _empty_parts(data: Mapping[str, Any]) -> list[str]:
    """A line for each table that sets no key, or one line if no table sets any."""
    empty = [key for key, value in data.items() if isinstance(value, Mapping) and not value]
    if len(empty) == len(data):
        return ["nothing is set; this is the scene paper"]
    return [f"[{key}] sets nothing; it has the values of the scene paper" for key in empty]


def _beside(name: str, data: dict[str, Any]) -> dict[str, Any]:
    """A scene whose files (`object`, `task.path.file`) are looked for beside the scene file."""
    folder = os.path.dirname(name)
    given = data.get("object")
    if isinstance(given, str) and is_object_file(given):
        data["object"] = os.path.join(folder, given)
    task: Any = data.get("task")
    path = task.get("path") if isinstance(task, dict) else None
    if isinstance(path, dict) and isinstance(path.get("file"), str):
        path["file"] = os.path.join(folder, path["file"])
    return data


def _validated(called: str, data: dict[str, Any]) -> Scene:
    try:
        return Scene.model_validate(data)
    except ValidationError as error:
        raise validation_error(called, error, Scene) from None
