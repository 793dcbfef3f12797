"""libFuzzer on the wire's decoder: compiles the target, writes the seeds, runs it.

    .venv/bin/python tests/fuzzing.py SECONDS     fuzzes on all cores (`make fuzz`)

What a long run learns stays in build/fuzz, so that the next one goes on from there. An input that
breaks a law is kept as build/fuzz-crash-*; the program takes it as its argument to show it again.
"""

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

import wire_oracle
from cxx import ROOT, compile_cxx

TARGET = ROOT / "tests" / "fuzz" / "decode_fuzz.cpp"
FLAGS = ("-O1", "-g", "-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all")
LONGEST = 200  # bytes of an input: a script of so many steps


def program(flags: Sequence[str] = ()) -> Path:
    """The compiled target."""
    return compile_cxx(TARGET, [*FLAGS, *flags], "clang++")


def seeds() -> Iterator[bytes]:
    """Where to start from: each law's way with the golden packets, and talks of two ends."""
    for line in wire_oracle.GOLDEN.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            packet = bytes.fromhex(line.split(" | ")[3])
            yield b"\x00" + packet
            yield b"\x01" + packet[:20]
            kind, roles, payload = packet[1], packet[2], packet[19]
            numbers = packet[5:8] + b"\x00" + packet[8:15] + b"\x00" + packet[15:19]
            yield bytes([2, kind, roles]) + packet[3:5] + numbers + bytes([payload])
    # Steps: 0, 1 boot; 2, 3 send; 4, 5 deliver to the left, the right; 6, 7 the same with a flip.
    greet = bytes([2, 5, 3, 4])
    yield b"\x03" + greet + bytes([2, 5] * 8)
    yield b"\x03" + greet + bytes([2, 2, 2, 13, 5, 5, 7, 0, 2, 5, 3, 4, 21, 5])
    yield b"\x03" + greet + bytes([2, 5, 1, 5, 3, 4, 5, 2, 5])


def write_seeds(folder: Path) -> Path:
    """Writes them to an existing folder."""
    for number, seed in enumerate(seeds()):
        (folder / f"seed-{number:03}").write_bytes(seed)
    return folder


def main(seconds: str) -> int:
    """Fuzz for so long; the exit code is that of libFuzzer, not 0 if a law is broken."""
    corpus = ROOT / "build" / "fuzz"
    corpus.mkdir(parents=True, exist_ok=True)
    cores = os.cpu_count()
    options = [f"-max_total_time={seconds}", f"-fork={cores}", f"-max_len={LONGEST}"]
    kept = f"-artifact_prefix={corpus}-"
    return subprocess.run([program(), *options, kept, write_seeds(corpus)]).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
