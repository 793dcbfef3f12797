# SPDX-License-Identifier: Apache-2.0
"""The station on a clock of the test: wishes, restarts, other stations, forged packets."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from palmbots._types import Side
from palmbots.links.packet_statistics import PacketStatistics
from palmbots.pair.launcher import UP
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.station.carry_script import carry_once
from palmbots.station.correction_watch import CorrectionWatch
from palmbots.station.fault_watch import FaultWatch
from palmbots.station.robot_view import RobotView
from palmbots.station.simulated_pair import Air, SimulatedPair
from palmbots.station.station import PERIOD_S, OtherStation, Station
from palmbots.station.station_epochs import StationEpochs
from palmbots.wire import Endpoint, Hello, Operate, Packet, Status, encode

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


def sent_by_a_stranger(pair: SimulatedPair, key: bytes, body: Any, sequence: int) -> None:
    """Packets to both robots as a station would send them, also with right acknowledgements."""
    for side in ("left", "right"):
        for ahead in (0, 5):
            packet = Packet(
                "station", side, pair.pair.settings.pair.number, 2**24 - 1, sequence + ahead,
                (pair.stored[side].epoch, 1), body,
            )  # fmt: skip
            pair.air.send("station", side, encode(packet, key))


def test_a_wrong_key_moves_nothing(tmp_path: Path) -> None:
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(50)
    wrong = bytes(16)
    assert wrong != pair.pair.key
    operations: tuple[Any, ...] = ("arm", "start", "e_stop", "release")
    for number, operation in enumerate(operations * 5):
        sent_by_a_stranger(pair, wrong, Operate(operation, stop=operation == "e_stop"), number + 1)
        pair.run(20)
        assert pair.modes() == ("disarmed", "disarmed")
    assert all(robot.count(6) >= 40 for robot in pair.robots.values())  # bad_tag


def test_with_the_right_key_the_same_packets_do_stop(tmp_path: Path) -> None:
    """Otherwise the test above could not fail."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.run(50)
    sent_by_a_stranger(pair, pair.pair.key, Operate("e_stop", stop=True), 1)
    pair.run(5)
    assert pair.modes() == ("stopped", "stopped")


def test_replayed_orders_do_nothing(tmp_path: Path) -> None:
    """Everything that the station has sent is recorded and sent again: after the carry, after a
    stop, and after a reboot of both robots. No robot arms, starts or is released by it."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP | {"limits.after_reboot": "disarm"})
    recorded: list[tuple[str, bytes]] = []
    before = pair.air.send

    def send(sender: str, receiver: str, data: bytes) -> None:
        if sender == "station":
            recorded.append((receiver, data))
        before(sender, receiver, data)

    pair.air.send = send
    pair.start()
    pair.wish("stop", "stopped")
    pair.wish("release", "disarmed")
    pair.start()
    pair.wish("stop", "stopped")
    pair.air.send = before

    def replay() -> set[str]:
        seen: set[str] = set()
        for receiver, data in recorded:
            pair.air.send("station", receiver, data)
            pair.run(1)
            seen |= set(pair.modes())
        return seen

    assert replay() == {"stopped"}
    for side in ("left", "right"):
        pair.boot(side)
    assert replay() == {"stopped"}
    pair.wish("release", "disarmed")
    # An emergency stop counts without a session, and can only stop.
    assert replay() <= {"disarmed", "stopped"}


def test_a_forged_release_does_not_end_an_e_stop(tmp_path: Path) -> None:
    """Bits of a release are changed in every byte, and its tag is that of other packets."""
    pair = SimulatedPair(tmp_path, "resilient", Air(), UP)
    pair.start()
    pair.wish("e_stop", "stopped")
    number = pair.pair.settings.pair.number
    stranger = Endpoint(bytes(range(16)), number, "station", 2**24 - 1)
    forged = stranger.send("left", Operate("release"))
    real: list[bytes] = []
    before = pair.air.send

    def send(sender: str, receiver: str, data: bytes) -> None:
        if (sender, receiver) == ("station", "left"):
            real.append(data)
        before(sender, receiver, data)

    pair.air.send = send
    pair.run(20)
    for k in range(len(forged)):
        changed = real[-1][:k] + bytes([real[-1][k] ^ 1]) + real[-1][k + 1 :]
        mixed = real[-1][:k] + forged[k:]
        for data in (forged, changed, mixed):
            pair.air.send("station", "left", data)
        pair.run(1)
        assert pair.robots["left"].mode == "stopped"
    pair.wish("release", "disarmed")  # a real one does


def test_a_correction_that_never_ends_is_named_once() -> None:
    watch = CorrectionWatch(6.0)
    for now, side, case in ((1.0, "left", "a"), (1.2, "right", "c"), (5.0, "left", "a")):
        watch.take(side, case, now)
    assert watch.hanging(7.0) == []
    assert watch.hanging(7.1) == ["correction A of left lasts for more than 6 s: it hangs"]
    assert watch.hanging(7.3) == ["right assists for more than 6 s: it hangs"]
    assert watch.hanging(20.0) == []
    watch.take("left", " ", 21.0)
    watch.take("left", "d", 22.0)
    watch.take("left", " ", 27.9)
    assert watch.hanging(40.0) == []


@pytest.mark.parametrize(
    ("left", "right", "hangs"),
    [
        ("holding", "carrying", True), ("holding", "done", True), ("done", "done", False),
        ("holding", "ready", False), ("fault", "carrying", False),
    ],
)  # fmt: skip
def test_a_carry_that_does_not_move_on_is_named(left: Any, right: Any, hangs: bool) -> None:
    watch = FaultWatch(PERIOD_S, PacketStatistics("station"), 0.0, lambda: 0.0)
    modes: dict[Any, Any] = {"left": left, "right": right}
    assert watch.step(modes, 0.0) == watch.step(modes, 5.0) == []
    line = f"the carry has not moved on for 5 s: it hangs (left is {left}, right is {right})"
    if right == "done":
        line += "; left waits for right, which is done: stop the carry"
    assert watch.step(modes, 5.1) == ([line] if hangs else [])
    assert watch.step(modes, 15.0) == []  # not again so soon
    assert watch.step(modes, 15.2) == ([line] if hangs else [])


@pytest.mark.parametrize(("jump_s", "way"), [(-3600.0, "back by 3600"), (90.0, "forward by 90")])
def test_a_clock_that_was_set_is_named_once(jump_s: float, way: str) -> None:
    wall = [1000.0]
    watch = FaultWatch(PERIOD_S, PacketStatistics("station"), 0.0, lambda: wall[0])
    wall[0] += 0.9  # as a time service does
    assert watch.step({}, 1.0) == []
    wall[0] = 1000.0 + jump_s
    line = f"station: the clock of this computer was set {way} s; nothing here depends on it"
    assert watch.step({}, 2.0) == [line]
    assert watch.step({}, 3.0) == []


def test_numbers_of_a_robot_are_kept_until_it_boots() -> None:
    """At rest it reports no progress any more; after a boot nothing is known."""
    view = RobotView(PacketStatistics("station").ends["left"])

    def take(epoch: int, mode: Any, item: Any, value: int) -> None:
        status = Status(mode=mode, item=item, value=value)
        view.take(Packet("left", "station", 1, epoch, 1, body=status), status, 0.0)

    take(1, "carrying", "battery", 7400)
    take(1, "carrying", "progress", 0x8000)
    take(1, "done", "progress", 0)
    assert view.progress == pytest.approx(0.5, abs=1e-4)
    assert view.battery_v == 7.4
    take(1, "disarmed", "progress", 0)
    assert view.progress == 0
    take(2, "disarmed", "overruns", 0)
    assert view.battery_v is None and view.progress is None


def test_corrections_get_labels_in_the_order_of_their_start() -> None:
    watch = CorrectionWatch()
    cases: list[tuple[Side, str]] = [
        ("left", "a"), ("right", "c"), ("left", " "), ("right", " "), ("right", "b"),
        ("left", "c"), ("right", "a"), ("right", "a"),
    ]  # fmt: skip
    said = [watch.take(side, case, now) for now, (side, case) in enumerate(cases)]
    assert said == [
        "correction A of left (a) begins", "correction A: right assists",
        "correction A ends after 2.0 s", None, "correction B of right (b) begins",
        "correction B: left assists", "correction C of right (a) begins", None,
    ]  # fmt: skip
    assert [(c.label, c.robot, c.assistant, c.start_s, c.end_s) for c in watch.ended] == [
        ("A", "left", "right", 0, 2),
        ("B", "right", "left", 4, 6),
    ]
    assert [(c.label, c.assistant) for c in watch.under_way] == [("C", "left")]


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
    pair.run(600)
    assert any("arm has no effect within 5 s: the robot is stopped" in x for x in pair.lines)
