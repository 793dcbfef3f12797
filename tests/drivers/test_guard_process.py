# SPDX-License-Identifier: Apache-2.0
"""When the guard stops the wheels, to the instant, on a clock of the test."""

from dataclasses import asdict
from typing import Any

import pytest

from palmbots.drivers import guard_process
from palmbots.drivers.arm import HOLDS
from palmbots.drivers.driver import Drive, DriverSettings, RawCommand, RawReading, Reading
from palmbots.drivers.hardware_driver import HardwareDriver
from palmbots.links.local_connection import ConnectionLost

W_S = 0.2
PERIOD_S = 0.0101  # on this clock, a frame does not end the wait
TURN = [0, 0, False, True, 0.5, 0.05]


class Clock:
    """Time passes only while the guard waits."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def monotonic(self) -> float:
        return self.now_s

    def select(self, read: Any, _: Any, __: Any, wait_s: float) -> None:
        self.now_s += max(wait_s, 1e-4)


class Program:
    """The robot's program: frames that arrive at given times, and then the end."""

    def __init__(self, clock: Clock, frames: list[tuple[float, Any]], end_s: float) -> None:
        self.clock, self.frames, self.end_s = clock, frames, end_s
        self.readings: list[Any] = []

    def poll(self) -> Any:
        if self.frames and self.frames[0][0] <= self.clock.now_s:
            return self.frames.pop(0)[1]
        if self.clock.now_s >= self.end_s:
            raise ConnectionLost("robot: has closed the connection")
        return None

    def offer(self, frame: Any) -> None:
        self.readings.append(frame)

    send = offer


class Noted:
    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.notes: list[tuple[str, float]] = []

    def read(self) -> Reading:
        return Reading(0, True, 0.0)

    def write(self, drive: Drive) -> None:
        self.notes.append(("write", self.clock.now_s))

    def stop(self) -> None:
        self.notes.append(("stop", self.clock.now_s))

    def close(self) -> None:
        pass


class Hardware(HardwareDriver):
    """Counts how often it is read."""

    reads = 0

    def read_raw(self) -> RawReading:
        self.reads += 1
        return RawReading((0.0, self.reads), (False, False, False))

    def write_raw(self, command: RawCommand) -> None:
        pass


def run(
    monkeypatch: pytest.MonkeyPatch,
    frames: list[tuple[float, Any]],
    seconds: float,
    hardware: HardwareDriver | None = None,
) -> tuple[list[tuple[str, float]], Program]:
    clock = Clock()
    monkeypatch.setattr(guard_process.time, "monotonic", clock.monotonic)
    monkeypatch.setattr(guard_process.select, "select", clock.select)
    start_s = clock.now_s
    script = [(start_s + at_s, _at(start_s, frame)) for at_s, frame in frames]
    program, driver = Program(clock, script, start_s + seconds), Noted(clock)
    settings = DriverSettings(
        side="left", leads=False, address="", period_s=0.01, watchdog_s=W_S
    )  # fmt: skip
    parts: Any = (hardware or driver, settings, program, object())
    guard = guard_process._Guard(*parts)
    with pytest.raises(ConnectionLost):
        guard.run()
    return [(name, at_s - start_s) for name, at_s in driver.notes], program


def _at(start_s: float, frame: Any) -> Any:
    name, given_s, content = frame
    return [name, start_s + given_s, content]


def test_wheels_stop_when_the_newest_command_is_old(monkeypatch: pytest.MonkeyPatch) -> None:
    frames = [(0.01 * i, ("drive", 0.01 * i, TURN)) for i in range(20)]
    notes, _ = run(monkeypatch, frames, 2.0)
    assert [name for name, _ in notes] == ["write"] * 20 + ["stop"]
    assert notes[-1][1] == pytest.approx(0.19 + 0.9 * W_S, abs=2e-4)


def test_the_time_counts_from_when_a_command_was_given(monkeypatch: pytest.MonkeyPatch) -> None:
    """A command that was on its way for long holds for less, and one that is too old not at all."""
    notes, _ = run(monkeypatch, [(0.1, ("drive", 0.0, TURN))], 1.0)
    assert notes == [("write", pytest.approx(0.1, abs=PERIOD_S)),
                     ("stop", pytest.approx(0.9 * W_S, abs=2e-4))]  # fmt: skip
    notes, _ = run(monkeypatch, [(0.2, ("drive", 0.0, TURN))], 1.0)
    assert notes == []


def test_only_the_newest_of_several_commands_is_carried_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frames = [(0.1, ("drive", 0.02 * i, TURN)) for i in range(5)] + [(0.1, ("stop", 0.1, None))]
    notes, _ = run(monkeypatch, frames, 1.0)
    assert notes == [("stop", pytest.approx(0.1, abs=PERIOD_S))]


def test_a_reading_is_sent_in_every_period(monkeypatch: pytest.MonkeyPatch) -> None:
    _, program = run(monkeypatch, [], 1.0)
    assert len(program.readings) == pytest.approx(100, abs=2)
    reading = asdict(Reading(0, True, 0.0))
    assert program.readings[0] == ["reading", [reading, None, True, [0, 0], None]]


def test_a_reading_names_the_command_to_which_it_refers(monkeypatch: pytest.MonkeyPatch) -> None:
    _, program = run(monkeypatch, [(0.1, ("drive", 0.1, TURN))], 0.2)
    palm_rad = TURN[4]
    named = [content[-1] for _, content in program.readings]
    assert named[0] is None
    assert named[-1] == [palm_rad, HOLDS, False]


def test_hardware_is_read_once_for_a_reading(monkeypatch: pytest.MonkeyPatch) -> None:
    hardware = Hardware(DriverSettings("left", False, "", 0.01, W_S))
    _, program = run(monkeypatch, [], 1.0, hardware)
    assert hardware.reads == len(program.readings)
    assert [content[1][0][1] for _, content in program.readings] == [*range(1, hardware.reads + 1)]
