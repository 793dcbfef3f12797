#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every controller under every condition: how often it drops the object, and what it costs.

    .venv/bin/python benchmarks/bench_robustness.py [CARRIES [CONDITION ...]]

By default 4000 carries of all conditions. Rows of other conditions stay, and so do those of
household objects whose scans are missing (_household.py).

A condition is one change of the default scene. Drops are counted at a speed noise of 1, 2 and
3 cm/s, everything else at 2 cm/s; palm moves and wheel reversals in the traces of 100 carries.
bench_rare_drops.py estimates the small drop rates at 1 cm/s. Writes
benchmarks/results/robustness.csv. Seeds are 0, 1, …; the counts depend on nothing but the version.
"""

import csv
import itertools
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import palmbots as pb
from _household import HOUSEHOLD
from palmbots.control.registry import shipped_names
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import DELIVERED, DROPPED, Columns, available_cores, run_seeds
from palmbots.simulation.prepare import prepare

RESULT = Path(__file__).parent / "results" / "robustness.csv"
TRACES = 100
CLOCK = 20_000  # parts per million

OBJECTS = [name for name in pb.object_names() if name != "box"]

# A condition: what it is called, the scene, and the keys that it sets.
Condition = tuple[str, str, dict[str, Any]]
CONDITIONS: tuple[Condition, ...] = (
    ("default scene", "paper", {}),
    ("latency 0.2 s", "paper", {"radio.latency_s": 0.2}),
    ("loss 20 %", "paper", {"radio.loss": 0.2}),
    ("bursts of loss, 60 % of the time", "paper", {"radio.burst_fraction": 0.6}),
    ("one reboot", "paper", {"faults.random_reboots": 1}),
    ("false readings 1 %", "paper", {"tactile.false_rate": 0.01}),
    ("a bump of 10 mm every 0.3 m", "paper", {
        "bumps.script": [
            {"robot": ("left", "right")[i % 2], "at_m": 0.3 * (i + 1), "shift_m": 0.01}
            for i in range(4)
        ]}),
    ("bias +1.5 cm/s of the left robot", "paper", {"robot.left.bias_m_s": 0.015}),
    ("bias −1.5 cm/s of the left robot", "paper", {"robot.left.bias_m_s": -0.015}),
    ("slope 3°", "paper", {"task.slope_deg": 3.0}),
    ("friction 0.2 and 0.4", "paper", {"palm.left.friction": 0.2, "palm.right.friction": 0.4}),
    ("COM 3 cm off the middle", "paper", {"object.com_m": [0.155, 0.04]}),
    ("palms of 10 cm", "paper", {"palm.length_m": 0.1}),
    *((f"object `{name}`", "paper", {"object": name}) for name in OBJECTS),
    ("scene `pipe`", "pipe", {}),
    ("corrections of 2 cm/s", "paper", {"robot.correction_m_s": 0.02}),
    ("zone of ±10 mm", "paper", {"tactile.zero_half_width_m": 0.01}),
    ("one clock 2 % fast", "paper", {"robot.left.clock_ppm": CLOCK}),
    ("noise with τ = 0.1 s", "paper", {"robot.noise_tau_s": 0.1}),
    ("noise with τ = 2 s", "paper", {"robot.noise_tau_s": 2.0}),
)  # fmt: skip


def scene_of(condition: Condition, noise: float) -> pb.Scene:
    """The scene of a condition at a speed noise [m/s]."""
    _, name, keys = condition
    return pb.load_scene(name, keys | {"robot.noise_m_s": noise})


def many(scene: pb.Scene, controller: str, n: int) -> Columns:
    """Metrics of n carries.

    Raises:
        SceneError: the controller refuses the scene.
    """
    prepared = prepare(scene, controller)
    return run_seeds(to_spec(prepared.scene), controller, 0, n, threads=available_cores())


def per_metre(scene: pb.Scene, controller: str) -> tuple[float, float]:
    """Palm moves and wheel reversals of both robots per metre of travel."""
    moves = reversals = distance = 0.0
    for seed in range(TRACES):
        carry = pb.carry(scene, controller, seed=seed)
        assert carry.trace is not None
        turning = np.diff(carry.trace["palm"].to_numpy(), axis=0) != 0
        begins = turning[1:] & ~turning[:-1]
        moves += begins.sum() + turning[0].sum()
        forward = np.sign(carry.trace["commanded"].to_numpy())
        for side in forward.T:
            moving = side[side != 0]
            reversals += np.count_nonzero(np.diff(moving))
        distance += float(np.ptp(carry.trace["midpoint"].to_numpy()))
    return moves / distance, reversals / distance


def row(condition: Condition, controller: str, n: int) -> dict[str, Any]:
    """One cell."""
    scene = scene_of(condition, 0.02)
    cell = many(scene, controller, n)
    noisy = many(scene_of(condition, 0.03), controller, n)
    moves, reversals = per_metre(scene, controller)
    calm = scene_of(condition, 0.01)
    rare = int((many(calm, controller, n)["outcome"] == DROPPED).sum())
    delivered = cell["outcome"] == DELIVERED
    return {
        "condition": condition[0],
        "controller": controller,
        "carries": n,
        "dropped_1_cm_s": rare,
        "dropped_2_cm_s": int((cell["outcome"] == DROPPED).sum()),
        "stalled_2_cm_s": int(n - delivered.sum() - (cell["outcome"] == DROPPED).sum()),
        "dropped_3_cm_s": int((noisy["outcome"] == DROPPED).sum()),
        "rms_mm": round(1e3 * float(np.sqrt(np.mean(cell["contact_rms_m"] ** 2))), 2),
        "time_s": round(float(cell["time_s"][delivered].mean()), 2) if delivered.any() else "",
        "messages_per_m": round(float(cell["messages"].sum() / cell["distance_m"].sum()), 1),
        "palm_moves_per_m": round(float(moves), 1),
        "reversals_per_m": round(float(reversals), 2),
    }


def household() -> Iterator[Condition]:
    """The objects whose scans are there; the others are named."""
    for one in HOUSEHOLD:
        try:
            yield f"object {one.name}", "paper", one.keys()
        except FileNotFoundError as error:
            print(error, flush=True)


def cells(condition: Condition, n: int) -> Iterator[dict[str, Any]]:
    """The rows of a condition."""
    for controller in shipped_names("station", "robots"):
        try:
            yield row(condition, controller, n)
        except pb.SceneError as error:
            print(f"{condition[0]}: {error}", flush=True)
            yield {"condition": condition[0], "controller": controller, "carries": 0}


def main() -> None:
    """Run all cells and write the file after each condition."""
    n, only = int((sys.argv[1:] or ["4000"])[0]), sys.argv[2:]
    with RESULT.open(newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file)
        head, known = reader.fieldnames, list(reader)
    rows = {
        name: [row for row in known if row["condition"] == name]
        for name in [
            *(condition[0] for condition in CONDITIONS),
            *(f"object {one.name}" for one in HOUSEHOLD),
        ]
    }
    for condition in (*CONDITIONS, *household()):
        if only and condition[0] not in only:
            continue
        rows[condition[0]] = []
        for cell in cells(condition, n):
            rows[condition[0]].append(cell)
            print(*cell.values(), sep="  ", flush=True)
        with RESULT.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, head or (), lineterminator="\n")
            writer.writeheader()
            writer.writerows(itertools.chain(*rows.values()))


if __name__ == "__main__":
    main()
