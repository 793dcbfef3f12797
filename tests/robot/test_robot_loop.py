# SPDX-License-Identifier: Apache-2.0
"""The control loop of a robot: what it stores, when it boots again, and what it leaves behind."""

import math
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import palmbots._core as _core
from palmbots._types import SIDES
from palmbots.drivers.driver import Drive, Reading
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import Pair, init_pair, load_pair
from palmbots.pair.stored_state import StoredState
from palmbots.robot.core_program import controller_of
from palmbots.robot.live_robot import core_settings
from palmbots.robot.reading_gauge import ReadingGauge
from palmbots.robot.robot_loop import RobotLoop
from palmbots.scene.scene import Scene, load_scene
from palmbots.scene.spec import to_spec

SEEN = Reading(0, True, 0.5)
WATCHDOG = 5.0


class Hardware:
    """Driver, clock, link and storage of a robot, in one."""

    works = is_done = is_stepped = True
    overruns = recent_overruns = 0

    def __init__(self, reads: list[Reading | None]) -> None:
        self.reads = reads
        self.written: list[Drive] = []
        self.kept: list[StoredState] = []
        self.sent: list[str] = []
        self.stops = self.boots = self.forgotten = 0

    def read(self) -> Reading | None:
        if not self.reads:
            raise PalmbotsError("driver: is lost")
        return self.reads.pop(0)

    def write(self, drive: Drive) -> None:
        self.written.append(drive)

    def stop(self) -> None:
        self.stops += 1

    def wait(self) -> int:
        return 1

    def receive(self) -> list[bytes]:
        return []

    def send(self, receiver: str, data: bytes) -> None:
        self.sent.append(receiver)

    def keep(self, state: StoredState) -> None:
        self.kept.append(state)

    def boot(self) -> StoredState:
        self.boots += 1
        return StoredState(epoch=8, carries=True)

    def settle(self) -> None:
        pass

    def forget(self) -> None:
        self.forgotten += 1


class Program:
    """The core's program: it drives, and says something to its partner in every step."""

    def __init__(self, wheels: bool) -> None:
        self.wheels, self.judged, self.to_store = wheels, [], (wheels, False)
        self.stamps = [(1, 1)]
        # No job on the floor.
        self.phase, self.holds, self.counts, self.share_of_way = "", False, True, 1.0

    def step(self, elapsed: int, reading: Any, packets: list[bytes]) -> tuple[Any, ...]:
        return 0, 0, not self.wheels, [(1, b"packet", 0)], "", False, True


class Log:
    """Takes what a program logs."""

    def __init__(self) -> None:
        self.read: list[dict[str, Any]] = []
        self.withheld: list[int] = []

    def take(
        self, robot: Any, elapsed: int, values: dict[str, Any], packets: Any, answer: Any
    ) -> None:
        self.read.append(values)

    def withhold(self, receiver: int) -> None:
        self.withheld.append(receiver)

    def close(self) -> None: ...


@pytest.fixture
def pair(tmp_path: Path) -> Pair:
    return load_pair(init_pair(tmp_path / "pair.toml")[0])


def loop_of(
    pair: Pair, hardware: Hardware, *, wheels: bool, may_resume: bool = True, last_ticks: int = 1
) -> tuple[RobotLoop, list[StoredState]]:
    """A loop whose program has started, and the states with which it starts."""
    starts: list[StoredState] = []

    def start(state: StoredState) -> Any:
        starts.append(state)
        return Program(wheels), Log()

    both: Any = hardware
    gauge = ReadingGauge(pair, "left", Scene(), SEEN, StoredState())
    loop = RobotLoop(
        "left", Scene(), start, both, both, both, both, gauge,
        watchdog=WATCHDOG, last_ticks=last_ticks, on_line=lambda _: None,
    )  # fmt: skip
    loop.start(StoredState(epoch=7, carries=wheels), may_resume=may_resume)
    return loop, starts


@pytest.mark.parametrize("wheels", [False, True])
def test_the_others_hear_of_a_lost_driver_and_it_is_stored(pair: Pair, wheels: bool) -> None:
    hardware = Hardware([SEEN])
    loop, _ = loop_of(pair, hardware, wheels=wheels)
    assert loop.step(1)
    sent = len(hardware.sent)
    with pytest.raises(PalmbotsError, match="is lost"):
        loop.step(1)
    assert len(hardware.sent) == sent + 1
    log: Any = loop._log
    assert not log.read[-1]["driver_ok"]
    assert hardware.kept[-1] == StoredState(7, False, wheels, False)
    assert len(hardware.kept) == 2


@pytest.mark.parametrize(
    ("elapsed", "wheels", "boots"), [(5, True, 0), (6, True, 1), (40, True, 1), (6, False, 0)]
)
def test_a_program_held_up_longer_than_the_watchdog_boots_in_a_carry(
    pair: Pair, elapsed: int, wheels: bool, boots: int
) -> None:
    hardware = Hardware([SEEN])
    loop, starts = loop_of(pair, hardware, wheels=wheels)
    assert loop.step(elapsed)
    assert hardware.boots == hardware.forgotten == boots  # late ticks are those since the boot
    assert [state.epoch for state in starts] == [7, 8][: 1 + boots]


@pytest.mark.parametrize("may_resume", [False, True])
def test_a_carry_goes_on_after_a_boot_only_if_the_pair_allows_it(
    pair: Pair, may_resume: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise the distance of the next carry counts from where it begins."""
    carried: list[bool] = []
    take = ReadingGauge.take

    def noted(self: ReadingGauge, seen: Reading, *, carries: bool, **others: Any) -> Any:
        carried.append(carries)
        return take(self, seen, carries=carries, **others)

    monkeypatch.setattr(ReadingGauge, "take", noted)
    loop, _ = loop_of(pair, Hardware([SEEN, SEEN]), wheels=True, may_resume=may_resume)
    assert loop.step(1)
    assert loop.step(40)
    assert carried == [may_resume, may_resume]


@pytest.mark.parametrize("ended", [False, True])
def test_the_driver_is_stopped_at_the_end(pair: Pair, ended: bool) -> None:
    hardware = Hardware([SEEN, SEEN, None])
    loop, _ = loop_of(pair, hardware, wheels=True)
    event = threading.Event()
    if ended:
        event.set()
    loop.run(event)
    assert hardware.stops == 1
    assert len(hardware.written) == (0 if ended else 2)


@pytest.mark.parametrize(("battery_v", "is_ok"), [(7.1, False), (7.2, True), (None, True)])
def test_a_low_battery_is_reported(tmp_path: Path, battery_v: float | None, is_ok: bool) -> None:
    values = {"hardware.battery_low_v": 7.2}
    pair = load_pair(init_pair(tmp_path / "pair.toml", values=values)[0])
    gauge = ReadingGauge(pair, "left", Scene(), Reading(0, True, math.nan, 8.0), StoredState())
    found = gauge.take(Reading(0, True, math.nan, battery_v), carries=False)
    assert found["battery_ok"] is is_ok


def test_limits_of_the_station_follow_the_rate_of_a_simulated_robot(pair: Pair) -> None:
    """The station lives in real time; the robot's ticks pass at a multiple of it."""
    scene = load_scene(pair.scene())
    usual, fast = (core_settings(pair, scene, controller_of(pair), 0.0, r) for r in (1.0, 3.0))
    for name in ("station_limit", "order_age", "status_period"):
        assert fast[name] == 3 * usual[name], name
    assert fast["time_limit"] == usual["time_limit"]


def test_time_limits_of_the_core_are_those_of_the_pair(tmp_path: Path) -> None:
    """Stated in seconds, counted in ticks of 10 ms."""
    values = {
        "limits.time_limit_s": 12.0, "limits.station_limit_s": 0.305, "limits.order_age_s": 2.0,
    }  # fmt: skip
    pair = load_pair(init_pair(tmp_path / "pair.toml", values=values)[0])
    scene = load_scene("paper", {"control.period_s": 0.01, "robot.acceleration_m_s2": 0.5})
    settings = core_settings(pair, scene, controller_of(pair), 3.0)
    braking = scene.robot_of("left").speed_m_s / 0.5
    found = {name: settings[name] for name in ("time_limit", "station_limit", "order_age")}
    assert found == {"time_limit": 1200, "station_limit": 31, "order_age": 200}
    assert settings["travel"] == 300
    assert settings["stopping_limit"] == math.ceil(100 * braking - 1e-9)
    # More than half of the newest hundred ticks may not be missed.
    assert settings["most_overruns"] == 50


@pytest.mark.parametrize("wheels", [False, True])
def test_a_packet_for_the_partner_that_is_withheld_is_logged_as_such(
    pair: Pair, wheels: bool
) -> None:
    """A replay must not take it for sent."""
    hardware = Hardware([SEEN])
    hardware.is_done = False
    loop, _ = loop_of(pair, hardware, wheels=wheels)
    assert loop.step(1)
    log: Any = loop._log
    assert (hardware.sent, log.withheld) == (([], [1]) if wheels else (["right"], []))


def test_a_lost_driver_is_reported_for_as_many_ticks_as_given(pair: Pair) -> None:
    """The station hears a robot only once per period of its status."""
    hardware = Hardware([])
    loop, _ = loop_of(pair, hardware, wheels=True, last_ticks=5)
    with pytest.raises(PalmbotsError, match="is lost"):
        loop.step(1)
    assert len(hardware.sent) == 5


@pytest.mark.parametrize(
    ("stopping_s", "ticks"), [(0.1, 10), (0.101, 11), (0.109, 11), (0.3, 30), (0.07, 7)]
)
def test_a_measured_stopping_time_is_never_rounded_down(
    tmp_path: Path, stopping_s: float, ticks: int
) -> None:
    values = {"hardware.stopping_s": stopping_s}
    pair = load_pair(init_pair(tmp_path / "pair.toml", values=values)[0])
    scene = load_scene("paper", {"control.period_s": 0.01})
    gauge = ReadingGauge(pair, "left", scene, SEEN, StoredState())
    assert gauge.take(SEEN, carries=False)["stopping"] == ticks


@pytest.mark.parametrize(
    ("battery_v", "battery_mv"), [(None, 0xFFFF), (12.6, 12600), (70.0, 0xFFFE), (-0.2, 0)]
)
def test_a_voltage_fits_into_the_status(
    pair: Pair, battery_v: float | None, battery_mv: int
) -> None:
    """The largest number says that it is not measured."""
    gauge = ReadingGauge(pair, "left", Scene(), SEEN, StoredState())
    seen = Reading(0, True, 0.5, battery_v)
    assert gauge.take(seen, carries=False)["battery_mv"] == battery_mv


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_robot_knows_by_its_distance_when_it_is_below_an_object_on_a_stand(
    pair: Pair, side: Any
) -> None:
    scene = load_scene("stand")
    sense = 1 if side == "left" else -1  # the right robot leads: towards its partner is back
    gauge = ReadingGauge(pair, side, scene, SEEN, StoredState())
    way_m = _core.way_below(to_spec(scene), SIDES.index(side))
    assert 0.1 < way_m < 0.11

    def is_beneath(driven_m: float, beneath: bool | None = None) -> bool:
        seen = Reading(0, True, 2.0 + sense * driven_m, beneath=beneath)
        return gauge.take(seen, carries=driven_m != 0)["beneath"]

    found = [is_beneath(driven_m) for driven_m in (0.0, -0.2, 0.1, 0.11)]
    assert found == [False, False, False, True]
    gauge = ReadingGauge(pair, side, scene, Reading(0, True, 0.5, beneath=False), StoredState())
    assert [is_beneath(0.3, knows) for knows in (False, True)] == [False, True]


def test_a_robot_that_cannot_know_when_it_is_below_the_object_is_refused(pair: Pair) -> None:
    line = (
        r'^task\.from: value is "stand", and the left robot does not know when it is below the '
        r"object: it has no wheel encoders \(hardware\.encoder_ticks_per_turn\), and its driver "
        r"does not state it \(Reading\.beneath\); allowed: floor, palms$"
    )
    scene, blind = load_scene("stand"), Reading(0, True, math.nan)
    with pytest.raises(PalmbotsError, match=line):
        ReadingGauge(pair, "left", scene, blind, StoredState())
    # Where the object begins elsewhere, or the driver states it, nothing is missing.
    ends = {"task.from": "palms"}
    ReadingGauge(pair, "left", load_scene("stand", ends), blind, StoredState())
    ReadingGauge(pair, "left", scene, replace(blind, beneath=False), StoredState())
