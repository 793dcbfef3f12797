# SPDX-License-Identifier: Apache-2.0
"""The chunks of a study, which cover every carry once, and its estimated cost."""

import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palmbots.cli import main as cli
from palmbots.simulation.batch import SlowBuildWarning
from palmbots.studies import chunk_task
from palmbots.studies import cost_estimate as explain
from palmbots.studies.chunk_task import Block
from palmbots.studies.chunking import make_layout
from palmbots.studies.points import design_points
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import layout_of
from study_fixtures import said_here


def test_cost_estimate_counts_carries_and_disk_and_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Carries and cells exactly, disk about right. The next test checks time by a fake clock."""
    file = tmp_path / "s.toml"
    file.write_text(
        "[set]\ntask.distance_m = 0.1\n[vary]\nrobot.noise_m_s = [0.01, 0.015, 0.02]\n"
        "[seeds]\ncount = 1500\n"
    )
    monkeypatch.chdir(tmp_path)
    summary = said_here(file, "--estimate-cost", "--threads", 1)
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]
    assert (summary["points"], summary["cells"], summary["carries"]) == (3, 6, 9000)
    assert set(summary["ms_a_carry"]) == {"centralized", "distributed"}
    actual = said_here(file, "--threads", 1)
    assert actual["carries"] == summary["carries"]
    files = (tmp_path / "s.study").rglob("*")
    size = sum(path.stat().st_size for path in files if path.is_file())
    assert summary["disk_bytes"] / 2 < size < 2 * summary["disk_bytes"] + 100_000


@pytest.mark.parametrize("threads", [1, 2])
def test_cost_follows_the_measured_time_of_each_controller(
    monkeypatch: pytest.MonkeyPatch, threads: int
) -> None:
    """Every carry takes 1 ms of a thread without a controller and 3 ms with one."""
    table = {
        "controllers": ["none", "distributed"],
        "vary": {"robot.noise_m_s": [0.01, 0.02, 0.03]},
        "seeds": {"count": 1000},
    }
    now = [0.0]

    def run(_table: bytes, which: Any, seeds: Any, controller: str, *_: Any, **__: Any) -> Block:
        assert len(which) == len(seeds)
        now[0] += len(seeds) * (1e-3 if controller == "none" else 3e-3) / threads
        return chunk_task.empty_block((1, 1, len(seeds)))

    monkeypatch.setattr(chunk_task, "run_batch", run)
    monkeypatch.setattr(explain.time, "perf_counter", lambda: now[0])
    points = design_points(load_plan(table))
    cost = explain.estimate_cost(points, layout_of(points, 500), threads)
    assert cost.ms_a_carry == pytest.approx({"none": 1.0, "distributed": 3.0})
    assert cost.seconds == pytest.approx((3000 * 1e-3 + 3000 * 3e-3) / threads)
    wide = 1 + 1 + 8 + 2 * 3 * 4 + 2 * 4  # bytes a carry, as the columns of results have them
    assert 0.5 * wide * 6000 < cost.disk_bytes < 1.0 * wide * 6000 + 1000 * 6 * cost.chunks
    assert 2 * wide * 500 < cost.memory_bytes < 8 * wide * 500


@pytest.mark.parametrize(("count", "is_built", "warns"), [
    (10_001, False, True), (10_000, False, False), (10_001, True, False),
])  # fmt: skip
def test_large_study_is_said_to_be_slow_if_nothing_runs_in_lanes(
    count: int, is_built: bool, warns: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(explain, "is_built", lambda: is_built)
    points = design_points(load_plan({"controllers": ["none"], "seeds": {"count": count}}))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        explain.estimate_cost(points, layout_of(points, None), 1)
    assert [one.category for one in said] == [SlowBuildWarning] * warns


def test_refused_cells_cost_nothing(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(
        'controllers = ["resilient"]\n[vary]\nradio.latency_s = [0.05, 0.5]\n[seeds]\ncount = 10\n'
    )
    assert cli.run(["study", str(file), "--estimate-cost", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert (summary["cells"], summary["carries"]) == (1, 10)
    assert cli.run(["study", str(file), "--estimate-cost"]) == 0
    assert "1 cell" in capsys.readouterr().out


@pytest.mark.parametrize("shape", [(1,), (7,), (3, 5), (3, 2, 4)])
@pytest.mark.parametrize("seeds", [1, 10, 37])
@pytest.mark.parametrize("stop", [None, 5, 30])
@pytest.mark.parametrize("chunk", [1, 8, 100, 10**6])
def test_chunks_cover_every_carry_once(
    shape: tuple[int, ...], seeds: int, stop: int | None, chunk: int
) -> None:
    layout = make_layout(shape, 2, seeds, stop, chunk)
    seen = np.zeros((int(np.prod(shape)), seeds), int)
    for number in range(layout.chunks):
        one = layout.chunk(number)
        assert one.number == one.row * layout.columns + one.column
        seen[one.points, one.seeds] += 1
        region = np.zeros(shape, int)
        region[one.region] = 1
        assert (np.nonzero(region.reshape(-1))[0] == one.points).all()
        if stop is not None and stop < seeds:
            assert one.seeds.start // stop == (one.seeds.stop - 1) // stop
    assert (seen == 1).all()
    if stop is None:
        assert layout.carries_a_chunk <= max(chunk, 2)


@pytest.mark.parametrize("points_", [4, 100])
def test_default_chunk_sizes(points_: int) -> None:
    """64 parts of a study, about, of at most 32 768 carries; and one part of what is small."""
    for seeds, parts, most in ((10, 1, 8192), (400_000 // points_, 64, 12_500), (10**6, 0, 32_768)):
        layout = make_layout((points_,), 2, seeds)
        carries = points_ * 2 * seeds
        assert layout.carries_a_chunk <= most
        assert layout.chunks <= 2 * (parts or carries / most)
