# SPDX-License-Identifier: Apache-2.0
"""A wall clock that a test sets for its processes; that of the machine is not touched."""

import time
from pathlib import Path

import pytest

_KEPT_S = 1  # libfaketime reads its file again when more whole seconds than this have passed

# libfaketime 0.9.10 refuses to sleep until an absolute time, as Python does, if it leaves the
# monotonic clock alone.
_SLEEP = """import select, time
time.sleep = lambda seconds: select.select([], [], [], seconds) and None
"""


class WallClock:
    """The wall clock of some processes. Skips the test where libfaketime is not installed.

    Args:
        folder: a folder for its files, which is made.
    """

    def __init__(self, folder: Path) -> None:
        found = [*Path("/usr/lib").glob("*/faketime/libfaketime.so.1")]
        if not found:
            pytest.skip("needs libfaketime: scripts/setup robot")
        folder.mkdir()
        (folder / "sitecustomize.py").write_text(_SLEEP)
        self._stamp = folder / "stamp"
        self._stamp.write_text("+0")
        self.environment = {
            "LD_PRELOAD": str(found[0]),
            "FAKETIME_TIMESTAMP_FILE": str(self._stamp),
            "FAKETIME_CACHE_DURATION": str(_KEPT_S),  # it reads the file in every call otherwise
            "FAKETIME_DONT_FAKE_MONOTONIC": "1",
            "PYTHONPATH": str(folder),
        }
        """For the processes."""

    def set(self, offset: str) -> None:
        """Set the clock to this distance from the right time, as in ``-1h``.

        When it returns, every process sees it: where a test grants the time, a whole carry may take
        less than the time for which libfaketime keeps what it has read.
        """
        self._stamp.write_text(offset)
        time.sleep(_KEPT_S + 1.1)
