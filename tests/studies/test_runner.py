# SPDX-License-Identifier: Apache-2.0
"""A study's results are its single carries, however it was cut, spread and ordered."""

import itertools
import random
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import zarr

import palmbots as pb
from palmbots._util.confidence_intervals import wilson
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import run_study
from palmbots.studies.variables import VARIABLES
from sampled import in_soak, sampled
from study_fixtures import SMALL, command, hash_of, marks, said_here

OUTCOMES = ("running", "delivered", "dropped", "stalled")


def test_every_carry_equals_the_single_carry(small: Path) -> None:
    found = pb.open_study(small)
    assert dict(found.sizes) == {
        "radio.latency_s": 2, "robot.noise_m_s": 3, "controller": 2,
        "seed": 30, "side": 2, "end": 2,
    }  # fmt: skip
    rng = random.Random(0)
    for _ in range(25):
        keys = {key: rng.choice(values) for key, values in SMALL["vary"].items()}
        controller, seed = rng.choice(SMALL["controllers"]), rng.randrange(7, 37)
        one = pb.carry("paper", controller, seed=seed, record=False, overrides=keys)
        row = found.sel({**keys, "controller": controller, "seed": seed})
        assert OUTCOMES[int(row.outcome)] == one.outcome
        assert float(row.time_s) == one.time_s
        assert int(row.corrections) == len(one.corrections)
        assert int(row.messages) == one.messages
        for side in ("left", "right"):
            summary = row.sel(side=side)
            assert float(summary.contact_rms_m) == np.float32(one.contact_rms_m[side])
            assert float(summary.contact_peak_m) == np.float32(one.contact_peak_m[side])
            assert float(summary.waiting_s) == np.float32(one.waiting_s[side])


def test_reasons_and_single_precision_equal_the_single_carry(tmp_path: Path) -> None:
    """Objects that fall for unlike reasons, each as the legend of the array names it."""
    table: dict[str, Any] = {
        "controllers": ["none"],
        "precision": "float",
        "set": {"robot.noise_m_s": 0.03},
        "vary": {"task.slope_deg": [0, 20], "object.com_m": [[0.125, 0.04], [0.24, 0.15]]},
        "seeds": {"count": 12},
    }
    found = pb.study(table, tmp_path / "study").load()
    names = dict(entry.split(" ", 1) for entry in found.reason.attrs["long_name"].split(", "))
    outcomes = dict(entry.split(" ", 1) for entry in found.outcome.attrs["long_name"].split(", "))
    seen, unlike = set(), 0
    for slope, com, seed in itertools.product((0, 20), range(2), (0, 5, 11)):
        com_m = table["vary"]["object.com_m"][com]
        keys = {"task.slope_deg": slope, "object.com_m": com_m, **table["set"]}
        one = pb.carry("paper", "none", seed=seed, precision="float", record=False, overrides=keys)
        two = pb.carry("paper", "none", seed=seed, record=False, overrides=keys)
        summary = found.sel({"task.slope_deg": slope, "seed": seed, "controller": "none"})
        summary = summary.isel({"object.com_m": com})
        assert names[str(int(summary.reason))] == (one.reason or "none")
        assert outcomes[str(int(summary.outcome))] == one.outcome
        rms = float(summary.contact_rms_m.sel(side="left"))
        assert rms == np.float32(one.contact_rms_m["left"])
        unlike += rms != np.float32(two.contact_rms_m["left"])
        seen.add(one.reason)
    assert seen >= {"off-palm", "sliding", "tipping"}
    assert unlike > 0


@pytest.mark.parametrize("seeds", [30, 15_000])
def test_progress_increases_from_0_to_1(tmp_path: Path, seeds: int) -> None:
    """Never back, also from one controller of a chunk to the next, and in the end all of it."""
    summary: list[float] = []
    table = {**SMALL, "set": {"task.distance_m": 0.1}, "seeds": {"count": seeds}}
    pb.study(table, tmp_path / "study", chunk_size=10**6, threads=1, on_progress=summary.append)
    assert summary[0] == 0 and summary[-1] == 1
    assert summary == sorted(summary)
    # The core reports at intervals of time: a fast machine has completed a few carries before.
    if seeds > 1000:
        assert sum(0.5 < part < 1 for part in summary) >= 2, "also within a chunk"


def test_statistics_follow_from_the_carries(small: Path) -> None:
    found = pb.open_study(small).load()
    dropped = found.outcome == 2
    rate = dropped.mean("seed")
    np.testing.assert_allclose(found.drop_rate, rate, rtol=1e-15)
    assert float(rate.max()) > 0.01
    for cell, low, high in zip(
        dropped.sum("seed").values.flat,
        found.drop_rate_interval.sel(end="low").values.flat,
        found.drop_rate_interval.sel(end="high").values.flat,
        strict=True,
    ):
        assert (low, high) == pytest.approx(wilson(int(cell), 30), abs=1e-15)
    square = (found.contact_rms_m.astype(float) ** 2).mean("side")
    np.testing.assert_allclose(found.rms_m, np.sqrt(square.mean("seed")), rtol=1e-14)
    half = 1.959963984540054 * square.std("seed", ddof=1) / np.sqrt(30)
    high = np.sqrt(square.mean("seed") + half)
    np.testing.assert_allclose(found.rms_m_interval.sel(end="high"), high, rtol=1e-12)
    delivered = found.outcome == 1
    np.testing.assert_allclose(
        found.mean_time_s, found.time_s.where(delivered).mean("seed"), rtol=1e-13
    )
    difference = (dropped.astype(float) - dropped.sel(controller="centralized")).mean("seed")
    np.testing.assert_allclose(found.drop_rate_difference, difference, atol=1e-15)
    excess = (square - square.sel(controller="centralized")).mean("seed")
    np.testing.assert_allclose(found.square_difference, excess, rtol=1e-9, atol=1e-20)
    assert found.drop_rate.attrs["units"] == "1"
    assert found.contact_rms_m.attrs["units"] == "m"
    assert found["radio.latency_s"].attrs["units"] == "s"


def test_units_agree_with_the_names(small: Path) -> None:
    """`time_s` is in seconds, `rms_m` in metres; a count, a rate or a code has none."""
    found = pb.open_study(small)
    units = {"m": "m", "s": "s", "difference": "m2"}
    for name, variable in found.data_vars.items():
        word = str(name).removesuffix("_interval").split("_")[-1]
        unit = "1" if str(name).startswith("drop_rate") else units.get(word, "1")
        assert variable.attrs["units"] == unit, name
        assert variable.attrs["long_name"], name


def test_other_statistics_follow_from_the_carries(small: Path) -> None:
    found = pb.open_study(small).load()
    per_carry = {
        "mean_peak_m": found.contact_peak_m.max("side"),
        "mean_waiting_s": found.waiting_s.astype(float).sum("side"),
        "mean_corrections": found.corrections,
        "mean_messages": found.messages,
        "stall_rate": found.outcome == 3,
    }
    for name, each in per_carry.items():
        mean = each.astype(float).mean("seed")
        np.testing.assert_allclose(found[name], mean, rtol=1e-12, atol=1e-18, err_msg=name)
        if name != "stall_rate":
            half = 1.959963984540054 * each.astype(float).std("seed", ddof=1) / np.sqrt(30)
            ends = found[f"{name}_interval"]
            np.testing.assert_allclose(ends.sel(end="high"), mean + half, rtol=1e-9, err_msg=name)


def test_plain_xarray_opens_the_store(small: Path) -> None:
    """Without a word of palmbots, and without a 0 that is taken for missing."""
    found = xr.open_zarr(small / "results.zarr", chunks=None)
    assert found["radio.latency_s"].values.tolist() == [0.0, 0.2]
    assert found.outcome.dtype == np.uint8
    assert not np.isnan(found.mean_peak_m).any()


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        in_soak({"chunk_size": 12}),
        {"chunk_size": 17, "threads": 1},
        in_soak({"chunk_size": 50, "threads": 3}),
        {"chunk_size": 100_000},
        in_soak({"order": reversed}),
        {
            "chunk_size": 40,
            "order": lambda chunks: random.Random(3).sample(list(chunks), len(chunks)),
        },
    ],
    ids=["crumbs", "odd", "three-threads", "one", "reversed", "shuffled"],
)
def test_results_do_not_depend_on_chunks_threads_and_order(
    small: Path, tmp_path: Path, options: dict[str, Any]
) -> None:
    result = run_study(load_plan(SMALL), tmp_path / "study", **options)
    assert result.hash == hash_of(small)
    assert result.carries == 360
    first, second = pb.open_study(small).load(), result.dataset().load()
    xr.testing.assert_identical(first, second)


def test_different_results_have_different_hashes(small: Path, tmp_path: Path) -> None:
    seen = {hash_of(small)}
    for k, change in enumerate(({"precision": "float"}, {"seeds": {"first": 8, "count": 30}})):
        result = run_study(load_plan({**SMALL, **change}), tmp_path / str(k))
        seen.add(result.hash)
    assert len(seen) == 3


def test_remarks_and_spelling_are_not_part_of_the_identity(small: Path) -> None:
    same = {
        "about": "another remark",
        "controllers": SMALL["controllers"],
        "vary": {"radio": {"latency_s": [0, 0.2]}, "robot": {"noise_m_s": SPAN}},
        "seeds": SMALL["seeds"],
    }
    result = run_study(load_plan(same), small)
    assert result.resumed == 360
    assert result.hash == hash_of(small)


SPAN = {"from": 0.01, "to": 0.03, "steps": 3}


def test_cells_that_resilient_refuses_are_left_out(tmp_path: Path) -> None:
    table = {
        "controllers": ["distributed", "resilient"],
        "vary": {"radio.latency_s": [0.05, 0.5]},
        "seeds": {"count": 20},
    }
    result = run_study(load_plan(table), tmp_path / "study")
    assert list(result.points.rejected_cells) == [(1, 1)]
    found = result.dataset().load()
    at = found.sel({"radio.latency_s": 0.5, "controller": "resilient"})
    assert int(at.carries) == 0
    assert np.isnan(float(at.drop_rate))
    assert not at.outcome.any()
    assert result.carries == 60
    summary = result.summary()
    assert "radio.lease_s" in summary["refused"][0]["why"]
    assert summary["refused"][0]["at"] == {"radio.latency_s": 0.5}
    assert summary["cells"][3]["statistics"]["drop_rate"]["value"] is None


def test_keys_may_be_names_booleans_and_entries_of_lists(tmp_path: Path) -> None:
    table = {
        "controllers": ["none"],
        "set": {"task.distance_m": 0.3},
        "vary": {
            "object": ["box", "box-strips"],
            "task.inertia": [True, False],
            "object.com_m[1]": [0.05, 0.06],
        },
        "seeds": {"count": 2},
    }
    found = pb.study(table, tmp_path / "study").load()
    assert found["object"].values.tolist() == ["box", "box-strips"]
    assert found["task.inertia"].dtype == bool
    for thing, height in itertools.product(("box", "box-strips"), (0.05, 0.06)):
        base = pb.load_scene("paper", {"object": thing, "task.distance_m": 0.3})
        com = [base.object.com_m[0], height]
        one = pb.carry(base, "none", seed=1, record=False, overrides={"object.com_m": com})
        at = {"object": thing, "task.inertia": True, "object.com_m[1]": height, "seed": 1}
        summary = found.sel(at).isel(controller=0)
        assert float(summary.time_s) == one.time_s
        assert float(summary.contact_rms_m.sel(side="left")) == np.float32(
            one.contact_rms_m["left"]
        )


def shuffled_marks(root: Path) -> Iterable[Path]:
    return random.Random(1).sample(sorted((root / "chunks").glob("*.npz")), 2)


@pytest.mark.slow
def test_damaged_chunks_are_carried_again(small: Path, tmp_path: Path) -> None:
    """Files of the store truncated, overwritten, removed; marks too."""
    root = tmp_path / "study"
    run_study(load_plan(SMALL), root, chunk_size=40)
    before = marks(root)
    results = root / "results.zarr"
    files = sorted(p for p in (results / "contact_rms_m" / "c").rglob("*") if p.is_file())
    files[0].write_bytes(files[0].read_bytes()[:-5])
    files[3].write_bytes(b"nonsense")
    whole = files[5].read_bytes()
    files[5].write_bytes(whole[:-3] + bytes(b ^ 1 for b in whole[-3:]))
    (results / "outcome" / "c" / "0" / "1" / "0" / "0").unlink()
    for mark in shuffled_marks(root):
        mark.write_bytes(mark.read_bytes()[:100])
    result = run_study(load_plan(SMALL), root)
    assert result.hash == hash_of(small)
    assert marks(root) == before
    xr.testing.assert_identical(pb.open_study(small).load(), result.dataset().load())


def test_lost_chunk_file_is_carried_again(small: Path, tmp_path: Path) -> None:
    """A chunk of an honest file, but not of this study's."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    (root / "results.zarr" / "time_s" / "c" / "0" / "0" / "0" / "0").unlink()
    assert run_study(load_plan(SMALL), root).hash == hash_of(small)


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(VARIABLES, 3))
def test_changed_value_in_any_column_is_carried_again(
    small: Path, tmp_path: Path, name: str
) -> None:
    """Other values that are as honest as the old ones, in one array alone."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    store = zarr.open_group(str(root / "results.zarr"), mode="r+")
    column = store[name]
    assert isinstance(column, zarr.Array)
    column[1, 2, 1, 3] = np.asarray(column[1, 2, 1, 3]) + 1
    result = run_study(load_plan(SMALL), root)
    assert result.hash == hash_of(small)
    xr.testing.assert_identical(pb.open_study(small).load(), result.dataset().load())


def test_summary_is_the_sum_of_the_cells(tmp_path: Path) -> None:
    """Some arrive, some are dropped, and some do not get there in time."""
    table = {**SMALL, "set": {"task.timeout_s": 25.3}}
    result = run_study(load_plan(table), tmp_path / "study")
    outcome = result.dataset().load().outcome.values
    n, drops, stalls = (int((outcome == code).sum()) for code in (1, 2, 3))
    assert n > 0 and stalls > drops > 0
    summary = result.summary()
    assert summary["carries"] == n + drops + stalls == 360
    assert summary["drop_rate"] == drops / 360
    assert summary["stall_rate"] == stalls / 360
    assert summary["interval"] == pytest.approx(wilson(drops, 360))
    for i, row in enumerate(summary["cells"]):
        cell = outcome.reshape(12, 30)[i]
        drop_rate, stall_rate = (row["statistics"][f"{end}_rate"] for end in ("drop", "stall"))
        assert drop_rate["value"] == np.mean(cell == 2)
        assert drop_rate["interval"] == pytest.approx(wilson(int((cell == 2).sum()), 30))
        assert stall_rate["value"] == np.mean(cell == 3)
        point = list(itertools.product(*SMALL["vary"].values()))[i // 2]
        at = dict(zip(SMALL["vary"], point, strict=True))
        assert (row["at"], row["controller"]) == (at, SMALL["controllers"][i % 2])


def test_command_and_python_agree(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "small.toml"
    file.write_text(
        'controllers = ["centralized", "distributed"]\n'
        "[vary]\nradio.latency_s = [0, 0.2]\nrobot.noise_m_s = [0.01, 0.02, 0.03]\n"
        "[seeds]\nfirst = 7\ncount = 30\n"
    )
    summary = said_here(file)
    assert summary["hash"] == hash_of(small)
    assert (summary["output"], summary["carries"]) == ("small.study", 360)
    assert summary["interval"][0] < summary["drop_rate"] < summary["interval"][1]
    assert summary["scene"] == pb.load_scene("paper").model_dump(mode="json")
    assert len(summary["cells"]) == 12
    again = said_here(file)
    assert again["resumed"] == 360
    assert again["hash"] == summary["hash"]


@pytest.mark.slow
def test_memory_does_not_grow_with_the_number_of_carries(tmp_path: Path) -> None:
    """Twenty-five times the carries, the same peak: of real processes, as the system counts it."""
    # Not `ru_maxrss`: it counts the process that this one was forked from, too.
    program = """if True:
        import sys
        from palmbots.cli.main import run
        code = run(sys.argv[1:])
        print(open("/proc/self/status").read().split("VmHWM:")[1].split()[0], file=sys.stderr)
        sys.exit(code)
    """
    peaks = []
    for count in (10_000, 250_000):
        file = tmp_path / f"{count}.toml"
        file.write_text(
            'controllers = ["none", "distributed"]\n[set]\ntask.distance_m = 0.002\n'
            f"[seeds]\ncount = {count}\n"
        )
        words = [str(word) for word in command(file, "--chunk-size", 10_000, "--json")]
        study = words.index("study")
        result = subprocess.run(
            [sys.executable, "-c", program, *words[study:]],
            cwd=tmp_path, capture_output=True, text=True,
        )  # fmt: skip
        assert result.returncode == 0, result.stderr
        peaks.append(int(result.stderr.split()[-1]) / 1e3)
    results = pb.open_study(tmp_path / "250000.study")
    assert int(results.carries.sum()) == 500_000
    in_all = sum(v.nbytes for v in results.data_vars.values()) / 1e6
    assert in_all > 20, "what it would take to hold all of it"
    assert peaks[1] - peaks[0] < 10
    assert peaks[1] < 200


def test_a_study_that_fails_at_once_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object, **__: object) -> None:
        raise pb.PalmbotsError("no memory")

    monkeypatch.setattr("palmbots.studies.study_runner.run_locally", fail)
    with pytest.raises(pb.PalmbotsError, match="no memory"):
        pb.study(SMALL, tmp_path / "s")
    assert not (tmp_path / "s").exists()
