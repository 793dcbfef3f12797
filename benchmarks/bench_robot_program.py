#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the program of one robot costs: memory, time to the first tick, processor time, jitter.

    .venv/bin/python benchmarks/bench_robot_program.py [SECONDS]      20 by default

A process of `palmbots robot` carries with the controller `silent`: it gets a reading of its driver
and packets of its station in every control period of 10 ms, as from a world and a station. Targets:
under 80 MB, under 1 s to the first tick, and at most 5 % of one core.
Writes benchmarks/results/robot_program.csv.
"""

import contextlib
import csv
import json
import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from _machine import processor
from palmbots.links.local_connection import Connection, ConnectionLost, listen
from palmbots.links.reading_frame import ReadingFrame
from palmbots.pair.launcher import free_addresses
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.wire import Endpoint, Hello, Operate

RESULTS = Path(__file__).parent / "results"
PERIOD_S = 0.01
TARGETS = {"memory [MB]": 80.0, "to the first tick [s]": 1.0, "processor time [%]": 5.0}


def cpu_s(number: int) -> float:
    """Processor time of a process so far [s]."""
    fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mb(number: int) -> float:
    """The most memory that a process has had [MB]."""
    status = Path(f"/proc/{number}/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1000


def measured(seconds: float) -> tuple[dict[str, float], dict[str, Any]]:
    """The figures, and what the program itself reports."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        with free_addresses(3) as addresses:
            links = dict(zip(("left", "right", "station"), addresses, strict=True))
        values: dict[str, object] = {f"link.{end}": place for end, place in links.items()}
        address = f"unix:{folder / 'world'}"
        pair = load_pair(
            init_pair(folder / "pair.toml", controller="silent", address=address, values=values)[0]
        )
        station = Endpoint(pair.key, pair.settings.pair.number, "station", 1)
        with listen(address) as door, socket.socket(type=socket.SOCK_DGRAM) as radio:
            host, _, port = links["station"].partition(":")
            radio.bind((host, int(port)))
            radio.setblocking(False)
            host, _, port = links["left"].partition(":")
            command = ["robot", str(pair.file), "--side", "left", "--json"]
            start_s = time.monotonic()
            process = subprocess.Popen(
                [sys.executable, "-m", "palmbots", *command], stdout=subprocess.PIPE
            )
            stream, _ = door.accept()
            world = Connection(stream, "robot")
            world.receive(60)
            world.send(ReadingFrame(0, True, 0.0, 0))
            world.receive(60)
            figures = {
                "to the first tick [s]": time.monotonic() - start_s,
                "processor time to the first tick [s]": cpu_s(process.pid),
            }
            ticks = round(seconds / PERIOD_S)
            before_s, since_s = 0.0, 0.0
            for tick in range(ticks + 100):
                if tick == 100:
                    before_s, since_s = cpu_s(process.pid), time.monotonic()
                with contextlib.suppress(ConnectionLost):
                    world.offer(ReadingFrame((tick // 50) % 3 - 1, True, 0.0006 * tick % 1.0, 0))
                    while world.poll() is not None:
                        pass
                with contextlib.suppress(BlockingIOError):
                    while True:
                        station.receive(radio.recv(100))
                body: Any = {20: Operate("arm"), 40: Operate("start")}.get(tick, Hello())
                radio.sendto(station.send("left", body), (host, int(port)))
                time.sleep(PERIOD_S)
            share = (cpu_s(process.pid) - before_s) / (time.monotonic() - since_s)
            figures |= {"memory [MB]": memory_mb(process.pid), "processor time [%]": 100 * share}
            process.terminate()
            printed, _ = process.communicate(timeout=30)
            return figures, json.loads(printed)


def main() -> None:
    """Measure, print and write."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 20.0
    figures, end = measured(seconds)
    table = Table("", "measured", "target", title=f"palmbots robot, {processor()}")
    rows = [[name, f"{figures[name]:.2f}", f"{limit:g}"] for name, limit in TARGETS.items()]
    name = "processor time to the first tick [s]"
    rows.append([name, f"{figures[name]:.2f}", ""])
    rows.append(["load of the machine, one minute", f"{os.getloadavg()[0]:.1f}", ""])
    total = sum(end["jitter"].values())
    rows.append(["overruns", str(end["overruns"]), f"of {total}"])
    for name, count in end["jitter"].items():
        rows.append([f"ticks late by {name}", f"{100 * count / total:.1f} %", ""])
    for row in rows:
        table.add_row(*map(escape, row))
    Console(highlight=False).print(table)
    print(f"mode {end['mode']}, {end['ticks']} ticks")
    with (RESULTS / "robot_program.csv").open("w", newline="") as file:
        csv.writer(file).writerows([["figure", "measured", "target"], *rows])


if __name__ == "__main__":
    main()
