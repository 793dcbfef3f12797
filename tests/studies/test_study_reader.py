# SPDX-License-Identifier: Apache-2.0
"""Opening results: damaged and unfinished stores are refused, by us and by plain xarray.

Every fault is real: bits of real files are flipped, files are truncated, removed and exchanged, and
real processes are killed.
"""

import itertools
import os
import random
import re
import shutil
import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import zarr

import at_call
import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.studies.store import Store
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import run_study
from palmbots.studies.variables import MISSING, STATISTICS, VARIABLES
from study_fixtures import CHUNK, LONG, SMALL, marks, study_here


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("small") / "study"
    run_study(load_plan(SMALL), root, chunk_size=180)  # two chunks
    return root


@pytest.fixture
def copy(small: Path, tmp_path: Path) -> Path:
    root = tmp_path / "study"
    shutil.copytree(small, root)
    return root


def test_a_dataset_is_written_as_netcdf_and_read_again(small: Path, tmp_path: Path) -> None:
    found = pb.open_study(small)
    found.to_netcdf(tmp_path / "study.nc", engine="scipy")
    assert xr.open_dataset(tmp_path / "study.nc", engine="scipy").equals(found)


def chunk_files(root: Path, name: str) -> list[Path]:
    return sorted(
        path for path in (root / "results.zarr" / name / "c").rglob("*") if path.is_file()
    )


def flip(file: Path, rng: random.Random) -> None:
    data = bytearray(file.read_bytes())
    data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    file.write_bytes(data)


def truncate(file: Path, rng: random.Random) -> None:
    os.truncate(file, rng.randrange(file.stat().st_size))


def remove(file: Path, _rng: random.Random) -> None:
    file.unlink()


ARRAYS = [
    *VARIABLES, *STATISTICS, "rms_m_interval", "seed", "controller", "radio.latency_s", "side",
    "end",
]  # fmt: skip


@pytest.mark.slow
def test_damaged_file_is_reported(copy: Path) -> None:
    """One bit, one cut or one missing file, in any array; by the folder and by the store alone."""
    rng = random.Random(0)
    alone = copy.parent / "alone"
    shutil.copytree(copy / "results.zarr", alone)
    places = itertools.cycle([(copy, copy / "results.zarr"), (alone, alone)])
    faults = itertools.cycle([flip, truncate, remove])
    for name, (place, store), fault in zip(ARRAYS, places, faults, strict=False):
        file = rng.choice(
            sorted(path for path in (store / name / "c").rglob("*") if path.is_file())
        )
        sound = file.read_bytes()
        fault(file, rng)
        with pytest.raises(PalmbotsError, match="the results are damaged") as caught:
            pb.open_study(place)
        assert name in str(caught.value)
        assert "\n" not in str(caught.value)
        file.write_bytes(sound)
    pb.open_study(copy)
    pb.open_study(alone)


def test_rerun_repairs_a_damaged_study(copy: Path, small: Path) -> None:
    rng = random.Random(1)
    for k, name in enumerate(ARRAYS):
        (flip, truncate, remove)[k % 3](rng.choice(chunk_files(copy, name)), rng)
    with pytest.raises(PalmbotsError, match="run the same study again"):
        pb.open_study(copy)
    run_study(load_plan(SMALL), copy)
    xr.testing.assert_identical(pb.open_study(copy).load(), pb.open_study(small).load())


@pytest.mark.parametrize("name", ["outcome", "time_s", "corrections"])
@pytest.mark.parametrize("fault", [flip, truncate])
def test_plain_xarray_raises_for_a_damaged_chunk(
    copy: Path, name: str, fault: Callable[[Path, random.Random], None]
) -> None:
    """For every bit and every length: the checksum is part of the store."""
    file = chunk_files(copy, name)[1]
    sound = file.read_bytes()
    found = xr.open_zarr(copy / "results.zarr", chunks=None)[name]
    for seed in range(8):
        file.write_bytes(sound)
        fault(file, random.Random(seed))
        with pytest.raises(ValueError, match="checksum"):
            found.compute()  # each time from the file
    file.write_bytes(sound)
    found.compute()


def test_plain_xarray_sees_a_lost_chunk_as_missing(copy: Path) -> None:
    """Not as "not carried", delivered or 0."""
    for name in VARIABLES:
        chunk_files(copy, name)[1].unlink()
    found = xr.open_zarr(copy / "results.zarr", chunks=None).load()
    lost = found.outcome == MISSING
    assert int(lost.sum()) == 180
    assert (found.reason.where(lost) == MISSING).sum() == 180
    for name in set(VARIABLES) - {"outcome", "reason"}:
        assert (found[name].isnull() == lost).all(), name


@pytest.mark.parametrize("key", ["carries", "hash", "identity", "is_complete", "max_carries"])
def test_changed_attribute_of_the_store_is_refused(copy: Path, key: str) -> None:
    group = zarr.open_group(str(copy / "results.zarr"), mode="r+")
    value: Any = group.attrs[key]
    for other in ("x", 7, None):
        group.attrs[key] = other
        if key == "max_carries" and other == 7:
            continue  # of a complete study it is not used
        with pytest.raises(PalmbotsError):
            pb.open_study(copy)
    group.attrs[key] = value
    pb.open_study(copy)


def test_sound_chunk_of_another_study_is_noticed(copy: Path, tmp_path: Path) -> None:
    """Its checksum is right, but the hash of all results is not."""
    other = tmp_path / "other"
    run_study(load_plan({**SMALL, "seeds": {"first": 8, "count": 30}}), other, chunk_size=180)
    for name in VARIABLES:
        shutil.copy(chunk_files(other, name)[1], chunk_files(copy, name)[1])
    with pytest.raises(PalmbotsError, match=r"are damaged: 360 carries with hash \w+ instead of"):
        pb.open_study(copy)
    pb.open_study(copy, verify=False)  # nothing is read


def test_metadata_that_differs_from_its_copy_is_noticed(copy: Path) -> None:
    file = copy / "results.zarr" / "time_s" / "zarr.json"
    file.write_text(file.read_text().replace('"units": "s"', '"units": "h"'))
    with pytest.raises(PalmbotsError, match="time_s: the metadata was changed"):
        pb.open_study(copy)


def test_killed_study_is_incomplete(tmp_path: Path) -> None:
    """A real process, killed by SIGKILL once three chunks are written."""
    file, root = tmp_path / "long.toml", tmp_path / "study"
    file.write_text(LONG)
    words = (file, "--out", root, "--chunk-size", CHUNK)
    killed = at_call.fork("SIGKILL", "after", Store.write, 3, lambda: study_here(*words))
    assert killed == -signal.SIGKILL
    assert 3 <= len(marks(root)) < 12
    with pytest.raises(PalmbotsError, match="incomplete: ") as caught:
        pb.open_study(root)
    number = re.search(r"incomplete: (\d+) of 960 carries; run the same study", str(caught.value))
    assert number and int(number[1]) in (CHUNK * len(marks(root)), CHUNK * len(marks(root)) + CHUNK)
    found = pb.open_study(root, allow_incomplete=True).load()
    carried = found.outcome < MISSING
    assert int(carried.sum()) == int(number[1])
    assert (found.time_s.isnull() == ~carried).all(), "nothing reads as 0"
    assert found.drop_rate.isnull().all()
    assert found.attrs["is_complete"] == 0
    plain = xr.open_zarr(root / "results.zarr", chunks=None)
    assert int((plain.outcome == MISSING).sum()) == 960 - int(number[1])


@pytest.mark.parametrize("verify", [True, False])
def test_study_that_has_just_begun_is_incomplete(tmp_path: Path, verify: bool) -> None:
    root = tmp_path / "study"

    def stop(_fraction: float) -> None:
        raise KeyboardInterrupt

    for table, limit in ((SMALL, ""), ({**SMALL, "stop": {"block": 10, "rms": 0.1}}, "at most ")):
        with pytest.raises(KeyboardInterrupt):
            pb.study(table, root / limit, on_progress=stop)
        with pytest.raises(PalmbotsError, match=f"incomplete: 0 of {limit}360 carries; run"):
            pb.open_study(root / limit, verify=verify)
        assert pb.open_study(root / limit, verify=verify, allow_incomplete=True).sizes["seed"] == 30


def test_damage_of_an_unfinished_study_is_reported_too(copy: Path) -> None:
    zarr.open_group(str(copy / "results.zarr"), mode="r+").attrs["is_complete"] = False
    pb.open_study(copy, allow_incomplete=True)
    flip(chunk_files(copy, "messages")[0], random.Random(0))
    with pytest.raises(PalmbotsError, match="damaged: messages: "):
        pb.open_study(copy, allow_incomplete=True)


def test_early_stopping_is_not_taken_for_damage(tmp_path: Path) -> None:
    """Carries that the study leaves out are "not carried"; none is "missing"."""
    table = {**SMALL, "seeds": {"count": 120}, "stop": {"block": 40, "drop_rate": 0.08}}
    run_study(load_plan(table), tmp_path / "study", chunk_size=100)
    found = pb.open_study(tmp_path / "study").load()
    left_out = found.outcome == 0
    assert 0 < int(left_out.sum()) < found.outcome.size
    assert not (found.outcome == MISSING).any()
    assert (found.time_s.isnull() == left_out).all()
    mean = found.corrections.mean("seed")
    np.testing.assert_allclose(mean, found.mean_corrections, rtol=1e-12)
