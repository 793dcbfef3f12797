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
from palmbots.studies.arrays import Arrays
from palmbots.studies.design import design
from palmbots.studies.layout import Layout
from palmbots.studies.plan import load_plan
from palmbots.studies.run import run_study
from palmbots.studies.store import Store
from studies import SMALL, hash_of


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("small") / "study"
    pb.study(SMALL, root)
    return root


def damaged(root: Path, what: str) -> None:
    results = root / "results.zarr"
    match what:
        case "an array's metadata cut short":
            os.truncate(results / "outcome" / ".zarray", 10)
        case "an array's metadata of another shape":
            file = results / "time_s" / ".zarray"
            file.write_text(file.read_text().replace("30", "20"))
        case "an array gone":
            shutil.rmtree(results / "contact_rms_m")
        case "a statistic gone":
            shutil.rmtree(results / "drop_rate_interval")
        case "a coordinate gone":
            shutil.rmtree(results / "controller")
        case "the group gone":
            (results / ".zgroup").unlink()
        case _:
            shutil.rmtree(results)


@pytest.mark.parametrize(
    "what",
    [
        "an array's metadata cut short", "an array's metadata of another shape", "an array gone",
        "a statistic gone", "a coordinate gone", "the group gone", "all of it gone",
    ],
)  # fmt: skip
def test_a_damaged_store_is_mended(small: Path, tmp_path: Path, what: str) -> None:
    """And nothing is carried again that is still there."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    file = root / "results.zarr" / "messages" / "0" / "0" / "0" / "0"
    before = file.stat().st_mtime_ns
    damaged(root, what)
    done = run_study(load_plan(SMALL), root)
    assert done.hash == hash_of(small)
    xr.testing.assert_identical(pb.open_study(small).load(), done.dataset().load())
    if what not in ("an array gone", "all of it gone"):
        assert file.stat().st_mtime_ns == before
    assert not (root / "results.zarr.part").exists()


@pytest.mark.parametrize("key", ["seeds_a_chunk", "block", "shape", "controllers", "seeds"])
@pytest.mark.parametrize("value", ["x", 0, -1, 10**6, [0], None])
def test_a_record_of_an_impossible_cut_is_refused(
    small: Path, tmp_path: Path, key: str, value: object
) -> None:
    root = tmp_path / "study"
    root.mkdir()
    record = json.loads((small / "study.json").read_text())
    record["layout"][key] = value
    (root / "study.json").write_text(json.dumps(record))
    with pytest.raises(PalmbotsError, match=r"study\.json is missing or not of a study"):
        run_study(load_plan(SMALL), root)
    del record["layout"][key]
    (root / "study.json").write_text(json.dumps(record))
    with pytest.raises(PalmbotsError, match=r"study\.json is missing or not of a study"):
        run_study(load_plan(SMALL), root)


@pytest.mark.parametrize("what", ["another shape", "floats", "no tally", "no archive"])
def test_a_mark_of_something_else_is_no_mark(small: Path, tmp_path: Path, what: str) -> None:
    """Files of the right name that a study did not write: their chunk is carried again."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    mark = root / "chunks" / "0.npz"
    with np.load(mark) as told:
        tally, checksum = told["tally"], told["checksum"]
    match what:
        case "another shape":
            np.savez(mark, tally=tally[:1], checksum=checksum)
        case "floats":
            np.savez(mark, tally=tally.astype(float), checksum=checksum)
        case "no tally":
            np.savez(mark, checksum=checksum)
        case _:
            np.save(mark.with_suffix(".npy"), tally)
            mark.with_suffix(".npy").rename(mark)
    done = run_study(load_plan(SMALL), root)
    assert done.hash == hash_of(small)
    assert done.resumed == 0
    xr.testing.assert_identical(pb.open_study(small).load(), done.dataset().load())


def test_a_bit_that_flips_in_a_mark(small: Path, tmp_path: Path) -> None:
    """Wherever it is, the mark is what it was or none."""
    points = design(load_plan(SMALL))
    mark = tmp_path / "chunks" / "0.npz"
    mark.parent.mkdir()
    whole = (small / "chunks" / "0.npz").read_bytes()
    cut = Layout(points.shape, points.shape, 2, 30, 30)
    store = Store(tmp_path, points, cut, Arrays(small / "results.zarr", points, cut))
    mark.write_bytes(whole)
    sound = store.kept(0, (6, 2))
    assert sound is not None
    rng = random.Random(0)
    lost = 0
    for _ in range(1500):
        damaged = bytearray(whole)
        # Most of a mark is its tally, whose damage a checksum tells: more often elsewhere.
        at = rng.randrange(250) if rng.random() < 0.5 else -1 - rng.randrange(700)
        damaged[at] ^= 1 << rng.randrange(8)
        mark.write_bytes(damaged)
        kept = store.kept(0, (6, 2))
        lost += kept is None
        assert kept is None or ((kept[0] == sound[0]).all() and kept[1] == sound[1])
    assert lost > 500
    assert store.kept(1, (6, 2)) is None


def test_a_record_of_another_format_is_refused(small: Path, tmp_path: Path) -> None:
    record = json.loads((small / "study.json").read_text())
    (tmp_path / "study.json").write_text(json.dumps(record | {"palmbots study": 2}))
    with pytest.raises(PalmbotsError, match=r"study\.json is missing or not of a study"):
        run_study(load_plan(SMALL), tmp_path)


def test_what_was_kept_counts_as_such_also_after_a_repair(small: Path, tmp_path: Path) -> None:
    """Carries of a damaged chunk had been kept, as far as anybody knew."""
    root = tmp_path / "study"
    run_study(load_plan(SMALL), root, chunk=60)
    (root / "chunks" / "1.npz").unlink()
    times = root / "results.zarr" / "time_s"
    shutil.rmtree(times / "1")  # three chunks of six
    done = run_study(load_plan(SMALL), root)
    assert (done.resumed, done.carries, done.hash) == (300, 360, hash_of(small))
