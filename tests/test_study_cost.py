"""What a study is told to cost, before it is carried."""

import json
from pathlib import Path
from typing import Any

import pytest

from palmbots import cli
from palmbots.studies import explain
from palmbots.studies.design import design
from palmbots.studies.plan import load_plan
from palmbots.studies.run import cut_of
from studies import said


def test_the_cost_is_told_and_nothing_is_written(tmp_path: Path) -> None:
    """Carries and cells exactly, time and disk about right."""
    file = tmp_path / "s.toml"
    file.write_text("[vary]\nrobot.noise_m_s = [0.01, 0.015, 0.02]\n[seeds]\ncount = 1500\n")
    told = said(file, "--explain", "--threads", 1, cwd=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["s.toml"]
    assert (told["points"], told["cells"], told["carries"]) == (3, 6, 9000)
    assert set(told["ms_a_carry"]) == {"centralized", "distributed"}
    done = said(file, "--threads", 1, cwd=tmp_path)
    assert done["carries"] == told["carries"]
    assert told["seconds"] / 3 < done["seconds"] < told["seconds"] * 3 + 2
    files = (tmp_path / "s.study").rglob("*")
    size = sum(path.stat().st_size for path in files if path.is_file())
    assert told["disk_bytes"] / 2 < size < 2 * told["disk_bytes"] + 100_000


@pytest.mark.parametrize("threads", [1, 2])
def test_the_cost_by_a_clock_of_its_own(monkeypatch: pytest.MonkeyPatch, threads: int) -> None:
    """Every carry takes 1 ms of a thread without a controller and 3 ms with one: exactly told."""
    table = {
        "controllers": ["none", "distributed"],
        "vary": {"robot.noise_m_s": [0.01, 0.02, 0.03]},
        "seeds": {"count": 1000},
    }
    now = [0.0]

    def carried(_table: bytes, which: Any, seeds: Any, controller: str, *_: Any, **__: Any) -> None:
        assert len(which) == len(seeds)
        now[0] += len(seeds) * (1e-3 if controller == "none" else 3e-3) / threads

    monkeypatch.setattr(explain, "run_table", carried)
    monkeypatch.setattr(explain.time, "perf_counter", lambda: now[0])
    points = design(load_plan(table))
    cost = explain.cost_of(points, cut_of(points, 500), threads)
    assert cost.by_controller == pytest.approx({"none": 1.0, "distributed": 3.0})
    assert cost.seconds == pytest.approx((3000 * 1e-3 + 3000 * 3e-3) / threads)
    wide = 1 + 1 + 8 + 2 * 3 * 4 + 2 * 4  # bytes a carry, as the columns of results have them
    assert 0.5 * wide * 6000 < cost.disk_bytes < 1.0 * wide * 6000 + 1000 * 6 * cost.chunks
    assert 2 * wide * 500 < cost.memory_bytes < 8 * wide * 500


def test_the_cost_of_refused_points(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "s.toml"
    file.write_text(
        'controllers = ["resilient"]\n[vary]\nradio.latency_s = [0.05, 0.5]\n[seeds]\ncount = 10\n'
    )
    assert cli.run(["study", str(file), "--explain", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["cells"], told["carries"]) == (1, 10)
    assert cli.run(["study", str(file), "--explain"]) == 0
    assert "1 point by the resilient one" in capsys.readouterr().out
