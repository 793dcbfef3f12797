# SPDX-License-Identifier: Apache-2.0
"""What the doctor says besides the radio: each thing that is wrong, and only that, is one line."""

import random
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots.drivers.driver import Drive, RawCommand, RawReading, Reading
from palmbots.drivers.hardware import Hardware, HardwareParameters
from palmbots.pair.checkup import (
    Check,
    check_driver,
    check_own_clock,
    checks_of_status,
    clock_rate,
)
from palmbots.pair.diagnosis import Diagnosis
from palmbots.pair.link_check import PERIOD_S, LinkFigures, measure
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.wire import Status


def checks(pair: SimulatedPair, seconds: float = 30.0) -> list[Check]:
    pair.station.step = lambda: None  # the measurement takes its place
    verdicts: dict[Any, int] = {}
    figures = measure(
        pair.pair,
        pair.air.link("station"),
        epoch=2,
        seconds=seconds,
        clock=lambda: 0.01 * pair.air.now,
        wait=lambda: pair.run(round(PERIOD_S / 0.01)),
        verdicts=verdicts,
    )
    return checks_of_status(pair.pair, pair.scene, figures, verdicts)


def wrong(found: list[Check]) -> list[str]:
    assert all(bool(check.remedy) is not check.is_well for check in found)
    return [f"{check.robot} {check.about}: {check.text}" for check in found if not check.is_well]


def test_a_pair_that_is_well_has_no_complaint(tmp_path: Path) -> None:
    found = checks(SimulatedPair(tmp_path, "resilient", Air(delay_ms=20)))
    assert wrong(found) == []
    assert {check.about for check in found} == {"key", "driver", "clock", "battery"}


@pytest.mark.parametrize("rate", [0.98, 0.99])
def test_a_clock_that_runs_wrong_is_measured(rate: float, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(delay_ms=30, jitter_ms=20, seed=1))
    pair.clock_rate["left"] = rate
    found = checks(pair, 60)
    lines = wrong(found)
    assert len(lines) == 1
    assert lines[0].startswith("left clock: rate ")
    other = next(check.text for check in found if check.robot == "right" and check.about == "clock")
    assert other.startswith("rate ")


@pytest.mark.parametrize("seed", range(20))
def test_the_interval_of_the_rate_holds_the_rate(seed: int) -> None:
    """Packets that are lost, delayed and held up, under clocks of many rates."""
    chance = random.Random(seed)
    rate = 1 + chance.choice([1e-4, 2e-2]) * chance.uniform(-1, 1)
    arrivals = [
        (0.05 * n / rate + 0.01 + chance.expovariate(1 / 0.02), n)
        for n in range(600)
        if chance.random() > 0.2
    ]
    found = clock_rate(sorted(arrivals), 0.01)
    assert found is not None
    ppm, error = found
    assert abs(ppm - 1e6 * (rate - 1)) < error
    assert error < 1000


def test_few_packets_give_no_rate() -> None:
    assert clock_rate([(0.05 * n, n) for n in range(29)], 0.01) is None


def figures(mode: Any = "disarmed", **values: Any) -> dict[Any, LinkFigures]:
    both: dict[Any, LinkFigures] = {}
    for side in ("left", "right"):
        both[side] = LinkFigures()
        both[side].note(1, Status(mode="disarmed"))
    both["left"].note(2, Status(mode=mode, **values))
    return both


@pytest.mark.parametrize(
    "fault",
    ["driver", "contact", "palm", "battery", "partner_lost", "station_lost", "time_limit",
     "overrun", "storage", "settings", "stopping", "partner", "stop"],
)  # fmt: skip
def test_every_fault_has_a_line_and_a_remedy(fault: Any, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air())
    found = checks_of_status(pair.pair, pair.scene, figures(mode="fault", fault=fault), {})
    assert len(wrong(found)) == 1
    assert wrong(found)[0].startswith("left ")


def test_a_stop_in_force_is_wrong(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air())
    found = checks_of_status(pair.pair, pair.scene, figures(mode="stopped"), {})
    assert wrong(found) == ["left mode: a stop is in force"]


@pytest.mark.parametrize(
    ("value", "low", "line"),
    [
        (6400, 6.6, "left battery: 6.40 V, less than 6.6 V"),
        (6700, 6.6, None),
        (6400, 0.0, None),
        (0xFFFF, 6.6, "left battery: is not measured"),
        (0xFFFF, 0.0, None),
    ],
)
def test_battery(value: int, low: float, line: str | None, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air())
    hardware = Hardware(battery_low_v=low)
    settings = pair.pair.settings.model_copy(update={"hardware": hardware})
    found = checks_of_status(
        replace(pair.pair, settings=settings), pair.scene,
        figures(item="battery", value=value), {},
    )  # fmt: skip
    assert wrong(found) == ([] if line is None else [line])


def test_another_key_is_named(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air())
    other = replace(pair.pair, key=bytes(16))
    pair.pair = other
    pair.boot("left")  # the left robot has another key than the station
    pair.pair = replace(other, key=bytes.fromhex("00" * 15 + "01"))
    found = checks(pair, 5)
    assert any("packets have a wrong tag" in line for line in wrong(found))
    assert any("key: " in line for line in wrong(found))


def test_own_clock() -> None:
    good = check_own_clock(0.02, 0.4)
    assert "ticks of 20 ms" in good.text
    bad = check_own_clock(1e-6, 0.2)  # no computer keeps a period of a microsecond
    assert not bad.is_well
    assert bad.remedy


class StubDriver:
    """A robot whose palm needs some ticks, or does not move."""

    works = True

    def __init__(
        self, *, turns: int = 5, dies: bool = False, contact: bool = True, read_s: float = 0.0
    ) -> None:
        self.read_s = read_s
        self.turns, self.dies, self.contact = turns, dies, contact
        self.palm, self.left, self.now = 0, 0, 0.0
        self.written: list[Drive] = []
        self.stopped = False

    def read(self) -> Reading | None:
        self.now += self.read_s
        if self.dies and self.now > 0.2:
            return None
        return Reading(1, self.left <= 0, 0.0, 7.4, self.contact)

    def write(self, drive: Drive) -> None:
        self.written.append(drive)
        if drive.palm != self.palm:
            self.palm, self.left = drive.palm, self.turns

    def wait(self) -> None:
        self.now += 0.01
        self.left -= 1

    def stop(self) -> None:
        self.stopped = True

    def close(self) -> None:
        pass


def driver_checks(stub: StubDriver, **hardware: Any) -> list[Check]:
    scene = pb.load_scene("paper")
    return check_driver(
        stub, "left", scene, HardwareParameters(**hardware), stub.wait, lambda: stub.now
    )


def test_a_driver_that_is_well() -> None:
    stub = StubDriver()
    found = driver_checks(stub)
    assert wrong(found) == []
    assert {check.about for check in found} == {"driver", "palm", "contact", "battery"}
    assert stub.stopped
    assert all(not drive.wheels and drive.speed_m_s == 0 for drive in stub.written)
    assert {drive.palm for drive in stub.written} == {0, 1}


def test_a_servo_that_reports_no_angle_is_given_the_time_of_a_whole_turn() -> None:
    stub = StubDriver()
    stub.left = 360  # 180° at 50°/s
    assert wrong(driver_checks(stub)) == []


@pytest.mark.parametrize(
    ("stub", "hardware", "line"),
    [
        (StubDriver(turns=10_000), {}, "left palm: the palm does not reach its shallow angle"),
        (StubDriver(turns=0), {}, "left palm: the palm is always at its target: it does not "),
        (
            StubDriver(read_s=0.05),
            {},
            "left driver: answers; a read takes 50.0 ms and a write 0.0 ms (medians); allowed: ",
        ),
        (StubDriver(dies=True), {}, "left driver: ceases to answer"),
        (StubDriver(contact=False), {}, "left contact: not sensed"),
        (StubDriver(), {"battery_low_v": 7.5}, "left battery: 7.40 V, less than 7.5 V"),
        (
            StubDriver(),
            {"stopping_s": 0.2},
            "left stopping: 0.2 s, longer than the 0.12 s of the scene",
        ),
    ],
)
def test_what_is_wrong_with_a_driver(stub: StubDriver, hardware: dict[str, Any], line: str) -> None:
    lines = wrong(driver_checks(stub, **hardware))
    assert len(lines) == 1
    assert lines[0].startswith(line)


def test_a_driver_that_takes_most_of_a_period_is_unsure() -> None:
    for read_s, is_sure in ((0.004, True), (0.006, False)):
        found = driver_checks(StubDriver(read_s=read_s))
        assert wrong(found) == []
        assert [check.is_sure for check in found if check.about == "driver"] == [is_sure]


@pytest.mark.parametrize(("servo_rad", "is_sure"), [(None, False), (0.5, True)])
def test_a_palm_without_a_reported_angle_is_not_checked(
    servo_rad: float | None, is_sure: bool
) -> None:
    class Raw(StubDriver):
        def read_raw(self) -> RawReading:
            return RawReading(None, (), servo_rad)

        def write_raw(self, command: RawCommand) -> None:
            pass

    (palm,) = [check for check in driver_checks(Raw()) if check.about == "palm"]
    assert (palm.is_well, palm.is_sure) == (True, is_sure)
    assert palm.text.startswith("not checked") is not is_sure
    assert ("unsure left palm: not checked: the" in str(Diagnosis(True, (palm,)))) is not is_sure


def test_a_driver_without_a_reading_is_wrong() -> None:
    class Silent(StubDriver):
        def read(self) -> None:
            return None

    assert wrong(driver_checks(Silent())) == ["left driver: gives no reading (None)"]


def test_a_driver_that_cannot_be_read() -> None:
    class Lost(StubDriver):
        def read(self) -> Reading | None:
            raise pb.PalmbotsError("board: no answer within 1 s")

    assert wrong(driver_checks(Lost())) == ["left driver: board: no answer within 1 s"]
