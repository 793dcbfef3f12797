# SPDX-License-Identifier: Apache-2.0
"""libFuzzer on the wire's decoder: writes the seeds and runs the target.

    .venv/bin/python tests/soak/fuzz_decode.py SECONDS     fuzzes on all cores (`make fuzz`)

What a long run learns stays in build/fuzz, so that the next one goes on from there. An input that
breaks a law is kept as build/fuzz-crash-*; the program takes it as its argument to show it again.
"""

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parent.parent / "support"))

import wire_oracle
from cxx import ROOT, program

TARGET = ROOT / "tests" / "soak" / "fuzz_decode.cpp"
CORPUS = ROOT / "build" / "fuzz"
LONGEST = 200  # bytes of an input: a script of so many steps


def seeds() -> Iterator[bytes]:
    """Where to start from: each law's way with the golden packets, and talks of two ends."""
    for line in wire_oracle.GOLDEN.read_text(encoding="utf-8").splitlines():
        if not line.startswith("#"):
            packet = bytes.fromhex(line.split(" | ")[3])
            yield b"\x00" + packet
            yield b"\x05" + bytes([len(packet) % 7, len(packet)]) + packet + packet[:5]
            yield b"\x01" + packet[:24]
            kind, roles, payload = packet[1], packet[2], packet[19:24]
            numbers = packet[5:8] + b"\x00" + packet[8:15] + b"\x00" + packet[15:19]
            yield bytes([2, kind, roles]) + packet[3:5] + numbers + payload
    # Steps: 0, 1 boot; 2, 3 send; 4, 5 deliver to the left, the right; 6, 7 the same with a flip.
    greet = bytes([2, 5, 3, 4])
    yield b"\x03" + greet + bytes([2, 5] * 8)
    yield b"\x03" + greet + bytes([2, 2, 2, 13, 5, 5, 7, 0, 2, 5, 3, 4, 21, 5])
    yield b"\x03" + greet + bytes([2, 5, 1, 5, 3, 4, 5, 2, 5])


def write_seeds(folder: Path) -> Path:
    """Writes them to an existing folder."""
    for number, seed in enumerate(seeds()):
        (folder / f"seed-{number:04}").write_bytes(seed)
    return folder


def crashes() -> list[Path]:
    """The inputs that broke a law, of all runs."""
    return [*CORPUS.parent.glob("fuzz-*")]


def main(seconds: str) -> int:
    """Fuzz for so long; the exit code is that of libFuzzer, not 0 if a law is broken."""
    CORPUS.mkdir(parents=True, exist_ok=True)
    cores = os.cpu_count()
    options = [f"-max_total_time={seconds}", f"-fork={cores}", f"-max_len={LONGEST}"]
    kept = f"-artifact_prefix={CORPUS}-"
    return subprocess.run(
        [program("wire/fuzz_decode"), *options, kept, write_seeds(CORPUS)]
    ).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
