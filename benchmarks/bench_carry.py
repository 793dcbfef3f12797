# SPDX-License-Identifier: Apache-2.0
"""One carry of the default scene here, in pymunk, Box2D, Rapier and MuJoCo, in one run.

    .venv/bin/python benchmarks/bench_carry.py

Prints a table with ratios and writes benchmarks/results/carry.csv. docs/reference/benchmarks.md has
the method. Times are those of the processor, so that other programs matter little.
"""

import csv
import datetime
import platform
import statistics
import time
from pathlib import Path

import mujoco
from rich.console import Console
from rich.table import Table

import palmbots._core as _core
from _machine import compiler, processor
from palmbots._version import __version__
from palmbots.control.registry import shipped_names
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds
from peers import common_task as task
from peers import peer_box2d, peer_mujoco, peer_pymunk, peer_rapier

RESULTS = Path(__file__).parent / "results" / "carry.csv"
CARRIES, REPEATS, SEEDS = 4000, 9, 4
PEERS = {
    "pymunk": (peer_pymunk.Pymunk, peer_pymunk.version()),
    "Box2D": (peer_box2d.Box2d, peer_box2d.version()),
    "Rapier": (peer_rapier.Rapier, peer_rapier.version()),
    "MuJoCo": (peer_mujoco.Mujoco, mujoco.__version__),
}


# What is timed here: its name, the controller, and scene keys other than the default's.
CASES: list[tuple[str, str, dict[str, object]]] = [
    *((name, name, {}) for name in shipped_names()),
    ("distributed, palms 1 cm above their pivots", "distributed", {"palm.pivot_offset_m": 0.01}),
    ("distributed, 1 % of messages lost", "distributed", {"radio.loss": 0.01}),
    ("centralized, 1 % of messages lost", "centralized", {"radio.loss": 0.01}),
    ("resilient, 1 % of messages lost", "resilient", {"radio.loss": 0.01}),
    ("distributed, false readings", "distributed", {"tactile.false_rate": 0.001}),
    ("distributed, one reboot", "distributed", {"faults.random_reboots": 1}),
    ("centralized, one reboot", "centralized", {"faults.random_reboots": 1}),
    ("resilient, one reboot", "resilient", {"faults.random_reboots": 1}),
    (
        "shared-sign, one reboot and 1 % of messages lost",
        "shared-sign",
        {"faults.random_reboots": 1, "radio.loss": 0.01},
    ),
    ("distributed, one bump a metre", "distributed", {"bumps.rate_per_m": 1.0}),
]


def palmbots_us(controller: str, keys: dict[str, object], precision: str) -> float:
    """Microseconds a carry, trace and hash off: the median of several runs of many carries."""
    spec = to_spec(load_scene("paper", keys))
    times = []
    for _ in range(REPEATS):
        start = time.process_time()
        run_seeds(spec, controller, 0, CARRIES, precision)
        times.append((time.process_time() - start) / CARRIES)
    return 1e6 * statistics.median(times)


def one_by_one_us() -> float:
    """Microseconds a carry of the distributed algorithm in double precision, by itself."""
    spec = to_spec(Scene())
    times = []
    for seed in range(200):
        start = time.process_time()
        _core.run(spec, "distributed", seed, "double", False)
        times.append(time.process_time() - start)
    return 1e6 * statistics.median(times)


def main() -> None:
    """Time everything, print a table and write the CSV."""
    console = Console(width=120)
    rows: list[tuple[str, str, float, str]] = []
    for name, controller, keys in CASES:
        for precision in ("double", "float"):
            rows.append(
                (f"palmbots, {name}, {precision}", __version__,
                 palmbots_us(controller, keys, precision), "")
            )  # fmt: skip
    rows.append(("palmbots, distributed, double, one by one", __version__, one_by_one_us(), ""))
    for name, (engine, version) in PEERS.items():
        console.print(f"{name} …", end="\r")
        results = [task.carry(engine(), seed) for seed in range(SEEDS)]
        dropped = sum(r.outcome == "dropped" for r in results)
        rms = 1e3 * statistics.mean(r.rms_m for r in results)
        result = f"{dropped} of {SEEDS} dropped, rms {rms:.1f} mm"
        rows.append(
            (f"{name}, engine alone", version,
             1e6 * statistics.median(r.engine_s for r in results), result)
        )  # fmt: skip
        rows.append(
            (f"{name}, with its loop in Python", version,
             1e6 * statistics.median(r.total_s for r in results), result)
        )  # fmt: skip
    (base,) = [us for what, _, us, _ in rows if what == "palmbots, distributed, double"]
    table = Table("one carry of 25 s", "version", "µs", "ratio", "carried")
    for what, version, us, result in rows:
        table.add_row(what, version, f"{us:,.0f}", f"{us / base:,.2f}", result)
    console.print(table)

    machine, built = processor(), compiler()
    console.print(f"{machine}; Python {platform.python_version()}")
    RESULTS.parent.mkdir(exist_ok=True)
    with RESULTS.open("w", newline="") as file:
        out = csv.writer(file)
        out.writerow(
            ["what", "version", "us", "ratio", "carried", "machine", "python", "compiler", "date"]
        )
        for what, version, us, result in rows:
            out.writerow(
                [what, version, f"{us:.1f}", f"{us / base:.3f}", result, machine,
                 platform.python_version(), built,
                 datetime.date.today().isoformat()]
            )  # fmt: skip
    console.print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
