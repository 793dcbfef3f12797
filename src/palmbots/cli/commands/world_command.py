# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots world`."""

from typing import Annotated

import typer

from palmbots.cli._run import controller_of, load, print_json, warn
from palmbots.cli.options import (
    DONE,
    FAILED,
    ControllerOption,
    JsonOption,
    PrecisionOption,
    SceneArgument,
    SeedOption,
    SetOption,
    WorldOption,
)
from palmbots.errors import PalmbotsError

__all__ = ["COMMAND", "EXAMPLE", "ORDER"]

ORDER = 210
EXAMPLE = "palmbots world paper --serve 127.0.0.1:7400 --lockstep"


def world(
    scene: SceneArgument = "paper",
    serve: Annotated[
        str, typer.Option("--serve", metavar="ADDRESS", help="HOST:PORT or unix:PATH.")
    ] = "127.0.0.1:7400",
    lockstep: Annotated[
        bool, typer.Option("--lockstep", help="World and robots wait for each other every tick.")
    ] = False,
    controller: ControllerOption = "resilient",
    world: WorldOption = "quasistatic",
    precision: PrecisionOption = "double",
    seed: SeedOption = 0,
    changes: SetOption = None,
    as_json: JsonOption = False,
    called: Annotated[str, typer.Option("--called", hidden=True)] = "",
) -> int:
    """Simulate a world for robots that run in other processes.

    Exit status 1: the object was not delivered.
    """
    from palmbots.cli.reports.carry_report import carry_report
    from palmbots.control.dead_band import warnings_before
    from palmbots.node.frames import listen
    from palmbots.node.lockstep_world import Robots, remote
    from palmbots.simulation.single import carry
    from palmbots.simulation.worlds import check_precision, world_entry
    from palmbots.stability.scene_limits import self_check

    if not lockstep:
        raise PalmbotsError("world: needs --lockstep; a world in real time is not there yet")
    chosen = load(scene, changes)
    entry = controller_of(controller, quiet=as_json)
    check_precision(world_entry(world), precision)
    with listen(serve) as door:
        robots = Robots(door)
        remote_entry = remote(entry, robots.exchange)
        try:
            robots.wait_for({"left", "right"})
            robots.establish_session()
            result = carry(
                chosen, remote_entry, world=world, precision=precision, seed=seed, record=True
            )
        finally:
            robots.close()
    before = [*warnings_before(chosen, entry), *self_check(chosen)]
    late = [text for text in result.warnings if text not in before]
    if as_json:
        forecast = {"drift_forecast": None}
        print_json(result.summary() | {"warnings": [*before, *late]} | forecast)
    else:
        for text in before:
            warn(text)
        carry_report(result, called or scene, late, [], [], None)
    return DONE if result.outcome == "delivered" else FAILED


COMMAND = world
