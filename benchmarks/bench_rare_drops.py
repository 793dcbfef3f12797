#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The drop rate at 1 cm/s of noise, for every controller under every condition.

    .venv/bin/python benchmarks/bench_rare_drops.py [new]

Where 20 or more of the 4000 carries of bench_robustness.py dropped, the rate is their share. The
other rates are estimated by multilevel splitting: 16 independent replicates with 250 carries in
each stage, whose mean is unbiased, with a 95 % interval by Student's t. Levels are added until one
carry in 10^9 would reach the last one. If no replicate drops, or one of them contributes half of
the estimate, only an upper bound is stated: the probability that a contact gets as far out as the
last level that at least 12 replicates reached. It is the upper end of its interval. Where the 4000
carries of bench_robustness.py give a tighter bound, theirs is stated.

Takes about fifteen minutes of one core. Writes benchmarks/results/rare_drops.csv after each cell
and continues where it was stopped; `new` starts from the beginning.
"""

import csv
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import palmbots._core as _core
from _cells import Cells
from bench_robustness import CONDITIONS, RESULT, Condition, scene_of
from palmbots._util.confidence_intervals import student_t95, wilson
from palmbots.control.registry import resolve
from palmbots.simulation.prepare import prepare

RARE = RESULT.with_name("rare_drops.csv")
NOISE_M_S = 0.01
ENOUGH = 20  # drops that make the share of the carries good enough
EFFORT = 250
REPLICATES = 16
SHARE = 0.4
DEEPEST = 1e-9
OFTEN = 12  # replicates that have to reach a level which gives a bound
HEAD = ("condition", "controller", "method", "rate", "low", "high")


def splitting(condition: Condition, controller: str) -> tuple[str, float, float, float]:
    """The method (estimate or bound), the rate and its interval; the rate of a bound is 0."""
    entry = resolve(controller)
    spec = prepare(scene_of(condition, NOISE_M_S), entry).spec
    core = entry.for_core(spec)
    levels, _ = _core.choose_levels(spec, core, 0, EFFORT, SHARE)
    levels = levels[: math.ceil(math.log(DEEPEST) / math.log(SHARE))]
    rows, _ = _core.replicates(spec, core, 0, EFFORT, levels, 0, REPLICATES, 1)
    stages = np.array(rows, float) / EFFORT
    reached, dropped = stages[:, :, 0], stages[:, :, 1]
    before = np.concatenate([np.ones((REPLICATES, 1)), np.cumprod(reached, axis=1)], axis=1)
    drops = np.sum(before[:, :-1] * dropped, axis=1)
    if drops.max() > 0 and drops.max() < 0.5 * drops.sum():
        return ("estimate", *interval(drops))
    # A carry that drops either reaches a level or has dropped before.
    until = np.cumsum(before[:, :-1] * dropped, axis=1) + before[:, 1:]
    often = np.nonzero(np.count_nonzero(before[:, 1:-1], axis=0) >= OFTEN)[0]
    at = int(often[-1]) if len(often) else 0
    return ("bound", 0.0, 0.0, interval(until[:, at])[2])


def interval(estimates: NDArray[Any]) -> tuple[float, float, float]:
    """Their mean, and its 95 % interval."""
    mean = float(estimates.mean())
    half = student_t95(REPLICATES - 1) * float(estimates.std(ddof=1)) / math.sqrt(REPLICATES)
    return mean, max(mean - half, 0.0), min(mean + half, 1.0)


def rate(condition: Condition, row: dict[str, str]) -> tuple[str, float, float, float]:
    """The rate of one cell of bench_robustness.py."""
    drops, carries = int(row["dropped_1_cm_s"]), int(row["carries"])
    if drops >= ENOUGH:
        return ("carries", drops / carries, *wilson(drops, carries))
    return tighter(splitting(condition, row["controller"]), drops, carries)


def tighter(
    rate: tuple[str, float, float, float], drops: int, carries: int
) -> tuple[str, float, float, float]:
    """A bound by splitting says little where a contact often comes far out and returns."""
    method, mean, low, high = rate
    if method != "bound":
        return rate
    if drops:
        return ("carries", drops / carries, *wilson(drops, carries))
    return (method, mean, low, min(high, wilson(drops, carries)[1]))


def main() -> None:
    """Compute the cells that the file lacks."""
    with RESULT.open(newline="", encoding="utf-8") as file:
        cells = [row for row in csv.DictReader(file) if int(row["carries"])]
    done = Cells(RARE, HEAD, 2)
    by_name = {condition[0]: condition for condition in CONDITIONS}
    for cell in cells:
        key = (cell["condition"], cell["controller"])
        if done.row(*key) is None:
            method, *numbers = rate(by_name[cell["condition"]], cell)
            done.add(*key, method, *(f"{number:.2g}" for number in numbers))


if __name__ == "__main__":
    main()
