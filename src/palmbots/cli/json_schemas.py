# SPDX-License-Identifier: Apache-2.0
"""JSON Schemas (draft 2020-12) of a scene, of a log, and of what commands print with `--json`."""

import json
from collections.abc import Mapping
from importlib import import_module
from typing import Any

from palmbots.cli.analysis_json_shapes import ANALYSIS_SHAPES
from palmbots.cli.json_shapes import JSON_SHAPES
from palmbots.cli.robot_json_shapes import ROBOT_SHAPES

_SHAPES: dict[str, Any] = JSON_SHAPES | ANALYSIS_SHAPES | ROBOT_SHAPES
_DIALECT = "https://json-schema.org/draft/2020-12/schema"
_WORDS: dict[str, dict[str, Any]] = {
    "any": {},
    "text": {"type": "string"},
    "number": {"type": "number"},
    "whole": {"type": "integer"},
    "boolean": {"type": "boolean"},
    "pair": {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2},
    "scene": {"$ref": "#/$defs/Scene"},
}


def schema_names() -> list[str]:
    """What there are schemas of: ``scene``, ``log``, and the names of commands."""
    from palmbots.cli.main import command_names

    return ["scene", "log", *command_names()]


def schema_of(name: str) -> dict[str, Any]:
    """The schema of a scene, of the records of a log, or of what a command prints with `--json`.

    Raises:
        PalmbotsError: there is no schema of that name.
    """
    from palmbots._util.arguments import one_of
    from palmbots.cli.main import command_module

    one_of("NAME", name, tuple(schema_names()))
    if name == "scene":
        from palmbots.scene.scene_schema import scene_schema

        return scene_schema()
    if name == "log":
        from palmbots.logs.log_schema import log_schema
        from palmbots.mujoco.trace_columns import COLUMNS

        return log_schema(COLUMNS)
    title = {"$schema": _DIALECT, "title": f"What palmbots {name} --json prints"}
    if name in _SHAPES:
        return title | _schema(_SHAPES[name]) | _definitions(_SHAPES[name])
    from palmbots._util.result_schema import result_schema

    places = (place.partition(":") for place in command_module(name).RESULTS)
    kinds = [getattr(import_module(module), kind) for module, _, kind in places]
    return title | with_scene(result_schema(*kinds))


def with_scene(schema: dict[str, Any]) -> dict[str, Any]:
    """The schema of a result with the definition of a scene, where it refers to one."""
    if "#/$defs/Scene" not in json.dumps(schema):
        return schema
    from palmbots.scene.scene_schema import scene_schema

    scene = scene_schema()
    tables = scene.pop("$defs")
    del scene["$schema"]
    return schema | {"$defs": schema.get("$defs", {}) | {"Scene": scene} | tables}


def _schema(shape: Any) -> dict[str, Any]:
    if shape is None:
        return {"type": "null"}
    if isinstance(shape, str):
        word = _WORDS[shape.removesuffix("?")]
        return {"anyOf": [word, {"type": "null"}]} if shape.endswith("?") else dict(word)
    if isinstance(shape, tuple):
        return {"anyOf": [_schema(one) for one in shape]}
    if isinstance(shape, list):
        return {"type": "array", "items": _schema(shape[0])}
    keys = {key: inner for key, inner in shape.items() if key != "*"}
    schema: dict[str, Any] = {
        "type": "object",
        "properties": {key.removesuffix("?"): _schema(inner) for key, inner in keys.items()},
        "additionalProperties": _schema(shape["*"]) if "*" in shape else False,
    }
    required = [key for key in keys if not key.endswith("?")]
    return schema | ({"required": required} if required else {})


def _definitions(shape: Any) -> dict[str, Any]:
    """The schema of a scene, with those of its tables, where the shape has a scene in it."""
    if not _has_scene(shape):
        return {}
    from palmbots.scene.scene_schema import scene_schema

    scene = scene_schema()
    tables = scene.pop("$defs")
    del scene["$schema"]
    return {"$defs": {"Scene": scene} | tables}


def _has_scene(shape: Any) -> bool:
    if isinstance(shape, str):
        return shape.startswith("scene")
    if isinstance(shape, Mapping):
        return any(map(_has_scene, shape.values()))
    return shape is not None and any(map(_has_scene, shape))
