# SPDX-License-Identifier: Apache-2.0
"""The driver that moves nothing: its scripted sensor, and what it states."""

import math
from typing import Any

import pytest

from palmbots.drivers import dry_run
from palmbots.drivers.driver import Drive, DriverSettings, RawAccess
from palmbots.drivers.driver_registry import open_driver

LINES: list[str] = []


def settings(**options: Any) -> DriverSettings:
    LINES.clear()
    return DriverSettings(
        side="right", leads=True, address="", period_s=0.01, watchdog_s=0.1, options=options,
        on_line=LINES.append,
    )  # fmt: skip


def test_the_script_gives_the_signs(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = [50.0]
    monkeypatch.setattr(dry_run.time, "monotonic", lambda: now_s[0])
    driver = open_driver("dry-run", settings(script=[[1, 1], [2.5, 0], [4.0, -1]]))
    signs = []
    for at_s in (0.0, 0.99, 1.0, 2.49, 2.5, 4.0, 100.0):
        now_s[0] = 50.0 + at_s
        seen = driver.read()
        assert seen is not None
        assert seen.palm_at_target
        assert math.isnan(seen.distance_m)
        signs.append(seen.sign)
    assert signs == [0, 0, 1, 1, 0, -1, -1]


def test_it_states_each_command_once_with_the_speed_limit() -> None:
    driver = open_driver("dry-run", settings())
    assert not isinstance(driver, RawAccess)
    for _ in range(3):
        driver.write(Drive(0, 0, False, True, math.radians(40), 0.06))
    driver.write(Drive(1, 1, False, True, math.radians(20), -9.0))
    driver.write(Drive(1, 1, False, True, math.radians(20), math.nan))
    driver.stop()
    driver.close()
    assert LINES == [
        "right robot, dry run: palm at 40.0 degrees, wheels 0.060 m/s",
        "right robot, dry run: palm at 20.0 degrees, wheels -0.200 m/s",
        "right robot, dry run: palm at 20.0 degrees, wheels at rest",
        "right robot, dry run: wheels at rest",
    ]
