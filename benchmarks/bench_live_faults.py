#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fault does to a pair of robots with a station, for every controller of robots.

    .venv/bin/python benchmarks/bench_live_faults.py [RUNS]      20 by default

Everything runs that the processes of `palmbots up` run: the core's program of each robot, packets
and station. Only sockets and clocks are replaced, so the results are the same on every machine.
Each run carries over 1 m with other seeds of the wheels' noise and of the radio. The faults are
those of tests/fixtures/live_faults.toml, 2 s after the start.
Writes benchmarks/results/live_faults.csv.

The second table is the time from the operator's e-stop until both drivers get the command to stop.
"""

import csv
import sys
import tempfile
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from palmbots.control.registry import shipped_names
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair

RESULTS = Path(__file__).parent / "results"
TABLE = Path(__file__).parent.parent / "tests" / "fixtures" / "live_faults.toml"
CONTROLLERS = shipped_names("robots")
SCENE = {"task.distance_m": 1.0}
BEGIN_TICKS = 200
LIMIT_TICKS = 4000
WATCH_TICKS = 1000
E_STOPS = 200


def nothing(pair: SimulatedPair, whom: Any) -> None:
    """The radio or a clock alone is bad."""


def gone(pair: SimulatedPair, whom: str) -> None:
    """Nothing from the station reaches a robot."""
    pair.air.cut((whom, "left"), (whom, "right"))


def connected(pair: SimulatedPair, whom: Any) -> None:
    """All hear each other again."""
    pair.air.cut()


Act = Callable[[SimulatedPair, Any], object]
KINDS: dict[str, tuple[Act, Act]] = {
    "radio": (nothing, nothing),
    "clock": (nothing, nothing),
    "cut": (lambda pair, whom: pair.air.cut(tuple(whom)), connected),
    "robot-off": (SimulatedPair.power_off, SimulatedPair.boot),
    "robot-held-up": (
        lambda pair, whom: pair.frozen.add(whom),
        lambda pair, whom: pair.frozen.discard(whom),
    ),
    "station-off": (gone, lambda pair, whom: (pair.air.cut(), pair.restart_station())),
    "station-held-up": (gone, connected),
}
"""What begins a fault and what ends it. The world cannot fail here: it is part of this program."""
FAULTS = {
    name: fault
    for name, fault in tomllib.loads(TABLE.read_text(encoding="utf-8")).items()
    if fault["kind"] in KINDS
}


def outcome(controller: str, fault: str, seed: int) -> str:
    """How one run ends."""
    given = FAULTS[fault]
    begin, end = KINDS[given["kind"]]
    whom, lasts = given.get("whom"), round(100 * given.get("lasts_s", 0))
    with tempfile.TemporaryDirectory() as folder:
        air = Air(seed, **({"delay_ms": 20.0} | given.get("radio", {})))
        pair = SimulatedPair(Path(folder), controller, air, UP, SCENE, seed=seed)
        if "rate" in given:
            pair.clock_rate[whom] = given["rate"]
        pair.run(50)
        pair.station.wish("arm")
        pair.run_until(("armed",))
        pair.station.wish("start")
        tick = -1  # ticks since both carry
        for _ in range(LIMIT_TICKS):
            if tick >= 0 or all(mode in ("carrying", "holding") for mode in pair.modes()):
                tick += 1
                if tick == BEGIN_TICKS:
                    begin(pair, whom)
                if tick == BEGIN_TICKS + lasts:
                    end(pair, whom)
            pair.tick()
            if pair.stage.outcome == "dropped":
                return "dropped" if tick > 0 else "dropped at the start"
            modes = {robot.mode for robot in pair.robots.values()}
            if len(pair.robots) == 2 and modes == {"done"}:
                return "delivered"
            if tick > BEGIN_TICKS + WATCH_TICKS and modes <= {"fault", "stopped", "disarmed"}:
                codes = sorted({robot.fault for robot in pair.robots.values()} - {"none"})
                return f"ended ({', '.join(codes) or 'stopped'})"
        return "hangs"


def e_stop_ticks(loss: float, seed: int) -> int:
    """Ticks from the operator's e-stop until both drivers get the command to stop."""
    with tempfile.TemporaryDirectory() as folder:
        pair = SimulatedPair(Path(folder), "resilient", Air(seed, loss=loss), UP, SCENE)
        pair.run(50)
        pair.start()
        pair.run(50 + seed % 5)  # the key may be pressed anywhere in the station's period
        pair.station.wish("e_stop")
        for ticks in range(1, 1000):
            pair.tick()
            if pair.modes() == ("stopped", "stopped"):
                return ticks
    raise AssertionError("no stop")


def main() -> None:
    """Run everything, print and write the tables."""
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    console = Console(highlight=False, soft_wrap=True)
    table = Table("fault", *CONTROLLERS, title=f"{runs} runs each")
    rows = []
    for fault in track(FAULTS, console=Console(stderr=True)):
        cells = []
        for controller in CONTROLLERS:
            counts = Counter(outcome(controller, fault, seed) for seed in range(runs))
            cells.append(", ".join(f"{n} {name}" for name, n in counts.most_common()))
        table.add_row(fault, *cells)
        rows.append([fault, *cells])
    console.print(table)
    stops = Table("loss", "median [s]", "99 % [s]", "longest [s]", title="e-stop until both stop")
    stop_rows = []
    for loss in (0.0, 0.05, 0.2):
        times = 0.01 * np.array([e_stop_ticks(loss, seed) for seed in range(E_STOPS)])
        cells = [f"{100 * loss:g} %"]
        cells += [f"{t:.2f}" for t in (np.median(times), np.quantile(times, 0.99), times.max())]
        stops.add_row(*cells)
        stop_rows.append(cells)
    console.print(stops)
    for name, head, body in (
        ("live_faults", ["fault", *CONTROLLERS], rows),
        ("e_stop", ["loss", "median [s]", "99 % [s]", "longest [s]"], stop_rows),
    ):
        with (RESULTS / f"{name}.csv").open("w", newline="") as file:
            csv.writer(file).writerows([head, *body])


if __name__ == "__main__":
    main()
