# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots scenes`."""

from palmbots.cli._run import print_list
from palmbots.cli.options import DONE, JsonOption

ORDER = 150
EXAMPLE = "palmbots scenes"


def scenes(as_json: JsonOption = False) -> int:
    """List the built-in scenes.

    Start a scene of your own with palmbots init scene FILE.
    """
    from palmbots.scene.key_reference import built_in_meanings

    print_list("scenes", built_in_meanings("scenes"), as_json=as_json)
    return DONE


COMMAND = scenes
