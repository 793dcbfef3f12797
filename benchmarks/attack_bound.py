#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Controllers that try to drop less than `palmbots bound` says, in random scenes.

    .venv/bin/python benchmarks/attack_bound.py [SCENES [CARRIES]]

Every scene has the noise at which the design law expects about 1 % of drops, and a perfect radio.
The attackers know the world: they read both contacts, or filter the signs, with several times of
correction, and the optimal policies read the noise, too. Six want both contacts near the tips or
the noses, or one far out and the other far in, so that the object lies flat on a palm. `table` is
the best of a random search over all tables that give palms and wheels for each pair of contact
signs. `level table` is the same with palms that can be level, in every eighth scene. Their robots
keep driving. `standing` and `creeping`, whose robots stand, are measured beside them: the bound
does not hold for them. A z above 3 of one that drives would mean that it beats the bound; a carry
that stalls counts as a drop.
Writes benchmarks/results/attack_bound.csv. SCENES are 0 (the default scene, at 5.9 cm/s) and random
ones, on all cores.
"""

import csv
import itertools
import math
import sys
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

import palmbots as pb
from palmbots._types import SIDES
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.optimum.opening import COARSE, LinearFeedback, best_price, law_m_s, opening_problem
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, STALLED, run_seeds

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from random_scenes import random_scene

RESULT = Path(__file__).parent / "results" / "attack_bound.csv"
TIMES_S = (0.1, 0.2, 0.3, 0.6, 1.0)
PLACES = ((0.5, 0.5), (0.95, 0.95), (-0.95, -0.95), (0.9, -0.9), (-0.9, 0.9), (0.5, -0.5))
STANDING = ("standing", "creeping")
PALMS, DRIVES = ("shallow", "steep"), ("hold", "away", "closer")
Row = tuple[tuple[str, str], tuple[str, str]]
SEARCH = ((20, 150), (50, 150), (200, 80), (800, 30))
"""Carries for each of so many tables, the first of which are random."""
SHORT = ((6, 20), (20, 40), (60, 15))
LEVEL_EVERY = 8
"""Level palms are slow to simulate: a shorter search, and only in every eighth scene."""


def linear(exact: bool, time_s: float) -> ControllerEntry:
    """A reference with linear feedback in this time."""
    base = resolve("exact-p-stopping" if exact else "kalman-stopping")
    name = f"{base.name} in {time_s:g} s"
    return replace(base, name=name, policy_maker=lambda spec: LinearFeedback(exact, True, time_s))


def off_centre(scene: pb.Scene, left: float, right: float) -> ControllerEntry:
    """A reference that wants the contacts at these parts of the palms' half-lengths."""
    parts = zip(SIDES, (left, right), strict=True)
    targets = [part * scene.palm_of(side).reach_m for side, part in parts]
    maker = LinearFeedback(True, True, targets_m=targets)
    name = f"exact-p-stopping at {left:+g}, {right:+g}"
    return replace(resolve("exact-p-stopping"), name=name, policy_maker=lambda spec: maker)


def attackers(scene: pb.Scene) -> list[ControllerEntry]:
    """Nineteen that keep driving, and two that stand."""
    found = [linear(exact, time_s) for exact in (True, False) for time_s in TIMES_S]
    found += [off_centre(scene, *places) for places in PLACES]
    names = ("optimal", "optimal-stopping", "kalman", *STANDING)
    return [*found, *(resolve(name) for name in names)]


def rows_of(table: np.ndarray) -> tuple[Row, ...]:
    """The rows of a table of numbers: two palms and two drives for each pair of signs."""
    return tuple(
        ((PALMS[row[0]], PALMS[row[1]]), (DRIVES[row[2]], DRIVES[row[3]])) for row in table
    )


def searched(spec: Any, name: str, seed: int, search: Sequence[tuple[int, int]]) -> ControllerEntry:
    """The best table of signs that a random search finds.

    It starts from the best of random tables and of those in which each robot corrects its own sign,
    and changes one or two rows at a time. Later comparisons have more carries.
    """
    rng = np.random.default_rng([seed, 97])
    base = ControllerEntry(name, "searched", team="station")

    def entry(table: np.ndarray) -> ControllerEntry:
        return replace(base, station_rows=rows_of(table))

    def failed(table: np.ndarray, carries: int) -> int:
        outcome = run_seeds(spec, entry(table), 0, carries)["outcome"]
        return int((outcome != DELIVERED).sum())

    def corrected(palms: tuple[int, ...], drives: tuple[int, ...]) -> np.ndarray:
        """Both palms and both drives by the sign of the sum of both signs, or of each one."""
        signs = list(itertools.product((1, 0, -1), repeat=2))
        return np.array(
            [[palms[1 - p], palms[1 - q], drives[1 - p], drives[1 - q]] for p, q in signs]
        )

    (carries, tries), *later = search
    starts = [rng.integers(0, (2, 2, 3, 3), (9, 4)) for _ in range(tries)]
    starts += [
        corrected(palms, drives)
        for palms in itertools.product((0, 1), repeat=3)
        for drives in itertools.product((0, 1, 2), repeat=3)
    ]
    best = min(starts, key=lambda table: failed(table, carries))
    for carries, tries in later:
        least = failed(best, carries)
        for _ in range(tries):
            table = best.copy()
            for row in rng.integers(0, 9, rng.integers(1, 3)):
                table[row] = rng.integers(0, (2, 2, 3, 3))
            if (found := failed(table, carries)) <= least:
                best, least = table, found
    return entry(best)


def scene_of(index: int, changes: dict[str, Any]) -> pb.Scene:
    """The default scene, or a random one, with the noise of the law."""
    if index == 0:
        return pb.load_scene("paper", {"robot.noise_m_s": 0.059, **changes})
    scene = random_scene(index, 0.5)
    spec = to_spec(scene)
    law = law_m_s(opening_problem(spec, "stopping"), spec.robots[0].noise_tau)
    return pb.load_scene(scene, {"robot.noise_m_s": 1.1 * law, **changes})


def attack(index: int, carries: int) -> list[tuple[object, ...]]:
    """Rows of a scene: noise, least drop rate, controller, carries, dropped, stalled, z."""
    rows: list[tuple[object, ...]] = []
    for changes in ({}, {"palm.shallow_deg": 0.0})[: 1 + (index % LEVEL_EVERY == 0)]:
        scene = scene_of(index, {"radio.latency_s": 0.0, **changes})
        spec = to_spec(scene)
        noise = round(scene.robot.noise_m_s, 4)
        least = min(max(best_price(opening_problem(spec, "stopping"), COARSE).drop, 0.0), 1.0)
        name, search = ("level table", SHORT) if changes else ("table", SEARCH)
        table = searched(spec, name, index, search)
        for entry in [table] if changes else [*attackers(scene), table]:
            outcome = run_seeds(spec, entry, 10**6, carries)["outcome"]
            dropped, stalled = int((outcome == DROPPED).sum()), int((outcome == STALLED).sum())
            error = math.sqrt(max(carries * least * (1 - least), 1.0))
            z = round((carries * least - dropped - stalled) / error, 1)
            rows.append((index, noise, f"{least:.4g}", entry.name, carries, dropped, stalled, z))
    return rows


def main() -> None:
    """Write the table, row by row."""
    scenes, carries = (int(word) for word in [*sys.argv[1:], *("41", "4000")[len(sys.argv) - 1 :]])
    head = ("scene", "noise_m_s", "least", "controller", "carries", "dropped", "stalled", "z")
    with RESULT.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
            for rows in pool.map(attack, range(scenes), itertools.repeat(carries)):
                writer.writerows(rows)
                file.flush()


if __name__ == "__main__":
    main()
