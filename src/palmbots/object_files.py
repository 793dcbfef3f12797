"""Objects that come with the package, by name: `object = "tray"` in a scene stands for the table.

Each is the section `object` of a scene, complete, in a file of its own that says where its numbers
are from. A name is replaced by its table as early as can be, so that nothing else in the package,
no dump and no log ever sees one.
"""

import difflib
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from typing import Any

from palmbots.quantities import fault

__all__ = ["by_name", "objects", "with_named_object"]


@cache
def _tables() -> dict[str, dict[str, Any]]:
    folder = resources.files("palmbots") / "objects"
    files = {f.name.removesuffix(".toml"): f for f in folder.iterdir() if f.name.endswith(".toml")}
    return {name: tomllib.loads(files[name].read_text("utf-8"))["object"] for name in sorted(files)}


def objects() -> list[str]:
    """The names of the objects that come with the package, sorted."""
    return list(_tables())


def by_name(given: object) -> object:
    """The complete section `object` for a name, what is no string as it is.

    Raises the fault of a scene where there is no such object.
    """
    if not isinstance(given, str):
        return given
    known = objects()
    if given not in known:
        near = difflib.get_close_matches(given, known, n=1)
        hint = f" (did you mean {near[0]}?)" if near else ""
        raise fault(given, f"is no object{hint}", f"{', '.join(known)}, or a table")
    return dict(_tables()[given])


def with_named_object(data: Mapping[str, Any]) -> dict[str, Any]:
    """A scene or overrides with the name of an object replaced by its table.

    The table comes first, so that keys given beside the name are set in it. What is no known name
    comes last, for the scene to complain about it and nothing else.
    """
    name = data.get("object")
    if not isinstance(name, str):
        return dict(data)
    rest = {key: value for key, value in data.items() if key != "object"}
    return {"object": by_name(name)} | rest if name in objects() else rest | {"object": name}
