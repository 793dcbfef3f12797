# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots replay`."""

from pathlib import Path
from typing import Annotated

from palmbots.cli._run import present
from palmbots.cli.options import DONE, FAILED, JsonOption, input_argument

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 130
EXAMPLE = "palmbots replay out/carry.mcap"


def replay(
    log: Annotated[Path, input_argument("LOG", "MCAP log of a carry.")],
    as_json: JsonOption = False,
) -> int:
    """Run a logged carry again and compare every bit.

    Exit status 1: the new run differs from the log.
    """
    from palmbots.cli.reports.carry_report import replay_report
    from palmbots.logs.replaying import replay as run_again

    result = run_again(log)
    present(result, lambda found, _: replay_report(found, log), as_json=as_json)
    return DONE if result.identical else FAILED


COMMAND = replay
