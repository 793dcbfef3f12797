# SPDX-License-Identifier: Apache-2.0
"""The guard process: drivers of entry points, with the robot's program stopped and killed."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from distributions import installed
from palmbots.drivers.arm import StoredArm
from palmbots.drivers.driver import Drive, DriverSettings, RawAccess, RawCommand, works
from palmbots.drivers.driver_registry import open_driver
from waiting import wait_until

W_S = 0.2
TURN = Drive(0, 0, False, True, 0.5, 0.06)
LINES: list[str] = []


@pytest.fixture
def note(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The file in which the driver notes what it does; the drivers are installed."""
    module = "scripted_drivers:"
    environment = installed(
        tmp_path / "site", "palmbots.drivers", noted=module + "Noted",
        hardware=module + "NotedHardware", own=module + "WithWatchdog", broken="no_such:Class",
    )  # fmt: skip
    monkeypatch.setenv("PYTHONPATH", environment["PYTHONPATH"])
    monkeypatch.syspath_prepend(tmp_path / "site")
    LINES.clear()
    yield tmp_path / "note"


def settings(note: Path, **changes: Any) -> DriverSettings:
    made = DriverSettings(
        side="left", leads=False, address=str(note), period_s=0.01, watchdog_s=W_S,
        max_speed_m_s=0.05, on_line=LINES.append,
    )  # fmt: skip
    return replace(made, **changes)


def notes(file: Path) -> list[list[str]]:
    return [line.split() for line in file.read_text().splitlines()] if file.exists() else []


def words(file: Path) -> list[str]:
    return [note[1] for note in notes(file)]


def test_readings_and_commands_pass_the_guard(note: Path) -> None:
    driver = open_driver("noted", settings(note))
    seen = driver.read()
    assert seen is not None
    assert (seen.sign, seen.palm_at_target, seen.battery_v, seen.has_contact) == (
        1,
        True,
        7.5,
        True,
    )
    assert seen.distance_m != seen.distance_m  # NaN
    assert works(driver)
    assert not isinstance(driver, RawAccess)
    driver.write(TURN)
    wait_until(lambda: "write" in words(note))
    assert notes(note)[-1][2] == "0.05"  # the limit of the speed
    assert int(notes(note)[0][2]) != os.getpid()
    driver.stop()
    wait_until(lambda: words(note)[-1] == "stop")
    driver.close()
    assert words(note)[-2:] == ["stop", "close"]


def test_nothing_has_arrived_until_the_driver_has_received_the_newest_command(note: Path) -> None:
    driver = open_driver("noted", settings(note))
    guard = int(notes(note)[0][2])
    seen = driver.read()
    assert seen is not None
    assert seen.palm_at_target
    os.kill(guard, signal.SIGSTOP)
    driver.write(TURN)
    seen = driver.read()
    os.kill(guard, signal.SIGCONT)
    assert seen is not None
    assert not seen.palm_at_target

    def has_arrived() -> bool:
        driver.write(TURN)
        seen = driver.read()
        return seen is not None and seen.palm_at_target

    wait_until(has_arrived)
    driver.close()


def test_a_silent_program_is_stopped_within_the_watchdog(note: Path) -> None:
    driver = open_driver("noted", settings(note))
    for _ in range(5):
        driver.write(TURN)
        wait_until(lambda: words(note)[-1] == "write")
    wait_until(lambda: words(note)[-1] == "stop")
    assert float(notes(note)[-1][0]) - float(notes(note)[-2][0]) >= 0.5 * W_S
    # It goes on with the next command.
    driver.write(TURN)
    wait_until(lambda: words(note)[-1] == "write")
    driver.close()


NODE = """
import sys, time
from pathlib import Path
from palmbots.drivers.arm import StoredArm
from palmbots.drivers.driver import Drive, DriverSettings
from palmbots.drivers.driver_registry import open_driver
driver = open_driver("noted", DriverSettings(
    side="left", leads=False, address=sys.argv[1], period_s=0.01, watchdog_s=0.2))
number = 0
while True:
    driver.write(Drive(0, 0, False, True, 0.5, 0.05))
    print(time.monotonic(), flush=True)
    time.sleep(0.01)
"""


@pytest.mark.parametrize("by", [signal.SIGSTOP, signal.SIGKILL])
def test_wheels_stop_when_the_program_is_stopped_or_killed(by: signal.Signals, note: Path) -> None:
    node = subprocess.Popen(
        [sys.executable, "-c", NODE, str(note)], stdout=subprocess.PIPE, text=True
    )
    try:
        wait_until(lambda: words(note).count("write") > 10)
        node.send_signal(by)
        wait_until(lambda: words(note)[-1] in ("stop", "close"))
        stop = next(entry for entry in notes(note)[::-1] if entry[1] == "stop")
        after = [entry for entry in notes(note) if float(entry[0]) > float(stop[0])]
        assert "write" not in [entry[1] for entry in after]
        if by == signal.SIGSTOP:
            writes = words(note).count("write")
            node.send_signal(signal.SIGCONT)
            wait_until(lambda: words(note).count("write") > writes)
    finally:
        node.kill()
        node.communicate()
    guard = int(notes(note)[0][2])
    wait_until(lambda: words(note)[-1] == "close")
    wait_until(lambda: not Path(f"/proc/{guard}").exists())


def test_a_stopped_program_leaves_no_old_commands(note: Path) -> None:
    """Commands that waited while the guard was stopped are too old to be carried out."""
    driver = open_driver("noted", settings(note))

    def is_carried_out(speed_m_s: float) -> bool:
        return [str(speed_m_s)] in [entry[2:3] for entry in notes(note) if entry[1] == "write"]

    def send(speed_m_s: float) -> bool:
        # A machine that is busy for longer than the watchdog makes any command too old.
        driver.write(replace(TURN, speed_m_s=speed_m_s))
        return is_carried_out(speed_m_s)

    wait_until(lambda: send(0.02))
    guard = int(notes(note)[0][2])
    os.kill(guard, signal.SIGSTOP)
    wait_until(lambda: Path(f"/proc/{guard}/stat").read_text().split()[2] == "T")
    send(0.03)
    waited_s = time.monotonic() + 1.5 * W_S
    wait_until(lambda: time.monotonic() > waited_s)
    os.kill(guard, signal.SIGCONT)
    wait_until(lambda: "stop" in words(note))
    wait_until(lambda: send(0.04))
    assert not is_carried_out(0.03)
    driver.close()


def test_a_killed_guard_is_a_lost_driver_and_starts_again(note: Path) -> None:
    driver = open_driver("noted", settings(note, stored_arm=StoredArm(0.1, 0.05)))
    guard = int(notes(note)[0][2])
    os.kill(guard, signal.SIGKILL)
    wait_until(lambda: (driver.read(), not works(driver))[1])
    wait_until(lambda: (driver.read(), works(driver))[1])
    # The arm is where the first one said: this driver adds 1 cm each time that it is opened.
    seen = driver.read()
    assert seen is not None
    assert seen.stored_arm == pytest.approx(StoredArm(0.12, 0.05))
    assert int(notes(note)[-1][2]) != guard
    driver.write(TURN)
    wait_until(lambda: words(note)[-1] == "write")
    driver.close()
    assert LINES == [
        "driver.kind: noted is lost: driver: has closed the connection",
        "driver.kind: noted is back",
    ]


def test_a_driver_that_fails_is_stopped_and_named(note: Path) -> None:
    driver = open_driver("noted", settings(note, options={"fail_after": 20}))
    wait_until(lambda: (driver.read(), not works(driver))[1])
    wait_until(lambda: words(note)[-1] == "close")
    assert words(note)[-2] == "stop"
    line = (
        "driver.kind: noted is lost: OSError: [Errno 5] Input/output error at scripted_drivers.py:"
    )
    assert LINES[0].startswith(line)
    driver.close()


def test_a_driver_may_end_the_carry(note: Path) -> None:
    driver = open_driver("noted", settings(note, options={"end_after": 5}))
    wait_until(lambda: driver.read() is None)
    driver.close()
    assert words(note)[-2:] == ["stop", "close"]


@pytest.mark.parametrize(
    ("kind", "options", "line"),
    [
        ("noted", {"refuse": "no arm"}, "driver.options.refuse: no arm"),
        ("noted", {"crash": True}, "driver.kind: noted: RuntimeError: no such bus"),
        ("broken", {}, "driver.kind: broken (no_such:Class) cannot be imported: ModuleNotFound"),
        ("nosuch", {}, 'driver.kind: value is "nosuch"; allowed: simulated, serial, dry-run, ros2, '
         "broken, hardware, noted, own, or an installed entry point of palmbots.drivers"),
    ],
)  # fmt: skip
def test_what_cannot_be_opened_is_refused_in_one_line(
    kind: str, options: dict[str, Any], line: str, note: Path
) -> None:
    with pytest.raises(pb.PalmbotsError) as refused:
        open_driver(kind, settings(note, options=options))
    assert str(refused.value).startswith(line)
    assert "\n" not in str(refused.value)


def test_hardware_as_it_is_passes_the_guard(note: Path) -> None:
    driver = open_driver("hardware", settings(note))
    assert isinstance(driver, RawAccess)
    driver.write_raw(RawCommand((0.5, 99.0), 1.25))
    wait_until(lambda: (raw := driver.read_raw()) and raw.servo_rad == 1.25)
    raw = driver.read_raw()
    assert raw is not None
    # 0.05 m/s with wheels of 4 cm: 1.25 rad/s at most.
    assert raw.wheel_counts == (0.5, pytest.approx(1.25))
    assert raw.closed == (False, True, False)
    seen = driver.read()
    assert seen is not None
    assert seen.palm_at_target is False
    wait_until(lambda: (raw := driver.read_raw()) and raw.wheel_counts == (0.0, 0.0))  # watchdog
    driver.close()


def test_hardware_with_a_watchdog_needs_no_guard(note: Path) -> None:
    driver = open_driver("own", settings(note))
    assert int(notes(note)[0][2]) == os.getpid()
    driver.close()
