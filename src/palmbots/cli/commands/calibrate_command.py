# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots calibrate`."""

from typing import Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._run import check_rate, print_result, warn
from palmbots.cli.options import DONE, JsonOption
from palmbots.errors import PalmbotsError


@command(
    order=207,
    example="palmbots calibrate pair.toml --side left",
    results=("palmbots.pair.calibration_run:CalibrationRun",),
)
def calibrate(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    side: Annotated[str, typer.Option("--side", metavar="SIDE", help="left or right.")],
    only: Annotated[
        str,
        typer.Option(
            "--only",
            metavar="STEPS",
            help="Only these of: dead-zone,wheels,stopping,palm,switches.",
        ),
    ] = "",
    length: Annotated[
        float, typer.Option("--length", metavar="M", help="Length of the drive along the tape.")
    ] = 1.5,
    rate: Annotated[float, typer.Option("--rate", help="Of a simulated robot.")] = 1.0,
    as_json: JsonOption = False,
) -> int:
    """Measure the hardware of one robot; writes pair.toml.

    It asks for one thing at a time. You need a tape measure, a protractor and a thin rod. The
    robot's program must not run. pair.toml keeps its comments; it is written at the end, and what
    it was before is kept beside it.
    """
    import sys

    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.cli.terminal_person import TerminalPerson
    from palmbots.pair.calibration_run import run_calibration, steps_of
    from palmbots.pair.pair_file import load_pair

    one_of("--side", side, SIDES)
    steps = steps_of(only)
    if not 0.3 <= length <= 10:
        raise PalmbotsError(
            f"--length: value is {length:g}; allowed: a number in m, from 0.3 to 10"
        )
    chosen: Any = side
    found = load_pair(pair)
    check_rate(rate)
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise PalmbotsError(
            "calibrate: needs a terminal, at which a person reads instructions and types what "
            "tape, protractor and rod say; allowed: stdin and stderr that are a terminal "
            "(--json changes only stdout)"
        )
    run = run_calibration(found, chosen, TerminalPerson(), steps=steps, length_m=length, rate=rate)
    for line in run.warnings:
        warn(line)
    print_result(run, as_json=as_json)
    return DONE
