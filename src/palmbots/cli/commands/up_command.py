# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots up`."""

import contextlib
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from palmbots._util.command import Option, command
from palmbots._util.optional_imports import require
from palmbots._util.user_paths import state_folder
from palmbots.cli._run import controller_of, interruption_line, load
from palmbots.cli._streams import say
from palmbots.cli._warnings import print_held_warnings, warn
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.links.impairment import Impairment, RecordedFates
    from palmbots.scene.scene import Scene

_WAIT = ("--wait-s", "60")  # the station is a process that starts at the same time
_SCREEN = ("--attach", *_WAIT)
_PLAIN = ("--watch", "--plain", *_WAIT)


@command(
    order=200,
    example="palmbots up paper --lockstep",
    results=("palmbots.assessment.carried:Carried", "palmbots.simulation.live_world:LiveCarry"),
    link=Option(metavar="TEXT"),
    log=Option(metavar="DIR"),
    live=Option(metavar="ADDRESS"),
)
def up(
    scene: str = "paper",
    controller: str = "shared-sign",
    lockstep: bool = False,
    rate: float = 1.0,
    link: str = "",
    world: str = "quasistatic",
    precision: str = "double",
    seed: int = 0,
    overrides: list[str] | None = None,
    log: Path | None = None,
    no_log: bool = False,
    live: str | None = None,
    plain: bool = False,
    as_json: bool = False,
) -> int:
    """Run a world, robots and a station, each as a process.

    The station arms and starts the robots, and shows what happens: on a screen in a terminal
    (space or Escape is the e-stop), otherwise in lines. With --lockstep there is no station, and
    the result is that of palmbots carry with the same scene, controller and seed.

    Exit status 1: the object was not delivered.

    Args:
        link: another radio than that of the scene: "loss=0.2 delay_ms=50 jitter_ms=30".
        log: folder for the logs; None: a new one.
        live: serve a live 3-D view for Foxglove at this HOST:PORT.
    """
    from palmbots._util.arguments import seed_of
    from palmbots.links.impairment import Impairment
    from palmbots.pair.launcher import run_live, run_lockstep
    from palmbots.pair.pair_file import check_on_robots
    from palmbots.simulation.lockstep_world import ends_of, remote
    from palmbots.simulation.prepare import check_precision, prepare
    from palmbots.simulation.world_stage import refuse_live_floor
    from palmbots.simulation.worlds import world_entry

    chosen = load(scene, overrides)
    entry = controller_of(controller, quiet=as_json)
    place = world_entry(world)
    check_on_robots(chosen)
    check_precision(place, precision)
    remote(entry, lambda *_: [])
    prepare(chosen, entry, place)  # refuses a scene
    if not lockstep:
        refuse_live_floor(chosen, world)
        if idle := not_simulated(chosen, link):
            warn(idle)
    options = ["--world", world, "--seed", str(seed_of(seed))]
    options += ["--json"] if as_json else []
    given = {"rate": rate != 1.0, "link": link != "", "live": live, "log": log}
    given = {name: bool(value) for name, value in given.items()} if lockstep else {}
    given["precision"] = not lockstep and precision != "double"
    for name in (name for name, is_so in given.items() if is_so):
        raise PalmbotsError(
            f"--{name} has no effect {'with' if lockstep else 'without'} --lockstep; "
            f"allowed: {'without' if lockstep else 'with'} it"
        )
    if lockstep:
        options += ["--precision", precision, "--called", scene]
        has_station = "station" in ends_of(entry, chosen)
        return run_lockstep(chosen, controller, options, has_station=has_station)
    if entry.team == "station":
        raise PalmbotsError(
            f"--controller: {entry.name} needs a station that decides; allowed: with --lockstep"
        )
    has_screen = not (plain or as_json) and sys.stdout.isatty()
    if has_screen:
        require("textual", "station")
    if live is not None:
        from palmbots.views.foxglove_server import place_of

        require("foxglove", "station")
        place_of(live, "--live")
    logs = "" if no_log else _log_folder(log, scene)
    print_held_warnings()
    end = "palmbots: interrupted; world, robots and station have ended"
    if logs:
        end += f", their logs are in {logs}"
    with interruption_line(end), _output(has_screen) as (output, on_line):
        status = run_live(
            chosen,
            controller,
            options,
            rate=rate,
            impairment=Impairment.parse(link) if link else _radio_of(chosen),
            seed=seed_of(seed),
            fates=None if link else _fates_of(chosen),
            screen=None if as_json else _SCREEN if has_screen else _PLAIN,
            output=output,
            log_folder=logs,
            live=live,
            on_line=on_line,
        )
    if logs and not as_json:
        print(f"logs: {logs}")
    return status


_IN_PROCESSES = {
    *("radio.loss", "radio.latency_s", "radio.jitter_s", "radio.reorder", "radio.duplicate"),
    *("radio.beacon_s", "radio.lease_s"),  # of the programs of robots
    "radio.trace",
}
"""Keys of the radio that count between processes in real time; no fault of a scene does."""


def not_simulated(scene: "Scene", link: str = "") -> str:
    """A line about the keys of radio and faults that the scene sets and that have no effect in real
    time; empty: there are none.

    Args:
        scene: the scene.
        link: another radio than that of the scene; empty: none.
    """
    from palmbots.scene.overrides import leaves
    from palmbots.scene.scene import Scene

    found = []
    for section in ("faults",) if link else ("radio", "faults"):
        given, usual = (leaves(section, one.model_dump()[section]) for one in (scene, Scene()))
        found += [key for key, value in given.items() if value != usual.get(key)]
    if not (idle := [key for key in found if key not in _IN_PROCESSES]):
        return ""
    verb = "has" if len(idle) == 1 else "have"
    return f"{', '.join(idle)} of the scene {verb} no effect in real time, only with --lockstep"


def _radio_of(scene: "Scene") -> "Impairment":
    """What happens to packets between processes, as the scene's radio has it."""
    from palmbots.links.impairment import Impairment

    radio = scene.radio
    return Impairment(
        loss=radio.loss,
        delay_ms=1e3 * (radio.latency_s + 0.5 * radio.jitter_s),
        jitter_ms=1e3 * 0.5 * radio.jitter_s,
        duplicate=radio.duplicate,
        reorder=float(radio.reorder),
    )


def _fates_of(scene: "Scene") -> "RecordedFates | None":
    """The recorded packets that the scene replays."""
    from palmbots.links.impairment import RecordedFates
    from palmbots.scene.recorded_traces import fates_of

    rows = fates_of(scene)
    if rows is None:
        return None
    return RecordedFates(rows.interval_s, rows.kind, rows.delays_s.tolist())


def _log_folder(log: Path | None, scene: str) -> str:
    """Where the programs log."""
    if log is not None:
        return str(log.absolute())
    name = f"{time.strftime('%Y-%m-%d-%H%M%S')}-{Path(scene).stem}"
    return str(state_folder() / "logs" / name)


def _say(line: str) -> None:
    say(f"palmbots: {line}")


@contextlib.contextmanager
def _output(has_screen: bool) -> Iterator[tuple[Path | None, Callable[[str], None]]]:
    """A file for what the world prints, and what takes warnings. While a screen is shown, both
    wait until it is closed."""
    if not has_screen:
        yield None, _say
        return
    lines: list[str] = []
    with tempfile.TemporaryDirectory(prefix="palmbots-") as folder:
        file = Path(folder) / "world.txt"
        try:
            yield file, lines.append
        finally:
            for line in lines:
                _say(line)
            if file.exists():
                print(file.read_text(encoding="utf-8"), end="")
