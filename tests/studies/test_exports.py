# SPDX-License-Identifier: Apache-2.0
"""What the rooms `studies` and `learn` export, and what importing them costs."""

import subprocess
import sys

import pytest

import palmbots.learn
import palmbots.studies

SLOW = ("zarr", "scipy", "SALib", "xarray", "distributed", "pettingzoo", "gymnasium", "matplotlib")


@pytest.mark.parametrize("room", [palmbots.studies, palmbots.learn], ids=lambda room: room.__name__)
def test_dir_is_all_and_every_name_exists(room: object) -> None:
    names = room.__all__  # type: ignore[attr-defined]
    assert dir(room) == sorted(names)
    for name in names:
        assert getattr(room, name) is not None
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = room.nothing  # type: ignore[attr-defined]


@pytest.mark.parametrize("module", ["palmbots", "palmbots.studies", "palmbots.learn"])
def test_import_leaves_slow_packages_alone(module: str) -> None:
    program = f"import sys, {module}; print(*(n for n in {SLOW!r} if n in sys.modules))"
    process = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    loaded = set(process.stdout.split())
    # The room `simulation` imports these two itself.
    assert loaded <= {"xarray", "matplotlib"}
