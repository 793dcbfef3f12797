# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots up`."""

from typing import Annotated

import typer

from palmbots.cli._run import controller_of, load
from palmbots.cli._streams import say
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

ORDER = 200
EXAMPLE = "palmbots up paper --controller resilient --lockstep"


def up(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "resilient",
    lockstep: Annotated[
        bool, typer.Option("--lockstep", help="World and robots wait for each other every tick.")
    ] = False,
    rate: Annotated[float, typer.Option("--rate", help="Run at this multiple of real time.")] = 1.0,
    link: Annotated[
        str,
        typer.Option(
            "--link",
            metavar="TEXT",
            help='Simulate a bad radio: "loss=0.2 delay_ms=50 jitter_ms=30".',
        ),
    ] = "",
    world: WorldOption = "quasistatic",
    precision: PrecisionOption = "double",
    seed: SeedOption = 0,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Run a world, robots and a station, each as a process.

    The station arms and starts the robots, and reports what happens. With --lockstep there is no
    station, and the result is that of palmbots carry with the same scene, controller and seed.

    Exit status 1: the object was not delivered.
    """
    from palmbots._util.arguments import seed_of
    from palmbots.control.registry import check
    from palmbots.runtime.impairment import Impairment
    from palmbots.runtime.launcher import check_rate, run_live, run_lockstep
    from palmbots.runtime.lockstep_world import remote
    from palmbots.simulation.worlds import check_precision, check_scene, world_entry

    chosen = load(scene, changes)
    entry = controller_of(controller, quiet=as_json)
    place = world_entry(world)
    check_scene(place, chosen)
    check_precision(place, precision)
    remote(entry, lambda *_: [])
    check(entry, chosen)
    options = ["--world", world, "--seed", str(seed_of(seed))]
    options += ["--json"] if as_json else []
    given = {"rate": rate != 1.0, "link": link != ""} if lockstep else {}
    given["precision"] = not lockstep and precision != "double"
    for name in (name for name, is_so in given.items() if is_so):
        raise PalmbotsError(
            f"--{name} has no effect {'with' if lockstep else 'without'} --lockstep; "
            f"allowed: {'without' if lockstep else 'with'} it"
        )
    if lockstep:
        options += ["--precision", precision, "--called", scene]
        return run_lockstep(chosen, controller, options, has_station=entry.team == "station")
    if entry.team == "station":
        raise PalmbotsError(
            f"--controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    return run_live(
        chosen,
        controller,
        options,
        rate=check_rate(rate),
        impairment=Impairment.parse(link),
        quiet=as_json,
        on_line=lambda line: say(f"palmbots: {line}"),
    )


COMMAND = up
