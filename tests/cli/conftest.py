# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the command line's tests."""

import pytest

from commands import Run, runner


@pytest.fixture
def here(capsys: pytest.CaptureFixture[str]) -> Run:
    """`palmbots`, run in this process."""
    return runner(capsys)
