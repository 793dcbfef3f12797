# SPDX-License-Identifier: Apache-2.0
"""Jobs at stands and on the floor whose robots have motors, servos and switches.

Nothing but the drivers knows the heights of the arms, and nothing but the encoders how far a robot
has driven. While a program is off, wheels stop and arms hold. The object never falls.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from built_robots import BuiltRobot, LateGuard, built_pair
from live_faults import SHORT_WAY
from palmbots._types import SIDES, Side
from palmbots.errors import PalmbotsError
from palmbots.scene.scene import load_scene

MOST_TICKS = 15_000
OFF_TICKS = 60
STANDS = SHORT_WAY["stand"]["floor.stands"]
JOBS: dict[str, dict[str, Any]] = {
    "stand to stand": {},
    "stand to floor": {"floor.stands": STANDS[:1], "task.to": "floor"},
    "floor to stand": {"floor.stands": STANDS[1:], "task.from": "floor"},
    "lower stand": {"floor.stands": [STANDS[0], STANDS[1] | {"height_m": 0.08}]},
    "one first": {"task.dock": "one-first", "start.left_m": 0.02, "start.right_m": -0.02},
}
PHASES = (
    "dock", "touch", "meet", "poised", "raise", "raise_hold", "up", "carry", "arrived", "lower",
    "lower_hold", "down", "leave_steep", "leave_shallow", "empty", "retreat",
)  # fmt: skip
HOLDS = PHASES[3:]
"""In these a robot holds everything after a boot until it hears its partner."""


class Job:
    """A pair that has started, and what has to hold in every tick."""

    def __init__(self, folder: Path, patch: pytest.MonkeyPatch, job: str, **how: Any) -> None:
        scene = load_scene("stand", SHORT_WAY["stand"] | JOBS[job])
        self.pair, self.world = built_pair(folder, patch, scene, **how)
        self.touched: dict[Side, float] = {}
        """Contact coordinates at which the palms touched last before they rose."""
        self.width_m = scene.object.width_m
        self.pair.start()

    def phases(self) -> dict[Side, str]:
        return {side: robot.phase for side, robot in self.pair.robots.items()}

    def tick(self) -> None:
        self.pair.tick()
        state = self.world.state
        assert self.world.outcome == "running", (self.phases(), state)
        for side, phase in self.phases().items():
            if phase == "meet":
                self.touched[side] = state.touched_m[side] or math.nan

    def run_until(self, holds: Callable[[], bool], within: int = MOST_TICKS) -> None:
        for _ in range(within):
            if holds():
                return
            self.tick()
        raise AssertionError((self.phases(), self.pair.modes(), self.pair.lines))

    def is_in(self, phase: str) -> bool:
        return phase in self.phases().values()

    def finish(self) -> str:
        """``delivered``, or ``held``: nothing has moved for 30 s."""
        still, before = 0, None
        while still <= 3000:
            if set(self.pair.modes()) == {"done"}:
                return "delivered"
            self.tick()
            now = (self.world.midpoint, self.world.heights_m)
            still, before = (still + 1 if now == before else 0), now
        return "held"

    def has_put_down(self) -> bool:
        """The object stands level on the ground of the job's end, and no palm touches it."""
        state, to = self.world.state, self.pair.scene.task.to
        is_free = state.touched_m["left"] is None and state.touched_m["right"] is None
        return is_free and state.grounds == (to,) and abs(state.tilt_deg) < 1e-6


@pytest.mark.parametrize("job", JOBS)
def test_robots_with_hardware_do_the_whole_job(
    job: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = Job(tmp_path / "pair", monkeypatch, job)
    starts_on = done.pair.scene.task.ends[0]
    done.run_until(lambda: done.is_in("raise"))
    if starts_on == "stand":
        # Each was at its place, and its arm has raised a corner by what it moves in a tick.
        start = done.pair.scene.start
        assert done.touched["left"] == pytest.approx(start.left_m, abs=2e-3)
        assert done.touched["right"] == pytest.approx(start.right_m, abs=2e-3)
        assert math.radians(abs(done.world.state.tilt_deg)) * done.width_m < 1.5e-3
    assert done.finish() == "delivered"
    assert done.has_put_down()
    assert 0.3 < done.world.moved_m < 0.6


@pytest.mark.parametrize("job", ["stand to stand", "stand to floor"])
def test_readings_and_commands_that_arrive_late_do_not_harm(
    job: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As from a guard process. The driver stops an arm whose palm touches before the robot's
    program knows, so the object is not raised farther."""
    done = Job(tmp_path / "pair", monkeypatch, job, driver=LateGuard)
    done.run_until(lambda: done.is_in("raise"))
    assert math.radians(abs(done.world.state.tilt_deg)) * done.width_m < 1.5e-3
    assert done.finish() == "delivered"
    assert done.has_put_down()


def restart(job: Job, side: Side) -> None:
    """The program of a robot is killed, and starts again."""
    k = SIDES.index(side)
    watchdog = round(job.pair.scene.control.watchdog_s / job.pair.period_s)
    job.pair.power_off(side)
    height_m = job.world.heights_m[k]
    for _ in range(watchdog + 1):
        job.tick()
    x_m = job.world.state.pivots_m[side][0]
    for _ in range(OFF_TICKS):
        job.tick()
    assert job.world.state.pivots_m[side] == pytest.approx((x_m, height_m), abs=1e-9)
    job.pair.boot(side)
    for _ in range(2):
        job.tick()
    # It goes on within a step, or, while it reaches, below the object again.
    arm = job.pair.stored[side].arm
    assert job.world.heights_m[k] == pytest.approx(arm.pivot_m, abs=2e-3)


@pytest.mark.parametrize(
    ("job", "phase"),
    [
        ("stand to stand", "touch"), ("stand to stand", "raise_hold"),
        ("stand to stand", "carry"), ("stand to floor", "lower"),
        *(
            pytest.param(job, phase, marks=pytest.mark.slow)
            for job in ("stand to stand", "stand to floor")
            for phase in PHASES
        ),
    ],
)  # fmt: skip
def test_a_robot_that_restarts_in_a_phase_goes_on(
    job: str, phase: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = Job(tmp_path / "pair", monkeypatch, job)
    done.run_until(lambda: done.is_in(phase))
    side = next(side for side in SIDES if done.phases()[side] == phase)
    assert done.pair.stored[side].holds == (phase in HOLDS)
    restart(done, side)
    assert done.finish() == "delivered"
    assert done.has_put_down()


def test_a_robot_that_restarts_on_its_way_below_the_object_knows_how_far_it_has_driven(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the 2 cm in which it stores that, and what its wheels roll before they stop."""
    done = Job(tmp_path / "pair", monkeypatch, "stand to stand")
    start_x = done.world.state.pivots_m["left"][0]
    done.run_until(lambda: done.world.state.pivots_m["left"][0] > start_x + 0.055)
    assert done.is_in("dock")
    restart(done, "left")
    assert done.finish() == "delivered"
    assert 0.01 < done.touched["left"] < 0.03
    assert abs(done.touched["right"]) < 2e-3


@pytest.mark.slow
def test_a_robot_whose_partner_stays_away_tries_again_at_the_same_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = Job(tmp_path / "pair", monkeypatch, "stand to stand")
    done.pair.power_off("right")
    for _ in range(2):
        done.run_until(lambda: done.is_in("meet"))
        done.run_until(lambda: done.is_in("back_off"))
        assert abs(done.touched.pop("left")) < 2e-3
    assert done.world.state.grounds == ("stand",)
    done.pair.boot("right")
    assert done.finish() == "delivered"


def test_two_robots_that_restart_in_the_air_hold_the_object(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done = Job(tmp_path / "pair", monkeypatch, "stand to stand")
    done.run_until(lambda: done.is_in("carry"))
    for side in SIDES:
        done.pair.power_off(side)
    for side in SIDES:
        done.pair.boot(side)
    assert done.finish() == "held"
    assert min(done.world.heights_m) == pytest.approx(0.15, abs=1e-3)
    assert set(done.phases().values()) == {"held"}


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"hardware.arm_floor_deg": 0, "hardware.arm_top_deg": 0},
         r"hardware\.arm_top_deg: value is 0, as arm_floor_deg: the left robot has no arm"),
        ({"hardware.arm_floor_deg": 178},
         r"hardware\.arm_floor_deg: the arm's servo of the left robot would have to turn to "),
        ({"hardware.switches": [{"sign": "-", "from_m": -0.075, "to_m": -0.01},
                                {"sign": "+", "from_m": 0.01, "to_m": 0.075}]},
         r"hardware\.switches: the left palm has no switch of sign 0"),
        ({"hardware.encoder_ticks_per_turn": 0},
         r'task\.from: value is "stand", and the left robot does not know when it is below the '),
    ],
)  # fmt: skip
def test_hardware_that_cannot_do_the_job_is_refused(
    values: dict[str, Any], line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = load_scene("stand", SHORT_WAY["stand"])
    with pytest.raises(PalmbotsError, match=line):
        built_pair(tmp_path / "pair", monkeypatch, scene, values, driver=BuiltRobot)
