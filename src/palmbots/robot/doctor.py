# SPDX-License-Identifier: Apache-2.0
"""Checks a pair before a carry: from the place of the station, or on one of the robots."""

import contextlib
import time
from collections.abc import Callable
from functools import partial
from os import PathLike

from palmbots._types import Side
from palmbots._util.command import Option, command
from palmbots.drivers.driver import DriverFailed, NoAnswer
from palmbots.errors import PalmbotsError
from palmbots.links.local_connection import ConnectionLost
from palmbots.pair.checkup import Check, check_driver, check_own_clock, checks_of_status
from palmbots.pair.diagnosis import Diagnosis
from palmbots.pair.link_check import PERIOD_S, measure, needs_of
from palmbots.pair.live_ends import open_pair_link
from palmbots.pair.pair_file import Pair, load_pair
from palmbots.pair.robot_driver import opened_driver
from palmbots.pair.stored_state import booted
from palmbots.robot.core_program import controller_of
from palmbots.scene.scene import Scene
from palmbots.wire import Verdict

_CLOCK_S = 3.0


@command(
    "doctor",
    order=208,
    example="palmbots doctor pair.toml",
    failure=("well", "something is wrong. A line says what to do"),
    pair=Option(is_argument=True, metavar="PAIR"),
    seconds=Option(least=1.0, most=3600.0),
    side=Option(metavar="SIDE"),
)
def diagnose(
    pair: str | PathLike[str],
    *,
    seconds: float = 30.0,
    side: Side | None = None,
    on_stage: Callable[[str, float], None] | None = None,
) -> Diagnosis:
    """Check a pair: radio, clocks, drivers, key and battery.

    Run it in place of the station while the programs of both robots run. It measures losses and
    round trips, and reports which lease this radio needs and which controllers can work with it.
    With `side`, run it on a robot in place of its program: it checks the driver, and turns the palm
    to both of its angles. The wheels never turn.

    Args:
        pair: the pair.toml of both robots.
        seconds: how long to measure.
        side: check this robot's own driver; its palm moves.
        on_stage: called with the name of the present stage and the completed fraction of it.

    Raises:
        PalmbotsError: a file cannot be read, or the programs that it needs do not run.
    """
    chosen = load_pair(pair)
    scene = chosen.checked_scene()
    clock_s = _CLOCK_S if side else min(seconds, _CLOCK_S)
    show = on_stage or (lambda stage, fraction: None)
    report = partial(show, "measuring the clock")
    own = check_own_clock(scene.control.period_s, clock_s, report=report)
    if side:
        return _of_robot(chosen, scene, side, own)
    return _of_pair(chosen, scene, seconds, own, partial(show, "measuring the radio"))


def _of_pair(
    pair: Pair, scene: Scene, seconds: float, own: Check, report: Callable[[float], None]
) -> Diagnosis:
    """What the programs of both robots answer to the station."""
    verdicts: dict[Verdict, int] = {}
    controller = controller_of(pair).name
    with (
        booted(pair.state_file("station")) as state,
        contextlib.closing(open_pair_link(pair, "station")) as link,
    ):
        start_s = time.monotonic()

        def wait() -> None:
            report(min(1.0, (time.monotonic() - start_s) / seconds))
            time.sleep(PERIOD_S)

        figures = measure(pair, link, state.epoch, seconds, time.monotonic, wait, verdicts)
    checks = (own, *checks_of_status(pair, scene, figures, verdicts))
    heard = {side: one for side, one in figures.items() if one.received}
    needs = None
    if heard:
        delay_s = max(one.delay_s for one in heard.values() if one.round_trips_s)
        needs = needs_of(
            scene,
            delay_s,
            max(one.loss for one in heard.values()),
            stops_without_partner=pair.settings.limits.partner_lost == "stop",
        )
    suffices = needs is not None and needs.verdicts.get(controller, "suffices") == "suffices"
    is_well = len(heard) == 2 and suffices and all(check.is_well for check in checks)
    return Diagnosis(is_well, checks, controller, figures, needs)


def _of_robot(pair: Pair, scene: Scene, side: Side, own: Check) -> Diagnosis:
    """The checks on the robot itself.

    Raises:
        PalmbotsError: its driver has no hardware.
    """
    if pair.settings.driver.kind == "dry-run":
        raise PalmbotsError(
            "driver.kind: dry-run has no hardware to check; allowed: the driver of the robot"
        )
    checks = [own]
    try:
        with opened_driver(pair, side, scene) as driver:
            hardware = pair.settings.hardware.of(side)
            checks += check_driver(
                driver, side, scene, hardware, silent=_silence_remedy(pair, side)
            )
    except NoAnswer as error:
        checks.append(Check("driver", side, False, str(error), _silence_remedy(pair, side)))
    except DriverFailed as error:
        checks.append(
            Check("driver", side, False, error.why, "correct the driver, or its hardware")
        )
    except ConnectionLost as error:
        remedy = "start the world, or the motor board"
        checks.append(Check("driver", side, False, str(error), remedy))
    return Diagnosis(all(check.is_well for check in checks), tuple(checks))


def _silence_remedy(pair: Pair, side: Side) -> str:
    """What to do about hardware that does not answer."""
    table = pair.settings.driver
    if table.kind == "simulated":
        return "start the world"
    address = table.address_of(side)
    remedy = (
        f"check power and cable, driver.address ({address or 'empty'}) and driver.baud "
        f"({table.baud})"
    )
    if table.kind == "serial":
        return remedy
    return f"{remedy}; a driver that waits for its first answer must not return None"
