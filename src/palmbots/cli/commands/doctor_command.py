# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots doctor`."""

import contextlib
import time
from typing import TYPE_CHECKING, Annotated, Any

import typer

from palmbots._util.command import command
from palmbots.cli._progress import progress
from palmbots.cli._run import print_result
from palmbots.cli.options import DONE, FAILED, JsonOption
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.pair.checkup import Check
    from palmbots.pair.pair_file import Pair
    from palmbots.scene.scene import Scene

_CLOCK_S = 3.0


@command(
    order=208, example="palmbots doctor pair.toml", results=("palmbots.pair.diagnosis:Diagnosis",)
)
def doctor(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    seconds: Annotated[float, typer.Option("--seconds", help="How long to measure.")] = 30.0,
    side: Annotated[
        str,
        typer.Option(
            "--side", metavar="SIDE", help="Check this robot's own driver. Its palm moves."
        ),
    ] = "",
    as_json: JsonOption = False,
) -> int:
    """Check a pair: radio, clocks, drivers, key and battery.

    Run it in place of the station while the programs of both robots run. It measures losses and
    round trips, and reports the lease that they need and the controllers that they suffice for.
    It never moves a robot. With --side, run it on a robot in place of its program: it checks the
    driver, and turns the palm to both of its angles. The wheels do not turn.

    Exit status 1: something is wrong. A line says what to do.
    """
    from palmbots.pair.checkup import checks_of_status
    from palmbots.pair.diagnosis import Diagnosis
    from palmbots.pair.link_check import PERIOD_S, measure, needs_of
    from palmbots.pair.live_ends import open_pair_link
    from palmbots.pair.pair_file import load_pair
    from palmbots.pair.stored_state import booted
    from palmbots.robot.robot_program import controller_of
    from palmbots.scene.scene import load_scene

    if not 1 <= seconds <= 3600:
        raise PalmbotsError(f"--seconds: value is {seconds:g}; allowed: a number from 1 to 3600")
    chosen = load_pair(pair)
    scene = load_scene(chosen.scene())
    if side:
        return _check_robot(chosen, scene, side, as_json=as_json)
    own = _check_clock(scene, min(seconds, _CLOCK_S), as_json=as_json)
    verdicts: dict[Any, int] = {}
    controller = controller_of(chosen).name
    with (
        booted(chosen.state_file("station")) as state,
        contextlib.closing(open_pair_link(chosen, "station")) as link,
        progress("measuring the radio", as_json) as report,
    ):
        start_s = time.monotonic()

        def wait() -> None:
            report(min(1.0, (time.monotonic() - start_s) / seconds))
            time.sleep(PERIOD_S)

        figures = measure(chosen, link, state.epoch, seconds, time.monotonic, wait, verdicts)
    checks = [own, *checks_of_status(chosen, scene, figures, verdicts)]
    heard = {side: one for side, one in figures.items() if one.received}
    needs = None
    if heard:
        delay_s = max(one.delay_s for one in heard.values() if one.round_trips_s)
        needs = needs_of(scene, delay_s, max(one.loss for one in heard.values()))
    suffices = needs is not None and needs.verdicts.get(controller, "suffices") == "suffices"
    is_well = len(heard) == 2 and suffices and all(check.is_well for check in checks)
    found = Diagnosis(is_well, tuple(checks), controller, figures, needs)
    print_result(found, as_json=as_json)
    return DONE if is_well else FAILED


def _check_clock(scene: "Scene", seconds: float, *, as_json: bool) -> "Check":
    from palmbots.pair.checkup import check_own_clock

    with progress("measuring the clock", as_json) as report:
        return check_own_clock(scene.control.period_s, seconds, report=report)


def _check_robot(pair: "Pair", scene: "Scene", side: str, *, as_json: bool) -> int:
    """The checks on the robot itself."""
    from palmbots._types import SIDES
    from palmbots._util.arguments import one_of
    from palmbots.links.local_connection import ConnectionLost
    from palmbots.pair.checkup import Check, check_driver
    from palmbots.pair.diagnosis import Diagnosis
    from palmbots.pair.robot_driver import opened_driver

    one_of("--side", side, SIDES)
    chosen: Any = side
    checks = [_check_clock(scene, _CLOCK_S, as_json=as_json)]
    try:
        with opened_driver(pair, chosen, scene) as driver:
            checks += check_driver(driver, chosen, scene, pair.settings.hardware.of(chosen))
    except ConnectionLost as error:
        checks.append(
            Check("driver", side, False, str(error), "start the world, or the motor board")
        )
    is_well = all(check.is_well for check in checks)
    print_result(Diagnosis(is_well, tuple(checks)), as_json=as_json)
    return DONE if is_well else FAILED
