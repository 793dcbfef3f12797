# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots controllers`."""

from palmbots.cli._run import print_list
from palmbots.cli.options import DONE, JsonOption

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 180
EXAMPLE = "palmbots controllers"


def controllers(as_json: JsonOption = False) -> int:
    """List the controllers.

    The option --controller also takes a class of your own, as module:Class or
    FILE.py:Class.
    """
    from palmbots.control.registry import controller_names, describe

    print_list(
        "controllers",
        {name: describe(name).description for name in controller_names()},
        as_json=as_json,
    )
    return DONE


COMMAND = controllers
