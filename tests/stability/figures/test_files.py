# SPDX-License-Identifier: Apache-2.0
"""Figures 2 to 7 as files: whole, reproducible, of the state that was asked for."""

from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots._util import fork_join as side_by_side
from palmbots.cli.main import run
from palmbots.errors import PalmbotsError
from palmbots.stability.analysis import Analysis
from palmbots.stability.figures.analysis_figures import (
    draw_all,
    friction_cones,
    geometry,
    meeting_points,
    save_all,
)
from palmbots.viz.save_figure import write_figure

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def paper() -> Analysis:
    """The paper's box."""
    return pb.analyze("paper")


@pytest.mark.parametrize(
    "kind", ["png", *(pytest.param(kind, marks=pytest.mark.soak) for kind in ("svg", "pdf"))]
)
def test_files_are_whole_and_the_same(
    kind: Any, tmp_path: Path, paper: Analysis, monkeypatch: pytest.MonkeyPatch
) -> None:
    start = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[kind]
    written = save_all(paper, tmp_path / "one", kind=kind)
    assert [path.name for path in written] == [f"figure{k}.{kind}" for k in range(2, 8)]
    assert sorted(written) == sorted((tmp_path / "one").iterdir())  # no temporary file is left
    monkeypatch.setattr(side_by_side, "can_fork", lambda: False)  # one process draws all
    for first, second in zip(written, save_all(paper, tmp_path / "two", kind=kind), strict=True):
        assert first.read_bytes().startswith(start)
        assert first.read_bytes() == second.read_bytes()


def test_meeting_points_outside_the_region_are_refused() -> None:
    # Palms much longer than the region: the object reaches across in the region only.
    outline = [[0.0, 0.0], [0.03, 0.0], [0.03, 0.03], [0.0, 0.03]]
    small = {"vertices_m": outline, "com_m": [0.015, 0.01]}
    table = {"object": small, "palm": {"length_m": 0.3, "steep_deg": 30.0}}
    found = pb.analyze(table, region_m=(-0.01, 0.01))
    draw_all(found)
    with pytest.raises(PalmbotsError, match="less than the object's width"):
        draw_all(found, (-0.1, 0.1))


def test_command_draws_the_chosen_state(tmp_path: Path, paper: Analysis) -> None:
    """Figures 2 to 4 are of a state, Figures 5 to 7 of the scene."""
    words = ["analyze", "--format", "svg", "--out"]
    chosen = ["--p-left-m", "-0.03"]
    both, one = tmp_path / "both", tmp_path / "one"
    assert run([*words, str(both), *chosen, "--p-right-m", "0.02"]) == 0
    assert run([*words, str(one), *chosen]) == 0  # the other one is 0
    names = [f"figure{k}.svg" for k in range(2, 8)]
    differs = [(both / name).read_bytes() != (one / name).read_bytes() for name in names]
    assert differs == [True, True, True, False, False, False]
    draws = {names[0]: geometry, names[1]: friction_cones, names[2]: meeting_points}
    for name, draw in draws.items():
        write_figure(tmp_path / name, draw(paper, (-0.03, 0.02)))
        assert (tmp_path / name).read_bytes() == (both / name).read_bytes()
    write_figure(tmp_path / names[0], geometry(paper, (-0.03, 0.0)))
    assert (tmp_path / names[0]).read_bytes() == (one / names[0]).read_bytes()
