# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots world`."""

import os
from typing import TYPE_CHECKING

from palmbots._util.command import Option, command
from palmbots._util.end_signal import has_starter
from palmbots._util.exit_status import DONE, FAILED
from palmbots.cli._run import controller_of, load, print_json, print_result, warn
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.control.registry import ControllerEntry
    from palmbots.scene.scene import Scene


@command(
    order=210,
    example="palmbots world paper --serve 127.0.0.1:7400 --lockstep",
    results=("palmbots.assessment.carried:Carried", "palmbots.simulation.live_world:LiveCarry"),
    serve=Option(metavar="ADDRESS"),
    imperfect=Option(metavar="FILE|KEY=VALUE"),
    called=Option(is_hidden=True),
)
def world(
    scene: str = "paper",
    serve: str = "127.0.0.1:7400",
    lockstep: bool = False,
    rate: float = 1.0,
    controller: str = "shared-sign",
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    overrides: list[str] | None = None,
    imperfect: list[str] | None = None,
    bench: bool = False,
    probe: bool = False,
    as_json: bool = False,
    called: str = "",
) -> int:
    """Simulate a world for robots that run in other processes.

    Exit status 1: the object was not delivered.

    Args:
        serve: serve at this HOST:PORT or unix:PATH.
        imperfect: a property of a robot that its program does not know, as in left.trim=0.02, or a
            file of them (repeatable).
        bench: a workbench without an object, for palmbots calibrate.
        probe: robots whose motors are commanded, for palmbots probe.
        called: what the scene is called in the report.
    """
    from palmbots._util.arguments import seed_of

    chosen = load(scene, overrides)
    seed = seed_of(seed)
    if bench:
        if lockstep or as_json:
            other = "--lockstep" if lockstep else "--json"
            raise PalmbotsError(f"--bench: does not work with {other}; allowed: without it")
        return _bench(chosen, serve, seed, rate, imperfect)
    if probe:
        if as_json or imperfect:
            other = "--json" if as_json else "--imperfect"
            raise PalmbotsError(f"--probe: does not work with {other}; allowed: without it")
        return _probe(chosen, serve, world, seed, lockstep)
    entry = controller_of(controller, quiet=as_json)
    if not lockstep:
        return _live(chosen, serve, world, seed, rate, imperfect, as_json=as_json)
    if imperfect:
        raise PalmbotsError("--imperfect has no effect with --lockstep; allowed: without it")
    return _lockstep(chosen, serve, world, seed, entry, precision, called or scene, as_json)


def _lockstep(
    scene: "Scene",
    serve: str,
    world: str,
    seed: int,
    entry: "ControllerEntry",
    precision: str,
    name: str,
    as_json: bool,
) -> int:
    """A world that waits in every tick for the programs of the robots."""
    from palmbots.assessment.carried import Carried
    from palmbots.control.dead_band import warnings_before
    from palmbots.links.greeting import scene_number
    from palmbots.links.local_connection import listen
    from palmbots.simulation.lockstep_world import Programs, ends_of, remote
    from palmbots.simulation.prepare import check_precision
    from palmbots.simulation.single import carry
    from palmbots.simulation.worlds import world_entry
    from palmbots.stability.scene_limits import self_check

    check_precision(world_entry(world), precision)
    with listen(serve, "--serve") as door:
        programs = Programs(door, ends_of(entry, scene), scene_number(scene))
        remote_entry = remote(entry, programs.exchange)
        try:
            programs.wait()
            result = carry(
                scene, remote_entry, world=world, precision=precision, seed=seed, record=False
            )
        finally:
            programs.close()
    before = [*warnings_before(scene, entry), *self_check(scene)]
    if not as_json:
        for text in before:
            warn(text)
    print_result(Carried.of(result, before), as_json=as_json, about=name)
    return DONE if result.outcome == "delivered" else FAILED


def _live(
    scene: "Scene",
    serve: str,
    world: str,
    seed: int,
    rate: float,
    imperfect: list[str] | None,
    *,
    as_json: bool,
) -> int:
    """A world in real time, which prints what happens; in `palmbots up` the station does so."""
    from palmbots.cli._streams import say
    from palmbots.cli._warnings import say_warning
    from palmbots.control.dead_band import warnings_before
    from palmbots.links.local_connection import listen
    from palmbots.simulation.imperfections import load_imperfections
    from palmbots.simulation.live_world import run_live_world

    imperfections = load_imperfections(imperfect) if imperfect else None
    if not as_json:
        for text in warnings_before(scene, "none"):
            say_warning(text)

    def on_line(line: str) -> None:
        say(f"palmbots: world at {serve}: {line}")

    with listen(serve, "--serve") as door:
        result = run_live_world(
            scene, door, world=world, seed=seed, rate=rate, imperfections=imperfections,
            on_line=on_line, on_event=None if has_starter(os.environ) else on_line,
        )  # fmt: skip
    if as_json:
        print_json(result)
    else:
        print(result.line())
    return DONE if result.outcome == "delivered" else FAILED


def _bench(scene: "Scene", serve: str, seed: int, rate: float, imperfect: list[str] | None) -> int:
    """A workbench, until quit is typed."""
    import select
    import sys

    from palmbots.links.local_connection import listen
    from palmbots.simulation.bench_world import run_bench
    from palmbots.simulation.imperfections import load_imperfections

    imperfections = load_imperfections(imperfect or [])

    def lines() -> str | None:
        if not select.select([sys.stdin], [], [], 0)[0]:
            return None
        return sys.stdin.readline() or None

    def on_line(text: str) -> None:
        print(text, flush=True)

    with listen(serve, "--serve") as door:
        run_bench(scene, door, imperfections, lines=lines, on_line=on_line, seed=seed, rate=rate)
    return DONE


def _probe(scene: "Scene", serve: str, world: str, seed: int, lockstep: bool) -> int:
    """Robots that probe, until their programs end or the object is dropped."""
    from palmbots.cli._streams import say
    from palmbots.links.local_connection import listen
    from palmbots.simulation.probe_stage import run_probe_world

    def on_line(line: str) -> None:
        say(f"palmbots: world at {serve}: {line}")

    with listen(serve, "--serve") as door:
        stage = run_probe_world(
            scene, door, world=world, seed=seed, lockstep=lockstep, on_line=on_line
        )
    left, right = (1000 * p for p in stage.contacts)
    held = f"dropped: {stage.drop_reason()}" if stage.outcome == "dropped" else "held"
    print(
        f"the object is {held}, with its contacts at {left:+.1f} and {right:+.1f} mm, which were "
        f"within ±{1000 * stage.farthest_m:.1f} mm"
    )
    return DONE if stage.outcome == "running" else FAILED
