# SPDX-License-Identifier: Apache-2.0
"""What the rooms `studies` and `learn` export, and what importing them costs."""

import subprocess
import sys

import pytest

SLOW = ("zarr", "scipy", "SALib", "xarray", "distributed", "pettingzoo", "gymnasium", "matplotlib")


@pytest.mark.parametrize("module", ["palmbots", "palmbots.studies", "palmbots.learn"])
def test_import_leaves_slow_packages_alone(module: str) -> None:
    program = f"import sys, {module}; print(*(n for n in {SLOW!r} if n in sys.modules))"
    process = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    loaded = set(process.stdout.split())
    # The room `simulation` imports these two itself.
    assert loaded <= {"xarray", "matplotlib"}
