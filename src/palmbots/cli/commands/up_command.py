# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots up`."""

from typing import Annotated

import typer

from palmbots.cli._run import controller_of, load
from palmbots.cli.options import (
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

ORDER = 205
EXAMPLE = "palmbots up paper --controller resilient --lockstep"


def up(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "resilient",
    lockstep: Annotated[
        bool, typer.Option("--lockstep", help="World and robots wait for each other every tick.")
    ] = False,
    world: WorldOption = "quasistatic",
    precision: PrecisionOption = "double",
    seed: SeedOption = 0,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Run a world and two robots on this machine, each as a process of its own.

    In lockstep the result is that of palmbots carry with the same scene, controller and seed.

    Exit status 1: the object was not delivered.
    """
    from palmbots._util.arguments import seed_of
    from palmbots.control.registry import check
    from palmbots.node.launcher import run_processes
    from palmbots.node.lockstep_world import remote
    from palmbots.simulation.worlds import check_precision, check_scene, world_entry

    if not lockstep:
        raise PalmbotsError("up: needs --lockstep; a world in real time is not there yet")
    chosen = load(scene, changes)
    entry = controller_of(controller, quiet=as_json)
    place = world_entry(world)
    check_scene(place, chosen)
    check_precision(place, precision)
    remote(entry, lambda *_: [])
    check(entry, chosen)
    options = ["--world", world, "--precision", precision, "--seed", str(seed_of(seed))]
    options += ["--called", scene]
    return run_processes(chosen, controller, [*options, *(["--json"] if as_json else [])])


COMMAND = up
