# SPDX-License-Identifier: Apache-2.0
"""Run the model checker: every run of runs.toml, or those named; a table of what came out.

Spin turns a model into a C program that explores it; linked in are the shipped controllers,
compiled from include/palmbots. Exit status 1: a run came out otherwise than runs.toml and
state_counts.csv say.

    .venv/bin/python verify/model_check.py [--quick] [--rewrite] [NAME...]
"""

import argparse
import csv
import fcntl
import hashlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
BUILD = ROOT / "build" / "verify"
PINNED = HERE / "state_counts.csv"
MESSAGES = {"none": 0, "TiltUp": 1, "TiltDown": 2, "Ack": 3}

# How a search is compiled, and called. The breadth-first one finds the shortest counterexample.
SEARCHES = {
    "safety": (["-DSAFETY", "-DNOCLAIM"], []),
    "shortest": (["-DSAFETY", "-DNOCLAIM", "-DBFS"], []),
    "formula": ([], ["-a"]),
}
FOUND = re.compile(
    r"pan:\d*:? ?(assertion violated|acceptance cycle|invalid end state)(.*)\(at depth"
)


@dataclass(frozen=True)
class Run:
    """One question to the checker."""

    name: str
    model: str
    says: str
    parameters: dict[str, int]
    claims: tuple[str, ...] = ()
    formula: str | None = None
    fails: str | None = None
    quick: bool = False
    depth: int = 0
    """How many steps a counterexample may have that a depth-first search looks for, where the
    breadth-first one needs too much memory. It is then not the shortest. 0: the shortest one."""

    @property
    def search(self) -> str:
        """Which of `SEARCHES` answers it."""
        if self.formula is not None:
            return "formula"
        return "shortest" if self.fails and self.depth == 0 else "safety"


@dataclass(frozen=True)
class Finding:
    """The answer: what was violated, if anything, and how large the search was."""

    run: Run
    violated: str | None
    complete: bool
    states: int
    transitions: int
    seconds: float
    transcript: str
    """The counterexample, a line a cycle; empty where there is none."""

    @property
    def expected(self) -> bool:
        """Whether the run came out as runs.toml says, pins aside."""
        return self.violated == self.run.fails and (self.complete or self.run.fails is not None)


def runs() -> dict[str, Run]:
    """All runs of runs.toml by name."""
    with (HERE / "runs.toml").open("rb") as file:
        table = tomllib.load(file)
    found = {}
    for row in table.pop("run"):
        known = {k: row.pop(k) for k in ("name", "model", "says")}
        claims = tuple(row.pop("claims", ()))
        meaning = claims_of(known["model"])
        unknown = [c for c in claims if c not in meaning]
        if unknown:
            raise SystemExit(
                f"runs.toml: {known['name']}: no claim {unknown[0]} in {known['model']}"
            )
        rest = {k: row.pop(k) for k in ("formula", "fails", "quick", "depth") if k in row}
        defaults = table[known["model"]]
        alien = [k for k in row if k not in defaults]
        if alien:
            raise SystemExit(f"runs.toml: {known['name']}: no parameter {alien[0]}")
        values = {k: _number(v) for k, v in (defaults | row).items()}
        values["ARMED"] = sum(number for c, (number, _) in meaning.items() if c in claims)
        found[known["name"]] = Run(**known, parameters=values, claims=claims, **rest)
    return found


def _number(value: int | str) -> int:
    if isinstance(value, int):
        return value
    return MESSAGES[value] if value in MESSAGES else ord(value)


@cache
def claims_of(model: str) -> dict[str, tuple[int, str]]:
    """The claims that a model can arm: their bits and meanings, as the model states them."""
    text = (HERE / "models" / f"{model}.pml").read_text()
    rows = re.findall(r"^#define ([A-Z]\w*) (\d+) +/\* (.*?) \*/$", text, re.MULTILINE)
    return {name: (int(bit), says) for name, bit, says in rows}


def _call(command: Sequence[object], folder: Path) -> str:
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}\n{done.stdout}{done.stderr}")
    return done.stdout


@cache
def build(model: str, searches: tuple[str, ...] = tuple(SEARCHES)) -> Path:
    """The folder with the compiled searches of a model; compiled again when a source changes."""
    if shutil.which("spin") is None:
        raise SystemExit("verify: needs spin; run: sudo apt-get install spin")
    BUILD.mkdir(parents=True, exist_ok=True)
    with (BUILD / "lock").open("w") as lock:  # test processes share the folder
        fcntl.flock(lock, fcntl.LOCK_EX)
        return _built(model, searches)


def _built(model: str, searches: Sequence[str]) -> Path:
    """Spin's code depends on the models alone: a change of a controller compiles only that anew."""
    sources = sorted([*HERE.glob("models/*.pml"), *HERE.glob("glue/*")])
    version = subprocess.run(["spin", "-V"], capture_output=True, check=True).stdout
    folder = BUILD / f"{model}-{_digest(sources, version)}"
    if not folder.exists():
        for old in BUILD.glob(f"{model}-*"):
            shutil.rmtree(old)
        part = folder.with_suffix(".part")
        part.mkdir(parents=True)
        for path in sources:
            shutil.copy(path, part)
        _call(["spin", "-a", f"{model}.pml"], part)
        part.rename(folder)
    linked = folder / _digest(sorted(ROOT.glob("include/**/*.hpp")))
    if not linked.exists():
        for old in folder.glob("*/"):
            shutil.rmtree(old)
        part = linked.with_suffix(".part")
        part.mkdir()
        include = str(ROOT / "include")
        flags = ["-std=c++20", "-O2", "-Wall", "-Wextra", "-Werror", "-I", include]
        _call(["g++", *flags, "-c", f"{model}.cpp", "-o", part / f"{model}.o"], folder)
        part.rename(linked)

    def made(program: Path, *command: object) -> None:
        if not program.exists():
            part = program.with_suffix(".part")
            _call([*command, "-o", part], folder)
            part.rename(program)

    def compiled(search: str) -> None:
        # Spin's own code is not free of warnings. More optimization takes longer than it saves.
        search_object = folder / f"{search}.o"
        made(search_object, "gcc", "-O1", "-w", *SEARCHES[search][0], "-c", "pan.c")
        made(linked / search, "gcc", search_object, linked / f"{model}.o")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compiled, searches))
    return linked


def _digest(files: Sequence[Path], more: bytes = b"") -> str:
    digest = hashlib.sha256(more)
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def explore(run: Run, megabytes: int = 6000) -> Finding:
    """Ask the checker."""
    folder = build(run.model, (run.search,))
    flags = SEARCHES[run.search][1]
    place = folder / "runs" / run.name
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir(parents=True)
    environment = os.environ | {k: str(v) for k, v in run.parameters.items()}
    pan = str(folder / run.search)
    # Spin clears all this memory first. A search that does not fit is not complete.
    entries, steps = (20, 500_000) if run.quick else (24, 5_000_000)
    depth = [] if run.search == "shortest" else [f"-m{run.depth or steps}"]
    claim = [] if run.formula is None else ["-N", run.formula]
    command = [pan, *flags, *claim, f"-w{entries}", *depth]
    limit = ["prlimit", f"--as={megabytes * 2**20}"]
    done = subprocess.run(
        [*limit, *command], cwd=place, env=environment, capture_output=True, text=True
    )
    text = done.stdout
    if done.returncode != 0 and "errors:" not in text:
        raise SystemExit(f"{run.name}: {text}{done.stderr}")
    trails = sorted(place.glob("*.trail"))
    transcript = ""
    if trails:
        replay = [pan, *claim, "-r", str(trails[0])]
        shown = subprocess.run(replay, cwd=place, env=environment, capture_output=True, text=True)
        transcript = _transcript(run, shown.stdout)
    return Finding(
        run,
        violated=_violated(run, text),
        complete="Search not completed" not in text and "max search depth too small" not in text,
        states=int(float(_first(r"([\d.e+]+) states, stored", text))),
        transitions=int(float(_first(r"([\d.e+]+) transitions", text))),
        seconds=float(_first(r"elapsed time ([\d.]+)", text)),
        transcript=transcript,
    )


def _first(pattern: str, text: str) -> str:
    found = re.search(pattern, text)
    if found is None:
        raise SystemExit(f"the checker's answer has no {pattern}:\n{text}")
    return found[1]


def _violated(run: Run, text: str) -> str | None:
    found = FOUND.search(text)
    if found is None:
        return None
    if found[1] == "assertion violated":
        claim = re.search(r"ARMED&(\d+)", found[2])
        names = {bit: name for name, (bit, _) in claims_of(run.model).items()}
        return names[int(claim[1])] if claim else found[2].strip()
    return run.formula if found[1] == "acceptance cycle" else found[1]


def _transcript(run: Run, replay: str) -> str:
    """The model's account of a trail: a line a cycle, then, indented, the events of each robot."""
    lines = [f"{run.says}: {run.fails} is violated", ""]
    for line in replay.splitlines():
        if re.match(r" {0,3}\d+  left|      \w.*[^;{]$", line) and not line.endswith("...]"):
            lines.append(line.rstrip())
        elif "START OF CYCLE" in line:
            lines.append("      from here for ever:")
    return "\n".join(lines) + "\n"


def golden(run: Run) -> Path:
    """Where a run's counterexample is kept."""
    return HERE / "counterexamples" / f"{run.name}.txt"


def pinned() -> dict[str, tuple[int, int]]:
    """States and transitions of each complete search."""
    with PINNED.open() as file:
        return {
            row["run"]: (int(row["states"]), int(row["transitions"]))
            for row in csv.DictReader(file)
        }


def check(found: Finding) -> str | None:
    """What is otherwise than it should be, in a few words; None: nothing."""
    run = found.run
    if not found.expected:
        return f"expected {run.fails or 'it to hold'}, got {found.violated or 'no end'}"
    if run.fails is not None:
        kept = golden(run).read_text() if golden(run).exists() else ""
        return None if kept == found.transcript else f"does not agree with {golden(run).name}"
    pin = pinned().get(run.name)
    return None if pin == (found.states, found.transitions) else f"pinned are {pin}"


def _rewrite(findings: Sequence[Finding]) -> None:
    pins = pinned() if PINNED.exists() else {}
    for found in findings:
        if not found.expected:
            continue
        if found.run.fails is not None:
            golden(found.run).parent.mkdir(exist_ok=True)
            golden(found.run).write_text(found.transcript)
        else:
            pins[found.run.name] = (found.states, found.transitions)
    with PINNED.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["run", "states", "transitions"])
        writer.writerows((name, *pins[name]) for name, run in runs().items() if name in pins)


def main() -> int:
    """Run what the command line asks for and print the table."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="runs; all by default")
    parser.add_argument("--quick", action="store_true", help="only those that the tests run")
    parser.add_argument("--rewrite", action="store_true", help="pin what comes out")
    wanted = parser.parse_args()
    chosen = [
        run
        for name, run in runs().items()
        if (not wanted.names or name in wanted.names) and (run.quick or not wanted.quick)
    ]
    for model in {run.model for run in chosen}:
        build(model)
    table = Table("run", "what", "states", "transitions", "s", "result", box=box.SIMPLE_HEAD)
    for column in table.columns:
        column.no_wrap = True
    for column in table.columns[2:5]:
        column.justify = "right"
    console = Console(width=None if sys.stdout.isatty() else 160)
    findings, wrong = [], 0
    with console.status("exploring") as status:
        for number, run in enumerate(chosen, 1):
            status.update(f"exploring {run.name}, {number} of {len(chosen)}")
            found = explore(run)
            findings.append(found)
            if wanted.rewrite:
                _rewrite([found])
            fault = check(found)
            wrong += fault is not None
            outcome = "holds" if found.violated is None else f"fails: {found.violated}"
            if findings[:-1] and findings[-2].run.model != run.model:
                table.add_section()
            table.add_row(
                run.name,
                run.says,
                f"{found.states:,}",
                f"{found.transitions:,}",
                f"{found.seconds:.1f}",
                outcome if fault is None else f"WRONG: {outcome}; {fault}",
            )
    console.print(table)
    console.print(f"{len(findings)} runs, {wrong} not as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
