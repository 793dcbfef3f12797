# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots controllers`."""

from palmbots._util.command import command
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, JsonOption


@command(
    order=180, example="palmbots controllers", results=("palmbots.cli.answers:ControllerList",)
)
def controllers(as_json: JsonOption = False) -> int:
    """List the controllers, and how much noise they tolerate.

    The option --controller also takes a class of your own, as module:Class or
    FILE.py:Class.
    """
    from palmbots.cli.answers import ControllerList, ListedController
    from palmbots.control.registry import controller_names

    listed = ControllerList(tuple(map(ListedController.of, controller_names())))
    print_result(listed, as_json=as_json)
    return DONE
