# SPDX-License-Identifier: Apache-2.0
"""The command `palmbots study`."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from palmbots._util.command import Option, command
from palmbots._util.exit_status import DONE
from palmbots.cli._progress import staged_progress
from palmbots.cli._run import check_output, interruption_line, print_result
from palmbots.cli._warnings import print_held_warnings, warn
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
    source=Option(is_argument=True, metavar="FILE"),
    out=Option(metavar="DIR"),
    carries=Option("--carries -n"),
    scheduler=Option(metavar="ADDRESS"),
    local_cluster=Option(metavar="N"),
)
def study(
    source: str,
    out: Path | None = None,
    carries: int | None = None,
    threads: int | None = None,
    chunk_size: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    plot: bool = False,
    estimate_cost: bool = False,
    unproved: bool = False,
    as_json: bool = False,
) -> int:
    """Run a study: any scene keys × controllers × seeds.

    Finished chunks are kept. You can stop a study at any time and rerun the
    command to continue; the results are the same to the bit.

    Args:
        source: TOML study file or built-in study name.
        out: write the results to this folder; None: NAME.study.
        carries: carries per cell; None: as in the file.
        threads: worker threads; None: all cores.
        chunk_size: carries per chunk (approximate).
        scheduler: use the workers of a Dask scheduler.
        local_cluster: start N local Dask workers instead.
        plot: write curves or maps to study.png in the folder.
        estimate_cost: print carries, time and disk space; run nothing.
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
