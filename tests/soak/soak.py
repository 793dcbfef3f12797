# SPDX-License-Identifier: Apache-2.0
"""Random examples, fuzzing, kill loops and long statistics until the time is over (`make soak`).

    .venv/bin/python tests/soak/soak.py MINUTES

First come the measurements that a release states: instructions, coverage and the mutation score.
They take at most half of the time, and are left out if there is less than an hour. One that runs
out of its time is no failure. The mutation score goes on where it stopped before; the others begin
anew. Coverage takes about 20 minutes on two idle cores, so give at least 90 minutes for a release.

Then rounds follow one another, each with another seed: first libFuzzer, then the tests of
tests/soak, then every Hypothesis property with random examples and every test marked `soak`, with
those of the firmware where its compiler is installed. Each failure is appended to
build/soak/failures.txt with the example that shows it; such an example then becomes an explicit
`@example` of the property. Exit code 1 if anything failed.
"""

import secrets
import shutil
import subprocess
import sys
import time
from pathlib import Path

import fuzz_decode
import live_table

ROOT = Path(__file__).resolve().parent.parent.parent
FAILURES = ROOT / "build" / "soak" / "failures.txt"
MEASURED_FROM_MIN = 60.0
MEASURED_SHARE = 0.5
FUZZ_SHARE = 0.1  # of the time that is left
FUZZ_MAX_S = 300.0
INTERRUPTED = 2  # pytest's exit code when the time is over before the tests are
NO_TESTS = 5


def note(text: str) -> None:
    with FAILURES.open("a", encoding="utf-8") as stream:
        print(text, file=stream)


def measure(seconds: float) -> None:
    """Instructions, coverage and mutation score; what fails is noted."""
    until = time.time() + seconds
    commands = [
        [ROOT / "benchmarks" / "bench_instructions.py"],
        [ROOT / "tests" / "soak" / "measure_coverage.py"],
        [ROOT / "tests" / "soak" / "mutation_score.py", "--seconds"],
    ]
    for command in commands:
        left_s = max(60.0, until - time.time())
        words = [str(word) for word in command]
        if words[-1] == "--seconds":
            words.append(str(round(left_s)))
            left_s += 1800.0  # to finish what it has begun
        print(f"soak: {Path(words[0]).name}", flush=True)
        try:
            status = subprocess.run(
                [sys.executable, *words], cwd=ROOT, check=False, timeout=left_s
            ).returncode
        except subprocess.TimeoutExpired:
            print(f"soak: {Path(words[0]).name}: not finished, runs again next time", flush=True)
            continue
        if status != 0 and "--seconds" not in words:
            note(f"== {Path(words[0]).name}: {status}")


def fuzz(seconds: float) -> bool:
    """Run libFuzzer; True if no input breaks a law. Such an input is noted in hexadecimal."""
    before = set(fuzz_decode.crashes())
    if fuzz_decode.main(str(round(seconds))) == 0:
        return True
    note(f"== libFuzzer, {fuzz_decode.TARGET.relative_to(ROOT)}")
    for path in sorted(set(fuzz_decode.crashes()) - before):
        note(f"{path.relative_to(ROOT)}: {path.read_bytes().hex()}")
    return False


def pytest(seed: int, until: float, *arguments: str) -> bool:
    """Run tests with random examples; True if none of them failed."""
    command = [
        sys.executable, "-m", "pytest", "--quiet", "-p", "no:cacheprovider",
        "--numprocesses", "auto", "--dist", "worksteal",
        "--hypothesis-profile", "soak",
        "--soak-seed", str(seed), "--until", str(until), "--failures-to", str(FAILURES),
        *arguments,
    ]  # fmt: skip
    before = FAILURES.stat().st_size
    status = subprocess.run(command, cwd=ROOT, check=False).returncode
    if status not in (0, INTERRUPTED, NO_TESTS) and FAILURES.stat().st_size == before:
        note(f"== pytest {' '.join(arguments)}, seed {seed}: exit code {status}")
    return FAILURES.stat().st_size == before


def main(minutes: str) -> int:
    began = time.time()
    until = began + 60.0 * float(minutes)
    FAILURES.parent.mkdir(parents=True, exist_ok=True)
    FAILURES.touch()
    failures_before = FAILURES.stat().st_size
    rounds = 0
    if float(minutes) >= MEASURED_FROM_MIN:
        measure(60.0 * float(minutes) * MEASURED_SHARE)
    while (left_s := until - time.time()) > 0:
        rounds += 1
        seed = secrets.randbelow(2**32)
        print(f"soak: round {rounds}, seed {seed}, {left_s / 60:.0f} min left", flush=True)
        fuzz(max(10.0, min(FUZZ_MAX_S, FUZZ_SHARE * left_s)))
        pytest(seed, until, "tests/soak")
        if time.time() < until:
            pytest(seed, until, "-m", "hypothesis or soak", "tests")
        if time.time() < until:
            pytest(seed, until, "-m", "soak", "tests/processes")
        if time.time() < until and shutil.which("arm-none-eabi-g++"):
            pytest(seed, until, "-m", "soak", "tests/firmware")
    if rounds:
        live_table.main()
    failed = FAILURES.stat().st_size > failures_before
    print(f"soak: {rounds} rounds in {(time.time() - began) / 60:.0f} min")
    print(f"soak: failures are in {FAILURES}" if failed else "soak: no failure")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
