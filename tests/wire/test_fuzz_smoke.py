# SPDX-License-Identifier: Apache-2.0
"""A short run of the fuzz target that `make fuzz` runs for long, and proof that it can fail."""

import subprocess
from pathlib import Path

import pytest

import fuzz_decode
from cxx import program
from wire_defects import DEFECTS

# How many inputs; the seed makes every run the same.
ENOUGH = ("-runs=10000", "-seed=1", f"-max_len={fuzz_decode.LONGEST}", "-print_final_stats=1")
TRAPPED = 77  # libFuzzer's exit code when the target dies


def run(target: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    corpus = folder / "corpus"
    corpus.mkdir()
    options = [*ENOUGH, f"-artifact_prefix={folder}/"]
    command = [target, *options, fuzz_decode.write_seeds(corpus)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_random_inputs_satisfy_the_packet_rules(tmp_path: Path) -> None:
    done = run(program("wire/fuzz_decode"), tmp_path)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "stat::number_of_executed_units: 10" in done.stderr


@pytest.mark.soak
@pytest.mark.parametrize("defect", DEFECTS)
def test_fuzzer_finds_planted_defects(defect: str, tmp_path: Path) -> None:
    """The same short run finds what somebody might break in a header."""
    done = run(program(f"wire/fuzz_decode-{defect}"), tmp_path)
    assert done.returncode == TRAPPED, done.stderr[-3000:]
