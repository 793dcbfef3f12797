#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fault does to a pair of robots with a station, for every controller of robots.

    .venv/bin/python benchmarks/bench_live_faults.py [RUNS]      20 by default

Everything runs that the processes of `palmbots up` run: the core's program of each robot, packets
and station. Only sockets and clocks are replaced, so the results are the same on every machine.
Each run carries over 1 m with another seed of the radio. The fault comes 2 s after the start.
Writes benchmarks/results/live_faults.csv.

The second table is the time from the operator's e-stop until both drivers get the command to stop.
"""

import csv
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from palmbots.control.registry import shipped_names
from palmbots.station.simulated_pair import Air, SimulatedPair

RESULTS = Path(__file__).parent / "results"
CONTROLLERS = shipped_names("robots")
UP: dict[str, object] = {"limits.after_reboot": "rejoin", "limits.partner_lost": "controller"}
SCENE = {"task.distance_m": 1.0}
BEGIN_TICKS = 200
LIMIT_TICKS = 4000
WATCH_TICKS = 1000
E_STOPS = 200


def reboot(pair: SimulatedPair, tick: int) -> None:
    """The left robot is off for half a second."""
    if tick == BEGIN_TICKS:
        pair.power_off("left")
    if tick == BEGIN_TICKS + 50:
        pair.boot("left")


def freeze(pair: SimulatedPair, tick: int) -> None:
    """The right robot's program is held up for five seconds."""
    if tick == BEGIN_TICKS:
        pair.frozen = {"right"}
    if tick == BEGIN_TICKS + 500:
        pair.frozen = set()  # held up for longer than the watchdog's time, it starts again


def blackout(pair: SimulatedPair, tick: int) -> None:
    """The right robot hears nothing from the left one for three seconds."""
    if tick == BEGIN_TICKS:
        pair.air.cut = {("left", "right")}
    if tick == BEGIN_TICKS + 300:
        pair.air.cut = set()


def station_off(pair: SimulatedPair, tick: int) -> None:
    """The station is gone for three seconds, and starts again."""
    if tick == BEGIN_TICKS:
        pair.air.cut = {("station", "left"), ("station", "right")}
    if tick == BEGIN_TICKS + 300:
        pair.air.cut = set()
        pair.restart_station()


def drift(pair: SimulatedPair, tick: int) -> None:
    """The left robot's clock runs 2 % fast."""
    pair.clock_rate["left"] = 1.02


def nothing(pair: SimulatedPair, tick: int) -> None:
    """The radio alone is bad."""


FAULTS: dict[str, tuple[dict[str, float], Callable[[SimulatedPair, int], None]]] = {
    "none": ({}, nothing),
    "loss 20 %": ({"loss": 0.2}, nothing),
    "delay 50 ± 30 ms": ({"delay": 5, "jitter": 3}, nothing),
    "copies 20 %": ({"duplicate": 0.2}, nothing),
    "one direction dead for 3 s": ({}, blackout),
    "left robot reboots, 0.5 s": ({}, reboot),
    "right program held up for 5 s": ({}, freeze),
    "station off for 3 s": ({}, station_off),
    "one clock 2 % fast": ({}, drift),
}


def outcome(controller: str, fault: str, seed: int) -> str:
    """How one run ends."""
    radio, act = FAULTS[fault]
    with tempfile.TemporaryDirectory() as folder:
        air = Air(**({"delay": 2} | radio), seed=seed)  # type: ignore[arg-type]
        pair = SimulatedPair(Path(folder), controller, air, UP, SCENE)
        pair.run(50)
        pair.station.wish("arm")
        pair.run_until(("armed",))
        pair.station.wish("start")
        tick = -1  # ticks since both carry
        for _ in range(LIMIT_TICKS):
            if tick >= 0 or all(mode in ("carrying", "holding") for mode in pair.modes()):
                tick += 1
                act(pair, tick)
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
        pair = SimulatedPair(Path(folder), "resilient", Air(1, loss, seed=seed), UP, SCENE)
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
