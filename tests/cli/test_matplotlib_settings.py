# SPDX-License-Identifier: Apache-2.0
"""A command writes the same figure whatever settings of matplotlib it inherits."""

from pathlib import Path

import pytest

from shell import palmbots

INLINE = "module://matplotlib_inline.backend_inline"  # of a notebook of another environment
SETTINGS = "text.usetex: True\nfont.size: 30\naxes.grid: True\n"


def figure(folder: Path) -> bytes:
    """The figure that a command writes into a folder."""
    few = ("--values", "0", "-n", "2", "--controllers", "none", "--set", "task.distance_m=0.1")
    run = palmbots("compare", *few, "--out", str(folder))
    assert (run.returncode, run.stderr) == (0, "")
    return (folder / "compare.png").read_bytes()


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return figure(tmp_path_factory.mktemp("usual"))


@pytest.mark.slow
@pytest.mark.parametrize("backend", [INLINE, "nonsense"])
def test_settings_of_the_user_change_nothing(
    backend: str, usual: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """There is neither such a backend nor LaTeX here."""
    settings = tmp_path / "matplotlibrc"
    settings.write_text(SETTINGS)
    monkeypatch.setenv("MATPLOTLIBRC", str(settings))
    monkeypatch.setenv("MPLBACKEND", backend)
    assert figure(tmp_path / "out") == usual
