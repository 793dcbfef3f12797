#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Controllers that try to drop less than `palmbots bound` says, in random scenes.

    .venv/bin/python benchmarks/attack_bound.py [SCENES [CARRIES]]

Every scene has the noise at which the design law expects about 1 % of drops. The attackers know the
world: they read both contacts, or filter the signs, with several times of correction, and the
optimal policies read the noise, too. Their robots keep driving. `standing` and `creeping`, whose
robots stand, are measured beside them: the bound does not hold for them. A z above 3 of one that
drives would mean that it beats the bound. Writes benchmarks/results/attack_bound.csv. SCENES are 0
(the default scene, at 5.9 cm/s) and random ones.
"""

import csv
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import palmbots as pb
from palmbots.control.registry import ControllerEntry, resolve
from palmbots.optimum.opening import COARSE, LinearFeedback, best_price, law_m_s, opening_problem
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DROPPED, STALLED, run_seeds

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))

from random_scenes import random_scene

RESULT = Path(__file__).parent / "results" / "attack_bound.csv"
TIMES_S = (0.1, 0.2, 0.3, 0.6, 1.0)
STANDING = ("standing", "creeping")


def linear(exact: bool, time_s: float) -> ControllerEntry:
    """A reference with linear feedback in this time."""
    base = resolve("exact-p-stopping" if exact else "kalman-stopping")
    name = f"{base.name} in {time_s:g} s"
    return replace(base, name=name, policy_maker=lambda spec: LinearFeedback(exact, True, time_s))


def attackers() -> list[ControllerEntry]:
    """Thirteen that keep driving, and two that stand."""
    found = [linear(exact, time_s) for exact in (True, False) for time_s in TIMES_S]
    names = ("optimal", "optimal-stopping", "kalman", *STANDING)
    return [*found, *(resolve(name) for name in names)]


def scene_of(index: int) -> pb.Scene:
    """The default scene, or a random one, with the noise of the law."""
    if index == 0:
        return pb.load_scene("paper", {"robot.noise_m_s": 0.059})
    scene = random_scene(index, 0.5)
    spec = to_spec(scene)
    law = law_m_s(opening_problem(spec, "stopping"), spec.robots[0].noise_tau)
    return pb.load_scene(scene, {"robot.noise_m_s": 1.1 * law})


def attack(scenes: int, carries: int) -> Iterator[tuple[object, ...]]:
    """Rows: scene, noise, least drop rate, controller, carries, dropped, stalled, z."""
    for index in range(scenes):
        scene = scene_of(index)
        spec = to_spec(scene)
        noise = round(scene.robot.noise_m_s, 4)
        least = min(max(best_price(opening_problem(spec, "stopping"), COARSE).drop, 0.0), 1.0)
        for entry in attackers():
            outcome = run_seeds(spec, entry, 10**6, carries)["outcome"]
            dropped, stalled = int((outcome == DROPPED).sum()), int((outcome == STALLED).sum())
            error = math.sqrt(max(carries * least * (1 - least), 1.0))
            z = round((carries * least - dropped) / error, 1)
            yield index, noise, f"{least:.4g}", entry.name, carries, dropped, stalled, z


def main() -> None:
    """Write the table, row by row."""
    scenes, carries = (int(word) for word in [*sys.argv[1:], *("41", "4000")[len(sys.argv) - 1 :]])
    head = ("scene", "noise_m_s", "least", "controller", "carries", "dropped", "stalled", "z")
    with RESULT.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        for row in attack(scenes, carries):
            writer.writerow(row)
            file.flush()


if __name__ == "__main__":
    main()
