# SPDX-License-Identifier: Apache-2.0
"""A study's folder whose own words are damaged: its record, and what the store says of itself."""

import json
import os
import random
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.studies.chunking import ChunkGrid
from palmbots.studies.points import design_points
from palmbots.studies.store import Store
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import run_study
from palmbots.studies.zarr_arrays import ZarrArrays
from sampled import amounts, in_soak
from study_fixtures import SMALL, hash_of


def damaged(root: Path, what: str) -> None:
    results = root / "results.zarr"
    match what:
        case "an array's metadata cut short":
            os.truncate(results / "outcome" / "zarr.json", 10)
        case "an array's metadata of another shape":
            file = results / "time_s" / "zarr.json"
            file.write_text(file.read_text().replace("30", "20"))
        case "an array gone":
            shutil.rmtree(results / "contact_rms_m")
        case "a statistic gone":
            shutil.rmtree(results / "drop_rate_interval")
        case "a coordinate gone":
            shutil.rmtree(results / "controller")
        case "the group gone":
            (results / "zarr.json").unlink()
        case _:
            shutil.rmtree(results)


@pytest.mark.slow
@pytest.mark.parametrize(
    "what",
    [
        "an array's metadata cut short", "a coordinate gone", "all of it gone",
        *map(in_soak, ("an array gone", "an array's metadata of another shape", "a statistic gone",
                       "the group gone")),
    ],
)  # fmt: skip
def test_damaged_metadata_is_written_again(small: Path, tmp_path: Path, what: str) -> None:
    """And nothing is carried again that is still there."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    file = root / "results.zarr" / "messages" / "c" / "0" / "0" / "0" / "0"
    before = file.stat().st_mtime_ns
    damaged(root, what)
    result = run_study(load_plan(SMALL), root)
    assert result.hash == hash_of(small)
    xr.testing.assert_identical(pb.open_study(small).load(), result.dataset().load())
    if what not in ("an array gone", "all of it gone"):
        assert file.stat().st_mtime_ns == before
    assert not (root / "results.zarr.part").exists()


@pytest.mark.parametrize("key", ["seeds_a_chunk", "block", "shape", "controllers", "seeds"])
@pytest.mark.parametrize("value", ["x", 0, -1, 10**6, [0], None])
def test_record_with_an_impossible_layout_is_refused(
    small: Path, tmp_path: Path, key: str, value: object
) -> None:
    root = tmp_path / "study"
    root.mkdir()
    record = json.loads((small / "study.json").read_text())
    record["layout"][key] = value
    (root / "study.json").write_text(json.dumps(record))
    with pytest.raises(PalmbotsError, match=r"study\.json is missing or damaged"):
        run_study(load_plan(SMALL), root)
    del record["layout"][key]
    (root / "study.json").write_text(json.dumps(record))
    with pytest.raises(PalmbotsError, match=r"study\.json is missing or damaged"):
        run_study(load_plan(SMALL), root)


@pytest.mark.slow
@pytest.mark.parametrize("what", ["another shape", "floats", "no tally", "no archive"])
def test_foreign_mark_is_ignored(small: Path, tmp_path: Path, what: str) -> None:
    """Files of the right name that a study did not write: their chunk is carried again."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    mark = root / "chunks" / "0.npz"
    with np.load(mark) as mark_file:
        tally, checksum = mark_file["sums"], mark_file["checksum"]
    match what:
        case "another shape":
            np.savez(mark, sums=tally[:1], checksum=checksum)
        case "floats":
            np.savez(mark, sums=tally.astype(float), checksum=checksum)
        case "no tally":
            np.savez(mark, checksum=checksum)
        case _:
            np.save(mark.with_suffix(".npy"), tally)
            mark.with_suffix(".npy").rename(mark)
    result = run_study(load_plan(SMALL), root)
    assert result.hash == hash_of(small)
    assert result.resumed == 0
    xr.testing.assert_identical(pb.open_study(small).load(), result.dataset().load())


@pytest.mark.parametrize("times", amounts(500, 1500))
def test_mark_with_a_flipped_bit_is_ignored_or_unchanged(
    small: Path, tmp_path: Path, times: int
) -> None:
    """Wherever it is, the mark is what it was or none."""
    points = design_points(load_plan(SMALL))
    mark = tmp_path / "chunks" / "0.npz"
    mark.parent.mkdir()
    whole = (small / "chunks" / "0.npz").read_bytes()
    layout = ChunkGrid(points.shape, points.shape, 2, 30, 30)
    store = Store(tmp_path, points, layout, ZarrArrays(small / "results.zarr", points, layout))
    mark.write_bytes(whole)
    sound = store.mark(0, (6, 2))
    assert sound is not None
    rng = random.Random(0)
    lost = 0
    for _ in range(times):
        damaged = bytearray(whole)
        # Most of a mark is its sums, which the checksum of the archive covers: test the rest more.
        at = rng.randrange(250) if rng.random() < 0.5 else -1 - rng.randrange(700)
        damaged[at] ^= 1 << rng.randrange(8)
        mark.write_bytes(damaged)
        kept = store.mark(0, (6, 2))
        lost += kept is None
        assert kept is None or ((kept[0] == sound[0]).all() and kept[1] == sound[1])
    assert lost > times / 3
    assert store.mark(1, (6, 2)) is None


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (1, r"this study has format 1 \(palmbots 0\.1\.0\), and palmbots \S+ uses format 2; run"),
        (3, r"this study has format 3 \(palmbots 0\.1\.0\), and palmbots \S+ uses format 2; run"),
        ("1", r"study\.json is missing or damaged"),
        (None, r"study\.json is missing or damaged"),
    ],
)
def test_record_of_another_format_is_refused(
    small: Path, tmp_path: Path, number: object, words: str
) -> None:
    """By the command that continues a study, and by the function that opens its results."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    record = json.loads((small / "study.json").read_text())
    record["content"]["version"] = "0.1.0"
    (root / "study.json").write_text(json.dumps(record | {"palmbots study": number}))
    for read in (lambda: run_study(load_plan(SMALL), root), lambda: pb.open_study(root)):
        with pytest.raises(PalmbotsError, match=words) as caught:
            read()
        assert "\n" not in str(caught.value)


def test_resumed_carries_are_counted_before_the_repair(small: Path, tmp_path: Path) -> None:
    """Carries of a damaged chunk count as resumed: their damage shows only at the end."""
    root = tmp_path / "study"
    run_study(load_plan(SMALL), root, chunk_size=60)
    (root / "chunks" / "1.npz").unlink()
    times = root / "results.zarr" / "time_s"
    shutil.rmtree(times / "c" / "1")  # three chunks of six
    result = run_study(load_plan(SMALL), root)
    assert (result.resumed, result.carries, result.hash) == (300, 360, hash_of(small))
