"""The command line: `palmbots carry`, `modes`, `compare`, `replay`, `derive`, `study`, and those of
`stability`.

Every command has ``--json`` (one object on stdout, nothing else) and exits with 0 when it did its
job, 1 when what it was asked about failed, 2 on bad input, which is answered with one line.
"""

import contextlib
import io
import json
import os
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from palmbots.cli_options import (
    BAD_INPUT,
    DONE,
    FAILED,
    ControllerOption,
    JsonOption,
    PrecisionOption,
    SceneArgument,
    SeedOption,
    SetOption,
    app,
    path_given,
    progress,
    scene_of,
)
from palmbots.derivation import cli as derivation  # puts its command into `app`
from palmbots.dynamic import cli as dynamic  # likewise
from palmbots.errors import PalmbotsError, one_line
from palmbots.stability import cli as stability  # likewise
from palmbots.studies import cli as studies  # likewise

__all__ = ["derivation", "dynamic", "main", "stability", "studies"]

# The base of all errors of usage. Typer brings its own copy of click, under a private name.
_UsageFault: Any = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")


def main() -> None:
    """Run the command line and exit with its status."""
    for stream in (sys.stdout, sys.stderr):  # where an encoding has no ° there is a ?, no traceback
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        status = run(sys.argv[1:])
        if sys.stdout is not None:
            sys.stdout.flush()  # here, where a full disk can still be told
    except OSError as error:
        _muted()
        status = FAILED if isinstance(error, BrokenPipeError) else _unwritable(error)
    sys.exit(status)


def run(arguments: list[str]) -> int:
    """Run one command; returns the exit status."""
    try:
        status = app(args=arguments, prog_name="palmbots", standalone_mode=False)
        return status if isinstance(status, int) else DONE
    except PalmbotsError as error:
        return _refuse(str(error))
    except _UsageFault as error:
        context = getattr(error, "ctx", None)
        where = f"{context.command_path}: " if context is not None else ""
        helps = f"; see {context.command_path} --help" if context is not None else ""
        return _refuse(f"{where}{error.format_message().rstrip('.')}{helps}")
    except typer.Exit as stop:
        return stop.exit_code
    except (KeyboardInterrupt, typer.Abort):
        print("palmbots: interrupted; nothing half-written is left behind", file=sys.stderr)
        return 130


def _muted() -> None:
    """Nobody reads on, or there is no room: what is left to print goes nowhere, without a word."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _unwritable(error: OSError) -> int:
    name = f"{error.filename}: " if error.filename else ""
    return _refuse(f"{name}the output cannot be written: {error.strerror or error}")


def _refuse(message: str) -> int:
    text = one_line(message)
    print(text if text.startswith("palmbots") else f"palmbots: {text}", file=sys.stderr)
    return BAD_INPUT


@app.callback(invoke_without_command=True)
def _root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    if version:
        from palmbots.version import __version__

        print(f"palmbots {__version__}")
        raise typer.Exit()
    if context.invoked_subcommand is None:
        print(context.get_help())


@app.command(epilog="Example: palmbots carry paper --controller centralized --seed 3 --out out")
def carry(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    world: Annotated[str, typer.Option("--world", help="quasistatic or mujoco.")] = "quasistatic",
    precision: PrecisionOption = "double",
    seed: SeedOption = 0,
    changes: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            parser=path_given,
            metavar="DIR",
            help="Write pictures, animation and log there.",
        ),
    ] = None,
    video: Annotated[
        str | None, typer.Option("--animation", help="gif, mp4 or none [default: gif].")
    ] = None,
    film: Annotated[
        bool, typer.Option("--video", help="Film and still of the dynamic world too.")
    ] = False,
    view: Annotated[
        bool, typer.Option("--view", help="Watch the dynamic world in MuJoCo's viewer.")
    ] = False,
    beyond: Annotated[
        bool,
        typer.Option("--beyond-budget", help="Drive a curved path that will drop the object."),
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Carry the object once and say how it went. Exit status 1: it did not arrive."""
    from palmbots.carry import carry as run_carry
    from palmbots.deadband import warnings_before
    from palmbots.errors import one_of
    from palmbots.files import check_folder
    from palmbots.report import carry_report

    if video is not None:
        one_of("--animation", video, ("gif", "mp4", "none"))
        if out is None and video != "none":
            raise PalmbotsError(f"--animation: {video} needs --out; allowed: --out DIR with it")
    for option, given in (("--video", film), ("--view", view)):
        if given and world != "mujoco":
            raise PalmbotsError(
                f"{option}: shows the dynamic world; allowed: --world mujoco with it"
            )
    if film and out is None:
        raise PalmbotsError("--video: where to write is not given; allowed: --out DIR with it")
    chosen = scene_of(scene, changes)
    if out is not None:
        check_folder(out)
        if film:
            dynamic.check_film(out)
    before = warnings_before(chosen, controller)
    for warning in before:
        print(f"palmbots: warning: {warning}", file=sys.stderr)
    budget = None
    if world == "mujoco" and chosen.task.path.is_curved:
        budget = dynamic.sideways_budget(chosen, controller, quiet=as_json, anyway=beyond)
    lasts_s = 0.5 * chosen.timeout_s if world == "mujoco" else 0.0
    with dynamic.watching(view) as watch, progress("carrying", as_json, lasts_s) as report:
        done = run_carry(
            chosen,
            controller,
            world=world,
            precision=precision,
            seed=seed,
            record=out is not None,
            progress=report,
            watch=watch,
        )
    written, removed = [], []
    if out is not None:
        written, removed = _write_carry(done, out, video or "gif", film, quiet=as_json)
        if world == "mujoco" and chosen.task.path.is_curved:
            written.append(dynamic.write_plan(done, out))
        if film:
            written += dynamic.write_film(done, out, quiet=as_json)
    if as_json:
        foreseen = None if budget is None else budget.summary()
        print(json.dumps(done.summary() | {"sideways": foreseen}, allow_nan=False))
    else:
        from palmbots.stability.lacking import pointer

        dropped = done.outcome == "dropped"
        hint = pointer(chosen, controller, scene, changes) if dropped else None
        told = [w for w in done.warnings if w not in before]
        carry_report(done, scene, told, written, removed, hint)
    return DONE if done.outcome == "delivered" else FAILED


def _write_carry(
    done: Any, out: Path, video: str, film: bool, quiet: bool
) -> tuple[list[Path], list[Path]]:
    """The picture, the animation and the log of a carry; returns what was written and removed."""
    from palmbots import animation, figure8, sequence_chart
    from palmbots.files import folder, remove
    from palmbots.log import write_log

    target = folder(out)
    written = [target / "carry.png", target / "carry.mcap"]
    with progress("figure, log, animation", quiet) as report:
        figure8.save(done, written[0])
        if done.letters:
            written.append(target / "message_sequence.png")
            sequence_chart.save(done, written[-1])
        report(0.15)
        write_log(done, written[1])
        report(0.3)
        if video != "none":
            written.append(target / f"carry.{video}")
            animation.save(
                done, written[-1], progress=lambda done, of: report(0.3 + 0.7 * done / of)
            )
    # An animation of an earlier carry would pass for one of this.
    others = [target / f"carry.{kind}" for kind in ("gif", "mp4") if kind != video]
    if not done.scene.task.path.is_curved:
        others.append(target / "plan.png")
    if not film:
        others += [target / name for name in dynamic.FILM]
    if not done.letters:
        others.append(target / "message_sequence.png")
    return written, [path for path in others if remove(path)]


@app.command(epilog="Example: palmbots modes --theta-left-deg 5 --p-left-m -0.02")
def modes(
    scene: SceneArgument = "paper",
    p_left_m: Annotated[float, typer.Option(help="Left contact coordinate, outward.")] = 0.0,
    p_right_m: Annotated[float, typer.Option(help="Right contact coordinate, outward.")] = 0.0,
    theta_left_deg: Annotated[
        float | None, typer.Option(help="Left palm angle; default: the scene's steep one.")
    ] = None,
    theta_right_deg: Annotated[
        float | None, typer.Option(help="Right palm angle; default: the scene's steep one.")
    ] = None,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Say which contact modes balance in one state, and what happens."""
    from palmbots.modes import modes as find_modes
    from palmbots.report import modes_report

    found = find_modes(
        scene_of(scene, changes),
        p_left_m=p_left_m,
        p_right_m=p_right_m,
        theta_left_deg=theta_left_deg,
        theta_right_deg=theta_right_deg,
    )
    if as_json:
        print(json.dumps(found.summary(), allow_nan=False))
    else:
        modes_report(found)
    return DONE


@app.command(epilog="Example: palmbots compare --sweep robot.noise_m_s --values 0.01,0.02,0.03")
def compare(
    scene: SceneArgument = "paper",
    key: Annotated[
        str, typer.Option("--sweep", metavar="KEY", help="The numeric scene key to sweep.")
    ] = "radio.latency_s",
    values: Annotated[
        str | None,
        typer.Option("--values", metavar="A,B,…", help="What to set it to [default: latencies]."),
    ] = None,
    controllers: Annotated[
        str, typer.Option("--controllers", metavar="A,B,…", help="Which controllers.")
    ] = "none,centralized,distributed,resilient",
    carries: Annotated[int, typer.Option("--carries", "-n", help="Carries a cell.")] = 200,
    seed: SeedOption = 0,
    precision: PrecisionOption = "double",
    changes: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", parser=path_given, metavar="DIR", help="Write compare.png there."),
    ] = None,
    as_json: JsonOption = False,
) -> int:
    """Put controllers side by side over any numeric scene key. Radio latency by default."""
    from palmbots.compare import DEFAULT_SWEEP, DEFAULT_VALUES
    from palmbots.compare import compare as run_comparison
    from palmbots.files import check_folder
    from palmbots.report import compare_report

    if out is not None:
        check_folder(out)
    if values is None and key != DEFAULT_SWEEP:
        raise PalmbotsError(f"--values: not given; allowed: numbers to set {key} to, as in 0.1,0.2")
    with progress("comparing", as_json) as report:
        done = run_comparison(
            scene_of(scene, changes),
            key=key,
            values=DEFAULT_VALUES if values is None else _numbers("--values", values),
            controllers=[name.strip() for name in controllers.split(",")],
            carries=carries,
            seed=seed,
            precision=precision,
            progress=report,
        )
    if not done.rows:
        raise PalmbotsError(f"resilient refused {done.refused[0]}")
    written = None
    if out is not None:
        from palmbots.comparison_figure import save
        from palmbots.files import folder

        written = folder(out) / "compare.png"
        save(done, written)
    if as_json:
        print(json.dumps(done.summary(), allow_nan=False))
    else:
        compare_report(done, written)
    return DONE


@app.command(epilog="Example: palmbots rare --set robot.noise_m_s=0.012 --within-percent 20")
def rare(
    scene: SceneArgument = "paper",
    controller: ControllerOption = "distributed",
    within_percent: Annotated[
        float, typer.Option("--within-percent", help="Wanted half-width of the 95 % interval.")
    ] = 20.0,
    effort: Annotated[int, typer.Option("--effort", help="Carries in each stage.")] = 1000,
    seed: SeedOption = 0,
    changes: SetOption = None,
    as_json: JsonOption = False,
) -> int:
    """Tell the drop rate of a scene, however small. By multilevel splitting."""
    from palmbots.rare import rare as run_rare
    from palmbots.report import rare_report

    if not 1 <= within_percent <= 100:
        raise PalmbotsError(f"--within-percent: value is {within_percent:g}; allowed: 1 to 100")
    with progress("splitting", as_json) as report:
        found = run_rare(
            scene_of(scene, changes),
            controller,
            seed=seed,
            within=within_percent / 100,
            effort=effort,
            progress=report,
        )
    if as_json:
        print(json.dumps(found.summary(), allow_nan=False))
    else:
        rare_report(found, scene)
    return DONE


def _numbers(option: str, text: str) -> list[float]:
    from palmbots.errors import show

    def number(part: str) -> float:
        try:
            return int(part)  # a key that wants a whole number takes no 1.0
        except ValueError:
            return float(part)

    try:
        return [number(part) for part in text.split(",")]
    except ValueError:
        raise PalmbotsError(
            f"{option}: value is {show(text)}; allowed: numbers with commas between, as in 0.1,0.2"
        ) from None


@app.command(epilog="Example: palmbots replay out/carry.mcap")
def replay(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="An MCAP log of a carry.")],
    as_json: JsonOption = False,
) -> int:
    """Run a log again and check it bit for bit. Exit status 1: it differs."""
    from palmbots.replay import replay as run_again
    from palmbots.report import replay_report

    result = run_again(log)
    if as_json:
        print(json.dumps(result.summary(), allow_nan=False))
    else:
        replay_report(result, log)
    return DONE if result.identical else FAILED
