# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots replay`."""

from pathlib import Path
from typing import Annotated

from palmbots._util.command import command
from palmbots.cli._run import check_output, print_result
from palmbots.cli._warnings import warn
from palmbots.cli.options import DONE, FAILED, JsonOption, input_argument, output_option
from palmbots.errors import PalmbotsError


@command(
    order=130,
    example="palmbots replay out/carry.mcap",
    results=("palmbots.logs.replaying:ReplayResult", "palmbots.views.run_replay:RunReplay"),
)
def replay(
    logs: Annotated[list[Path], input_argument("LOG...", "MCAP logs, or folders with them.")],
    out: Annotated[
        Path | None, output_option("Write figures of a run of real robots to this folder.")
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Run a logged carry again and compare every bit.

    Logs of robots and of a station are verified: each robot's program gets what it had logged, and
    has to decide the same. Their clocks are aligned by the packets that they exchanged.

    Exit status 1: something differs from the log.
    """
    from palmbots.logs.run_log_reader import is_run_log

    if len(logs) == 1 and not logs[0].is_dir() and not is_run_log(logs[0]):
        if out is not None:
            raise PalmbotsError("--out: draws runs of robots; allowed: for logs of robots")
        return _replay_carry(logs[0], as_json=as_json)
    from palmbots.views.run_replay import read_run, replay_run

    check_output(out)
    run = read_run(logs)
    result = replay_run(run)
    written: list[Path] = []
    if out is not None:
        from palmbots.views.run_figures import save_figures

        try:
            written = save_figures(run, result, out)
        except PalmbotsError as error:  # what was verified counts all the same
            warn(f"no figures: {error}")
    print_result(result, as_json=as_json, written=written)
    return DONE if result.identical else FAILED


def _replay_carry(log: Path, *, as_json: bool) -> int:
    from palmbots.logs.replaying import replay as run_again

    result = run_again(log)
    print_result(result, as_json=as_json, about=str(log))
    return DONE if result.identical else FAILED
