# SPDX-License-Identifier: Apache-2.0
"""Jobs on the floor whose robots run by their own clocks, with a fault in each phase of the table.

Required each time: while a program is off, the wheels of its robot stop within the watchdog's time,
and an arm that is up holds its height. The object never falls. When the program runs again, the job
ends with the object on the floor, or both robots hold it where it is.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palmbots as pb
import palmbots._core as _core
from live_faults import SHORT_WAY
from palmbots.drivers.arm import FOLLOWS, HOLDS, RISES, SINKS
from palmbots.pair.launcher import UP
from palmbots.scene.spec import to_spec
from palmbots.simulation.floor_job import MEANINGS, TASK_PHASES
from palmbots.simulation.world_stage import FloorStage
from palmbots.station.simulated_pair import Air, SimulatedPair

SIDES: tuple[Any, ...] = ("left", "right")
MOST_TICKS = 15_000
OFF_TICKS = 60
JOB = pb.carry("lift", "shared-sign").floor_job
assert JOB is not None
VISITED = sorted({one.phase for one in JOB.phases})
"""The phases of a job that nothing disturbs."""


class Job:
    """A pair, and what has to hold in every tick."""

    def __init__(
        self,
        folder: Path,
        controller: str = "shared-sign",
        scene: str = "lift",
        limits: dict[str, Any] = UP,
        **overrides: Any,
    ) -> None:
        folder.mkdir(exist_ok=True)
        self.pair = SimulatedPair(
            folder, controller, Air(), limits, {"task.distance_m": 0.3, **overrides}, scene=scene
        )
        assert isinstance(self.pair.stage, FloorStage)
        self.stage: FloorStage = self.pair.stage

    def phases(self) -> dict[str, str]:
        return {side: robot.phase for side, robot in self.pair.robots.items()}

    def tick(self) -> None:
        self.pair.tick()
        assert self.stage.outcome == "running", (self.phases(), self.stage.drop_reason())

    def run_until(self, holds: Any, within: int = MOST_TICKS) -> None:
        for _ in range(within):
            if holds():
                return
            self.tick()
        raise AssertionError((self.phases(), self.pair.modes(), self.pair.lines))

    def finish(self) -> str:
        """``delivered``, or ``held``: nothing has moved for 30 s."""
        still, before = 0, None
        for _ in range(MOST_TICKS):
            if set(self.pair.modes()) == {"done"}:
                assert self.stage.is_put_down
                return "delivered"
            now = (self.stage.midpoint, self.stage.heights_m)
            still, before = (still + 1 if now == before else 0), now
            if still > 3000:
                return "held"
            self.tick()
        raise AssertionError((self.phases(), self.pair.modes(), self.pair.lines))

    def close(self) -> None:
        self.pair.close()


@pytest.fixture
def job(tmp_path: Path) -> Iterator[Job]:
    made = Job(tmp_path / "pair")
    yield made
    made.close()


def test_a_pair_does_the_whole_job(job: Job) -> None:
    visited: set[str] = set()
    job.pair.start()
    for _ in range(MOST_TICKS):
        visited |= {*job.phases().values()}
        if job.pair.modes() == ("done", "done"):
            break
        job.tick()
    assert job.pair.modes() == ("done", "done"), (job.phases(), job.pair.lines)
    assert job.stage.is_put_down
    assert 0.1 < job.stage.moved_m < 0.5
    assert visited >= {"dock", "under", "centre", "ready", "raise", "carry", "lower", "done"}


@pytest.mark.parametrize("controller", ["resilient", "distributed"])
def test_every_kind_of_controller_does_the_whole_job(controller: str, tmp_path: Path) -> None:
    job = Job(tmp_path / "pair", controller)
    assert job.pair.carry_until_the_end() == "delivered"
    assert job.stage.is_put_down
    job.close()


@pytest.mark.parametrize("seed", range(2))
def test_readings_that_arrive_late_do_not_harm(
    seed: int, job: Job, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A robot then acts on an old reading, which does not know its newest command."""
    random = np.random.default_rng(seed)

    def sometimes(send: Any) -> Any:
        return lambda frame, **how: send(frame, **how) if random.random() < 0.6 else None

    for board in job.pair._boards.values():
        monkeypatch.setattr(board, "send", sometimes(board.send))
    assert job.pair.carry_until_the_end() == "delivered"
    assert job.stage.is_put_down


@pytest.mark.slow
@pytest.mark.parametrize("fault", ["kill", "stop"])
@pytest.mark.parametrize("phase", VISITED)
def test_a_fault_in_each_phase_ends_safely(phase: str, fault: str, job: Job) -> None:
    pair = job.pair
    pair.start()
    for _ in range(MOST_TICKS):
        if phase in job.phases().values() or pair.modes() == ("done", "done"):
            break
        job.tick()
    if phase not in job.phases().values():
        pytest.skip("the robots were in this phase for no tick")
    side = next(one for one in SIDES if job.phases()[one] == phase)
    k = SIDES.index(side)
    if fault == "kill":
        pair.power_off(side)
    else:
        pair.frozen.add(side)
    height = job.stage.heights_m[k]
    watchdog = round(pair.scene.control.watchdog_s / pair.period_s)
    for tick in range(OFF_TICKS):
        if tick == watchdog + 5:
            height = job.stage.heights_m[k]
        job.tick()
        if tick > watchdog + 5:
            _, move, stop, arm, _ = pair.commands[side]
            assert (move, stop) == (0, True)
            assert arm == (FOLLOWS if TASK_PHASES[phase] == "low" else HOLDS)
            if arm == HOLDS:
                assert job.stage.heights_m[k] == height
    holds = pair.stored[side].holds
    if fault == "kill":
        pair.boot(side)
    else:
        pair.frozen.discard(side)
    if pair.modes() != ("done", "done"):
        job.tick()
        # From `ready` on a robot holds everything after a boot until it hears its partner.
        late = [*MEANINGS].index(phase) >= [*MEANINGS].index("ready")
        assert holds == late
        assert job.finish() in ("delivered", "held")


def test_a_robot_that_stays_off_leaves_the_object_where_it_is(job: Job) -> None:
    job.pair.start()
    job.run_until(lambda: "carry" in job.phases().values())
    job.pair.power_off("left")
    assert job.finish() == "held"
    assert min(job.stage.heights_m) > 0.1
    assert job.stage.outcome == "running"


def test_both_robots_that_reboot_in_the_air_hold(job: Job) -> None:
    job.pair.start()
    job.run_until(lambda: "carry" in job.phases().values())
    for side in SIDES:
        job.pair.power_off(side)
    for side in SIDES:
        job.pair.boot(side)
    assert job.finish() == "held"
    assert job.phases() == {"left": "held", "right": "held"}


def test_arms_go_down_once_the_object_is_taken_away(job: Job) -> None:
    """After an e-stop in the air a person takes the object off, releases and disarms."""
    pair = job.pair
    pair.start()
    job.run_until(lambda: "carry" in job.phases().values())
    pair.wish("e_stop", "stopped")
    high = job.stage.heights_m
    for _ in range(200):
        job.tick()
    assert job.stage.heights_m == high
    pair.wish("release", "disarmed")
    for _ in range(200):
        job.tick()
    assert job.stage.heights_m == high  # the object still lies on the palms
    pair.wish("arm", "disarmed")
    for _ in range(20):
        job.tick()
    assert {robot.fault for robot in pair.robots.values()} == {"arm"}
    assert {robot.arm for robot in pair.robots.values()} == {HOLDS}
    reading = _core.runtime.Reading(-1, True, contact=False, arm_there=False, arm_steps=4)
    for robot in pair.robots.values():
        robot.step(1, reading, [])
        assert robot.arm == SINKS
    low = _core.runtime.Reading(-1, True, contact=False, arm_there=True)
    for robot in pair.robots.values():
        robot.step(1, low, [])
        assert (robot.arm, robot.phase, robot.holds) == (FOLLOWS, "dock", False)


def test_after_a_job_from_the_palms_empty_arms_go_up_again(tmp_path: Path) -> None:
    """They do so when the robots are disarmed."""
    job = Job(tmp_path / "pair", **{"task.from": "palms"})
    pair = job.pair
    assert pair.carry_until_the_end() == "delivered"
    assert max(job.stage.heights_m) < 0.05
    pair.wish("disarm", "disarmed")
    for _ in range(20):
        job.tick()
    high = _core.runtime.Reading(-1, True, contact=False, arm_there=True, arm_steps=6)
    for robot in pair.robots.values():
        assert robot.arm == RISES
        robot.step(1, high, [])
        assert (robot.arm, robot.phase) == (HOLDS, "carry")
    job.close()


def test_a_job_onto_the_palms_ends_in_the_air(tmp_path: Path) -> None:
    job = Job(tmp_path / "pair", **{"task.to": "palms"})
    assert job.pair.carry_until_the_end() == "delivered"
    assert min(job.stage.heights_m) > 0.1
    job.close()


def phases_of(scene: str) -> list[str]:
    """The phases of a job that nothing disturbs."""
    job = pb.carry(scene, "shared-sign", overrides=SHORT_WAY[scene]).floor_job
    assert job is not None
    return sorted({one.phase for one in job.phases})


OTHERS = [(scene, phase) for scene in SHORT_WAY for phase in phases_of(scene)]


@pytest.mark.parametrize("scene", SHORT_WAY)
def test_jobs_at_stands_and_on_one_palm(scene: str, tmp_path: Path) -> None:
    job = Job(tmp_path / "pair", scene=scene, **SHORT_WAY[scene])
    assert {*job.pair.robots} == {*job.pair.scene.working_sides}
    assert job.pair.carry_until_the_end() == "delivered"
    assert job.stage.is_put_down
    assert job.stage.moved_m == pytest.approx(0.5, abs=0.1) or scene == "lone"
    job.close()


@pytest.mark.parametrize(("scene", "controller"), [("handover", "silent"), ("lift", "silent")])
def test_robots_whose_controllers_say_nothing_hear_each_other_to_the_end(
    scene: str, controller: str, tmp_path: Path
) -> None:
    """One is done earlier. Silence of the partner would end the carry of the other one."""
    limits = UP | {"limits.partner_lost": "stop"}
    job = Job(tmp_path / "pair", controller, scene, limits)
    assert job.pair.carry_until_the_end() == "delivered", (job.pair.modes(), job.pair.lines)
    assert not any("holding (partner_lost)" in line for line in job.pair.lines)
    job.close()


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "phase"), OTHERS)
def test_a_robot_is_killed_in_each_phase_of_these_jobs(
    scene: str, phase: str, tmp_path: Path
) -> None:
    """It goes on. If its palm may have held the object alone, it puts the object down and stands,
    and so does its partner."""
    job = Job(tmp_path / "pair", scene=scene, **SHORT_WAY[scene])
    job.pair.start()
    for _ in range(MOST_TICKS):
        if phase in job.phases().values() or set(job.pair.modes()) == {"done"}:
            break
        job.tick()
    if phase not in job.phases().values() or set(job.pair.modes()) == {"done"}:
        pytest.skip("no robot was in this phase for a tick")
    side = next(one for one in SIDES if job.phases().get(one) == phase)
    job.pair.power_off(side)
    for _ in range(OFF_TICKS):
        job.tick()
    job.pair.boot(side)
    on_trial = ("begin", "prop", "scoop", "seat", "ease")
    stands = to_spec(job.pair.scene).on_one_palm and phase not in on_trial
    assert job.finish() == ("held" if stands else "delivered")
    assert not stands or max(job.stage.heights_m) < 0.05
    job.close()
