#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The time from the operator's e-stop until both robots rest, with real processes in real time.

    .venv/bin/python benchmarks/bench_e_stop.py [STOPS]      100 by default, for each loss

World, robots and station are the processes of `palmbots up`. The time begins when the order leaves
a screen of the station, and ends when the station knows that both robots have stopped; the wheels'
braking time, 0.12 s from 6 cm/s, is added. So it contains the way of the robots' reports, up to
0.1 s. `bench_live_faults.py` measures the part until the drivers get the command, on a clock of its
own.
Writes benchmarks/results/e_stop_processes.csv.
"""

import csv
import json
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.progress import track
from rich.table import Table

import palmbots as pb
from _machine import processor
from palmbots.links.impairment import Impairment
from palmbots.pair.launcher import LiveCarryProcesses
from palmbots.pair.stopping_limit import stopping_limit_s
from palmbots.station.station_client import StationClient

RESULTS = Path(__file__).parent / "results"
LOSSES = (0.0, 0.05, 0.2)
HEAD = ["loss", "median [s]", "99 % [s]", "longest [s]", "stops"]
WITHIN_S = 20.0


def wait_for(client: StationClient, holds: Callable[[set[str]], bool]) -> float | None:
    """When the robots' modes first were so; None: not in time."""
    give_up = time.monotonic() + WITHIN_S
    while time.monotonic() < give_up:
        client.wait(0.002)
        client.poll()
        if client.state is not None:
            robots = client.state["robots"].values()
            heard = [robot for robot in robots if robot is not None and robot["is_heard"]]
            if len(heard) == 2 and holds({robot["mode"] for robot in heard}):
                return time.monotonic()
    return None


def stops_s(loss: float, count: int) -> list[float]:
    """Times from the key until both robots have reported the stop, and their braking time [s]."""
    scene = pb.load_scene("paper", {"task.distance_m": 1000.0, "control.watchdog_s": 0.6})
    times: list[float] = []
    with tempfile.TemporaryDirectory() as name:
        carry = LiveCarryProcesses(
            scene, "silent", ["--json"], rate=1.0, impairment=Impairment(loss=loss, delay_ms=2.0),
            output=Path(name) / "world", auto=False, on_line=lambda _: None,
        )  # fmt: skip
        with carry:
            client = StationClient(carry.station_address, "operator", 60.0)
            for _ in track(range(count), f"loss {loss:g}", console=Console(stderr=True)):
                for wish, modes in (
                    ("release", {"disarmed", "fault", "armed", "done", "carrying", "holding"}),
                    ("disarm", {"disarmed"}),
                    ("arm", {"armed"}),
                    ("start", {"carrying", "holding"}),
                ):
                    client.wish(wish)
                    wait_for(client, lambda found, modes=modes: found <= modes)
                time.sleep(0.3)
                start_s = time.monotonic()
                client.wish("e_stop")
                end_s = wait_for(client, lambda found: found == {"stopped"})
                if end_s is not None:
                    times.append(end_s - start_s)
            client.close()
    return [seconds + stopping_limit_s(scene) for seconds in times]


def main() -> None:
    """Measure, print and write."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    table = Table(*map(escape, HEAD), title=f"e-stop to rest, {processor()}")
    rows = []
    for loss in LOSSES:
        times = np.array(stops_s(loss, count))
        cells = [f"{100 * loss:g} %"]
        cells += [f"{t:.2f}" for t in (np.median(times), np.quantile(times, 0.99), times.max())]
        rows.append([*cells, str(len(times))])
        table.add_row(*rows[-1])
    Console(highlight=False).print(table)
    print(json.dumps({"rows": rows}))
    with (RESULTS / "e_stop_processes.csv").open("w", newline="") as file:
        csv.writer(file).writerows([HEAD, *rows])


if __name__ == "__main__":
    main()
