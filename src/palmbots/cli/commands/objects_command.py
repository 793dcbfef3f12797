# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots objects`."""

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption


@command(order=160, example="palmbots objects", results=("palmbots.cli.answers:ObjectList",))
def objects(as_json: JsonOption = False) -> int:
    """List the built-in objects.

    Use one with --set object=NAME, or object = "NAME" in a scene file.
    """
    from palmbots.cli.answers import ObjectList
    from palmbots.scene.key_reference import built_in_meanings

    print_result(ObjectList.of(built_in_meanings("objects")), as_json=as_json)
    return DONE
