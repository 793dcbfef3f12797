# SPDX-License-Identifier: Apache-2.0
"""The driver of a motor board, against the reference board in another process."""

import math
import struct
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
import serial_oracle
from motor_board import Board, board
from palmbots.drivers import serial_board
from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, Reading
from palmbots.drivers.hardware import HardwareParameters
from palmbots.drivers.serial_board import SerialDriver
from palmbots.wire.serial_frames import FrameDecoder, frame_of
from serial_lines import Line
from waiting import wait_until

HARDWARE = HardwareParameters(battery_low_v=6.5)
LINES: list[str] = []


def settings(device: Path, **changes: Any) -> DriverSettings:
    LINES.clear()
    made = DriverSettings(
        side="left", leads=False, address=str(device), period_s=0.01, watchdog_s=0.1,
        hardware=HARDWARE, on_line=LINES.append,
    )  # fmt: skip
    return replace(made, **changes)


def reading(driver: SerialDriver) -> Reading:
    found = driver.read()
    assert found is not None
    return found


def drive(speed_m_s: float, palm_rad: float = 0.5, *, wheels: bool = True) -> Drive:
    return Drive(0, 0, False, wheels, palm_rad, speed_m_s)


def test_readings_and_commands(tmp_path: Path) -> None:
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty"))
        first = driver.read()
        assert first is not None
        assert (first.sign, first.battery_v, first.has_contact) == (0, 7.4, False)
        assert driver.works
        made.order("press 2")
        made.order("battery 7.1")
        wait_until(lambda: (seen := driver.read()) and (seen.sign, seen.battery_v) == (1, 7.1))
        made.order("press 1")  # the switch in the middle takes precedence
        wait_until(lambda: (seen := driver.read()) and (seen.sign, seen.has_contact) == (0, True))
        # 4 cm/s with wheels of 4 cm: 1 rad/s, after the ramp; the palm goes to 90° + 0.5 rad.
        wait_until(lambda: (driver.write(drive(0.04)), driver.read())[1] and _turns(made, 1.0))
        assert made.commands[-1].palm_rad == pytest.approx(math.pi / 2 + 0.5, abs=1e-3)
        wait_until(lambda: (driver.write(drive(0.04)), reading(driver))[1].palm_at_target)
        before = driver.read()
        wait_until(lambda: (driver.write(drive(0.04)), reading(driver))[1].distance_m > 0.01)
        assert before is not None
        driver.stop()
        assert (made.wait_resting().left, made.commands[-1].by_watchdog) == (0, False)
        driver.close()


def _turns(made: Board, rate: float) -> bool:
    newest = made.commands[-1] if made.commands else None
    return newest is not None and newest.left == newest.right == pytest.approx(rate, abs=2e-3)


def test_wheels_are_reversed_as_they_are_wired(tmp_path: Path) -> None:
    hardware = HardwareParameters(right_reversed=True, trim=0.1)
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty", hardware=hardware))
        driver.write_raw(RawCommand((1.5, 2.0), 1.2))
        wait_until(lambda: made.commands and made.commands[-1].right != 0)
        newest = made.commands[-1]
        assert (newest.left, newest.right, newest.palm_rad) == (1.5, -2.0, 1.2)
        wait_until(lambda: (counts := driver.read_raw().wheel_counts) and min(counts) > 0)
        driver.close()


def test_a_silent_program_is_stopped_by_the_board(tmp_path: Path) -> None:
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty"))
        driver.write_raw(RawCommand((1.0, 1.0)))
        made.wait_turning()
        start_s = made.commands[-1].time_s
        rest = made.wait_resting()
        assert rest.by_watchdog
        # 0.9 of the watchdog; a board that a busy machine wakes late notices it later.
        assert rest.time_s - start_s >= 0.088
        driver.close()


def test_an_unplugged_board_comes_back(tmp_path: Path) -> None:
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty"))
        driver.write_raw(RawCommand((5.0, 5.0)))
        wait_until(lambda: (driver.read_raw().wheel_counts or (0,))[0] > 20)
        made.end()
        wait_until(lambda: (driver.read(), not driver.works)[1])
        covered_m = reading(driver).distance_m
        driver.write(drive(0.04))  # is lost, without an error
        made.start()
        wait_until(lambda: (driver.read(), driver.works)[1])
        # The new board counts from 0: the distance does not jump.
        assert reading(driver).distance_m == covered_m
        driver.close()
    lost, back = LINES
    assert lost.startswith(f"driver.address: {tmp_path / 'tty'} is lost: ")
    assert back == f"driver.address: {tmp_path / 'tty'} is back"


def test_a_board_whose_first_reading_is_faster_than_its_identity_does_not_move_the_odometry(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty"))
        driver.write_raw(RawCommand((5.0, 5.0)))
        wait_until(lambda: (driver.read_raw().wheel_counts or (0,))[0] > 20)
        made.end()
        before = driver.read_raw().wheel_counts
        assert driver._newest is not None and before is not None and before[0] > 20
        anew = driver._newest._replace(left_count=0, right_count=0)
        frames = FrameDecoder().take(frame_of(anew))
        opened = driver._line.times_opened + 1
        monkeypatch.setattr(driver._line, "times_opened", opened)
        monkeypatch.setattr(driver._line, "receive", lambda: frames)
        assert driver.read_raw().wheel_counts == before
        monkeypatch.undo()
        driver.close()


def test_a_board_that_boots_does_not_move_the_odometry(tmp_path: Path) -> None:
    with board(tmp_path / "tty") as made:
        driver = SerialDriver(settings(tmp_path / "tty"))
        wait_until(
            lambda: (driver.write_raw(RawCommand((9.0, 9.0))), reading(driver))[1].distance_m > 0.02
        )
        driver.stop()
        made.wait_resting()
        before = driver.read_raw().wheel_counts
        wait_until(lambda: driver.read_raw().wheel_counts == before)
        covered_m = reading(driver).distance_m
        made.order("reboot")
        wait_until(lambda: (driver.read(), driver._newest and driver._newest.left_count == 0)[1])
        assert reading(driver).distance_m == covered_m
        driver.close()


class Scripted(threading.Thread):
    """A device that answers every hello, and everything else, in the same way."""

    def __init__(self, line: Line, *frames: bytes) -> None:
        super().__init__(daemon=True)
        self.line, self.frames, self.ends = line, frames, False
        self.start()

    def run(self) -> None:
        while not self.ends:
            if self.line.read():
                self.line.write(b"".join(self.frames))


def identity(version: int, switches: int, watchdog_ms: int) -> bytes:
    content = struct.pack("<BBBH", version, 7, switches, watchdog_ms)
    return serial_oracle.frame(serial_oracle.KINDS["board_identity"], content)


READING = serial_oracle.frame(serial_oracle.KINDS["board_reading"], bytes(20))
PACKET = serial_oracle.frame(serial_oracle.KINDS["packet"], bytes(32))


@pytest.mark.parametrize(
    ("frames", "line"),
    [
        ([], "no motor board answers at {} within 0.3 s"),
        ([READING], "no motor board answers at {} within 0.3 s"),
        ([PACKET], "{} is a radio bridge; allowed: a motor board"),
        ([identity(2, 9, 500)], "the board at {} has version 2 of the frames; allowed: 1"),
        ([identity(1, 2, 500)], "3 switches are listed; the board at {} has 2"),
        ([identity(1, 9, 20)], "the board at {} stops after 20 ms without a command; needed: "),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(
    frames: list[bytes], line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(serial_board, "_ANSWERS_WITHIN_S", 0.3)
    device = tmp_path / "tty"
    wire = Line(device)
    scripted = Scripted(wire, *frames)
    with pytest.raises(pb.PalmbotsError) as refused:
        SerialDriver(settings(device))
    scripted.ends = True
    scripted.join()
    wire.close()
    assert line.format(device) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_board_that_takes_no_commands_does_not_work(tmp_path: Path) -> None:
    """Its readings come, but confirm nothing: the other wire is broken."""
    wire = Line(tmp_path / "tty")
    scripted = Scripted(wire, identity(1, 9, 500), READING)
    driver = SerialDriver(settings(tmp_path / "tty"))
    assert driver.works
    wait_until(lambda: (driver.write(drive(0.0)), driver.read(), not driver.works)[2])
    scripted.ends = True
    scripted.join()
    driver.close()
    wire.close()


@pytest.mark.parametrize(("now", "before", "moved"), [
    (5, 3, 2), (3, 5, -2), (-(2**31), 2**31 - 1, 1), (2**31 - 1, -(2**31), -1),
])  # fmt: skip
def test_counts_wrap(now: int, before: int, moved: int) -> None:
    assert serial_board._difference(now, before) == moved
