# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots scenes`."""

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption


@command(order=150, example="palmbots scenes", results=("palmbots.cli.answers:SceneList",))
def scenes(as_json: JsonOption = False) -> int:
    """List the built-in scenes.

    Start a scene of your own with palmbots init scene FILE.
    """
    from palmbots.cli.answers import SceneList
    from palmbots.scene.key_reference import built_in_meanings

    print_result(SceneList.of(built_in_meanings("scenes")), as_json=as_json)
    return DONE
