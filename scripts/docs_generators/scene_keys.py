# SPDX-License-Identifier: Apache-2.0
"""The table of scene keys, from the list that `palmbots keys` prints."""

from palmbots._util.arguments import show
from palmbots.scene.key_reference import scene_keys


def blocks() -> dict[str, str]:
    """The generated parts of the page, by the name of their markers."""
    return {"scene keys": table()}


def table() -> str:
    """Every key with its default, limits and meaning, as Markdown."""
    rows = ["| key | default | allowed | meaning |", "|---|---|---|---|"]
    for key in scene_keys():
        default = "not set" if key.default is None else f"`{show(key.default)}`"
        rows.append(f"| `{key.name}` | {default} | {key.allowed} | {key.meaning} |")
    return "\n".join(rows)
