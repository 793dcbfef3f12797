"""The command `palmbots study`. Importing this module puts it into the command line."""

import json
import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palmbots.cli_options import DONE, JsonOption, app, path_given
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.studies.plan import Plan
    from palmbots.studies.run import Report

__all__ = ["study"]

_INTERRUPTED = 130


@app.command(
    epilog="Example: palmbots study centralized-vs-distributed --carries 100 --out out --plot"
)
def study(
    source: Annotated[
        str, typer.Argument(metavar="FILE", help="A study in TOML, or the name of a ready one.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", parser=path_given, metavar="DIR", help="Its folder [default: NAME.study]."
        ),
    ] = None,
    carries: Annotated[
        int | None,
        typer.Option("--carries", "-n", help="Carries a cell, in place of the file's."),
    ] = None,
    threads: Annotated[
        int | None, typer.Option("--threads", help="How many carry at once [default: all cores].")
    ] = None,
    chunk: Annotated[
        int | None, typer.Option("--chunk", help="About how many carries are kept at a time.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler", metavar="ADDRESS", help="Let a Dask scheduler's workers carry."
        ),
    ] = None,
    local_cluster: Annotated[
        int | None,
        typer.Option("--local-cluster", metavar="N", help="Or N worker processes here, to try."),
    ] = None,
    plot: Annotated[
        bool, typer.Option("--plot", help="Draw curves or maps into the folder, as study.png.")
    ] = False,
    explain: Annotated[
        bool, typer.Option("--explain", help="Only tell what it will take: carries, time, disk.")
    ] = False,
    as_json: JsonOption = False,
) -> int:
    """Carry a whole study: any scene keys × controllers × seeds.

    What is finished is kept: kill it at any time and run the same command again, and it goes on;
    the result is the same to the bit.
    """
    from palmbots.studies.plan import load_plan
    from palmbots.studies.report import study_report
    from palmbots.studies.run import run_study

    plan = load_plan(source, carries)
    if scheduler is not None and local_cluster is not None:
        raise PalmbotsError("--scheduler: given with --local-cluster; allowed: one of them")
    if plot and not plan.keys:
        raise PalmbotsError("--plot: nothing varies; allowed: a study with at least one key")
    if explain:
        return _explain(plan, threads, chunk, as_json)
    root = out if out is not None else Path(f"{plan.name}.study")
    try:
        with _bars(as_json) as report:
            done = run_study(
                plan, root, threads=threads, chunk=chunk, scheduler=scheduler,
                local_cluster=local_cluster, report=report,
            )  # fmt: skip
    except KeyboardInterrupt:
        # What the store was reading or writing just now is cut off, which is no news.
        logging.getLogger("asyncio").setLevel(logging.CRITICAL)
        print(
            f"palmbots: interrupted; what was finished is kept in {root}: run the same command "
            "again, and it goes on",
            file=sys.stderr,
        )
        return _INTERRUPTED
    written = []
    if plot:
        from palmbots.studies.figures import save

        written = [root / "study.png"]
        save(done, written[0])
    if as_json:
        print(json.dumps(done.summary(), allow_nan=False))
    else:
        study_report(done, written)
    return DONE


def _explain(plan: "Plan", threads: int | None, chunk: int | None, as_json: bool) -> int:
    from palmbots.batch import cores
    from palmbots.studies.design import design
    from palmbots.studies.explain import cost_of
    from palmbots.studies.report import cost_report
    from palmbots.studies.run import checked_threads, cut_of

    many = checked_threads(threads) or cores()
    with _bars(as_json) as report:
        points = design(plan, lambda f: report("checking scenes", f))
        cost = cost_of(points, cut_of(points, chunk), many)
    if as_json:
        told = cost.summary() | {"study": plan.name, "scene": plan.base.model_dump()}
        print(json.dumps(told, allow_nan=False))
    else:
        cost_report(points, cost)
    return DONE


@contextmanager
def _bars(quiet: bool) -> "Iterator[Report]":
    """One progress bar on stderr, that says what goes on."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda what, fraction: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        tasks = {}

        def report(what: str, fraction: float) -> None:
            if what not in tasks:
                for task in tasks.values():
                    bar.update(task, visible=False)
                tasks[what] = bar.add_task(what, total=1.0)
            bar.update(tasks[what], completed=fraction)

        yield report
