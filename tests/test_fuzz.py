"""A short run of the fuzz target that `make fuzz` runs for long, and proof that it can fail."""

import subprocess
from pathlib import Path

import pytest

import fuzzing
from cxx import CACHE, ROOT

# How many inputs; the seed makes every run the same.
ENOUGH = ("-runs=30000", "-seed=1", f"-max_len={fuzzing.LONGEST}", "-print_final_stats=1")
TRAPPED = 77  # libFuzzer's exit code when the target dies


def run(program: Path, folder: Path) -> subprocess.CompletedProcess[str]:
    corpus = folder / "corpus"
    corpus.mkdir()
    options = [*ENOUGH, f"-artifact_prefix={folder}/"]
    command = [program, *options, fuzzing.write_seeds(corpus)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_no_input_breaks_a_law(tmp_path: Path) -> None:
    done = run(fuzzing.program(), tmp_path)
    assert done.returncode == 0, done.stderr[-3000:]
    assert "stat::number_of_executed_units: 30" in done.stderr


# Header, what stands there, and what a careless hand would make of it.
DEFECTS = {
    "no tag is looked at": ("wire.hpp", "if (!same_tag(tag,", "if (false && !same_tag(tag,"),
    "half of the tag is enough": ("wire.hpp", "difference | difference >> 32", "difference"),
    "the payload is not tagged": (
        "wire.hpp",
        "tagged_size = tag_field.offset;",
        "tagged_size = payload_field.offset;",
    ),
    "any payload means something": (
        "wire.hpp",
        "if (!well_formed(packet)) return {",
        "if (false) return {",
    ),
    "the newest packet counts twice": ("window.hpp", "stamp <= newest_", "stamp < newest_"),
    "what was sent before the boot counts": (
        "endpoint.hpp",
        "packet.heard.epoch == next_.epoch",
        "true",
    ),
}


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_planted_defect_is_found(defect: str, tmp_path: Path) -> None:
    """The same short run finds what somebody might break in a header."""
    header, right, wrong = DEFECTS[defect]
    text = (ROOT / "include" / "palmbots" / header).read_text(encoding="utf-8")
    assert text.count(right) == 1
    folder = CACHE / "defects" / defect.replace(" ", "-")
    (folder / "palmbots").mkdir(parents=True, exist_ok=True)
    (folder / "palmbots" / header).write_text(text.replace(right, wrong), encoding="utf-8")
    # -iquote comes before all -I, so that this header is taken and all others from include/.
    done = run(fuzzing.program(["-iquote", str(folder)]), tmp_path)
    assert done.returncode == TRAPPED, done.stderr[-3000:]
