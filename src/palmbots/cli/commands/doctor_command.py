# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots doctor`."""

import contextlib
import time
from typing import Annotated

import typer

from palmbots.cli._progress import progress
from palmbots.cli._run import print_json
from palmbots.cli.options import DONE, FAILED, JsonOption
from palmbots.errors import PalmbotsError

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 208
EXAMPLE = "palmbots doctor pair.toml"


def doctor(
    pair: Annotated[str, typer.Argument(metavar="PAIR", help="The pair.toml of both robots.")],
    seconds: Annotated[float, typer.Option("--seconds", help="How long to measure.")] = 30.0,
    as_json: JsonOption = False,
) -> int:
    """Check a pair: files, robots, and the radio.

    Run it in place of the station while the programs of both robots run. It measures losses and
    round trips, and reports the lease that they need and the controllers that they suffice for.
    It never moves a robot.

    Exit status 1: a robot is not heard, has a fault, or its controller does not suffice.
    """
    from palmbots.runtime.link_check import PERIOD_S, measure, needs_of
    from palmbots.runtime.live_ends import open_pair_link
    from palmbots.runtime.pair_file import load_pair
    from palmbots.runtime.robot_program import controller_of
    from palmbots.runtime.stored_state import booted
    from palmbots.scene.scene import load_scene

    if not 1 <= seconds <= 3600:
        raise PalmbotsError(f"--seconds: value is {seconds:g}; allowed: a number from 1 to 3600")
    chosen = load_pair(pair)
    scene = load_scene(chosen.scene())
    controller = controller_of(chosen).name
    with (
        booted(chosen.state_file("station")) as state,
        contextlib.closing(open_pair_link(chosen, "station")) as link,
        progress("measuring the radio", as_json, seconds) as report,
    ):
        start_s = time.monotonic()

        def wait() -> None:
            report(min(1.0, (time.monotonic() - start_s) / seconds))
            time.sleep(PERIOD_S)

        figures = measure(chosen, link, state.epoch, seconds, time.monotonic, wait)
    heard = {side: one for side, one in figures.items() if one.received}
    needs = None
    if heard:
        delay_s = max(one.delay_s for one in heard.values() if one.round_trips_s)
        needs = needs_of(scene, delay_s, max(one.loss for one in heard.values()))
    suffices = needs is not None and needs.verdicts.get(controller, "suffices") == "suffices"
    is_well = len(heard) == 2 and all(one.mode != "fault" for one in heard.values()) and suffices
    if as_json:
        links = {side: one.summary() for side, one in figures.items()}
        table = None if needs is None else needs.__dict__
        print_json({"well": is_well, "controller": controller, "links": links, "needs": table})
    else:
        from palmbots.cli.reports.doctor_report import doctor_report

        doctor_report(figures, needs, controller)
    return DONE if is_well else FAILED


COMMAND = doctor
