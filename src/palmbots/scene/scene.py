# SPDX-License-Identifier: Apache-2.0
"""A scene: everything that a carry depends on except controller, seed, world and precision.

`load_scene` reads the name of a built-in scene, a TOML file, a table or a scene, and sets overrides
on top. It returns a valid `Scene` or raises `SceneError` with one line. The keys with their
meanings, units, limits and defaults stand in the modules `*_section`, one for each topic.
"""

import os
import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Self, TypeAlias

from pydantic import BeforeValidator, PrivateAttr, ValidationError, model_validator

import palmbots._core as _core
from palmbots._types import SIDES, Overrides, Side
from palmbots._util.arguments import show, with_lists
from palmbots._util.toml_writer import toml_text
from palmbots.errors import SceneError
from palmbots.scene.error_messages import validation_error
from palmbots.scene.faults_section import Faults
from palmbots.scene.fields import field_error
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.files import built_in_scenes, read_scene
from palmbots.scene.mujoco_section import MujocoParameters
from palmbots.scene.object_library import by_name, is_object_file, with_named_object
from palmbots.scene.object_section import Object
from palmbots.scene.overrides import HOLDERS, merged, refuse_without_effect, without_superseded
from palmbots.scene.palm_section import Palm, PalmParameters
from palmbots.scene.radio_section import Radio
from palmbots.scene.robot_section import Arm, Control, Robot, RobotParameters, Tactile
from palmbots.scene.section import Section, as_given, plain
from palmbots.scene.task_section import Bumps, Floor, Start, Task, World

_STEP = re.compile(r"(\w+)|\[(\d+)\]")


class Scene(Section):
    """A complete, valid scene; `Scene()` is the built-in scene `paper`. Immutable.

    `model_dump()` returns it as a table without the keys that are not set; `load_scene` reads such
    a table. To change a key: ``load_scene(scene, {"radio.loss": 0.1})``.
    """

    object: Annotated[Object, BeforeValidator(by_name)] = Object()
    """A table, the name of an object of the package, or a TOML file with the table [object]."""
    palm: Palm = Palm()
    robot: Robot = Robot()
    arm: Arm = Arm()
    tactile: Tactile = Tactile()
    control: Control = Control()
    radio: Radio = Radio()
    faults: Faults = Faults()
    bumps: Bumps = Bumps()
    start: Start = Start()
    floor: Floor = Floor()
    world: World = World()
    task: Task = Task()
    mujoco: MujocoParameters = MujocoParameters()
    _spelled: str = PrivateAttr("SCENE")

    @property
    def spelled(self) -> str:
        """How a command line names it, for commands in reports; SCENE if it is not known."""
        return self._spelled

    def spell(self, words: str) -> None:
        """Remember how a command line names it."""
        self._spelled = words

    @property
    def working_sides(self) -> tuple[Side, ...]:
        """The robots that work: both, or the one that does a job on the floor alone."""
        if self.task.dock != "alone" or self.task.ends == ("palms", "palms"):
            return SIDES
        return SIDES[1:] if self.task.direction == "forward" else SIDES[:1]

    def palm_of(self, side: Side) -> PalmParameters:
        """The palm of one side: `palm` with the overrides of `palm.left` or `palm.right`.

        A palm with lips is as wide as the lips require. If a palm has a heel and `usable_m` is not
        set, its usable part is the part on which the heel cannot touch the object.
        """
        palm = self.palm.of(side)
        update: dict[str, float] = {}
        if palm.lip_height_m > 0:
            update["width_m"] = self.object.depth_m + 2 * palm.lip_clearance_m
        if palm.heel_m > 0 and palm.usable_m is None:
            update["usable_m"] = _core.spec_of_scene(as_given(self)).palms[SIDES.index(side)].usable
        return palm.model_copy(update=update) if update else palm

    def robot_of(self, side: Side) -> RobotParameters:
        """The robot of one side: `robot` with the overrides of `robot.left` or `robot.right`."""
        return self.robot.of(side)

    @property
    def timeout_s(self) -> float:
        """The time limit of the carry [s]: `task.timeout_s`, or the default."""
        return _core.time_limit(as_given(self))

    def mirrored(self) -> "Scene":
        """The mirror image: left and right exchanged, the direction of travel reversed.

        A slope keeps its sign, because uphill is defined in the direction of travel.
        """
        table = self.model_dump()
        item, task = table["object"], table["task"]
        item["vertices_m"] = tuple((0.0 - x, y) for x, y in item["vertices_m"])
        item["com_m"] = (0.0 - item["com_m"][0], item["com_m"][1])
        item["contacts"] = item["contacts"][::-1]
        for section in HOLDERS:
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
        task["route"] = self.task.route.mirrored().model_dump()
        return Scene.model_validate(table)

    def to_toml(self) -> str:
        """The scene as the text of a scene file."""
        return toml_text(self.model_dump())

    @model_validator(mode="after")
    def _check(self) -> Self:
        for key, value, problem, allowed in _core.check_scene(as_given(self)):
            shown = value[0] if len(value) == 1 else value or self._value_of(key)
            raise field_error(shown, problem, allowed, key)
        self._check_path()
        return self

    def _value_of(self, key: str) -> Any:
        """The value of a key as given, or its default."""
        value: Any = self
        for name, index in _STEP.findall(key):
            value = getattr(value, name) if name else value[int(index)]
        return plain(value)

    def _check_path(self) -> None:
        """Refuse a radius smaller than the robots' distance, and a route beside a curved path or
        from palms; `path_curve` and `route_planner` check the rest."""
        task, least = self.task, self.object.width_m
        radii = {"path": task.path.radius_m}
        if task.route.is_set:
            radii["route"] = task.route.radius_m
            for key in ("from", "to"):
                if (place := getattr(task, key)) != "floor":
                    problem = "is not the floor, but a route (task.route) leads from floor to floor"
                    raise field_error(place, problem, "floor", f"task.{key}")
            if task.path.is_curved:
                problem = "is a path beside a route (task.route), which has curves of its own"
                raise field_error(task.path.kind, problem, "straight", "task.path.kind")
        for section, radius in radii.items():
            if radius is not None and radius < least:
                raise field_error(
                    radius,
                    f"is too tight for robots {least:g} m apart",
                    f"a number in m, from {least:g} to 10000",
                    f"task.{section}.radius_m",
                )


SceneLike: TypeAlias = str | os.PathLike[str] | Mapping[str, Any] | Scene
"""Whatever `load_scene` accepts as a scene: a built-in name, a TOML file, a table or a `Scene`."""


def _other(side: Side) -> Side:
    return "right" if side == "left" else "left"


SCENE_FILE = FileKind(
    "a scene file",
    "palmbots carry, up and world",
    "palmbots scenes lists those built in, palmbots init scene FILE writes one",
    keys=Scene.model_fields,
    names=built_in_scenes,
)


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
        data = beside(name, data)
        scene = _validated(f"{name}:", data)
    else:
        raise SceneError(
            f"{show(source)}: is not a scene; allowed: a built-in name, a path, a table or a Scene"
        )
    if on_warning is not None:
        name = "scene" if isinstance(source, Mapping | Scene) else os.fspath(source)
        for line in _lines_of_empty(data):
            on_warning(f"{name}: {line}")
    if not overrides:
        return scene
    if not isinstance(overrides, Mapping):
        raise SceneError(f"{called} {show(overrides)} is not a table; allowed: {{key: value}}")
    data, changes = with_named_object(data), with_named_object(overrides, called)
    data = without_superseded(data, changes, called)
    changed = _validated(called, merged(data, changes, called=called))
    refuse_without_effect(changed, changes, called)
    return changed


def empty_tables(data: Mapping[str, Any]) -> list[str]:
    """The tables that set no key."""
    return [key for key, value in data.items() if isinstance(value, Mapping) and not value]


def _lines_of_empty(data: Mapping[str, Any]) -> list[str]:
    """A line for each table that sets no key, or one line if no table sets any."""
    empty = empty_tables(data)
    if len(empty) == len(data):
        return ["nothing is set; this is the scene paper"]
    return [f"[{key}] sets nothing; it has the values of the scene paper" for key in empty]


FILES = (
    ("task", "path", "file"),
    ("robot", "error_trace"),
    *(("robot", side, "error_trace") for side in SIDES),
    ("radio", "trace"),
)
"""The keys whose values are names of files, besides `object`."""


def beside(name: str, data: dict[str, Any]) -> dict[str, Any]:
    """A scene, or a part of one, whose files are looked for beside the file `name`."""
    folder = os.path.dirname(name)
    given = data.get("object")
    if isinstance(given, str) and is_object_file(given):
        data["object"] = os.path.join(folder, os.path.expanduser(given))
    for *tables, key in FILES:
        table: Any = data
        for step in tables:
            table = table.get(step) if isinstance(table, dict) else None
        if isinstance(table, dict) and isinstance(table.get(key), str):
            table[key] = os.path.join(folder, os.path.expanduser(table[key]))
    return data


def _validated(called: str, data: dict[str, Any]) -> Scene:
    try:
        return Scene.model_validate(with_lists(data))
    except ValidationError as error:
        raise validation_error(called, error, Scene) from None
