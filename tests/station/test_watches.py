# SPDX-License-Identifier: Apache-2.0
"""What the station notices: corrections, carries that hang, set clocks, numbers of the robots."""

from typing import Any

import pytest

import palmbots._core as _core
from palmbots._types import SIDES, Side
from palmbots.links.packet_statistics import PacketStatistics
from palmbots.station.correction_watch import CorrectionWatch
from palmbots.station.fault_watch import FaultWatch
from palmbots.station.robot_view import RobotView
from palmbots.station.station import PERIOD_S
from palmbots.wire import Packet, Status


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


@pytest.mark.parametrize(("phase", "after_s"), [("centre", 30.0), ("carry", 5.0)])
def test_a_job_may_stay_in_a_phase_before_the_carry(phase: str, after_s: float) -> None:
    watch = FaultWatch(PERIOD_S, PacketStatistics("station"), 0.0, lambda: 0.0)
    number = next(n for n, name in _core.lift_state_numbers.items() if name == phase)
    for sequence, side in enumerate(SIDES, 1):
        body = Status(item="phase", value=number)
        watch.take("accepted", Packet(side, "station", 1, 1, sequence, body=body), "new", 0.0)
    modes: dict[Side, Any] = {"left": "carrying", "right": "carrying"}
    assert watch.step(modes, after_s) == []
    (line,) = watch.step(modes, after_s + 0.1)
    assert line.startswith(f"the carry has not moved on for {after_s:g} s: it hangs")


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
