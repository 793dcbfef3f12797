# SPDX-License-Identifier: Apache-2.0
"""The station on a clock of the test: wishes, restarts, other stations."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from palmbots.pair.launcher import UP
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.station.carry_script import carry_once
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.station.station import PERIOD_S, OtherStation, Station
from palmbots.station.station_epochs import StationEpochs
from palmbots.wire import Hello, Operate

CARRYING = ("carrying", "holding")
STEP = round(PERIOD_S / 0.01)


@pytest.mark.parametrize("wish", ["arm", "start"])
def test_a_wish_does_not_arm_or_start_again_after_a_fault(wish: Any, tmp_path: Path) -> None:
    """The robots have a fault while the wish is the operator's newest."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.wish("arm", "armed")
    if wish == "start":
        pair.wish("start", *CARRYING)
    pair.air.cut(("station", "left"), ("station", "right"))
    pair.run_until(("fault",), within=150)
    pair.air.cut()
    pair.run(600)
    assert pair.modes() == ("fault", "fault")
    pair.wish("arm", "armed")  # the operator may


def test_a_refused_wish_lapses(tmp_path: Path) -> None:
    """What prevented it may end at any later time, when nobody expects a robot to arm."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.air.cut(("left", "right"), ("right", "left"))
    pair.station.wish("arm")
    pair.run(600)
    assert pair.modes() == ("disarmed", "disarmed")
    assert pair.station.has_lapsed()
    pair.air.cut()
    pair.run(300)
    assert pair.modes() == ("disarmed", "disarmed")
    late = [line for line in pair.lines if "no effect within 5 s" in line]
    assert len(late) == 2
    assert "left: arm has no effect within 5 s: the robot is disarmed (partner_lost: it" in late[0]


def test_a_robot_that_leaves_stopped_is_stopped_again(tmp_path: Path) -> None:
    """Only a stop stays in force."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.wish("arm", "armed")
    pair.wish("stop", "stopped")
    pair.run(30)  # until the station knows it
    view = pair.station.robots["left"]
    assert view.status is not None
    assert pair.station._due("left") == Hello(stop=True)
    view.status = replace(view.status, mode="armed")
    assert pair.station._due("left") == Operate("stop", stop=True)


def test_the_script_does_not_arm_again_after_a_fault(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    script = carry_once(pair.station, 600)
    done = None
    while done is None and set(pair.modes()) != {"armed"}:
        done = next(script)
        pair.run(STEP)
    pair.air.cut(("station", "left"), ("station", "right"))
    pair.run_until(("fault",), within=150)
    pair.air.cut()
    for _ in range(400):
        if done is not None:
            break
        done = next(script)
        pair.run(STEP)
        assert not set(pair.modes()) & {"armed", "ready", *CARRYING}
    assert done is False


def test_the_script_starts_only_once(tmp_path: Path) -> None:
    """An order to start that was void may not be repeated when nobody expects it any more."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
    pair.wish("arm", "armed")
    script = carry_once(pair.station, 600)
    done = None
    for _ in range(400):
        done = next(script)
        if done is not None:
            break
        if pair.station.wished == "start":
            pair.air.hold(1.5, "station")
        pair.run(STEP)
    assert done is False
    assert sum("script: start" in line for line in pair.lines) == 1, pair.lines


@pytest.mark.parametrize("deaf", ["none", "right"])
def test_the_script_stops_at_once_where_a_start_is_void(deaf: Any, tmp_path: Path) -> None:
    """The robots, or one of them, heard it, and do not hear each other."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    script = carry_once(pair.station, 600)
    while pair.modes() != ("armed", "armed"):
        assert next(script) is None
        pair.run(STEP)
    pair.air.cut(("left", "right"), ("right", "left"), ("station", deaf))
    while next(script) is None and pair.now_s() < 3:
        pair.run(STEP)
    assert any("left: ready" in line for line in pair.lines)
    assert any("script" in line and line.endswith(": stop") for line in pair.lines), pair.lines


def test_a_station_that_is_started_again_starts_robots_that_are_armed(tmp_path: Path) -> None:
    """They were armed for another carry than the one that was under way."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.wish("arm", "armed")
    pair.station.keep_carrying(True)
    pair.station.close()
    pair.restart_station()
    assert pair.station.was_carrying
    assert pair.carry()


def test_a_robot_that_two_programs_claim_to_be_is_not_armed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    with monkeypatch.context() as patch:
        patch.setattr(pair.station, "claimed_twice", lambda: ("left",))
        pair.station.wish("arm")
        pair.run(100)
        assert pair.modes() == ("disarmed", "disarmed")
        assert pair.station._due("right") == Hello()
    pair.wish("arm", "armed")
    with monkeypatch.context() as patch:
        patch.setattr(pair.station, "claimed_twice", lambda: ("left",))
        pair.station.wish("start")
        pair.run(100)
        assert pair.modes() == ("armed", "armed")


def test_the_epoch_before_a_boot_of_this_station_is_no_other_station() -> None:
    epochs = StationEpochs(5)
    epochs.take("left", (4, 100), 0, 0.0)
    assert epochs.found(0.1) == "alone"
    epochs.take("right", (3, 100), 0, 0.0)
    assert epochs.found(0.1) == "listening"


def test_the_script_gives_up_when_a_check_before_arming_fails(tmp_path: Path) -> None:
    """The robots hear the station, and never each other."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.air.cut(("left", "right"), ("right", "left"))
    assert pair.carry() is False
    assert pair.station.time_s() < 30
    assert sum("script: arm" in line for line in pair.lines) == 3
    assert any("script (the robots have not started): stop" in line for line in pair.lines)


@pytest.mark.parametrize("end", ["done", "fault"])
def test_a_station_that_was_killed_at_the_end_does_not_carry_again(
    end: str, tmp_path: Path
) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    script = carry_once(pair.station, 600)
    while not all(mode in CARRYING for mode in pair.modes()):
        assert next(script) is None
        pair.run(STEP)
    for _ in range(5):
        assert next(script) is None
        pair.run(STEP)
    pair.station.close()
    if end == "done":
        pair.run_until(("done",), within=3000)  # the old station still answers
    else:
        pair.air.cut(("station", "left"), ("station", "right"))
        pair.run_until(("fault",), within=150)
        pair.air.cut()
    for _ in range(30):  # until the wheels rest
        pair.air.now += 1
        pair.move()
    before = pair.stage.midpoint
    pair.restart_station()
    assert pair.station.was_carrying
    assert pair.carry() is (end == "done")
    assert pair.stage.midpoint == before
    # The next one begins anew.
    pair.station.close()
    pair.restart_station()
    assert not pair.station.was_carrying


def test_a_station_that_was_killed_in_the_carry_goes_on(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    script = carry_once(pair.station, 600)
    while not all(mode in CARRYING for mode in pair.modes()):
        assert next(script) is None
        pair.run(STEP)
    next(script)
    pair.station.close()
    pair.restart_station()
    assert pair.carry()


class Tap:
    """A link that hears everything to the station, as a second radio would."""

    def __init__(self, air: Air) -> None:
        self.air, self.heard = air, list[bytes]()
        self.sends = 0
        before = air.send

        def send(sender: str, receiver: str, data: bytes) -> None:
            if receiver == "station":
                self.heard.append(data)
            before(sender, receiver, data)

        air.send = send

    def send(self, receiver: str, data: bytes) -> None:
        self.sends += 1
        self.air.send("station", receiver, data)

    def receive(self) -> list[bytes]:
        heard, self.heard = self.heard, []
        return heard

    def close(self) -> None:
        pass


def second_laptop(pair: SimulatedPair, folder: Path, boots: int) -> tuple[Station, Tap, list[str]]:
    """A station with the key of the pair and a boot counter of its own."""
    folder.mkdir()
    (folder / "scene.toml").write_text(pair.scene.to_toml())
    number = pair.pair.settings.pair.number
    other = load_pair(init_pair(folder / "pair.toml", values={"pair.number": number})[0])
    other = type(other)(other.file, pair.pair.settings, pair.pair.key)
    tap, lines = Tap(pair.air), list[str]()
    station: Any = None
    other.state_file("station").path.parent.mkdir(exist_ok=True)
    for boot in range(boots):
        if boot:
            station.close()
        station = Station(other, tap, lines.append, lambda: 0.01 * pair.air.now)
    return station, tap, lines


@pytest.mark.parametrize("boots", [1, 5, 9])
def test_a_second_station_on_another_laptop_is_refused(boots: int, tmp_path: Path) -> None:
    """Whatever the count of its boots, it is refused before it has sent anything."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    for _ in range(4):
        pair.restart_station()  # epoch 5
    pair.start()
    other, tap, _ = second_laptop(pair, tmp_path / "laptop", boots)
    with pytest.raises(OtherStation, match=r"another station operates this pair \(it has booted 5"):
        for _ in range(100):
            pair.run(STEP)
            other.step()
    assert tap.sends == 0
    assert all(mode in CARRYING for mode in pair.modes())


def test_a_station_that_was_taken_over_says_so(tmp_path: Path) -> None:
    """Its radio had failed meanwhile, and another laptop has taken its place."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
    pair.start()
    first = pair.station
    pair.station = Station.__new__(Station)
    pair.station.step = lambda: None
    pair.run(300)
    other, _, lines = second_laptop(pair, tmp_path / "laptop", 1)
    for _ in range(60):
        pair.run(STEP)
        other.step()
    assert any("takes the next epoch" in line for line in lines)
    assert other.modes().keys() == {"left", "right"}
    with pytest.raises(OtherStation, match="another station operates this pair"):
        for _ in range(40):
            pair.run(STEP)
            other.step()
            first.step()


def test_an_e_stop_does_not_wait_until_other_stations_are_ruled_out(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.station_lost": "carry-on"})
    pair.start()
    for _ in range(3):  # the newest packets that the robots know are older than one boot
        Station(pair.pair, pair.air.link("nobody"), pair.lines.append).close()
    pair.restart_station()
    pair.station.wish("e_stop")
    pair.run_until(("stopped",), within=30)


def test_a_stop_that_a_robot_does_not_confirm_is_reported(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.wish("arm", "armed")
    pair.air.cut(("station", "right"), ("right", "station"), ("left", "right"))
    pair.station.wish("e_stop")
    pair.run(150)
    found = [line for line in pair.lines if "not confirmed" in line]
    assert len(found) == 1
    assert "right: e-stop is not confirmed within 1 s: the robot is not heard; use the" in found[0]


def test_an_order_without_effect_names_the_order_that_is_needed_first(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(20)
    pair.station.wish("start")
    pair.run(600)
    assert any("within 5 s: the robot is disarmed; arm it first" in x for x in pair.lines)
    pair.wish("stop", "stopped")
    pair.station.wish("arm")
    pair.run(50)
    found = [line for line in pair.lines if "arm has no effect" in line]
    assert len(found) == 2
    assert "left: arm has no effect: the robot is stopped; release it first" in found[0]
    pair.run(600)  # and once is enough
    assert [line for line in pair.lines if "arm has no effect" in line] == found


def test_an_order_right_after_a_release_is_not_called_void(tmp_path: Path) -> None:
    """The statuses that show the release are still on their way."""
    pair = SimulatedPair(tmp_path, "resilient", Air(delay_ms=20), UP)
    pair.wish("stop", "stopped")
    pair.station.wish("release")
    pair.run(7)
    pair.wish("arm", "armed")
    assert not any("has no effect" in line for line in pair.lines)


def test_a_fault_that_prevents_an_order_is_a_sentence(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(20)
    view = pair.station.robots["left"]
    assert view.status is not None
    view.status = replace(view.status, mode="fault", fault="overrun")
    assert pair.station._obstacle("left").startswith(
        "the robot has a fault (overrun: its control loop is too slow, or its driver waits; "
    )
