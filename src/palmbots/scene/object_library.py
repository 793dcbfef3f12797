# SPDX-License-Identifier: Apache-2.0
"""Objects by name or file: `object = "tray"` in a scene stands for the table `object`.

Each object of the package is a complete section `object` in a file of its own, which states where
its numbers are from. A user's file `object = "crate.toml"` has the same form. Names and files are
replaced by their tables when a scene is read, so that no dump and no log contains one.
"""

import difflib
import os
import shlex
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from palmbots.errors import SceneError
from palmbots.scene.command_text import command_text
from palmbots.scene.error_messages import validation_message
from palmbots.scene.fields import field_error
from palmbots.scene.file_kinds import FileKind
from palmbots.scene.files import read_table
from palmbots.scene.object_section import Object
from palmbots.scene.overrides import without_superseded

IMPORTED = (".svg", ".dxf", ".stl", ".obj", ".gltf", ".glb")
"""Suffixes of the drawings and meshes of which `palmbots.import_object` makes an object."""
DRAWING = FileKind(
    "a drawing or mesh", "palmbots import", "as other programs write it", suffixes=IMPORTED
)


@cache
def _tables() -> dict[str, dict[str, Any]]:
    folder = resources.files("palmbots.scene") / "data" / "objects"
    files = {f.name.removesuffix(".toml"): f for f in folder.iterdir() if f.name.endswith(".toml")}
    return {name: tomllib.loads(files[name].read_text("utf-8"))["object"] for name in sorted(files)}


def object_names() -> list[str]:
    """The names of the objects that come with the package, sorted."""
    return list(_tables())


OBJECT_FILE = FileKind(
    "an object file",
    "object = FILE in a scene",
    "palmbots import writes one",
    keys=("object",),
    names=object_names,
)


def is_object_file(name: str) -> bool:
    """Whether a text names a file rather than an object of the package."""
    return name not in object_names() and (name.endswith(".toml") or os.sep in name)


def by_name(given: object) -> object:
    """The complete section `object` for a name or a file; what is no string as it is.

    Raises the fault of a scene where there is no such object.
    """
    if not isinstance(given, str):
        return given
    known = object_names()
    if given not in known and (suffix := os.path.splitext(given)[1]) not in ("", ".toml"):
        made = "in which vertices_m is the outline"
        if suffix.lower() in IMPORTED:
            made = f"as {command_text('import', shlex.quote(given))} makes it"
        raise field_error(
            given, f"is a {suffix} file", f"a TOML file with the table [object], {made}"
        )
    if is_object_file(given):
        return _from_file(given)
    if given not in known:
        near = difflib.get_close_matches(given, known, n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        raise field_error(
            given, f"is not a known object{hint}", f"{', '.join(known)}, a file or a table"
        )
    return dict(_tables()[given])


def _from_file(name: str) -> dict[str, Any]:
    """The complete section `object` of a file that holds this section alone."""
    allowed = "a TOML file with the table [object] alone"
    try:
        table = read_table(name, OBJECT_FILE)
    except SceneError as error:
        problem = str(error).removeprefix(f"{name}: ").partition("; allowed: ")[0]
        raise field_error(name, f"cannot be used: {problem}", allowed) from None
    if list(table) != ["object"] or not isinstance(table["object"], dict):
        raise field_error(name, "contains something else", allowed)
    try:
        return Object.model_validate(table["object"]).model_dump()
    except ValidationError as error:
        problem = validation_message(error, Object)
        raise field_error(name, f"cannot be used: object.{problem}", allowed) from None


def with_named_object(data: Mapping[str, Any], called: str = "") -> dict[str, Any]:
    """A scene or overrides with the name or file of an object replaced by its table.

    The table comes first, so that keys given beside the name are set in it. An unknown name comes
    last, so that the scene reports that fault first.
    """
    name = data.get("object")
    if not isinstance(name, str):
        return dict(data)
    rest = {key: value for key, value in data.items() if key != "object"}
    try:
        table = by_name(name)
    except PydanticCustomError:
        return rest | {"object": name}
    return without_superseded({"object": table}, rest, called) | rest
