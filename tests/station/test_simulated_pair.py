# SPDX-License-Identifier: Apache-2.0
"""Two robots and a station in real time, on a clock of the test: start, stops, faults, the end."""

import time
from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
from palmbots._types import BySide
from palmbots._util.plain_values import plain
from palmbots.cli.json_schemas import schema_of
from palmbots.control.registry import describe, shipped_names
from palmbots.drivers.driver import Reading
from palmbots.pair.launcher import UP
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.pair.stored_state import StoredState, write_state
from palmbots.robot import live_robot, storage_thread
from palmbots.station import station as station_module
from palmbots.station.carry_script import carry_once
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.station.station_loop import StationEnd
from palmbots.wire import Endpoint, Operate, State, decode
from schema_refusals import assert_fits_exactly

CARRYING = ("carrying", "holding")
CONTROLLERS = shipped_names("robots")


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_the_station_arms_starts_and_sees_the_end(controller: str, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, controller, Air(delay_ms=20), UP)
    assert pair.carry()
    assert pair.modes() == ("done", "done")
    assert pair.stage.outcome == "running"
    assert pair.stage.midpoint == pytest.approx(0.3, abs=0.02)
    # Both rest, with their palms where they were.
    pair.run(50)
    before = pair.stage.midpoint
    pair.run(100)
    assert pair.stage.midpoint == before


def test_what_programs_print_at_their_end_fits_the_schemas_exactly(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "shared-sign", Air(delay_ms=20), UP)
    assert pair.carry()
    modes = BySide[str | None].of(pair.modes())
    station = StationEnd(True, modes, pair.lines, pair.station.links())
    assert_fits_exactly(schema_of("station"), plain(station))
    for side, other in (("left", "right"), ("right", "left")):
        found = plain(pair.end_of(side))
        assert_fits_exactly(schema_of("robot"), found)
        assert found["link"][side] is None
        assert found["link"][other]["received"] > 20


@pytest.mark.parametrize("controller", ["resilient", "shared-sign"])
def test_the_same_over_a_lossy_radio(controller: str, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, controller, Air(delay_ms=40, loss=0.2, seed=5), UP)
    assert pair.carry()
    assert pair.stage.outcome == "running"
    assert pair.stage.midpoint == pytest.approx(0.3, abs=0.02)


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_wheels_turn_only_in_a_carry(controller: str, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, controller, Air(), UP)
    pair.run(100)
    assert pair.modes() == ("disarmed", "disarmed")
    pair.wish("arm", "armed")
    pair.run(100)
    assert pair.modes() == ("armed", "armed")
    assert pair.stage.midpoint == 0.0


@pytest.mark.parametrize("by", ["stop", "e_stop", "left", "right"])
@pytest.mark.parametrize("controller", CONTROLLERS)
def test_a_stop_stops_both_and_is_latched(controller: str, by: Any, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, controller, Air(delay_ms=20), UP)
    pair.start()
    pair.run(100)
    if by in ("left", "right"):
        pair.press(by, "stop")
        pair.run(1)
    else:
        pair.station.wish(by)
    # Robots without a radio between them hear the station, but not each other.
    if not describe(controller).uses_radio and by in ("left", "right"):
        pair.station.wish("stop")
    pair.run_until(("stopped",), within=60)
    commands = dict(pair.commands)
    assert all(command[1:] == (0, True) for command in commands.values())
    pair.station.wish("start")
    pair.run(100)
    assert pair.modes() == ("stopped", "stopped")
    assert pair.commands == commands  # palms keep their angle
    pair.wish("release", "disarmed")
    pair.wish("arm", "armed")


@pytest.mark.parametrize("controller", ["resilient", "shared-sign", "distributed"])
def test_a_carrying_robot_states_its_mode_all_the_time(controller: str, tmp_path: Path) -> None:
    """Also one whose controller seldom says anything: its partner may wait for it."""
    pair = SimulatedPair(tmp_path, controller, Air(), UP)
    pair.start()
    for _ in range(20):
        before = [robot.count(0) for robot in pair.robots.values()]  # accepted packets
        pair.run(20)
        assert all(
            robot.count(0) > count + 1
            for robot, count in zip(pair.robots.values(), before, strict=True)
        )


def test_the_watchdog_of_a_motor_board_stops_the_wheels(tmp_path: Path) -> None:
    """Its program is held up: the wheels turn for as long as the watchdog lasts, and no longer."""
    pair = SimulatedPair(tmp_path, "silent", Air(), UP)
    pair.start()
    pair.run(50)
    pair.frozen = {"left"}
    limit = round(pair.scene.control.watchdog_s / pair.period_s)
    pair.run(limit)
    assert not pair.commands["left"][2]
    pair.run(1)
    assert pair.commands["left"][1:] == (0, True)


def test_an_e_stop_is_obeyed_without_a_session(tmp_path: Path) -> None:
    """A station that has just started, and hears nobody, stops the robots; nothing else works."""
    pair = SimulatedPair(
        tmp_path, "resilient", Air(delay_ms=20), UP | {"limits.station_lost": "carry-on"}
    )
    pair.start()
    pair.air.cut(("left", "station"), ("right", "station"))
    pair.run(5)  # nothing is under way any more
    pair.restart_station()
    pair.station.wish("stop")
    pair.run(100)
    assert all(mode in CARRYING for mode in pair.modes())
    pair.station.wish("e_stop")
    pair.run(20)
    assert pair.modes() == ("stopped", "stopped")
    pair.station.wish("release")
    pair.run(100)
    assert pair.modes() == ("stopped", "stopped")


def test_a_lost_station_ends_the_carry(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.air.cut(("station", "left"), ("station", "right"))
    pair.run_until(("fault",), within=150)
    assert {pair.robots[side].fault for side in ("left", "right")} == {"station_lost"}


@pytest.mark.parametrize("lost", ["left", "right"])
def test_a_lost_partner_ends_the_carry_if_the_pair_says_so(lost: Any, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "distributed", Air())
    pair.start()
    other: Any = "right" if lost == "left" else "left"
    pair.air.cut((lost, other))
    pair.run(80)
    assert pair.robots[other].fault == "partner_lost"
    assert pair.robots[lost].mode == "fault"  # it has heard that the other does not carry


@pytest.mark.parametrize(
    ("values", "least", "most", "lease_s"),
    [({}, 300, 500, 0.5), (UP, 5, 40, 4.5)],
    ids=["stop", "controller"],
)
def test_robots_that_spare_beacons_are_lost_only_when_they_are_not_heard(
    values: dict[str, object], least: int, most: int, lease_s: float, tmp_path: Path
) -> None:
    """They spare none where silence ends the carry: `least` to `most` packets pass in 9 s."""
    keys = {"task.distance_m": 1.0, "robot.noise_m_s": 0.0}
    pair = SimulatedPair(tmp_path, "shared-sign", Air(), values, keys)
    pair.start()
    pair.run(20)
    packets: list[str] = []
    send = pair.air.send

    def count(sender: str, receiver: str, data: bytes) -> None:
        packets.append(f"{sender} {receiver}")
        send(sender, receiver, data)

    pair.air.send = count
    for _ in range(900):
        pair.run(1)
        assert {status.fault for status in pair.station.status.values()} == {"none"}
        assert all(mode in CARRYING for mode in pair.modes())
    assert least <= sum("station" not in ends for ends in packets) <= most
    pair.air.cut(("right", "left"), ("left", "right"))
    silent = 0
    while pair.station.status["left"].fault != "partner_lost":
        pair.run(1)
        silent += 1
        assert silent * pair.period_s <= lease_s + 0.2


def test_robots_with_other_settings_are_not_armed(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.boot("right", pb.load_scene(pair.scene, {"task.distance_m": 0.4}))
    pair.station.wish("arm")
    pair.run(200)
    assert pair.modes() == ("disarmed", "disarmed")
    assert {robot.fault for robot in pair.robots.values()} == {"settings"}


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_rebooted_robot_rejoins_or_ends_the_carry(side: Any, tmp_path: Path) -> None:
    for rejoins in (True, False):
        folder = tmp_path / str(rejoins)
        folder.mkdir()
        values = UP | {"limits.after_reboot": "rejoin" if rejoins else "disarm"}
        pair = SimulatedPair(folder, "resilient", Air(delay_ms=20), values)
        pair.start()
        pair.run(150)
        pair.power_off(side)
        pair.run(50)
        pair.boot(side)
        pair.run(60)
        if rejoins:
            assert all(mode in CARRYING for mode in pair.modes())
            pair.run_until(("done",), within=3000)
            assert pair.stage.outcome == "running"
        else:
            assert set(pair.modes()) == {"disarmed", "fault"}


def test_a_station_with_a_lower_count_takes_the_next_epoch(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    for _ in range(5):
        pair.restart_station()
    pair.wish("arm", "armed")
    write_state(pair.pair.state_file("station"), StoredState())
    pair.restart_station()
    pair.wish("disarm", "disarmed")
    assert any("takes the next epoch" in line for line in pair.lines)


def test_a_release_does_not_end_a_later_stop(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(delay_ms=20), UP)
    pair.start()
    pair.wish("stop", "stopped")
    pair.wish("release", "disarmed")
    pair.run(100)
    pair.press("left", "stop")
    pair.run(1)
    pair.run(300)
    assert pair.robots["left"].mode == "stopped"
    pair.station.wish("release")
    pair.run(50)
    assert pair.modes() == ("disarmed", "disarmed")


@pytest.mark.parametrize("end", ["silence", "reboots"])
def test_the_station_ends_when_nobody_carries_any_more(end: str, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.after_reboot": "disarm"})
    steps = 0
    done = None
    for done in carry_once(pair.station, 600):
        steps += 1
        if done is not None:
            break
        pair.run(5)
        if steps == 60 and end == "silence":
            pair.power_off("left")
            pair.power_off("right")
        elif steps == 60:
            pair.boot("left")
            pair.boot("right")
    assert done is False
    assert steps < 60 + 20 * 21


def test_a_stop_is_passed_on_although_nothing_can_be_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The disk fills up in operation: the partner must hear the stop all the same."""
    pair = load_pair(init_pair(tmp_path / "pair.toml")[0])
    number = pair.settings.pair.number
    station = Endpoint(pair.key, number, "station", 1)
    sent: list[Any] = []

    class Driver:
        works = True

        def __init__(self, *_: Any) -> None:
            self.left = 40

        def read(self) -> Any:
            self.left -= 1
            return Reading(0, True, 0.0) if self.left else None

        def write(self, *_: Any) -> None:
            pass

        def stop(self) -> None:
            pass

        def close(self) -> None:
            pass

    class Link(Driver):
        def receive(self) -> list[bytes]:
            return [station.send("left", Operate("e_stop", stop=True))]

        def summary(self) -> dict[str, Any]:
            return {}

        def send(self, receiver: str, data: bytes) -> None:
            if receiver == "right":
                packet = decode(data, pair.key, number, "right").packet
                assert packet is not None
                sent.append(packet.body)

    def full(*_: Any) -> None:
        raise pb.PalmbotsError("No space left on device")

    monkeypatch.setattr(live_robot, "open_pair_driver", lambda *_, **__: Driver())
    monkeypatch.setattr(live_robot, "open_pair_link", lambda *_: Link())
    monkeypatch.setattr(storage_thread, "write_state", full)
    live_robot.run_live_robot(pair, "left", rate=10)
    assert any(isinstance(body, State) and body.stop for body in sent)


def test_a_station_that_ends_has_stored_that_the_carry_is_over(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else the next one, on a slow disk, takes robots that wait for a start for a carry."""

    def slow(*arguments: Any) -> None:
        time.sleep(0.3)
        write_state(*arguments)

    pair = SimulatedPair(tmp_path, "shared-sign", Air(), UP, {"task.distance_m": 0.1})
    monkeypatch.setattr(station_module, "write_state", slow)
    assert pair.carry()
    pair.boot("left")
    pair.boot("right")
    pair.restart_station()
    assert not pair.station.was_carrying
    assert pair.carry()


@pytest.mark.parametrize("delay_ms", [100, 1000, 6000, 30000])
def test_orders_act_only_while_they_are_young(delay_ms: int, tmp_path: Path) -> None:
    """Somebody in the middle holds the packets of the station back, and does not know the key."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(20)
    pair.air.hold(delay_ms / 1000, "station")
    pair.station.wish("arm")
    pair.run(450)
    in_time = delay_ms <= 100
    assert pair.modes() == (("armed",) * 2 if in_time else ("disarmed",) * 2)
    pair.run(max(0, delay_ms // 10))
    assert pair.modes() == (("armed",) * 2 if in_time else ("disarmed",) * 2)
    late = any("orders have no effect" in line for line in pair.lines)
    assert late != in_time, pair.lines


def test_a_station_that_is_heard_late_counts_as_lost_and_its_e_stop_acts(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.run(50)
    pair.air.hold(1.5, "station")
    pair.run_until(("fault",), within=160)
    assert {pair.robots[side].fault for side in ("left", "right")} == {"station_lost"}
    pair.station.wish("e_stop")
    pair.run_until(("stopped",), within=160)


@pytest.mark.parametrize("delay_s", [1.5, 6.0])
def test_a_late_order_is_void_once_the_station_says_so(delay_s: float, tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
    pair.wish("arm", "armed")
    pair.air.hold(delay_s, "station")
    pair.station.wish("start")
    pair.run(3000 if delay_s > 5 else 1200)
    assert pair.modes() == ("armed", "armed")
    assert any("start has no effect within 5 s: a packet and its answer" in x for x in pair.lines)


def test_no_order_acts_after_the_station_has_called_it_void(tmp_path: Path) -> None:
    """Those that were lost at first arrive late: the last ones are sent early enough."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
    pair.run(20)
    pair.air.hold(0.4, "station")
    pair.run(100)
    pair.station.wish("arm")
    links = (("station", "left"), ("station", "right"))
    pair.air.cut(*links)
    pair.run(430)
    pair.air.cut()
    pair.run(300)
    assert pair.modes() == ("disarmed", "disarmed"), pair.lines
    assert any("arm has no effect within 5 s" in line for line in pair.lines)


def test_a_robot_says_nothing_before_its_state_is_stored(tmp_path: Path) -> None:
    """What a partner relies on after a boot is on the disk before the partner hears it."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.run(50)
    heard = pair.robots["right"].count(0)
    pair.keepers["left"].is_done = False
    pair.air.cut(("station", "right"))
    pair.run(5)  # what is under way
    heard = pair.robots["right"].count(0)
    pair.run(30)
    assert pair.robots["right"].count(0) == heard
    pair.keepers["left"].is_done = True
    pair.run(30)
    assert pair.robots["right"].count(0) > heard
