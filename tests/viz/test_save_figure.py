# SPDX-License-Identifier: Apache-2.0
"""A figure is the same file whenever it is written, in the format that the suffix says."""

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from palmbots.errors import PalmbotsError
from palmbots.viz.save_figure import write_figure

BEGINS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF", ".PNG": b"\x89PNG"}


def figure() -> Figure:
    drawn = Figure(figsize=(2, 1))
    drawn.add_subplot().plot([0, 1], [1, 0])
    return drawn


@pytest.mark.parametrize("suffix", BEGINS)
def test_the_same_figure_is_the_same_file(
    tmp_path: Path, suffix: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for k, second in enumerate(("1000000000", "1700000000")):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", second)  # the time, as far as matplotlib knows
        write_figure(tmp_path / f"{k}{suffix}", figure())
    one, two = ((tmp_path / f"{k}{suffix}").read_bytes() for k in (0, 1))
    assert one == two
    assert one.startswith(BEGINS[suffix])


@pytest.mark.parametrize("name", ["figure.bmp", "figure", "figure.png.txt"])
def test_another_suffix_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(PalmbotsError, match=r"suffix is .*; allowed: \.png, \.svg, \.pdf$"):
        write_figure(tmp_path / name, figure())
    assert not list(tmp_path.iterdir())
