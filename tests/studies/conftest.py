# SPDX-License-Identifier: Apache-2.0
"""The studies of `study_fixtures` as files, and the result of the long one."""

from pathlib import Path

import pytest

import palmbots as pb
from study_fixtures import LONG, SMALL, said_here


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("small") / "study"
    pb.study(SMALL, root)
    return root


@pytest.fixture(scope="session")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("long") / "long.toml"
    file.write_text(LONG)
    return file


@pytest.fixture(scope="session")
def whole(long: Path) -> str:
    """The hash of an undisturbed run, on one thread with another chunk size."""
    return said_here(long, "--out", long.parent / "whole", "--chunk-size", 150, "--threads", 1)[
        "hash"
    ]
