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
from palmbots.compare import wilson
from palmbots.errors import PalmbotsError
from palmbots.studies.plan import load_plan
from palmbots.studies.run import run_study
from palmbots.studies.work import VARIABLES
from studies import SMALL, command, hash_of, marks, said

OUTCOMES = ("running", "delivered", "dropped", "stalled")


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("small") / "study"
    pb.study(SMALL, root)
    return root


def test_every_carry_is_the_single_one(small: Path) -> None:
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
            told = row.sel(side=side)
            assert float(told.contact_rms_m) == np.float32(one.contact_rms_m[side])
            assert float(told.contact_peak_m) == np.float32(one.contact_peak_m[side])
            assert float(told.waiting_s) == np.float32(one.waiting_s[side])


def test_reasons_and_single_precision(tmp_path: Path) -> None:
    """Objects that fall for unlike reasons, each as the legend of the array names it."""
    table = {
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
        keys = {"task.slope_deg": slope, "object.com_m": table["vary"]["object.com_m"][com]}
        keys |= table["set"]
        one = pb.carry("paper", "none", seed=seed, precision="float", record=False, overrides=keys)
        two = pb.carry("paper", "none", seed=seed, record=False, overrides=keys)
        told = found.sel({"task.slope_deg": slope, "seed": seed, "controller": "none"})
        told = told.isel({"object.com_m": com})
        assert names[str(int(told.reason))] == (one.reason or "none")
        assert outcomes[str(int(told.outcome))] == one.outcome
        rms = float(told.contact_rms_m.sel(side="left"))
        assert rms == np.float32(one.contact_rms_m["left"])
        unlike += rms != np.float32(two.contact_rms_m["left"])
        seen.add(one.reason)
    assert seen >= {"off-palm", "sliding", "tipping"}
    assert unlike > 0


def test_progress_is_the_share_of_what_is_due(tmp_path: Path) -> None:
    """Never back, also from one controller of a chunk to the next, and in the end all of it."""
    told: list[float] = []
    table = {**SMALL, "seeds": {"count": 3000}}
    pb.study(table, tmp_path / "study", chunk=10**6, threads=1, progress=told.append)
    assert told[0] == 0 and told[-1] == 1
    assert told == sorted(told)
    assert sum(0.5 < part < 1 for part in told) >= 2, "within a chunk it is told, too"


def test_statistics_are_those_of_the_carries(small: Path) -> None:
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


def test_every_unit_is_that_of_the_name(small: Path) -> None:
    """`time_s` is in seconds, `rms_m` in metres; a count, a rate or a code has none."""
    found = pb.open_study(small)
    units = {"m": "m", "s": "s", "difference": "m2"}
    for name, variable in found.data_vars.items():
        word = str(name).removesuffix("_interval").split("_")[-1]
        unit = "1" if str(name).startswith("drop_rate") else units.get(word, "1")
        assert variable.attrs["units"] == unit, name
        assert variable.attrs["long_name"], name


def test_other_statistics_are_those_of_the_carries(small: Path) -> None:
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


def test_any_reader_of_zarr_opens_it(small: Path) -> None:
    """Without a word of palmbots, and without a 0 that is taken for missing."""
    found = xr.open_zarr(small / "results.zarr", chunks=None)
    assert found["radio.latency_s"].values.tolist() == [0.0, 0.2]
    assert found.outcome.dtype == np.uint8
    assert not np.isnan(found.mean_peak_m).any()


@pytest.mark.parametrize(
    "options",
    [
        {"chunk": 12},
        {"chunk": 17, "threads": 1},
        {"chunk": 50, "threads": 3},
        {"chunk": 100_000},
        {"order": reversed},
        {"chunk": 40, "order": lambda chunks: random.Random(3).sample(list(chunks), len(chunks))},
    ],
    ids=["crumbs", "odd", "three-threads", "one", "reversed", "shuffled"],
)
def test_cut_threads_and_order_change_nothing(
    small: Path, tmp_path: Path, options: dict[str, Any]
) -> None:
    done = run_study(load_plan(SMALL), tmp_path / "study", **options)
    assert done.hash == hash_of(small)
    assert done.carries == 360
    first, second = pb.open_study(small).load(), done.dataset().load()
    xr.testing.assert_identical(first, second)


def test_the_hash_tells_results_apart(small: Path, tmp_path: Path) -> None:
    seen = {hash_of(small)}
    for k, change in enumerate(({"precision": "float"}, {"seeds": {"first": 8, "count": 30}})):
        done = run_study(load_plan({**SMALL, **change}), tmp_path / str(k))
        seen.add(done.hash)
    assert len(seen) == 3


def test_remarks_and_spelling_are_no_part_of_a_study(small: Path) -> None:
    same = {
        "about": "another remark",
        "controllers": SMALL["controllers"],
        "vary": {"radio": {"latency_s": [0, 0.2]}, "robot": {"noise_m_s": SPAN}},
        "seeds": SMALL["seeds"],
    }
    done = run_study(load_plan(same), small)
    assert done.resumed == 360
    assert done.hash == hash_of(small)


SPAN = {"from": 0.01, "to": 0.03, "steps": 3}


def test_what_the_resilient_algorithm_refuses_is_left_out(tmp_path: Path) -> None:
    table = {
        "controllers": ["distributed", "resilient"],
        "vary": {"radio.latency_s": [0.05, 0.5]},
        "seeds": {"count": 20},
    }
    done = run_study(load_plan(table), tmp_path / "study")
    assert list(done.points.refused) == [1]
    found = done.dataset().load()
    at = found.sel({"radio.latency_s": 0.5, "controller": "resilient"})
    assert int(at.carries) == 0
    assert np.isnan(float(at.drop_rate))
    assert not at.outcome.any()
    assert done.carries == 60
    told = done.summary()
    assert "radio.lease_s" in told["refused"][0]["why"]
    assert told["refused"][0]["at"] == {"radio.latency_s": 0.5}
    assert told["cells"][3]["drop_rate"] is None


def test_keys_of_all_kinds(tmp_path: Path) -> None:
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
        told = found.sel(at).isel(controller=0)
        assert float(told.time_s) == one.time_s
        assert float(told.contact_rms_m.sel(side="left")) == np.float32(one.contact_rms_m["left"])


def shuffled_marks(root: Path) -> Iterable[Path]:
    return random.Random(1).sample(sorted((root / "chunks").glob("*.npz")), 2)


def test_what_was_damaged_is_carried_again(small: Path, tmp_path: Path) -> None:
    """Files of the store truncated, overwritten, removed; marks too."""
    root = tmp_path / "study"
    run_study(load_plan(SMALL), root, chunk=40)
    before = marks(root)
    results = root / "results.zarr"
    files = sorted(
        p for p in (results / "contact_rms_m").rglob("*") if p.is_file() and p.name.isdigit()
    )
    files[0].write_bytes(files[0].read_bytes()[:-5])
    files[3].write_bytes(b"nonsense")
    whole = files[5].read_bytes()
    files[5].write_bytes(whole[:-3] + bytes(b ^ 1 for b in whole[-3:]))
    (results / "outcome" / "0" / "1" / "0" / "0").unlink()
    for mark in shuffled_marks(root):
        mark.write_bytes(mark.read_bytes()[:100])
    done = run_study(load_plan(SMALL), root)
    assert done.hash == hash_of(small)
    assert marks(root) == before
    xr.testing.assert_identical(pb.open_study(small).load(), done.dataset().load())


def test_results_of_another_folder_are_noticed(small: Path, tmp_path: Path) -> None:
    """A chunk of an honest file, but not of this study's."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    (root / "results.zarr" / "time_s" / "0" / "0" / "0" / "0").unlink()
    assert run_study(load_plan(SMALL), root).hash == hash_of(small)


@pytest.mark.parametrize("name", VARIABLES)
def test_a_mark_tells_of_every_column(small: Path, tmp_path: Path, name: str) -> None:
    """Other values that are as honest as the old ones, in one array alone."""
    root = tmp_path / "study"
    shutil.copytree(small, root)
    store = zarr.open_group(str(root / "results.zarr"), mode="r+")
    column = store[name]
    assert isinstance(column, zarr.Array)
    column[1, 2, 1, 3] = np.asarray(column[1, 2, 1, 3]) + 1
    done = run_study(load_plan(SMALL), root)
    assert done.hash == hash_of(small)
    xr.testing.assert_identical(pb.open_study(small).load(), done.dataset().load())


def test_the_summary_is_the_sum_of_the_cells(tmp_path: Path) -> None:
    """Some arrive, some are dropped, and some do not get there in time."""
    table = {**SMALL, "set": {"task.timeout_s": 25.3}}
    done = run_study(load_plan(table), tmp_path / "study")
    outcome = done.dataset().load().outcome.values
    n, drops, stalls = (int((outcome == code).sum()) for code in (1, 2, 3))
    assert n > 0 and stalls > drops > 0
    told = done.summary()
    assert told["carries"] == n + drops + stalls == 360
    assert told["drop_rate"] == drops / 360
    assert told["stall_rate"] == stalls / 360
    assert told["interval"] == pytest.approx(wilson(drops, 360))
    for i, row in enumerate(told["cells"]):
        cell = outcome.reshape(12, 30)[i]
        assert row["drop_rate"] == np.mean(cell == 2)
        assert row["drop_rate_interval"] == pytest.approx(wilson(int((cell == 2).sum()), 30))
        assert row["stall_rate"] == np.mean(cell == 3)
        point = list(itertools.product(*SMALL["vary"].values()))[i // 2]
        at = dict(zip(SMALL["vary"], point, strict=True))
        assert (row["at"], row["controller"]) == (at, SMALL["controllers"][i % 2])


def test_no_study_no_results(tmp_path: Path) -> None:
    with pytest.raises(PalmbotsError, match="is no study's results"):
        pb.open_study(tmp_path)


def test_command_and_python_agree(small: Path, tmp_path: Path) -> None:
    file = tmp_path / "small.toml"
    file.write_text(
        'controllers = ["centralized", "distributed"]\n'
        "[vary]\nradio.latency_s = [0, 0.2]\nrobot.noise_m_s = [0.01, 0.02, 0.03]\n"
        "[seeds]\nfirst = 7\ncount = 30\n"
    )
    told = said(file, cwd=tmp_path)
    assert told["hash"] == hash_of(small)
    assert (told["output"], told["carries"]) == ("small.study", 360)
    assert told["interval"][0] < told["drop_rate"] < told["interval"][1]
    assert told["scene"] == pb.load_scene("paper").model_dump(mode="json")
    assert len(told["cells"]) == 12
    again = said(file, cwd=tmp_path)
    assert again["resumed"] == 360
    assert again["hash"] == told["hash"]


def test_memory_is_that_of_a_chunk(tmp_path: Path) -> None:
    """Fifty times the carries, the same peak: of real processes, as the system counts it."""
    # Not `ru_maxrss`: it counts the process that this one was forked from, too.
    program = """if True:
        import sys
        from palmbots.cli import run
        code = run(sys.argv[1:])
        print(open("/proc/self/status").read().split("VmHWM:")[1].split()[0], file=sys.stderr)
        sys.exit(code)
    """
    peaks = []
    for count in (10_000, 500_000):
        file = tmp_path / f"{count}.toml"
        file.write_text(
            'controllers = ["none", "distributed"]\n[set]\ntask.distance_m = 0.002\n'
            f"[seeds]\ncount = {count}\n"
        )
        words = [str(word) for word in command(file, "--chunk", 20_000, "--json")]
        study = words.index("study")
        done = subprocess.run(
            [sys.executable, "-c", program, *words[study:]],
            cwd=tmp_path, capture_output=True, text=True,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        peaks.append(int(done.stderr.split()[-1]) / 1e3)
    results = pb.open_study(tmp_path / "500000.study")
    assert int(results.carries.sum()) == 1_000_000
    in_all = sum(v.nbytes for v in results.data_vars.values()) / 1e6
    assert in_all > 40, "what it would take to hold all of it"
    assert peaks[1] - peaks[0] < 20
    assert peaks[1] < 200
