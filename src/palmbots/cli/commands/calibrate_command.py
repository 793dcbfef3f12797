# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots calibrate`."""

from palmbots._types import Side
from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE
from palmbots.cli._run import print_result, warn
from palmbots.errors import PalmbotsError


@command(
    order=207,
    example="palmbots calibrate pair.toml --side left",
    results=("palmbots.pair.calibration_run:CalibrationRun",),
    only=Option(metavar="STEPS"),
    length=Option(metavar="M", least=0.3, most=10.0),
    rate=Option(
        help="Run a simulated robot at this multiple of real time.", least=0.01, most=100.0
    ),
)
def calibrate(
    pair: str,
    side: Side,
    only: str = "",
    *,
    length: float = 1.5,
    rate: float = 1.0,
    as_json: bool = False,
) -> int:
    """Measure the hardware of one robot; writes pair.toml.

    It asks for one thing at a time. You need a tape measure, a protractor and a thin rod. The
    robot's program must not run. pair.toml is written at the end; it keeps its comments, and a copy
    of the former file is kept beside it.

    Args:
        only: run only these of the steps dead-zone,wheels,stopping,palm,arm,switches.
        length: length of the drive along the tape.
    """
    import sys

    from palmbots.cli.terminal_person import TerminalPerson
    from palmbots.pair.calibration_run import run_calibration, steps_of
    from palmbots.pair.pair_file import load_pair

    steps = steps_of(only)
    found = load_pair(pair)
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise PalmbotsError(
            "calibrate: needs a terminal, at which a person reads instructions and types what "
            "tape, protractor and rod say; allowed: stdin and stderr that are a terminal "
            "(--json changes only stdout)"
        )
    run = run_calibration(found, side, TerminalPerson(), steps=steps, length_m=length, rate=rate)
    for line in run.warnings:
        warn(line)
    print_result(run, as_json=as_json)
    return DONE
