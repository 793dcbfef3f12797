# SPDX-License-Identifier: Apache-2.0
"""How many small defects of the core the tests find: the mutation score, with its interval.

    .venv/bin/python tests/soak/mutation_score.py [--size 200] [--seed 1] [--seconds 3000]

A sample of the changes of `mutants` in the rooms mechanics, control and wire is compiled into
copies of the headers, once. The tests of these rooms then run once per mutant, until the first of
them fails: the C++ programs, and the files of Python tests. A first run without a mutant records
which tests reach which mutants, so that only those run. A test that takes ten times its usual time
counts as failed.

Results are kept in build/mutation/results.csv, and a further run goes on from there. When all are
there, they are copied to benchmarks/results/mutation.csv. A mutant that does not compile is left
out, and the report says how many these are.
"""

import argparse
import csv
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import core_copy
import mutants
from palmbots._util.confidence_intervals import wilson

ROOT = Path(__file__).resolve().parent.parent.parent
WORK = ROOT / "build" / "mutation"
RESULTS = WORK / "results.csv"
PUBLISHED = ROOT / "benchmarks" / "results" / "mutation.csv"
ROOMS = ("mechanics", "control", "wire")
CPP_ROOMS = ("mechanics", "control", "wire", "runtime", "world")
FIELDS = ("number", "mutant", "result", "by")
BUILD_TRIES = 8
PATIENCE, LEAST_S = 10.0, 20.0
_PLACE = re.compile(r"include/(palmbots/(?:mechanics|control|wire)/\w+\.hpp):(\d+)")


@dataclass(frozen=True)
class Unit:
    """Something that runs tests: a program, or a file of Python tests."""

    name: str
    command: tuple[str, ...]
    seconds: float = 0.0
    reaches: frozenset[int] = frozenset()


def main(words: list[str]) -> int:
    """Measure; exit status 0 when all mutants of the sample were tried."""
    parser = argparse.ArgumentParser(description="Measure the mutation score.")
    parser.add_argument("--size", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time")
    options = parser.parse_args(words)
    until = time.monotonic() + options.seconds
    include = ROOT / "include"
    every = [
        mutant
        for room in ROOMS
        for path in sorted((include / "palmbots" / room).glob("*.hpp"))
        for mutant in mutants.mutants_of(include, str(path.relative_to(include)))
    ]
    chosen = dict(enumerate(mutants.sample(every, options.size, options.seed), start=1))
    names = {number: mutant.name for number, mutant in chosen.items()}
    done = _done(names)
    compiled = chosen
    for build, units_of in ((_programs, _program_units), (_extension, _python_units)):
        kept = _built(compiled, build)
        for number in sorted(compiled.keys() - kept.keys() - done.keys()):
            done[number] = _note(number, names[number], "does not compile", "")
        compiled = kept
        units = _recorded(units_of())
        for number in sorted(compiled.keys() - done.keys()):
            if time.monotonic() > until:
                return _report(done, len(chosen), len(every))
            by = _killed(number, units)
            if by or units_of is _python_units:
                done[number] = _note(number, names[number], "killed" if by else "survived", by)
    return _report(done, len(chosen), len(every))


def _done(names: dict[int, str]) -> dict[int, str]:
    """The results of an earlier run of the same sample."""
    if not RESULTS.exists():
        return {}
    with RESULTS.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {n: r["result"] for r in rows if names.get(n := int(r["number"])) == r["mutant"]}


def _note(number: int, name: str, result: str, by: str) -> str:
    is_new = not RESULTS.exists()
    with RESULTS.open("a", newline="") as stream:
        writer = csv.writer(stream)
        if is_new:
            writer.writerow(FIELDS)
        writer.writerow((number, name, result, by))
    print(f"{number:4} {result:9} {name} {by}", flush=True)
    return result


def _built(
    chosen: dict[int, mutants.Mutant], build: Callable[[], str | None]
) -> dict[int, mutants.Mutant]:
    """Compile the mutants into the programs or the extension; returns those that compile."""
    kept = dict(chosen)
    for _ in range(BUILD_TRIES):
        _write_headers(kept)
        messages = build()
        if messages is None:
            return kept
        places = {(m[1], int(m[2])) for m in _PLACE.finditer(messages)}
        broken = {n for n, mutant in kept.items() if (mutant.header, mutant.line) in places}
        if not broken:
            sys.exit(f"mutation_score: does not compile:\n{messages[:4000]}")
        kept = {n: mutant for n, mutant in kept.items() if n not in broken}
    sys.exit("mutation_score: too many mutants do not compile")


def _write_headers(kept: dict[int, mutants.Mutant]) -> None:
    """The changed copies; a file whose text stays the same keeps its time."""
    for path in (ROOT / "include").rglob("*.hpp"):
        relative = str(path.relative_to(ROOT / "include"))
        text = path.read_bytes()
        own = {n: mutant for n, mutant in kept.items() if mutant.header == relative}
        _put(WORK / "include" / relative, mutants.changed(text, own) if own else text)
    _put(WORK / "include" / "palmbots_mutation.hpp", mutants.HEADER.encode())


def _put(path: Path, data: bytes) -> None:
    if not path.exists() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def _sources() -> list[Path]:
    return [
        path
        for room in CPP_ROOMS
        for path in sorted((ROOT / "tests/cpp" / room).glob("*_test.cpp"))
    ]


def _programs() -> str | None:
    return core_copy.programs(WORK, WORK / "include", _sources(), "-O1")


def _extension() -> str | None:
    return core_copy.build(WORK, WORK / "include", "", is_quick=True)


def _program_units() -> list[Unit]:
    return [Unit(s.stem, (str(WORK / "programs" / s.stem),)) for s in _sources()]


def _python_units() -> list[Unit]:
    files = [p for room in ROOMS for p in sorted((ROOT / "tests" / room).glob("test_*.py"))]
    command = (
        str(core_copy.environment(WORK)),
        "-m",
        "pytest",
        "-x",
        "-q",
        "-p",
        "no:cacheprovider",
    )
    return [Unit(f"{p.parent.name}/{p.name}", (*command, str(p.relative_to(ROOT)))) for p in files]


def _recorded(units: list[Unit]) -> list[Unit]:
    """The units that pass without a mutant, fastest first, with what they reach."""
    found = []
    for unit in units:
        record = WORK / "reached.txt"
        record.unlink(missing_ok=True)
        began = time.monotonic()
        status = _run(unit, 600.0, {"PALMBOTS_REACHED": str(record)})
        seconds = time.monotonic() - began
        if status != 0:
            print(f"left out, as it fails without a mutant: {unit.name}", flush=True)
            continue
        reached = set(map(int, record.read_text().split())) if record.exists() else set()
        found.append(Unit(unit.name, unit.command, seconds, frozenset(reached)))
    return sorted(found, key=lambda unit: unit.seconds)


def _run(unit: Unit, limit_s: float, environment: dict[str, str]) -> int | None:
    try:
        return subprocess.run(
            unit.command,
            cwd=ROOT,
            env=os.environ | environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=limit_s,
            check=False,
        ).returncode
    except subprocess.TimeoutExpired:
        return None


def _killed(number: int, units: list[Unit]) -> str:
    """What found the mutant; empty: nothing."""
    for unit in units:
        if number not in unit.reaches:
            continue
        limit_s = max(LEAST_S, PATIENCE * unit.seconds)
        if _run(unit, limit_s, {"PALMBOTS_MUTANT": str(number)}) != 0:
            return unit.name
    return ""


def _report(done: dict[int, str], size: int, population: int) -> int:
    results = list(done.values())
    killed, survived = results.count("killed"), results.count("survived")
    tried = killed + survived
    low, high = wilson(killed, tried) if tried else (0.0, 1.0)
    print(
        f"mutation score {100 * killed / max(1, tried):.0f} % (95 % interval {100 * low:.0f} to "
        f"{100 * high:.0f} %): {killed} of {tried} mutants killed, of a sample of {size} from "
        f"{population}; {results.count('does not compile')} do not compile"
    )
    if len(done) < size:
        return 1
    shutil.copy2(RESULTS, PUBLISHED)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
