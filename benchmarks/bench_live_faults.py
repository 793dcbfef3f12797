#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fault does to a pair of robots with a station, for every controller of robots.

    .venv/bin/python benchmarks/bench_live_faults.py [RUNS]      20 by default

Everything runs that the processes of `palmbots up` run: the core's program of each robot, packets
and station. Only sockets and clocks are replaced, so the results are the same on every machine.
Each run carries over 1 m with other seeds of the wheels' noise and of the radio. The faults are
those of tests/support/live_faults.py, 2 s after the start.
Writes benchmarks/results/live_faults.csv.

The second table is the time from the operator's e-stop until both drivers get the command to stop.
"""

import csv
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from palmbots.control.registry import shipped_names
from palmbots.pair.launcher import UP
from palmbots.station.simulated_pair import Air, SimulatedPair

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "support"))
from live_faults import FAULTS

RESULTS = Path(__file__).parent / "results"
CONTROLLERS = shipped_names("robots")
SCENE = {"task.distance_m": 1.0}
BEGIN_TICKS = 200
LIMIT_TICKS = 4000
WATCH_TICKS = 1000
E_STOPS = 200
NAMES = [name for name, fault in FAULTS.items() if fault.whom != "world"]
"""The world cannot fail here: it is part of this program."""


class _Parts:
    """What a fault does to a simulated pair. A station that is off or held up is not heard."""

    def __init__(self, pair: SimulatedPair) -> None:
        self._pair = pair

    def cut(self, *directions: tuple[str, str]) -> None:
        self._pair.air.cut(*directions)

    def kill(self, whom: Any) -> None:
        if whom == "station":
            self.suspend(whom)
        else:
            self._pair.power_off(whom)

    def restart(self, whom: Any) -> None:
        if whom == "station":
            self.resume(whom)
            self._pair.restart_station()
        else:
            self._pair.boot(whom)

    def suspend(self, whom: Any) -> None:
        if whom == "station":
            self.cut((whom, "left"), (whom, "right"))
        else:
            self._pair.frozen.add(whom)

    def resume(self, whom: Any) -> None:
        if whom == "station":
            self.cut()
        else:
            self._pair.frozen.discard(whom)


def outcome(controller: str, fault: str, seed: int) -> str:
    """How one run ends."""
    given = FAULTS[fault]
    end_ticks = BEGIN_TICKS + round(100 * given.lasts_s)
    with tempfile.TemporaryDirectory() as folder:
        air = Air(seed, **{"delay_ms": 20.0, **given.radio})
        pair = SimulatedPair(Path(folder), controller, air, UP, SCENE, seed=seed)
        pair.clock_rate |= given.clock_rate
        parts = _Parts(pair)
        pair.run(50)
        pair.station.wish("arm")
        pair.run_until(("armed",))
        pair.station.wish("start")
        tick = -1  # ticks since both carry
        for _ in range(LIMIT_TICKS):
            if tick >= 0 or all(mode in ("carrying", "holding") for mode in pair.modes()):
                tick += 1
                if tick == BEGIN_TICKS:
                    given.begin(parts)
                if tick == end_ticks:
                    given.end(parts)
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


def e_stop_ticks(loss: float, seed: int) -> int | None:
    """Ticks from the operator's e-stop until both drivers get the command to stop.

    None if the carry does not start, because a ready robot did not hear its partner in time.
    """
    with tempfile.TemporaryDirectory() as folder:
        pair = SimulatedPair(Path(folder), "resilient", Air(seed, loss=loss), UP, SCENE)
        pair.run(50)
        try:
            pair.start()
        except AssertionError:
            return None
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
    for fault in track(NAMES, console=Console(stderr=True)):
        cells = []
        for controller in CONTROLLERS:
            counts = Counter(outcome(controller, fault, seed) for seed in range(runs))
            cells.append(", ".join(f"{n} {name}" for name, n in counts.most_common()))
        table.add_row(fault, *cells)
        rows.append([fault, *cells])
    console.print(table)
    head = ["loss", "not started", "median [s]", "99 % [s]", "longest [s]"]
    stops = Table(*head, title=f"{E_STOPS} e-stops until both stop")
    stop_rows = []
    for loss in (0.0, 0.05, 0.2):
        ticks = [e_stop_ticks(loss, seed) for seed in range(E_STOPS)]
        times = 0.01 * np.array([one for one in ticks if one is not None])
        cells = [f"{100 * loss:g} %", str(E_STOPS - len(times))]
        cells += [f"{t:.2f}" for t in (np.median(times), np.quantile(times, 0.99), times.max())]
        stops.add_row(*cells)
        stop_rows.append(cells)
    console.print(stops)
    for name, columns, body in (
        ("live_faults", ["fault", *CONTROLLERS], rows),
        ("e_stop", head, stop_rows),
    ):
        with (RESULTS / f"{name}.csv").open("w", newline="") as file:
            csv.writer(file).writerows([columns, *body])


if __name__ == "__main__":
    main()
