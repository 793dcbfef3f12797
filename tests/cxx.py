"""Compiles C++ sources of the tests, and keeps the results until a source changes."""

import functools
import hashlib
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CACHE = ROOT / "build" / "tests"

STANDARD = ("-std=c++20", "-I", str(ROOT / "include"), "-ffp-contract=off", "-fno-math-errno")
WARNINGS = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Wpedantic", "-Werror")
SANITIZERS = ("-g1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


def _digest(*parts: bytes) -> str:
    return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16]


@functools.cache
def _surroundings(compiler: str) -> str:
    """What every result depends on besides its own source: the compiler and all headers."""
    version = subprocess.run([compiler, "--version"], check=True, capture_output=True).stdout
    headers = sorted([*ROOT.glob("include/**/*.hpp"), *ROOT.glob("tests/core/*.hpp")])
    return _digest(version, *(header.read_bytes() for header in headers))


def compile_cxx(source: Path, flags: Sequence[str], compiler: str = "g++") -> Path:
    """Compile a source with STANDARD, WARNINGS and `flags`: to a program, or an object with "-c".

    Raises AssertionError with the compiler's messages when it does not compile.
    """
    command = [compiler, *STANDARD, *WARNINGS, *flags, str(source), "-o"]
    folder = CACHE / f"{source.stem}-{_digest(' '.join(command).encode())}"
    result = folder / _digest(_surroundings(compiler).encode(), source.read_bytes())
    if not result.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        unfinished = result.with_suffix(".part")
        done = subprocess.run([*command, str(unfinished)], capture_output=True, text=True)
        assert done.returncode == 0, f"{compiler} {source.name}:\n{done.stderr}"
        unfinished.rename(result)
    return result
