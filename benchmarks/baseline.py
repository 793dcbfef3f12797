# SPDX-License-Identifier: Apache-2.0
"""What a change must not make worse, measured at one commit and compared at a later one.

    .venv/bin/python benchmarks/baseline.py --write           measure, into baselines/COMMIT
    .venv/bin/python benchmarks/baseline.py                   measure, print the ratios to 05d8b30
    .venv/bin/python benchmarks/baseline.py --only carry,lanes,help,json
    .venv/bin/python benchmarks/baseline.py --versus TREE     times in lanes, in turns with TREE
    .venv/bin/python benchmarks/baseline.py --first-carry     the time of `make carry` in a clone

Needs `make build`, and the compiler of `make firmware`. Everything but the times is a count, so it
does not depend on how busy the machine is. It does depend on the compilers, which tree.json names.
measures.csv has one row for each count of these kinds:

    carry        instructions of a single carry (bench_instructions.py)
    packet       instructions to write or judge a packet (bench_instructions.py)
    lanes        instructions of a carry in lanes, as built, but without AVX-512
    tick         instructions of a control tick on an emulated board
    flash, ram   bytes of a firmware image
    page         bytes of the core of the page
    first-carry  seconds of the first `make carry` in a fresh clone

help.txt has the text of every --help, and json.txt the keys of --json with type and value, one a
line. Values that differ from run to run are left out.
"""

import argparse
import csv
import datetime
import difflib
import json
import os
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

import bench_instructions
from _machine import compiler, load, processor
from palmbots.control.registry import shipped_names

HERE = Path(__file__).parent
ROOT = HERE.parent
BASELINES = HERE / "baselines"
FIRST = BASELINES / "05d8b30"
CONTROLLERS = shipped_names()
ON_BOARDS = shipped_names("robots", "station")
LIMITS = {"carry": 1.03, "packet": 1.03, "lanes": 1.03, "tick": 1.05, "flash": 1.05,
          "ram": 1.05, "page": 1.05}  # fmt: skip
"""Greatest allowed ratio of a later count to the earlier one."""
CARRIES = 512
"""Carries in lanes of which the instructions are counted."""
PAIRS, TIMED_CARRIES = 7, 20000

Counts = dict[str, float]
PALMBOTS = (sys.executable, "-m", "palmbots")


def output(*command: str, cwd: Path = ROOT, **environment: str) -> str:
    """What a command prints; its own message if it fails."""
    done = subprocess.run(
        command, cwd=cwd, env=os.environ | environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    return done.stdout


def single(kind: str) -> Counts:
    """The counts of bench_instructions.py of one kind."""
    found = bench_instructions.counts([kind])
    return {name.removeprefix(f"{kind}, "): count for name, count in found.items()}


BEGIN = """
#include <valgrind/callgrind.h>
void begin(void) { CALLGRIND_START_INSTRUMENTATION; }
"""
COUNTED = """
import ctypes, os, sys
import palmbots as pb
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds
spec = to_spec(pb.load_scene("paper"))
run_seeds(spec, sys.argv[2], 0, 64)
ctypes.CDLL(sys.argv[1]).begin()
run_seeds(spec, sys.argv[2], 0, int(sys.argv[3]))
os._exit(0)
"""


def lanes() -> Counts:
    """Instructions of a carry in lanes, for each controller."""
    found: Counts = {}
    with tempfile.TemporaryDirectory() as folder:
        source, library = Path(folder) / "begin.c", Path(folder) / "begin.so"
        source.write_text(BEGIN)
        output("cc", "-shared", "-fPIC", "-o", str(library), str(source))
        for name in CONTROLLERS:
            command = [
                "valgrind", "--tool=callgrind", "--instr-atstart=no",
                "--callgrind-out-file=/dev/null", sys.executable, "-c", COUNTED, str(library),
                name, str(CARRIES),
            ]  # fmt: skip
            environment = os.environ | {"PYTHONHASHSEED": "0"}
            done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True,
                                  text=True, check=True)  # fmt: skip
            (count,) = re.findall(r"Collected : (\d+)", done.stderr)
            found[name] = round(int(count) / CARRIES)
    return found


def firmware() -> Path:
    """The folder of the images, compiled now."""
    folder = ROOT / "build" / "baseline"
    output(sys.executable, "firmware/build.py", "--out", str(folder))
    return folder


def ticks() -> Counts:
    """Instructions of a control tick on a board: mean and most over a short carry."""
    sys.path.insert(0, str(ROOT / "firmware"))
    import palmbots as pb
    from emulator.__main__ import dongle_image, robot_image
    from emulator.lockstep import carry_on_boards

    folder = firmware()
    image, dongle = robot_image(folder), dongle_image(folder)
    scene = pb.load_scene("paper", {"task.distance_m": 0.5})
    found: Counts = {}
    for name in ON_BOARDS:
        _, boards = carry_on_boards(image, scene, name, dongle=dongle)
        counts = [count for board in boards.boards for count in board.instructions]
        found[f"{name}, mean"] = round(statistics.mean(counts))
        found[f"{name}, most"] = max(counts)
        if boards.dongle is not None:
            found[f"{name}, dongle, mean"] = round(statistics.mean(boards.dongle.instructions))
    return found


def sizes() -> dict[str, tuple[int, int]]:
    """Bytes of flash and of RAM, with the stack, of each image."""
    folder = firmware()
    found: dict[str, tuple[int, int]] = {}
    for file in sorted(folder.glob("*.elf")):
        line = output("arm-none-eabi-size", str(file)).splitlines()[1]
        text, data, bss = map(int, line.split()[:3])
        found[file.stem] = (text + data, data + bss)
    return found


def page() -> Counts:
    """Bytes of the page's core."""
    core = ROOT / "site" / "src" / "generated" / "core.wasm"
    # Of the packages of the page the core needs the compiler alone.
    output("make", "-o", ".venv/site.done", str(core.relative_to(ROOT)))
    return {"core.wasm": core.stat().st_size}


KINDS: dict[str, Callable[[], Counts]] = {
    "carry": lambda: single("carry"),
    "packet": lambda: single("packet"),
    "lanes": lanes,
    "tick": ticks,
    "flash": lambda: {name: flash for name, (flash, _) in sizes().items()},
    "ram": lambda: {name: ram for name, (_, ram) in sizes().items()},
    "page": page,
}


# --- what the commands print


def helps() -> list[str]:
    """The text of every --help, with the commands of groups."""
    lines: list[str] = []
    waiting: list[tuple[str, ...]] = [()]
    while waiting:
        words = waiting.pop(0)
        text = output(*PALMBOTS, *words, "--help", COLUMNS="80", NO_COLOR="1", TERM="dumb")
        lines += [f"=== {' '.join(('palmbots', *words))}", *text.rstrip().splitlines(), ""]
        _, _, listed = text.partition("\nCommands:\n")
        names = re.findall(r"^  ([a-z0-9-]+)  ", listed, re.M)
        waiting += [(*words, name) for name in names]
    return lines


SHORT = "--set task.distance_m=0.2"
PRINTED = (
    f"carry --seed 3 {SHORT} --animation none --out log",
    f"carry -c centralized {SHORT}", f"carry -c resilient --set radio.loss=0.1 {SHORT}",
    f"carry --world mujoco {SHORT}",
    "contact-modes --theta-left-deg 5", "analyze",
    "design --resolution-deg 5 --set task.distance_m=0.1",
    "certify -o box.json", "check box.json",
    "drop-rate --set robot.noise_m_s=0.03 --effort 20 --relative-error-percent 100",
    f"noise-limit --relative-error-percent 10 {SHORT}", f"bound {SHORT}",
    f"compare --values 0,0.2 -n 2 {SHORT}", "study study.toml --out results",
    "replay log/carry.mcap", "view log/carry.mcap --layout layout.json",
    "export --mjcf scene.xml --urdf robot.urdf", "derive --controllers none",
    "speed-limits --carries 1", "validate --states 4 --carries 1",
    "scenes", "objects", "controllers", "keys", "schema scene", "schema log",
    "init scene scene.toml", "init pair pair.toml", "firmware pair.toml --out images",
    f"up --lockstep --no-log {SHORT}",
)  # fmt: skip
STUDY = """controllers = ["none"]
[set]
"task.distance_m" = 0.2
[vary]
"robot.noise_m_s" = [0.02]
[seeds]
count = 2
"""
SHOWN_ONCE = ("scene", "designed_scene", "certificate.scene")
"""Complete scenes. `palmbots schema scene` shows their keys and defaults."""
VOLATILE = re.compile(r"seconds|elapsed|version|date")


def leaves(value: Any, key: str = "") -> list[str]:
    """A line for each value: key, type, value. A list has its length and its first element."""
    if key in SHOWN_ONCE:
        return [f"{key} object of {len(value)}"]
    if isinstance(value, dict):
        rows = [row for name in value for row in leaves(value[name], f"{key}.{name}".lstrip("."))]
        return rows or [f"{key} object empty"]
    if isinstance(value, list):
        return [f"{key} list {len(value)}", *(leaves(value[0], f"{key}[]") if value else ())]
    kind = {bool: "boolean", str: "string", type(None): "null"}.get(type(value), "number")
    if VOLATILE.search(key.rpartition(".")[2]):
        return [f"{key} {kind}"]
    shown = f"{value:.6g}" if kind == "number" else json.dumps(value, ensure_ascii=False)
    return [f"{key} {kind} {shown}"]


def printed() -> list[str]:
    """What --json prints, key by key."""
    lines: list[str] = []
    with tempfile.TemporaryDirectory() as text:
        folder = Path(text)
        (folder / "study.toml").write_text(STUDY)
        for words in PRINTED:
            done = subprocess.run(
                [*PALMBOTS, *words.split(), "--json"],
                cwd=folder, capture_output=True, text=True, check=False,
            )  # fmt: skip
            lines.append(f"=== {words}: status {done.returncode}")
            if done.stdout.strip():
                lines += leaves(json.loads(done.stdout.replace(str(folder), "")))
            else:
                lines += done.stderr.replace(str(folder), "").splitlines()[-1:]
            lines.append("")
    return lines


SNAPSHOTS: dict[str, Callable[[], list[str]]] = {"help": helps, "json": printed}


# --- times


TIMED = """
import sys, time
import palmbots as pb
from palmbots.scene.spec import to_spec
from palmbots.simulation.batch import run_seeds
spec = to_spec(pb.load_scene("paper"))
run_seeds(spec, sys.argv[1], 0, 2000)
began = time.process_time()
run_seeds(spec, sys.argv[1], 0, int(sys.argv[2]))
print(time.process_time() - began)
"""


def versus(tree: Path, console: Console) -> None:
    """Processor times in lanes at this machine's highest level, this tree / that, in turns."""
    table = Table("lanes", *(f"pair {i + 1}" for i in range(PAIRS)), "median")
    for name in CONTROLLERS:
        ratios: list[float] = []
        for pair in range(PAIRS):
            both: dict[Path, float] = {}
            for place in (ROOT, tree) if pair % 2 else (tree, ROOT):
                python = place / ".venv" / "bin" / "python"
                words = ("-c", TIMED, name, str(TIMED_CARRIES))
                both[place] = float(output(str(python), *words, cwd=place))
            ratios.append(both[ROOT] / both[tree])
        median = statistics.median(ratios)
        table.add_row(name, *(f"{ratio:.3f}" for ratio in ratios), f"{median:.3f}")
    console.print(table)


def first_carry() -> float:
    """Seconds of the first `make carry` in a clone of HEAD, with packages from the registry."""
    environment = {k: v for k, v in os.environ.items() if "CCACHE" not in k and "LAUNCHER" not in k}
    with tempfile.TemporaryDirectory() as folder:
        output("git", "clone", "--quiet", str(ROOT), folder)
        began = time.monotonic()
        subprocess.run(["make", "carry"], cwd=folder, env=environment, check=True)
        return time.monotonic() - began


# --- files and the table


def read(folder: Path) -> dict[tuple[str, str], float]:
    """The rows of measures.csv."""
    file = folder / "measures.csv"
    if not file.exists():
        return {}
    with file.open(newline="") as stream:
        return {(row["kind"], row["name"]): float(row["value"]) for row in csv.DictReader(stream)}


def write(folder: Path, measured: dict[tuple[str, str], float], commit: str) -> None:
    """Write measures.csv, with the rows there that were not measured again, and tree.json."""
    rows = read(folder) | measured
    with (folder / "measures.csv").open("w", newline="") as stream:
        out = csv.writer(stream)
        out.writerow(("kind", "name", "value"))
        for (kind, name), value in rows.items():
            out.writerow((kind, name, f"{value:.0f}"))
    arm = output("arm-none-eabi-g++", "--version").splitlines()[0]
    about = {
        "commit": commit, "machine": processor(), "architecture": platform.machine(),
        "compiler": compiler(), "board compiler": arm, "python": platform.python_version(),
        "valgrind": output("valgrind", "--version").strip(), "load": round(load(), 1),
        "date": datetime.date.today().isoformat(),
    }  # fmt: skip
    (folder / "tree.json").write_text(json.dumps(about, indent=2) + "\n")


def ratios(before: dict[tuple[str, str], float], now: dict[tuple[str, str], float]) -> Table:
    """Later counts divided by earlier ones, with the limit where there is one."""
    table = Table("kind", "name", "before", "now", "ratio", "limit")
    for (kind, name), value in now.items():
        earlier, limit = before.get((kind, name)), LIMITS.get(kind)
        if earlier is None:
            table.add_row(kind, name, "", f"{value:,.0f}", "", "")
            continue
        ratio = value / earlier
        verdict = "" if limit is None else f"{limit:.2f}{'' if ratio <= limit else ' EXCEEDED'}"
        table.add_row(kind, name, f"{earlier:,.0f}", f"{value:,.0f}", f"{ratio:.4f}", verdict)
    return table


def main() -> int:
    """Measure, and write or compare; exit status 1 if a limit is exceeded."""
    assert __doc__
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", help=f"of {', '.join((*KINDS, *SNAPSHOTS))}; default: all")
    parser.add_argument("--write", action="store_true", help="write into baselines/COMMIT")
    parser.add_argument("--before", type=Path, default=FIRST, help="folder to compare with")
    parser.add_argument("--versus", type=Path, metavar="TREE", help="only compare times")
    parser.add_argument("--first-carry", action="store_true", help="only time `make carry`")
    given = parser.parse_args()
    console = Console(highlight=False, soft_wrap=True)
    if given.versus:
        versus(given.versus.resolve(), console)
        return 0
    commit = output("git", "rev-parse", "--short=7", "HEAD").strip()
    folder = BASELINES / commit if given.write else ROOT / "build" / "baseline"
    folder.mkdir(parents=True, exist_ok=True)
    wanted = given.only.split(",") if given.only else [*KINDS, *SNAPSHOTS]
    measured: dict[tuple[str, str], float] = {}
    if given.first_carry:
        wanted = []
        measured["first-carry", "seconds"] = first_carry()
    for kind in wanted:
        if kind in KINDS:
            measured |= {(kind, name): value for name, value in KINDS[kind]().items()}
            continue
        lines = SNAPSHOTS[kind]()
        (folder / f"{kind}.txt").write_text("\n".join(lines) + "\n")
        if not given.write:
            earlier = (given.before / f"{kind}.txt").read_text().splitlines()
            for line in difflib.unified_diff(earlier, lines, "before", "now", lineterm="", n=0):
                console.print(f"{kind}: {line}", markup=False)
    if given.write:
        write(folder, measured, commit)
        return 0
    table = ratios(read(given.before), measured)
    console.print(table)
    return int(any("EXCEEDED" in str(cell) for cell in table.columns[-1].cells))


if __name__ == "__main__":
    sys.exit(main())
