# SPDX-License-Identifier: Apache-2.0
"""A scene with some keys set to other values: dotted keys, and single numbers of lists.

A key is dotted, as in ``--set``; ``object.com_m[0]`` is one number of a list.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

from palmbots.errors import SceneError
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import refuse_curved, to_spec

ENTRY = re.compile(r"(.+)\[(\d{1,3})\]")
"""Pattern of a key of one number of a list: the key of the list, and the index."""


def with_values(
    base: Scene, keys: Sequence[str], values: Sequence[Any], called: str, *, curved: bool = False
) -> Scene:
    """The base scene with these keys set to these values.

    Raises `SceneError`, one line that begins with `called`, where the result is not a valid scene,
    or its path is curved and `curved` is not set.
    """
    given = dict(zip(keys, values, strict=True))
    plain = {key: value for key, value in given.items() if not ENTRY.fullmatch(key)}
    names = {match[1] for key in given if (match := ENTRY.fullmatch(key))}
    # Where no plain key changes a list with entries, the scene is validated only once.
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
    if "object.vertices_m" in entries:  # one vertex is moved: the other keys stay as they are
        kept = {key: getattr(scene.object, key) for key in _KEPT}
        entries = {f"object.{key}": value for key, value in kept.items()} | entries
    varied = load_scene(scene, entries, called=called) if entries else scene
    try:
        if not curved:
            refuse_curved(varied)
    except SceneError as error:
        raise SceneError(f"{called} {error}") from None
    return varied


def have_equal_carries(scenes: Sequence[Scene]) -> bool:
    """Whether the carries of all these scenes are the same in a world that runs their `Spec`."""
    return len({to_spec(scene).to_bytes() for scene in scenes}) == 1


def without_effect(called: str, key: str, world: str) -> SceneError:
    """The error for a key that is varied although no carry in this world depends on it."""
    return SceneError(
        f"{called} {key}: no carry of this scene in the {world} world depends on it; "
        "allowed: other keys, or a world in which carries depend on it"
    )


_KEPT = ("edge_radius_m", "contacts", "com_m", "mass_kg")


def _looked_up(scene: Scene, name: str) -> list[Any]:
    """The list with this key; empty where the scene has no such list."""
    table: Any = scene.model_dump()
    for part in name.split("."):
        table = table.get(part) if isinstance(table, Mapping) else None
    return list(table) if isinstance(table, list | tuple) else []
