# SPDX-License-Identifier: Apache-2.0
"""Faults of real processes and sockets, each at a given instant of a time that the test grants.

Required each time: no avoidable drop; ten seconds after the fault every process is ready again, or
has ended with a reason; and a line at the station says what has happened.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from json_output import read_json
from palmbots.links.impairment import Impairment
from stepped_processes import UNDER_WAY, SteppedProcesses

GOOD = Impairment(delay_ms=2.0)
READY = (*UNDER_WAY, "done", "disarmed", "armed")
ENDED = ("fault", "stopped")
AFTER_S = 10.0
BEGIN_S = 2.0


def nothing(pair: SteppedProcesses) -> None:
    """The radio alone is bad."""


def blackout(pair: SteppedProcesses) -> None:
    pair.packets.cut(("left", "right"))
    pair.run(3.0)
    pair.packets.cut()


def killed(name: str) -> Callable[[SteppedProcesses], None]:
    def kill(pair: SteppedProcesses) -> None:
        pair.kill(name)
        pair.run(0.5)
        pair.restart(name)

    return kill


def suspended(name: str) -> Callable[[SteppedProcesses], None]:
    def suspend(pair: SteppedProcesses) -> None:
        pair.suspend(name)
        pair.run(5.0)
        pair.resume(name)

    return suspend


@dataclass(frozen=True)
class Fault:
    """A fault and the line that the operator reads."""

    line: str
    act: Callable[[SteppedProcesses], None] = nothing
    radio: Impairment = GOOD
    clock_rate: dict[str, float] = field(default_factory=dict)


FAULTS = {
    "none": Fault("left: done"),
    "loss": Fault(r"left: \d\d % of its packets are lost", radio=Impairment(0.2, 2.0)),
    "delay and reordering": Fault(
        r"(left|right): a packet and its answer take 0\.\d\d s", radio=Impairment(0.0, 50.0, 30.0)
    ),
    "copies": Fault(
        r"left: \d\d % of its packets arrive twice", radio=Impairment(delay_ms=2.0, duplicate=0.3)
    ),
    "one direction dead": Fault(r"right: (holding|carrying) \(partner_lost\)", blackout),
    "left killed": Fault(r"left: has started again \(boot 2\)", killed("left")),
    "right killed": Fault(r"right: has started again \(boot 2\)", killed("right")),
    "left suspended": Fault(r"left: not heard for 1 s", suspended("left")),
    "right suspended": Fault(r"right: not heard for 1 s", suspended("right")),
    "one clock fast": Fault(r"left: its clock runs 2 % fast", clock_rate={"left": 1.02}),
}


def lines_match(pair: SteppedProcesses, pattern: str) -> bool:
    return re.search(rf"^ *[\d.]+ s  {pattern}", pair.lines(), re.MULTILINE) is not None


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_in_a_carry(fault: str, tmp_path: Path) -> None:
    given = FAULTS[fault]
    distance_m = 0.8 if given.clock_rate else 0.3
    with SteppedProcesses(
        tmp_path, "resilient", given.radio, clock_rate=given.clock_rate,
        overrides={"task.distance_m": distance_m},
    ) as pair:  # fmt: skip
        pair.start()
        pair.run_until(pair.carries, 20)
        pair.run(BEGIN_S)
        given.act(pair)
        pair.run_until(lambda: is_well(pair), AFTER_S)
        world = pair.finish()
        assert lines_match(pair, given.line), pair.report()
        assert world["outcome"] == "delivered", pair.report()
        assert "Traceback" not in pair.report()


def is_well(pair: SteppedProcesses) -> bool:
    """Both robots are ready again, or have ended with a reason."""
    faults = pair.faults()
    return all(
        (mode in READY and faults[side] == "none") or (mode in ENDED and faults[side] != "none")
        for side, mode in pair.modes().items()
    )


def run_once(folder: Path, **options: Any) -> tuple[str, str]:
    """A carry over a bad radio with a reboot; returns the trace and what the station printed."""
    folder.mkdir()
    with SteppedProcesses(folder, radio=Impairment(0.2, 50.0, 30.0, 0.1), **options) as pair:
        pair.start()
        pair.run_until(pair.carries, 20)
        pair.run(1.0)
        killed("left")(pair)
        pair.run(1.0)
        return pair.trace.hexdigest(), pair.lines()


def test_every_run_is_the_same_to_the_last_packet(tmp_path: Path) -> None:
    first, second = (run_once(tmp_path / name, seed=3) for name in ("a", "b"))
    assert first == second
    assert "left: has started again (boot 2)" in first[1]


def test_the_algorithm_of_the_paper_hangs_and_the_station_says_so(tmp_path: Path) -> None:
    """A robot that waits for a message which was lost waits until the carry ends."""
    overrides = {
        "robot.left.bias_m_s": 0.004, "robot.noise_m_s": 0.012, "task.distance_m": 1.2,
    }  # fmt: skip
    radio = Impairment(0.3, 2.0)
    with SteppedProcesses(tmp_path, "distributed", radio, seed=2, overrides=overrides) as pair:
        pair.start()
        pair.run_until(lambda: "it hangs" in pair.lines(), 20)
        assert lines_match(pair, r"right assists for more than 5\.4 s: it hangs"), pair.report()


def test_an_avoidable_drop_is_named(tmp_path: Path) -> None:
    """Both robots keep still under a drift that any controller corrects: the wheels of the left one
    run too fast, and `distributed` waits for an answer that never comes."""
    overrides = {"robot.left.bias_m_s": 0.02, "robot.noise_m_s": 0.0, "task.distance_m": 1.5}
    with SteppedProcesses(tmp_path, "distributed", GOOD, overrides=overrides) as pair:
        pair.start()
        pair.run_until(pair.carries, 20)
        pair.packets.cut(("left", "right"), ("right", "left"))
        pair.run_until(lambda: pair.has_ended("world"), 60)
        world = read_json("world", pair.programs["world"].printed())
        assert (world["outcome"], world["avoidable"]) == ("dropped", True), pair.report()
