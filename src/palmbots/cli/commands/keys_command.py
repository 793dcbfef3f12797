# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots keys`."""

import fnmatch
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.scene.key_reference import SceneKey


@command(order=170, example="palmbots keys radio", results=("palmbots.cli.answers:KeyList",))
def keys(
    pattern: Annotated[
        str,
        typer.Argument(metavar="PATTERN", help="Part of a key, or a pattern such as 'radio.*_s'."),
    ] = "",
    as_json: JsonOption = False,
) -> int:
    """List the scene keys with default, unit and meaning.

    palm.left.KEY, palm.right.KEY, robot.left.KEY and robot.right.KEY override one side.
    """
    from palmbots.cli.answers import KeyList
    from palmbots.scene.key_reference import scene_keys

    print_result(KeyList(tuple(_matching(scene_keys(), pattern))), as_json=as_json)
    return DONE


def _matching(keys: Sequence["SceneKey"], pattern: str) -> list["SceneKey"]:
    """The keys that contain a text or match a pattern.

    Raises:
        PalmbotsError: there is none.
    """
    from palmbots._util.arguments import show

    text = pattern.lower()
    if any(sign in text for sign in "*?["):
        found = [key for key in keys if fnmatch.fnmatchcase(key.name, text)]
    else:
        found = [key for key in keys if text in key.name]
    if not found:
        sections = sorted({key.name.partition(".")[0] for key in keys})
        raise PalmbotsError(
            f"PATTERN: value is {show(pattern)}, which matches no key; sections: "
            f"{', '.join(sections)}"
        )
    return found
