"""A study's folder whose own words are damaged: its record, and what the store says of itself."""

import json
import os
import shutil
from pathlib import Path

import pytest
import xarray as xr

import palmbots as pb
from palmbots.errors import PalmbotsError
from palmbots.studies.plan import load_plan
from palmbots.studies.run import run_study
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
