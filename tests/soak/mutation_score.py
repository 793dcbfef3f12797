# SPDX-License-Identifier: Apache-2.0
"""How many small defects of the core the tests find: the mutation score, with its interval.

    .venv/bin/python tests/soak/mutation_score.py [--rooms world,sim] [--seconds 3000] [--again]
    .venv/bin/python tests/soak/mutation_score.py --draw TREE | --redraw

The sample of mutants is mutants.csv, drawn with seed 2 from the headers of commit 05d8b30: 200 of
the rooms mechanics, control and wire together, and 50 of each of world, sim, stability and runtime.
A mutant is found again by the text of its line, in its header or another one. Where the line has
changed, look for the same defect in the code that took its place, and edit the row: `drawn_as`
keeps what was drawn, and `room` stays that of the draw. A mutant without such code is "gone". Once
a tenth of a group is gone, --redraw draws as many from the present headers of its rooms, with the
same seed.
A row says in `equivalent` why a mutant has no effect that a test could find, if that is proven.

The mutants of the chosen rooms are compiled into copies of the headers, once. Tests then run once
per mutant, until the first of them fails: the C++ programs, with sanitizers, and
the files of Python tests of the room in which the mutant is, and of those that use it. The rooms
are done one after the other. What is proven to be equivalent is tried with the programs alone. A
first run without a mutant records which tests reach which mutants, so that only those run. If a
test takes ten times its usual time, of the processor or ten times as much on the clock, the mutant
has "timed out". It counts neither as killed nor as survived, because a very busy machine has the
same effect.

Results are kept in build/mutation/results.csv, and a further run goes on from there; with --again
it tries those anew that were not killed. When all are there, they are copied to
benchmarks/results/mutation.csv. A mutant that is gone or does not compile is left out, and the
report says how many these are. "not reached" survived, too: no test runs the code, or only the
compiler does.
"""

import argparse
import csv
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import core_copy
import mutants
from palmbots._util.confidence_intervals import wilson

ROOT = Path(__file__).resolve().parent.parent.parent
WORK = ROOT / "build" / "mutation"
RESULTS = WORK / "results.csv"
PUBLISHED = ROOT / "benchmarks" / "results" / "mutation.csv"
LIST = Path(__file__).with_name("mutants.csv")
SEED = 2
SAMPLES: dict[tuple[str, ...], int] = {
    ("mechanics", "control", "wire"): 200,
    ("world",): 50, ("sim",): 50, ("stability",): 50, ("runtime",): 50,
}  # fmt: skip
"""Rooms, and how many mutants are drawn from them together."""
ROOMS = tuple(room for rooms in SAMPLES for room in rooms)
# Where the Python tests of a room's code are.
PYTHON_ROOMS = {
    "mechanics": ("mechanics", "stability", "world", "laws"),
    "control": ("control", "derivation", "simulation", "laws"),
    "wire": ("wire", "drivers", "links"),
    "world": ("world", "simulation", "laws"),
    "sim": ("simulation", "scene", "laws"),
    "stability": ("stability",),
    "runtime": ("robot", "station", "pair", "simulation"),
}
SANITIZERS = "-O1 -fsanitize=address,undefined -fno-sanitize-recover=all"
LONGEST_S = 20  # a program or file that takes longer is left out
FIELDS: tuple[str, ...] = ("number", "mutant", "result", "by")
BUILD_TRIES = 8
PATIENCE, LEAST_S = 10, 20
_PLACE = re.compile(r"include/(palmbots/\w+/\w+\.hpp):(\d+):\d+: error:")


@dataclass(frozen=True)
class Unit:
    """Something that runs tests: a program, or a file of Python tests."""

    name: str
    command: tuple[str, ...]
    rooms: tuple[str, ...] = ROOMS
    """The rooms whose mutants it is to find."""
    seconds: float = 0.0
    reaches: frozenset[int] = frozenset()


def main(words: list[str]) -> int:
    """Measure; exit status 0 when all mutants of the sample were tried."""
    parser = argparse.ArgumentParser(description="Measure the mutation score.")
    parser.add_argument("--rooms", default=",".join(ROOMS), help="only of these rooms")
    parser.add_argument("--seconds", type=float, default=1e9, help="stop after this time")
    parser.add_argument("--again", action="store_true", help="try what was not killed anew")
    parser.add_argument("--draw", type=Path, metavar="TREE", help="only write mutants.csv anew")
    parser.add_argument("--redraw", action="store_true", help="only replace those that are gone")
    options = parser.parse_args(words)
    if options.draw:
        return _draw(options.draw / "include")
    if options.redraw:
        return _redraw(ROOT / "include")
    until = time.monotonic() + options.seconds
    listed = _listed(options.rooms.split(","))
    chosen = mutants.found_again(ROOT / "include", listed)
    names = {
        number: f"{row['header']}:{row['line']} {row['operator']} @{row['column']}"
        for number, row in listed.items()
    }
    if options.again:
        _forget(lambda row: row["result"] not in ("killed", "does not compile"))
    done = _done(names)
    for number in sorted(listed.keys() - chosen.keys() - done.keys()):
        done[number] = _note(number, names[number], "gone", "")
    compiled = {n: m for n, m in chosen.items() if done.get(n) != "does not compile"}
    reached: set[int] = set()
    for build, units_of in ((_programs, _program_units), (_extension, _python_units)):
        kept = _built(compiled, build)
        for number in sorted(compiled.keys() - kept.keys() - done.keys()):
            done[number] = _note(number, names[number], "does not compile", "")
        compiled = kept
        is_last = units_of is _python_units
        units: dict[str, Unit | None] = {}
        for room in dict.fromkeys((*options.rooms.split(","), *ROOMS)):
            rest = [n for n in sorted(compiled) if _room(compiled[n]) == room and n not in done]
            own = [unit for unit in units_of() if room in unit.rooms]
            if is_last:
                for number in (n for n in rest if listed[n]["equivalent"]):
                    done[number] = _note(number, names[number], "survived", "")
                rest = [n for n in rest if n not in done]
            if rest:
                units |= _recorded([unit for unit in own if unit.name not in units])
            found = [unit for one in own if (unit := units.get(one.name)) is not None]
            found.sort(key=lambda unit: unit.seconds)
            reached |= {number for unit in found for number in unit.reaches}
            for number, result, by in _tried(rest, found, until):
                if result:
                    done[number] = _note(number, names[number], result, by)
                elif is_last:
                    kind = "survived" if number in reached else "not reached"
                    done[number] = _note(number, names[number], kind, "")
    return _report(done, listed)


def _draw(include: Path) -> int:
    """Write the list of mutants."""
    drawn: list[dict[str, str]] = []
    for rooms, size in SAMPLES.items():
        every = _every(include, rooms)
        drawn += [
            {"room": _room(mutant)} | mutant.row(include) | {"drawn_as": "", "equivalent": ""}
            for mutant in mutants.sample(every, size, SEED)
        ]
        print(f"{', '.join(rooms)}: {min(size, len(every))} of {len(every)}")
    _write_list({n: {"number": str(n)} | row for n, row in enumerate(drawn, start=1)})
    return 0


def _redraw(include: Path) -> int:
    """Replace the mutants that are gone, in the groups of which a tenth is."""
    listed = _listed(ROOMS)
    found = mutants.found_again(include, listed)
    for rooms, size in SAMPLES.items():
        gone = [n for n, row in listed.items() if row["room"] in rooms and n not in found]
        if 10 * len(gone) < size:
            continue
        taken = set(found.values())
        every = [mutant for mutant in _every(include, rooms) if mutant not in taken]
        for n, mutant in zip(gone, mutants.sample(every, len(gone), SEED), strict=True):
            place = "{header}:{line} {operator}: {text}".format(**listed[n])
            was = listed[n]["drawn_as"] or place.removeprefix("palmbots/")
            listed[n] |= {"room": _room(mutant)} | mutant.row(include)
            listed[n] |= {"drawn_as": f"gone: {was}", "equivalent": ""}
        print(f"{', '.join(rooms)}: {len(gone)} of {len(every)}")
    _write_list(listed)
    return 0


def _every(include: Path, rooms: tuple[str, ...]) -> list[mutants.Mutant]:
    return [
        mutant
        for room in rooms
        for path in sorted((include / "palmbots" / room).glob("*.hpp"))
        for mutant in mutants.mutants_of(include, str(path.relative_to(include)))
    ]


def _listed(rooms: Collection[str]) -> dict[int, dict[str, str]]:
    with LIST.open(newline="") as stream:
        rows = [row for row in csv.DictReader(stream) if row["room"] in rooms]
    return {int(row["number"]): row for row in rows}


def _write_list(rows: dict[int, dict[str, str]]) -> None:
    with LIST.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, tuple(next(iter(rows.values()))))
        writer.writeheader()
        writer.writerows(rows.values())


def _room(mutant: mutants.Mutant) -> str:
    return Path(mutant.header).parent.name


def _tried(rest: list[int], units: list[Unit], until: float) -> Iterator[tuple[int, str, str]]:
    """Result of each of the mutants, as it becomes known, and what found it."""

    def one(number: int) -> tuple[int, str, str] | None:
        if time.monotonic() > until:
            return None
        return number, *_killed(number, units)

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        yield from (found for found in pool.map(one, rest) if found is not None)


def _done(names: dict[int, str]) -> dict[int, str]:
    """The results of an earlier run of the same sample."""
    if not RESULTS.exists():
        return {}
    with RESULTS.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    return {n: r["result"] for r in rows if names.get(n := int(r["number"])) == r["mutant"]}


def _forget(is_old: Callable[[dict[str, str]], bool]) -> None:
    """Remove these results of an earlier run."""
    if RESULTS.exists():
        with RESULTS.open(newline="") as stream:
            kept = [row for row in csv.DictReader(stream) if not is_old(row)]
        with RESULTS.open("w", newline="") as stream:
            writer = csv.DictWriter(stream, FIELDS)
            writer.writeheader()
            writer.writerows(kept)


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
        # The copies have one more line at their beginning.
        places = {(m[1], int(m[2]) - 1) for m in _PLACE.finditer(messages)}
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
    # lane_carries_test runs longer than LONGEST_S, and takes half an hour to compile with mutants.
    every = sorted((ROOT / "tests" / "cpp").glob("*/*_test.cpp"))
    return [source for source in every if source.stem != "lane_carries_test"]


def _programs() -> str | None:
    return core_copy.programs(WORK, WORK / "include", _sources(), SANITIZERS)


def _extension() -> str | None:
    return core_copy.build(WORK, WORK / "include", "", is_quick=True)


def _program_units() -> list[Unit]:
    return [Unit(s.stem, (str(WORK / "programs" / s.stem),)) for s in _sources()]


def _python_units() -> list[Unit]:
    python = str(core_copy.environment(WORK))
    command = (python, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider")
    tests = ROOT / "tests"
    return [
        Unit(str(path.relative_to(tests)), (*command, str(path)), rooms)
        for folder in sorted({folder for folders in PYTHON_ROOMS.values() for folder in folders})
        if (rooms := tuple(room for room, folders in PYTHON_ROOMS.items() if folder in folders))
        for path in sorted((tests / folder).rglob("test_*.py"))
    ]


def _recorded(units: list[Unit]) -> dict[str, Unit | None]:
    """The units with what they reach, by name; None: it does not pass without a mutant."""

    def one(unit: Unit) -> Unit | None:
        record = WORK / f"reached-{threading.get_ident()}.txt"
        record.unlink(missing_ok=True)
        began = time.monotonic()
        status = _run(unit, LONGEST_S, {"PALMBOTS_REACHED": str(record)})
        seconds = time.monotonic() - began
        if status != 0:
            why = "takes too long" if status is None else "fails without a mutant"
            print(f"left out, as it {why}: {unit.name}", flush=True)
            return None
        reached = set(map(int, record.read_text().split())) if record.exists() else set()
        return replace(unit, seconds=seconds, reaches=frozenset(reached))

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        return dict(zip((unit.name for unit in units), pool.map(one, units), strict=True))


def _run(unit: Unit, limit_s: float, environment: dict[str, str]) -> int | None:
    try:
        status = subprocess.run(
            ("prlimit", f"--cpu={math.ceil(limit_s)}", *unit.command),
            cwd=ROOT,
            env=os.environ | environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            timeout=PATIENCE * limit_s,
            check=False,
        ).returncode
    except subprocess.TimeoutExpired:
        return None
    return None if status in (-signal.SIGXCPU, -signal.SIGKILL) else status


def _killed(number: int, units: list[Unit]) -> tuple[str, str]:
    """Whether the mutant was killed or timed out, and by what; both empty: nothing found it."""
    for unit in units:
        if number not in unit.reaches:
            continue
        limit_s = max(LEAST_S, PATIENCE * unit.seconds)
        status = _run(unit, limit_s, {"PALMBOTS_MUTANT": str(number)})
        if status != 0:
            return "timed out" if status is None else "killed", unit.name
    return "", ""


def _report(done: dict[int, str], listed: dict[int, dict[str, str]]) -> int:
    for rooms in SAMPLES:
        for some in (rooms, *((room,) for room in rooms if len(rooms) > 1)):
            numbers = [number for number, row in listed.items() if row["room"] in some]
            if numbers:
                print(f"{', '.join(some)}: {_score(done, numbers, listed)}")
    if len(done) < len(listed):
        return 1
    shutil.copy2(RESULTS, PUBLISHED)
    return 0


def _score(done: dict[int, str], numbers: list[int], listed: dict[int, dict[str, str]]) -> str:
    results = [done[number] for number in numbers if number in done]
    killed, unreached = results.count("killed"), results.count("not reached")
    tried = killed + results.count("survived") + unreached
    low, high = wilson(killed, tried) if tried else (0.0, 1.0)
    others = [number for number in numbers if done.get(number, "killed") != "killed"]
    equivalent = sum(bool(listed[number]["equivalent"]) for number in others)
    return (
        f"mutation score {100 * killed / max(1, tried):.0f} % (95 % interval {100 * low:.0f} to "
        f"{100 * high:.0f} %): {killed} of {tried} mutants killed, of a sample of {len(numbers)}; "
        f"{equivalent} of the others are equivalent, {unreached} are reached by no test, "
        f"{results.count('timed out')} timed out, {results.count('gone')} are gone, "
        f"{results.count('does not compile')} do not compile, and {len(numbers) - len(results)} "
        "have not been tried"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
