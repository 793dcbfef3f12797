# SPDX-License-Identifier: Apache-2.0
"""What `palmbots study` prints: the numbers of the cells, with their units."""

import re
from pathlib import Path
from typing import Any

import pytest

from palmbots._util.confidence_intervals import wilson
from palmbots.cli.console import print_report
from palmbots.studies.cost_estimate import Cost
from palmbots.studies.points import design_points
from palmbots.studies.sobol import sobol_indices
from palmbots.studies.study_file import load_plan
from palmbots.studies.study_runner import StudyResult, run_study

MIXED: dict[str, Any] = {
    "set": {"task.distance_m": 0.3, "task.timeout_s": 5.03},
    "vary": {"robot.noise_m_s": [0.02, 0.05]},
    "seeds": {"count": 40},
}


def rounded(text: str, exact: float) -> None:
    """A number as printed is the exact one to all of its digits."""
    _, _, decimals = text.partition(".")
    assert abs(float(text) - exact) <= 0.5000001 * 10.0 ** -len(decimals), (text, exact)


def shown(result: StudyResult, capsys: pytest.CaptureFixture[str]) -> str:
    capsys.readouterr()
    print_report(result.lines())
    return capsys.readouterr().out


def test_every_number_of_the_table_is_exact(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    result = run_study(load_plan(MIXED), tmp_path / "study")
    out = shown(result, capsys)
    assert "40 carries per cell" in out
    points = [line for line in out.splitlines() if line.startswith("robot.noise_m_s = ")]
    assert points == ["robot.noise_m_s = 0.02", "robot.noise_m_s = 0.05"]
    rows = re.findall(r"^(centralized|distributed)  +(\S.*?)$", out, re.MULTILINE)
    assert len(rows) == 4
    number = r"([-+]?[\d.]+)"
    for k, (controller, row) in enumerate(rows):
        i, c = divmod(k, 2)
        assert controller == ("centralized", "distributed")[c]
        drops, rms, *more = re.split(r"  +", row.strip())
        form = rf"{number} \({number}–{number}\)"
        spreads = [("drop_rate", drops, 100, form), ("rms_m", rms, 1e3, form)]
        assert len(more) == c
        if c:
            difference = rf"{number} \({number} to {number}\)"
            spreads.append(("drop_rate_difference", more[0], 100, difference))
        for name, text, scale, form in spreads:
            values, ends = result.values[name]
            found = re.fullmatch(form, text)
            assert found and ends is not None, text
            exact = (values[i, c], *ends[i, c])
            for text, one in zip(found.groups(), exact, strict=True):
                rounded(text, scale * one)
            decimals = len(found[2].partition(".")[2])
            width = scale * (exact[2] - exact[1]) * 10.0**decimals
            assert 10 <= width < 100, "two digits of the interval"
    drops, stalls = result.drops, result.stalls
    outcome = result.dataset().load().outcome
    assert (drops, stalls) == (int((outcome == 2).sum()), int((outcome == 3).sum()))
    assert 0 < drops != stalls > 0
    low, high = (100 * end for end in wilson(drops, 160))
    line = f"160 carries, {100 * drops / 160:.3g} % dropped ({low:.3g}–{high:.3g})"
    assert f"{line}, {stalls} carries stalled" in out
    assert f"results {result.hash}" in out


def test_indices_are_printed_in_order(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
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
    result = run_study(load_plan(table), tmp_path / "study")
    number = r"(-?[\d.]+)"
    pair = rf"{number} ± {number}"
    found = re.findall(rf"^  (\S+) +{pair} +{pair}$", shown(result, capsys), re.MULTILINE)
    expected = {(i.metric, i.key): i for i in sobol_indices(result.points, result.values)}
    assert len(found) == len(expected) == 4
    for k, (key, *numbers) in enumerate(found):
        assert key == ("robot.noise_m_s", "palm.friction")[k % 2]
        one = expected[("drop_rate", "rms_m")[k // 2], key]
        exact = (one.first, one.first_half, one.total, one.total_half)
        for text, value in zip(numbers, exact, strict=True):
            rounded(text, value)


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(80, "80.0 s"), (100, "1.7 min"), (6000, "1.7 h"), (200_000, "2.3 days")],
)
def test_cost_is_printed_with_units(
    seconds: float, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    points = design_points(load_plan({**MIXED, "stop": {"block": 10, "drop_rate": 0.1}}))
    cost = Cost(
        points=2, cells=4, carries=160, chunks=3, carries_a_chunk=60, seconds=seconds, threads=2,
        ms_a_carry={"centralized": 0.21, "distributed": 0.34}, disk_bytes=5_600_000,
        memory_bytes=7000,
        design=points,
    )  # fmt: skip
    print_report(cost.lines())
    lines = dict(
        re.split(r" {2,}", line.strip(), maxsplit=1)
        for line in capsys.readouterr().out.splitlines()[1:]
        if "ms per carry" not in line
    )
    assert lines == {
        "points": "2 (2 robot.noise_m_s)",
        "cells": "4 (centralized, distributed)",
        "carries": "at most 160, 40 per cell",
        "chunks": "3 of at most 60 carries",
        "time": f"at most about {text} on 2 threads",
        "disk": "at most about 5.6 MB",
        "memory": "about 7 kB in addition to Python's own",
    }
