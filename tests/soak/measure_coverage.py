# SPDX-License-Identifier: Apache-2.0
"""Which lines the tests run, in C++ and in Python (`make coverage`).

    .venv/bin/python tests/soak/measure_coverage.py [TESTS...]

The C++ test programs and the extension are compiled a second time, in build/coverage, with GCC's
counters. The programs run first, then the Python tests (TESTS: some of them) with that extension,
under coverage.py. gcov reads the counters. Writes benchmarks/results/coverage.csv: for each room
the number of lines that can run, and of those that did. Python lines that run in other processes
than the tests' own are not counted.
"""

import csv
import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import core_copy

ROOT = Path(__file__).resolve().parent.parent.parent
WORK = ROOT / "build" / "coverage"
RESULTS = ROOT / "benchmarks" / "results" / "coverage.csv"
FIELDS = ("language", "room", "lines", "run", "percent", "tests")
FLAGS = "--coverage"


def main(tests: list[str]) -> int:
    """Measure and write; the exit status is that of the tests."""
    WORK.mkdir(parents=True, exist_ok=True)
    for counters in WORK.rglob("*.gcda"):
        counters.unlink()
    failed = core_copy.build(WORK, ROOT / "include", FLAGS, is_quick=False)
    sources = sorted((ROOT / "tests" / "cpp").glob("*/*_test.cpp"))
    failed = failed or core_copy.programs(WORK, ROOT / "include", sources, f"-O0 {FLAGS}")
    if failed:
        sys.exit(failed)
    status = 0
    for source in sources:
        program = WORK / "programs" / source.stem
        status |= subprocess.run([program], cwd=WORK, check=False).returncode
    status |= _python_tests(tests)
    rows = [*_cpp_rows(), *_python_rows()]
    kind = " ".join(tests) or "make test test-slow"
    with RESULTS.open("w", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(FIELDS)
        for language, room, lines, run in rows:
            writer.writerow((language, room, lines, run, f"{100 * run / max(1, lines):.1f}", kind))
            print(f"{language:7} {room:12} {run:6} of {lines:6} {100 * run / max(1, lines):5.1f} %")
    return status


def _python_tests(tests: list[str]) -> int:
    python = core_copy.environment(WORK)
    command = [python, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--numprocesses", "auto"]
    command += [f"--cov={WORK / 'package' / 'palmbots'}", "--cov-report="]
    command += [f"--cov-report=json:{WORK / 'python.json'}", *tests]
    own = os.environ | {
        "COVERAGE_FILE": str(WORK / "python.coverage"),
        # Where the counters cannot be written, as in a test of a full disk, GCC must not say so on
        # stderr: tests compare that.
        "GCOV_ERROR_FILE": str(WORK / "gcov.log"),
    }
    return subprocess.run(command, cwd=ROOT, env=own, check=False).returncode


def _cpp_rows() -> list[tuple[str, str, int, int]]:
    lines: dict[str, dict[tuple[Path, int], bool]] = defaultdict(dict)
    for counters in WORK.rglob("*.gcda"):
        command = ["gcov", "--json-format", "--stdout", counters]
        found = subprocess.run(command, check=True, cwd=ROOT, capture_output=True, text=True)
        for report in map(json.loads, filter(None, found.stdout.splitlines())):
            place = Path(report["current_working_directory"])
            for source in report["files"]:
                path = (place / source["file"]).resolve()
                if not path.is_relative_to(ROOT / "include"):
                    continue
                room = lines[path.parent.name]
                for line in source["lines"]:  # a template has one for each kind
                    key = (path, line["line_number"])
                    room[key] = room.get(key, False) or line["count"] > 0
    return _totals("C++", {room: (len(x), sum(x.values())) for room, x in lines.items()})


def _python_rows() -> list[tuple[str, str, int, int]]:
    counts: dict[str, tuple[int, int]] = {}
    for file, found in json.loads((WORK / "python.json").read_text())["files"].items():
        inside = file.rpartition("package/palmbots/")[2]
        room = inside.partition("/")[0] if "/" in inside else "palmbots"
        lines, run = counts.get(room, (0, 0))
        summary = found["summary"]
        counts[room] = lines + summary["num_statements"], run + summary["covered_lines"]
    return _totals("Python", counts)


def _totals(language: str, counts: dict[str, tuple[int, int]]) -> list[tuple[str, str, int, int]]:
    rows = [(language, room, *counts[room]) for room in sorted(counts)]
    whole = (sum(lines for lines, _ in counts.values()), sum(run for _, run in counts.values()))
    return [(language, "all", *whole), *rows]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
