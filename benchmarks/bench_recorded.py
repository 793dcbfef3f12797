#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Real robots, real radios: drops of the object with recorded errors and packets.

    .venv/bin/python benchmarks/bench_recorded.py [CARRIES [FOLDER]]      500 a cell by default

FOLDER has the recordings of others that docs/reference/robustness.md names; the default is
../shared/data beside the project. What is missing there is left out, and named. A row is one
combination of robots and a radio; its carries are spread over all recordings of their kinds. The
robots of a pair are two different recorded ones, in all combinations. With the default radio there
are eight times as many carries. Writes
benchmarks/results/recorded.csv with the numbers of carries that were dropped or stalled, and
benchmarks/results/recorded-sources.csv with the SHA-256 of each file. Seeds are 0, 1, …
"""

import csv
import hashlib
import io
import lzma
import re
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.errors import PalmbotsError
from palmbots.fitting.fit import write_fit
from palmbots.fitting.motion_fit import MotionFit
from palmbots.simulation.batch import DROPPED, OUTCOMES, available_cores, run_batch
from palmbots.simulation.prepare import prepare

HERE = Path(__file__).parent
RESULT = HERE / "results" / "recorded.csv"
SOURCES = HERE / "results" / "recorded-sources.csv"
STALLED = OUTCOMES.index("stalled")
HEAD = ["robots", "radio", "packets_lost", "controller", "carries", "dropped", "stalled"]
LEAST_PACKETS = 50  # of a link that a carry can use

Keys = dict[str, Any]


def robots_in(data: Path, work: Path) -> list[Keys]:
    """The fitted keys and the errors of each recorded robot, from its two runs."""
    found: list[Keys] = []
    for robot in range(1, 6):
        files = [
            data / "robot-motion" / f"mrclam{run}-robot{robot}-{what}.dat.xz"
            for run in (6, 7)
            for what in ("commands", "truth")
        ]
        if not all(file.exists() for file in files):
            print(f"left out: robot {robot}, because its files are missing", file=sys.stderr)
            continue
        fit = pb.fit(files, motion=True)
        assert isinstance(fit, MotionFit) and fit.replay
        if fit.replay.reason:
            print(f"left out: robot {robot}, because {fit.replay.reason}", file=sys.stderr)
            continue
        write_fit(fit, work / f"robot{robot}")
        trace = str(work / f"robot{robot}" / "robot-errors.csv")
        keys: Keys = {key.partition(".")[2]: value for key, value in fit.keys.items()}
        found.append(keys | {"error_trace": trace})
        print(f"robot {robot}: {fit.stretches} stretches, {found[-1]}", flush=True)
    return found


def pairs_of(robots: list[Keys], gain: str) -> list[Keys]:
    """The keys of all pairs of two robots."""
    return [
        {f"robot.left.{key}": value for key, value in one.items()}
        | {f"robot.right.{key}": value for key, value in other.items()}
        | {"robot.trace_gain": gain}
        for one, other in permutations(robots, 2)
    ]


@dataclass(frozen=True)
class Fates:
    """One recording of a radio."""

    kind: str
    interval_s: float
    lost: Any
    delays_s: Any = None


def lost_of(index: Any, size: int = 0) -> Any:
    """Which packets are lost, from the numbers of those that arrived."""
    first = 0 if size else int(index.min())
    lost = np.ones(max(size, int(index.max()) + 1 - first), int)
    lost[index.astype(int) - first] = 0
    return lost


def nrf24(file: Path) -> Fates:
    """A recording at one distance and data rate, which its name has."""
    with lzma.open(file, "rt") as text:
        lines = [line.split(",") for line in text if line[0].isdigit() and "T" not in line]
    index = np.array([float(line[1 if len(line) == 2 else 2]) for line in lines])
    parts = re.fullmatch(r"nrf24-\d+-(\d+)m(?:(\d+)([km])bps)?\.csv\.xz", file.name)
    assert parts is not None
    rate = f", {parts[2]} {parts[3].replace('m', 'M')}bit/s" if parts[2] else ""
    return Fates(f"nRF24, {parts[1]} m{rate}", 0.002, lost_of(index))


def wifi(file: Path) -> Iterator[Fates]:
    """The links of the grid, by the level of noise."""
    with tarfile.open(file) as links:
        for member in links:
            place = Path(member.name)
            stored = links.extractfile(member) if place.name.startswith("sdec") else None
            text = stored.read().decode() if stored is not None else ""
            if text.count("\n") >= LEAST_PACKETS:
                noise = next(part for part in place.parts if part.startswith("dbm"))
                index = np.loadtxt(io.StringIO(text), usecols=0, ndmin=1)
                level = noise.removeprefix("dbm").replace("-", "−")
                yield Fates(f"Wi-Fi, noise {level} dBm", 0.1, lost_of(index, 300))


def packets_in(folder: Path) -> Iterator[Fates]:
    """All recordings of radios."""
    for file in sorted(folder.glob("nrf24-*.csv.xz")):
        yield nrf24(file)
    for file in sorted(folder.glob("wifi-*.tar.xz")):
        yield from wifi(file)
    for file in sorted(folder.glob("ros2-round-trips-*.csv.xz")):
        with lzma.open(file, "rt") as text:
            trips = np.loadtxt(text) / 1000
        kind = "ROS 2, robot " + ("stands" if "035" in file.name else "moves")
        yield Fates(kind, 0.05, np.zeros(len(trips), int), trips / 2)


def radios_in(data: Path, work: Path) -> tuple[dict[str, list[Keys]], dict[str, float]]:
    """The recordings of each kind as keys of a scene, and the share of their packets that was
    lost."""
    kinds: dict[str, list[Keys]] = {}
    shares: dict[str, list[float]] = {}
    for number, one in enumerate(packets_in(data / "radio")):
        file = work / f"radio{number}.csv"
        columns = [one.interval_s * np.arange(len(one.lost)), one.lost]
        head = "sent_s,lost"
        if one.delays_s is not None:
            columns.append(one.delays_s)
            head += ",delay_s"
        np.savetxt(file, np.column_stack(columns), "%.6g", ",", header=head, comments="")
        kinds.setdefault(one.kind, []).append({"radio.trace": str(file)})
        shares.setdefault(one.kind, []).append(float(np.mean(one.lost)))
    return kinds, {kind: float(np.mean(found)) for kind, found in shares.items()}


def cell(scenes: list[Keys], controller: str, carries: int) -> tuple[int, int, int] | None:
    """Carries, and how many of them were dropped and stalled; None: the controller refuses."""
    wanted = min(len(scenes), carries)
    chosen = [scenes[int(k)] for k in np.linspace(0, len(scenes) - 1, wanted).round()]
    try:
        specs = [prepare(pb.load_scene("paper", keys), controller).spec for keys in chosen]
    except PalmbotsError as error:
        print(f"refused: {controller}: {error}", file=sys.stderr)
        return None
    index = np.arange(carries) % wanted
    columns = run_batch(specs, index, np.arange(carries), controller, threads=available_cores())
    outcome = columns["outcome"]
    return carries, int((outcome == DROPPED).sum()), int((outcome == STALLED).sum())


def write_sources(data: Path) -> None:
    """The hashes of the files that were used."""
    files = sorted([*data.glob("robot-motion/*.xz"), *data.glob("radio/*.xz")])
    with SOURCES.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["file", "sha256"])
        for file in files:
            writer.writerow([file.name, hashlib.sha256(file.read_bytes()).hexdigest()])


def main() -> None:
    """Run all cells, and write the file after each row of the table."""
    carries = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    data = Path(sys.argv[2]) if len(sys.argv) > 2 else HERE.parents[1] / "shared" / "data"
    if not data.is_dir():
        print(f"skipped: {data} is missing", file=sys.stderr)
        return
    rows: list[list[Any]] = []
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        robots = robots_in(data, work)
        radios, lost = radios_in(data, work)
        model: list[Keys] = [{}]
        conditions: list[tuple[str, str, list[Keys]]] = [("default", "default", model)]
        if robots:
            fitted = [{k: v for k, v in one.items() if k != "error_trace"} for one in robots]
            conditions.append(("fitted model", "default", pairs_of(fitted, "carry")))
            conditions.append(("recorded", "default", pairs_of(robots, "carry")))
            conditions.append(("recorded, gain by segment", "default", pairs_of(robots, "segment")))
        for kind, traces in sorted(radios.items()):
            conditions.append(("default", kind, traces))
            if robots:
                pairs = pairs_of(robots, "carry")
                count = max(len(pairs), len(traces))
                both = [pairs[k % len(pairs)] | traces[k % len(traces)] for k in range(count)]
                conditions.append(("recorded", kind, both))
        for of_robots, of_radio, scenes in conditions:
            for controller in shipped_names():
                many = carries * (8 if of_radio == "default" else 1)
                found = cell(scenes, controller, many)
                share = lost.get(of_radio, 0.0)
                key = [of_robots, of_radio, round(share, 5), controller]
                rows.append([*key, *(found or ("", "", ""))])
                print(*rows[-1], sep="  ", flush=True)
            with RESULT.open("w", newline="", encoding="utf-8") as stream:
                writer = csv.writer(stream, lineterminator="\n")
                writer.writerows([HEAD, *rows])
    write_sources(data)


if __name__ == "__main__":
    main()
