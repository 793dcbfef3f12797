# SPDX-License-Identifier: Apache-2.0
"""Robots as programs of their own, which exchange packets as bytes, carry as inside one program."""

from pathlib import Path
from typing import Any

import pytest

import palmbots as pb
import palmbots._core as _core
from live_faults import SHORT_WAY, SIMULATED, scene_with
from palmbots.control.registry import resolve
from palmbots.errors import PalmbotsError
from palmbots.pair.pair_file import init_pair, load_pair
from palmbots.robot.lockstep_robot import run_lockstep_robot, without_effect
from palmbots.scene.spec import to_spec
from palmbots.simulation.lockstep_world import ends_of, establish_sessions, remote

SIDES = ("left", "right")
KEY = bytes(range(16))
PAIR = 7
STATION_LOST = {"faults.script": [{"kind": "station-down", "at_s": 5.0, "duration_s": 1.0}]}
DIRECTIONS = {
    "radio.left.latency_s": 0.09, "radio.left.loss": 0.1, "radio.right.jitter_s": 0.03,
    "radio.station.loss": 0.05,
}  # fmt: skip
REPLAY = {"radio.replay": 0.3, "radio.replay_within_s": 2.0}
CLOCKS = {
    "faults.script": [
        {"kind": "clock-rate", "robot": "left", "at_s": 2.0, "duration_s": 6.0, "ppm": 20000.0},
        {"kind": "clock-rate", "robot": "right", "at_s": 4.0, "duration_s": 6.0, "ppm": -15000.0},
        {"kind": "clock-jump", "robot": "right", "at_s": 12.0, "duration_s": 0.8},
    ]
}
PERIODS = {"robot.left.period_s": 0.03, "robot.right.period_s": 0.02}
LOST = {
    "faults.script": [
        {"kind": "reboot", "robot": "left", "at_s": 4.0, "duration_s": 0.5, "limp_deg": 0.0},
        {"kind": "reboot", "robot": "right", "at_s": 8.0, "duration_s": 0.5,
         "loses_boot_counter": True},
    ]
}  # fmt: skip


class Programs:
    """The programs of both robots in this process, and what survives their reboots."""

    def __init__(self, scene: pb.Scene, controller: str) -> None:
        self.spec, self.entry = to_spec(scene), resolve(controller)
        self.epoch, self.assists, self.holds = [0, 0], [False, False], [False, False]
        self.robots = [self.booted(side) for side in (0, 1)]
        self.station = _core.runtime.Station(KEY, PAIR, 1)
        establish_sessions(ends_of(self.entry, scene), self.greet, self.hear)

    def greet(self, end: str, other: str) -> bytes | None:
        if end == "station":
            return self.station.greet(SIDES.index(other))
        return self.robots[SIDES.index(end)].greet()

    def hear(self, end: str, data: bytes) -> None:
        (self.station if end == "station" else self.robots[SIDES.index(end)]).hear(data)

    def booted(self, side: int) -> Any:
        self.epoch[side] += 1
        return _core.runtime.Robot(
            self.spec, self.entry.for_core(self.spec), side, KEY, PAIR,
            epoch=self.epoch[side], assists=self.assists[side], holds=self.holds[side],
            settings=_core.runtime.RuntimeSettings.lockstep(), carries=True,
        )  # fmt: skip

    def exchange(self, tick: int, left: Any, right: Any, station: Any) -> list[Any]:
        answers: list[Any] = []
        for side, given in enumerate((left, right)):
            if given is None:
                answers.append(None)
                continue
            elapsed, sign, palm_at_target, boots, packets, senses = given
            if boots:
                self.robots[side] = self.booted(side)
            touches, arm_there, far_enough, steps, beneath = senses
            reading = _core.runtime.Reading(
                sign, palm_at_target, contact=touches, covered=far_enough, arm_there=arm_there,
                arm_steps=steps, beneath=beneath,
            )  # fmt: skip
            answer = self.robots[side].step(elapsed, reading, packets)
            self.assists[side], self.holds[side] = answer[-1], self.robots[side].holds
            answers.append(answer)
        return [*answers, None if station is None else self.station.step(station[4])]


def both_ways(
    controller: str, overrides: dict[str, Any], seed: int, name: str = "paper"
) -> tuple[Any, Any]:
    scene = pb.load_scene(name, overrides)
    inside = pb.carry(scene, controller, seed=seed)
    programs = Programs(scene, controller)
    outside = pb.carry(scene, remote(resolve(controller), programs.exchange), seed=seed)
    return inside, outside


LIVE = {name: scene_with(name) for name in SIMULATED}
EVERYTHING = scene_with(*LIVE) | {"radio.corruption": 0.05}
CASES = LIVE | {
    "everything": EVERYTHING,
    "station lost": STATION_LOST,
    "directions": DIRECTIONS,
    "replay": REPLAY,
    "clocks": CLOCKS,
    "lost": LOST,
    "periods": PERIODS,
    "everything with directions, replay and clocks": EVERYTHING | DIRECTIONS | REPLAY | CLOCKS,
    "everything with periods": EVERYTHING | PERIODS,
}


SEEDS = [(case, seed) for case in CASES for seed in range(3 if "everything" in case else 1)]


@pytest.mark.parametrize(("case", "seed"), SEEDS)
@pytest.mark.parametrize(
    "controller",
    [
        "resilient",
        "shared-sign",
        "silent",
        "distributed",
        "centralized",
        "examples/policies/table-1.toml",
    ],
)
def test_programs_carry_as_inside_one_program(controller: str, case: str, seed: int) -> None:
    inside, outside = both_ways(controller, CASES[case], seed)
    assert outside.trace_hash == inside.trace_hash
    assert outside.summary() == inside.summary()
    assert outside.message_log == inside.message_log


JOBS: dict[str, dict[str, Any]] = {
    "as it is": {},
    "from the palms": {"task.from": "palms"},
    "onto the palms, one first": {"task.to": "palms", "task.dock": "one-first"},
    "everything": EVERYTHING,
    "everything, at level pivots only": EVERYTHING | {"object": "bottle"},
    "lost and clocks": {
        "faults.script": [
            {"kind": "reboot", "robot": "left", "at_s": 1.0, "duration_s": 0.5},
            {"kind": "reboot", "robot": "right", "at_s": 12.0, "duration_s": 0.5},
            {"kind": "freeze", "robot": "left", "at_s": 20.0, "duration_s": 0.5},
            *CLOCKS["faults.script"],
        ],
        "robot.left.clock_ppm": 20000.0,
    },
    "hard radio": DIRECTIONS | REPLAY | {"radio.corruption": 0.05, "radio.airtime_s": 0.002},
}


@pytest.mark.parametrize("job", JOBS)
@pytest.mark.parametrize(
    "controller", ["resilient", "shared-sign", "silent", "distributed", "centralized"]
)
def test_jobs_on_the_floor_run_as_inside_one_program(controller: str, job: str) -> None:
    inside, outside = both_ways(controller, {"task.distance_m": 0.5} | JOBS[job], 3, "lift")
    assert outside.trace_hash == inside.trace_hash
    assert outside.summary() == inside.summary()
    assert outside.message_log == inside.message_log
    assert outside.floor_job == inside.floor_job


STANDS = SHORT_WAY["stand"]
OTHER_JOBS: dict[str, tuple[str, dict[str, Any]]] = {
    "stand": ("stand", STANDS),
    "stand, everything": ("stand", STANDS | EVERYTHING),
    "stand, both restart": (
        "stand",
        STANDS
        | {
            "faults.script": [
                {"kind": "reboot", "robot": "left", "at_s": 3.0, "duration_s": 0.5},
                {"kind": "reboot", "robot": "right", "at_s": 7.0, "duration_s": 0.5},
            ]
        },
    ),
    "from the floor onto a stand": (
        "stand",
        {"task.from": "floor", "floor.stands": STANDS["floor.stands"][1:]},
    ),
    "lone": ("lone", {}),
    "lone, restarts": (
        "lone",
        {
            "faults.script": [
                {"kind": "reboot", "robot": "right", "at_s": at_s, "duration_s": 0.5}
                for at_s in (1.0, 14.0)
            ]
            + [{"kind": "freeze", "robot": "right", "at_s": 4.0, "duration_s": 0.5}]
        },
    ),
    "from palm to palm": ("handover", {}),
    "from palm to palm, everything": ("handover", EVERYTHING),
    "from palm to palm, both restart": (
        "handover",
        {
            "faults.script": [
                {"kind": "reboot", "robot": "right", "at_s": 2.0, "duration_s": 0.5},
                {"kind": "reboot", "robot": "left", "at_s": 12.0, "duration_s": 0.5},
            ]
        },
    ),
}


@pytest.mark.parametrize("job", OTHER_JOBS)
def test_jobs_at_stands_and_of_one_robot_run_as_inside_one_program(job: str) -> None:
    name, overrides = OTHER_JOBS[job]
    inside, outside = both_ways("shared-sign", {"task.distance_m": 0.5} | overrides, 3, name)
    assert outside.trace_hash == inside.trace_hash
    assert outside.summary() == inside.summary()
    assert outside.message_log == inside.message_log
    assert outside.floor_job == inside.floor_job


def test_limits_that_are_not_in_force_in_lockstep_are_named(tmp_path: Path) -> None:
    file = init_pair(tmp_path / "pair.toml")[0]
    assert without_effect(load_pair(file)) == (
        f'{file}: [limits] after_reboot = "disarm" and partner_lost = "stop" have no effect in '
        "lockstep, where the controller alone decides, as in palmbots carry"
    )
    text = file.read_text().replace('"disarm"', '"rejoin"')
    file.write_text(text.replace('partner_lost = "stop"', 'partner_lost = "controller"'))
    assert without_effect(load_pair(file)) == ""


def test_speed_limit_holds_in_lockstep_too(tmp_path: Path) -> None:
    values: dict[str, object] = {"limits.max_speed_m_s": 0.05}
    pair = load_pair(init_pair(tmp_path / "pair.toml", values=values)[0])
    with pytest.raises(PalmbotsError, match=r"limits.max_speed_m_s: value is 0.05; allowed: at le"):
        run_lockstep_robot(pair, "left")
