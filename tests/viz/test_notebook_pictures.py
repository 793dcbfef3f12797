# SPDX-License-Identifier: Apache-2.0
"""A figure at the end of a notebook's cell is shown as a picture, whatever ran before."""

import subprocess
import sys

import pytest

pytest.importorskip("IPython")

CELLS = """
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
import palmbots as pb
figure = pb.carry("paper", overrides={"task.distance_m": 0.1}).plot()
shown, _ = shell.display_formatter.format(figure, include={"image/png"})
print(shown["image/png"][:4])
"""


@pytest.mark.slow
def test_a_figure_is_shown_without_a_magic_command() -> None:
    """In a process of its own: there is one shell for each."""
    run = subprocess.run([sys.executable, "-c", CELLS], capture_output=True, text=True)
    assert run.stdout.splitlines()[-1:] == [repr(b"\x89PNG")], run
