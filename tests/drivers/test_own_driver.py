# SPDX-License-Identifier: Apache-2.0
"""If a driver from another distribution raises, the robot's program goes on and names the place."""

import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import scripted_drivers
from distributions import installed
from pair_programs import new_pair
from palmbots.drivers.driver import Drive, DriverFailed, DriverSettings, works
from palmbots.drivers.driver_registry import DRIVERS, open_driver
from palmbots.errors import PalmbotsError
from palmbots.pair.checkup import Check
from palmbots.robot import doctor
from waiting import wait_until

LINES: list[str] = []
TURN = Drive(0, 0, False, True, 0.5, 0.05)
LINE = 1 + next(
    number
    for number, text in enumerate(Path(scripted_drivers.__file__).read_text().splitlines())
    if "the line that the tests look for" in text
)
WHY = f"OSError: [Errno 5] Input/output error at scripted_drivers.py:{LINE}"


@pytest.fixture(autouse=True)
def toy(monkeypatch: pytest.MonkeyPatch) -> None:
    """The driver is installed, and no attempt to open it again waits."""
    installed = DRIVERS._installed
    monkeypatch.setattr(
        DRIVERS,
        "_installed",
        lambda name, *rest: scripted_drivers.Toy if name == "toy" else installed(name, *rest),
    )
    monkeypatch.setattr("palmbots.drivers.own_driver._RETRY_S", 0.0)
    monkeypatch.setattr(scripted_drivers.Toy, "opened", 0)
    LINES.clear()


def settings(**options: Any) -> DriverSettings:
    made = DriverSettings("left", False, "", 0.01, 0.2, on_line=LINES.append)
    return replace(made, options=options)


@pytest.mark.parametrize("method", ["read_raw", "write_raw"])
def test_an_exception_is_a_lost_driver_that_is_opened_again(method: str) -> None:
    driver = open_driver("toy", settings(fails=method, after=3))
    for _ in range(3):
        driver.write(TURN)
        driver.read()
    driver.write(TURN)
    assert driver.read() is not None  # the last reading; `works` denies it
    assert not works(driver)
    assert [f"driver.kind: toy is lost: {WHY}"] == LINES
    driver.stop()  # nothing raises while it is lost
    wait_until(lambda: (driver.read(), works(driver))[1])
    assert LINES[1:] == ["driver.kind: toy is back"]
    driver.close()


def test_a_driver_that_stays_away_is_reported_once() -> None:
    driver = open_driver("toy", settings(fails="read_raw", after=1, times=5))
    driver.read()
    wait_until(lambda: (driver.read(), works(driver))[1])
    assert scripted_drivers.Toy.opened == 6
    assert [f"driver.kind: toy is lost: {WHY}", "driver.kind: toy is back"] == LINES
    driver.close()


def test_a_lost_driver_is_opened_again_after_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("palmbots.drivers.own_driver._RETRY_S", 1.0)
    clock = SimpleNamespace(now=100.0, monotonic=lambda: clock.now)
    monkeypatch.setattr("palmbots.drivers.own_driver.time", clock)
    driver = open_driver("toy", settings(fails="read_raw", after=1))
    opened: Any = driver
    driver.read()
    opened._driver._opening.join()
    clock.now = 100.9
    driver.read()
    assert scripted_drivers.Toy.opened == 1
    clock.now = 101.1
    driver.read()
    opened._driver._opening.join()
    assert scripted_drivers.Toy.opened == 2
    driver.close()


def test_a_driver_that_is_opened_after_the_end_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """While the program ends, a thread may still be opening the driver."""
    driver = open_driver("toy", settings(fails="read_raw", after=1))
    opened: Any = driver
    driver.read()
    opened._driver._opening.join()
    driver.close()
    ends: list[object] = []
    monkeypatch.setattr("palmbots.drivers.own_driver._end", ends.append)
    opened._driver._try()
    assert [type(one) for one in ends] == [scripted_drivers.Toy]


def test_an_exception_at_the_start_names_the_place() -> None:
    with pytest.raises(DriverFailed) as failed:
        open_driver("toy", settings(fails="read_raw"))
    assert str(failed.value) == f"driver.kind: toy: {WHY}"


def test_a_reading_of_another_type_is_refused() -> None:
    with pytest.raises(PalmbotsError, match="read_raw returns dict; allowed: a RawReading, or No"):
        open_driver("toy", settings(returns={"closed": ()}))


def test_the_wheels_are_stopped_at_once_when_a_driver_is_lost(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Not by the thread that closes it, which may have to wait."""
    monkeypatch.setattr("palmbots.drivers.own_driver._end", lambda driver: None)
    driver = open_driver("toy", settings(fails="read_raw", after=1))
    opened: Any = driver
    board = opened._driver._driver
    driver.write(TURN)
    before = len(board.commands)
    driver.read()
    (stop,) = board.commands[before:]
    assert stop.wheels_rad_s == (0.0, 0.0)
    driver.close()


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"fails": "read_raw"}, WHY),
        ({"fails": "read_raw", "after": 9}, WHY),
        ({"fails": "write_raw"}, WHY),
        ({"returns": 7}, "TypeError: read_raw returns int; allowed: a RawReading, or None"),
    ],
)
def test_the_doctor_names_the_exception_and_keeps_what_it_has_found(
    options: dict[str, Any], why: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own_clock = Check("clock", "", True, "runs")
    monkeypatch.setattr(doctor, "check_own_clock", lambda *_, **__: own_clock)
    file = new_pair(tmp_path, driver__kind="toy", driver__options=options)
    found = doctor.diagnose(file, side="left")
    assert not found.well
    assert found.checks[0] == own_clock
    assert [f"{check.robot} {check.about}: {check.text}" for check in found.checks[1:]] == [
        f"left driver: {why}"
    ]


@pytest.mark.parametrize("kind", ["toy", "guarded"])
def test_the_doctor_times_a_driver_in_and_outside_a_guard(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "check_own_clock", lambda *_, **__: Check("clock", "", True, ""))
    environment = installed(
        tmp_path / "site", "palmbots.drivers", guarded="scripted_drivers:GuardedToy"
    )
    monkeypatch.setenv("PYTHONPATH", environment["PYTHONPATH"])
    monkeypatch.syspath_prepend(tmp_path / "site")
    options = {"waits_s": 0.05}
    file = new_pair(tmp_path, driver__kind=kind, driver__options=options)
    found = doctor.diagnose(file, side="left").checks
    (driver,) = [check for check in found if check.about == "driver"]
    assert not driver.is_well
    assert re.search(r"a read takes (5|6|7)\d\.\d ms and a write \d\.\d ms", driver.text)
    assert "allowed: 5 ms together" in driver.text


def test_the_doctor_names_cable_device_and_baud_of_silent_hardware(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(doctor, "check_own_clock", lambda *_, **__: Check("clock", "", True, ""))
    monkeypatch.setattr(scripted_drivers.Toy, "read_raw", lambda self: None)
    file = new_pair(tmp_path, driver__kind="toy", driver__left_address="/dev/ttyX")
    found = doctor.diagnose(file, side="left").checks
    assert found[1].text == "gives no reading (None)"
    assert "power and cable, driver.address (/dev/ttyX) and driver.baud (115200)" in found[1].remedy
