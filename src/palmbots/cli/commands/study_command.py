# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots study`."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from palmbots._util.command import command
from palmbots.cli._progress import staged_progress
from palmbots.cli._run import check_output, interruption_line, print_result
from palmbots.cli._warnings import print_held_warnings, warn
from palmbots.cli.options import DONE, JsonOption, UnprovedOption, output_option
from palmbots.errors import PalmbotsError

if TYPE_CHECKING:
    from palmbots.studies.study_file import Plan


@command(
    order=80,
    example="palmbots study centralized-vs-distributed --carries 100 --out out --plot",
    results=(
        "palmbots.studies.study_runner:StudyResult",
        "palmbots.studies.cost_estimate:Cost",
    ),
)
def study(
    source: Annotated[
        str, typer.Argument(metavar="FILE", help="TOML study file or built-in study name.")
    ],
    out: Annotated[
        Path | None, output_option("Write the results to this folder [default: NAME.study].")
    ] = None,
    carries: Annotated[
        int | None,
        typer.Option("--carries", "-n", help="Carries per cell [default: as in the file]."),
    ] = None,
    threads: Annotated[
        int | None, typer.Option("--threads", help="Worker threads [default: all cores].")
    ] = None,
    chunk_size: Annotated[
        int | None, typer.Option("--chunk-size", help="Carries per chunk (approximate).")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Use the workers of a Dask scheduler."),
    ] = None,
    local_cluster: Annotated[
        int | None,
        typer.Option("--local-cluster", metavar="N", help="Start N local Dask workers instead."),
    ] = None,
    plot: Annotated[
        bool, typer.Option("--plot", help="Write curves or maps to study.png in the folder.")
    ] = False,
    estimate_cost: Annotated[
        bool,
        typer.Option("--estimate-cost", help="Print carries, time and disk space; run nothing."),
    ] = False,
    unproved: UnprovedOption = False,
    as_json: JsonOption = False,
) -> int:
    """Run a study: any scene keys × controllers × seeds.

    Finished chunks are kept. You can stop a study at any time and rerun the
    command to continue; the results are the same to the bit.
    """
    from palmbots.studies.study_file import load_plan
    from palmbots.studies.study_runner import run_study

    plan = load_plan(source, carries, unproved=unproved, on_warning=warn)
    if unproved:
        _warn_of_policies(plan)
    if scheduler is not None and local_cluster is not None:
        raise PalmbotsError("--scheduler and --local-cluster exclude each other; give one of them")
    if plot and not plan.keys:
        raise PalmbotsError("--plot needs a study that varies at least one key")
    if estimate_cost:
        return _print_cost(plan, threads, chunk_size, as_json)
    root = out if out is not None else Path(f"{plan.name}.study")
    if plot:
        check_output(root)
    line = (
        f"palmbots: interrupted; finished carries are kept in {root}; "
        "run the same command again to continue"
    )
    with interruption_line(line), _quiet_asyncio(), staged_progress(as_json) as report:
        result = run_study(
            plan, root, threads=threads, chunk_size=chunk_size, scheduler=scheduler,
            local_cluster=local_cluster, report=report, notify=_notify,
        )  # fmt: skip
    written: list[Path] = []
    if plot:
        from palmbots.studies.study_figures import save

        written = [root / "study.png"]
        save(result, written[0])
    print_result(result, as_json=as_json, written=written)
    return DONE


def _warn_of_policies(plan: "Plan") -> None:
    """Say which controllers are not checked.

    Raises:
        PalmbotsError: there is none, so that ``--unproved`` has no effect.
    """
    names = [entry.name for entry in plan.controllers if entry.machines is not None]
    if not names:
        raise PalmbotsError("--unproved needs a study with a policy file among its controllers")
    for name in names:
        warn(f"controllers: the algorithm derived from {name} is not checked (--unproved)")


def _notify(text: str) -> None:
    """Print a warning about a study that runs already."""
    print_held_warnings()
    warn(text)


@contextmanager
def _quiet_asyncio() -> Iterator[None]:
    """Suppress what asyncio reports when Ctrl-C cuts off a read or write of the store."""
    try:
        yield
    except KeyboardInterrupt:
        logging.getLogger("asyncio").setLevel(logging.CRITICAL)
        raise


def _print_cost(plan: "Plan", threads: int | None, chunk_size: int | None, as_json: bool) -> int:
    from palmbots.studies.cost_estimate import estimate_cost
    from palmbots.studies.points import design_points
    from palmbots.studies.study_runner import layout_of, thread_count

    number = thread_count(threads)
    with staged_progress(as_json) as report:
        points = design_points(plan, lambda fraction: report("checking scenes", fraction))
        cost = estimate_cost(points, layout_of(points, chunk_size), number)
    print_result(cost, as_json=as_json)
    return DONE
