# SPDX-License-Identifier: Apache-2.0
"""JSON Schemas (draft 2020-12) of a scene, of a log, and of what commands print with `--json`."""

import json
from typing import Any

from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE
from palmbots.cli._run import print_json
from palmbots.cli.declared_commands import commands_of, declared_commands, results_of

_DIALECT = "https://json-schema.org/draft/2020-12/schema"


@command(
    order=180,
    example="palmbots schema scene",
    results=("palmbots.cli.answers:SchemaTable",),
    name=Option(is_argument=True),
)
def schema(name: str, *, as_json: bool = False) -> int:
    """Print the JSON Schema of scenes, logs or --json.

    The schemas have the form of draft 2020-12. --json prints the same in one line.

    Args:
        name: ``scene``, log, or a command that has --json.
        as_json: in one line.
    """
    found = schema_of(name)
    if as_json:
        print_json(found)
    else:
        print(json.dumps(found, indent=2, ensure_ascii=False))
    return DONE


def schema_names() -> list[str]:
    """What there are schemas of: ``scene``, ``log``, and the names of commands."""
    return ["scene", "log", *sorted(declared_commands())]


def schema_of(name: str) -> dict[str, Any]:
    """The schema of a scene, of the records of a log, or of what a command prints with `--json`.

    Raises:
        PalmbotsError: there is no schema of that name.
    """
    from palmbots._util.arguments import one_of

    one_of("NAME", name, tuple(schema_names()))
    if name == "scene":
        from palmbots.scene.scene_schema import scene_schema

        return scene_schema()
    if name == "log":
        from palmbots.logs.log_schema import log_schema
        from palmbots.mujoco.trace_columns import COLUMNS

        return log_schema(COLUMNS)
    title = {"$schema": _DIALECT, "title": f"What palmbots {name} --json prints"}
    from palmbots._util.result_schema import result_schema

    kinds = dict.fromkeys(kind for one in commands_of(name) for kind in results_of(one))
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
