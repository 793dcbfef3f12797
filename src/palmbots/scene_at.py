"""A scene with some keys set to other values: dotted keys, and single numbers of lists.

A key is dotted, as in ``--set``; ``object.com_m[0]`` is one number of a list.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from palmbots.errors import SceneError
from palmbots.lowering import refuse_curved
from palmbots.scene import Scene, load_scene

__all__ = ["ENTRY", "scene_at"]

ENTRY = re.compile(r"(.+)\[(\d{1,3})\]")
"""A key of one number of a list: the list's key, and which number."""


def scene_at(base: Scene, keys: Sequence[str], values: Sequence[Any], called: str) -> Scene:
    """The base scene with these keys set to these values.

    Raises `SceneError`, one line that begins with `called`, where that is no scene.
    """
    given = dict(zip(keys, values, strict=True))
    plain = {key: value for key, value in given.items() if not ENTRY.fullmatch(key)}
    names = {found[1] for key in given if (found := ENTRY.fullmatch(key))}
    # A scene is made once, with all keys, where no other key can have changed a list.
    apart = not any(f"{name}.".startswith(f"{key}.") for name in names for key in plain)
    scene = base if names and apart else load_scene(base, plain, called=called)
    entries: dict[str, Any] = {}
    for key, value in given.items():
        indexed = ENTRY.fullmatch(key)
        if indexed is None:
            continue
        name, index = indexed[1], int(indexed[2])
        there = entries.setdefault(name, _looked_up(scene, name))
        if index >= len(there):
            raise SceneError(
                f"{called} {key}: there is no such entry; allowed: an index of a list that the "
                "scene has, as in object.com_m[0]"
            )
        there[index] = value
    if scene is base:
        entries = plain | entries
    done = load_scene(scene, entries, called=called) if entries else scene
    try:
        refuse_curved(done)
    except SceneError as error:
        raise SceneError(f"{called} {error}") from None
    return done


def _looked_up(scene: Scene, name: str) -> list[Any]:
    """A list of the scene; empty where there is none of that name."""
    table: Any = scene.model_dump()
    for part in name.split("."):
        table = table.get(part) if isinstance(table, Mapping) else None
    return list(table) if isinstance(table, list | tuple) else []
