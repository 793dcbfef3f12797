"""What `palmbots study` prints: the numbers of the cells, as told and with their units."""

import re
from pathlib import Path
from typing import Any

import pytest

from palmbots.compare import wilson
from palmbots.studies.design import design
from palmbots.studies.explain import Cost
from palmbots.studies.plan import load_plan
from palmbots.studies.report import cost_report, study_report
from palmbots.studies.run import Done, run_study
from palmbots.studies.sensitivity import sensitivities

MIXED: dict[str, Any] = {
    "set": {"task.distance_m": 0.3, "task.timeout_s": 5.03},
    "vary": {"robot.noise_m_s": [0.02, 0.05]},
    "seeds": {"count": 40},
}


def rounded(told: str, exact: float) -> None:
    """A number as printed is the exact one to all of its digits."""
    _, _, decimals = told.partition(".")
    assert abs(float(told) - exact) <= 0.5000001 * 10.0 ** -len(decimals), (told, exact)


def shown(done: Done, capsys: pytest.CaptureFixture[str]) -> str:
    capsys.readouterr()
    study_report(done, [])
    return capsys.readouterr().out


def test_every_number_of_the_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = run_study(load_plan(MIXED), tmp_path / "study")
    out = shown(done, capsys)
    rows = [line for line in out.splitlines() if re.search(r"│ (centralized|distributed) +│", line)]
    assert len(rows) == 4
    number = r"([-+]?[\d.]+)"
    for k, row in enumerate(rows):
        i, c = divmod(k, 2)
        key, controller, carries, drops, rms, more = (x.strip() for x in row.split("│")[1:-1])
        assert key == ("" if c else ("0.02", "0.05")[i])
        assert (controller, carries) == (("centralized", "distributed")[c], "40")
        spreads = [
            ("drop_rate", drops, 100, rf"{number} % \({number}–{number}\)"),
            ("rms_m", rms, 1e3, rf"{number} mm \({number}–{number}\)"),
        ]
        if c:
            difference = rf"{number} % \({number} to {number}\)"
            spreads.append(("drop_rate_difference", more, 100, difference))
        else:
            assert more == ""
        for name, text, scale, form in spreads:
            values, ends = done.values[name]
            found = re.fullmatch(form, text)
            assert found and ends is not None, text
            exact = (values[i, c], *ends[i, c])
            for told, one in zip(found.groups(), exact, strict=True):
                rounded(told, scale * one)
            decimals = len(found[2].partition(".")[2])
            width = scale * (exact[2] - exact[1]) * 10.0**decimals
            assert 10 <= width < 100, "two digits of the interval"
    drops, stalls = done.drops, done.stalls
    outcome = done.dataset().load().outcome
    assert (drops, stalls) == (int((outcome == 2).sum()), int((outcome == 3).sum()))
    assert 0 < drops != stalls > 0
    low, high = (100 * end for end in wilson(drops, 160))
    line = f"160 carries, {100 * drops / 160:.3g} % dropped ({low:.3g}–{high:.3g})"
    assert f"{line}, {stalls} carries stalled" in out
    assert f"results {done.hash}" in out


def test_indices_are_sorted_and_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = {
        "controllers": ["none"],
        "set": {"task.distance_m": 0.3},
        "vary": {
            "palm.friction": {"from": 0.2, "to": 0.4},
            "robot.noise_m_s": {"from": 0.01, "to": 0.2},
        },
        "design": {"kind": "sobol-indices", "points": 16},
        "seeds": {"count": 10},
    }
    done = run_study(load_plan(table), tmp_path / "study")
    number = r"(-?[\d.]+)"
    pair = rf"{number} ± {number}"
    found = re.findall(rf"│ (\S+) +│ +{pair} │ +{pair} │", shown(done, capsys))
    told = {(i.metric, i.key): i for i in sensitivities(done.points, done.values)}
    assert len(found) == len(told) == 4
    for k, (key, *numbers) in enumerate(found):
        assert key == ("robot.noise_m_s", "palm.friction")[k % 2]
        one = told[("drop_rate", "rms_m")[k // 2], key]
        exact = (one.first, one.first_half, one.total, one.total_half)
        for text, value in zip(numbers, exact, strict=True):
            rounded(text, value)


@pytest.mark.parametrize(
    ("seconds", "told"),
    [(80, "80.0 s"), (100, "1.7 min"), (6000, "1.7 h"), (200_000, "2.3 days")],
)
def test_a_cost_with_its_units(
    seconds: float, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    points = design(load_plan({**MIXED, "stop": {"block": 10, "drop_rate": 0.1}}))
    cost = Cost(
        points=2, cells=4, carries=160, chunks=3, carries_a_chunk=60, seconds=seconds, threads=2,
        by_controller={"centralized": 0.21, "distributed": 0.34}, disk_bytes=5_600_000,
        memory_bytes=7000,
    )  # fmt: skip
    cost_report(points, cost)
    lines = dict(
        re.split(r" {2,}", line.strip(), maxsplit=1)
        for line in capsys.readouterr().out.splitlines()
        if "ms a carry" not in line
    )
    assert lines == {
        "points": "2 (2 robot.noise_m_s)",
        "cells": "4 (centralized, distributed)",
        "carries": "at most 160, 40 a cell",
        "chunks": "3 of at most 60 carries",
        "time": f"at most about {told} on 2 threads",
        "disk": "at most about 5.6 MB",
        "memory": "about 7 kB besides Python's own",
    }
