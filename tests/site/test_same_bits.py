# SPDX-License-Identifier: Apache-2.0
"""The page computes the same bits as the native core, and its commands reproduce what it shows."""

import random
from typing import Any

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from palmbots.control.registry import shipped_names
from site_pages import Open, command_of, go, hash_of, run_json

SCENES = ("paper", "paper-offset", "figure8")
OBJECTS = ("box", "box-strips", "l-shape", "plank", "tray", "trapezoid")


BOUNDS = {"friction": (0.25, 0.5), "friction_angle_deg": (14.0, 26.0)}


def expect_hash(page: Page, carried: pb.simulation.Carry) -> None:
    expect(page.locator("#hash")).to_have_text(carried.trace_hash)


def test_every_controller_and_scene(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    for controller in shipped_names():
        for seed, scene in enumerate(SCENES):
            go(page, hash_of("carry", {"scene": scene, "controller": controller, "seed": seed}))
            expect_hash(page, pb.carry(scene, controller, seed=seed, record=False))


def test_every_object(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    for seed, name in enumerate(OBJECTS):
        go(page, hash_of("carry", {"seed": seed}, object=name))
        expect_hash(page, pb.carry(seed=seed, overrides={"object": name}, record=False))


def friction_keys(draw: random.Random) -> dict[str, float]:
    """A coefficient or an angle, of both palms and of one."""
    both, one = draw.choice(list(BOUNDS)), draw.choice(list(BOUNDS))
    side = draw.choice(("left", "right"))
    return {
        f"palm.{both}": draw.uniform(*BOUNDS[both]),
        f"palm.{side}.{one}": draw.uniform(*BOUNDS[one]),
    }


def random_keys(draw: random.Random) -> dict[str, Any]:
    """Keys of every section of a scene."""
    sides = ("left", "right")
    half = draw.uniform(0.05, 0.3)
    return {
        "object.vertices_m": [
            [-half + 0.3, draw.uniform(-0.02, 0.02)], [half + 0.31, 0.0],
            [half + draw.uniform(0.2, 0.33), draw.uniform(0.08, 0.2)], [-half + 0.28, 0.17],
        ],
        "object.contacts": [0, 1],
        "object.com_m": [0.3 + draw.uniform(-0.01, 0.01), 0.05],
        "object.mass_kg": 0.5,
        "palm.left.steep_deg": draw.uniform(13, 18),
        **friction_keys(draw),
        "palm.pivot_offset_m": draw.choice([0.0, 0.004]),
        "robot.noise_m_s": draw.uniform(0, 0.02),
        "robot.right.bias_m_s": draw.uniform(-0.003, 0.003),
        "robot.left.clock_ppm": 100.0,
        "robot.right.period_s": draw.choice([0.01, 0.03]),
        "radio.right.latency_s": draw.uniform(0.01, 0.09),
        "radio.left.loss": draw.uniform(0, 0.1),
        "radio.replay": draw.choice([0.0, 0.2]),
        "tactile.zero_half_width_m": draw.uniform(0.004, 0.008),
        "tactile.false_rate": draw.choice([0.0, 0.01]),
        "control.brake": draw.choice([True, False]),
        "radio.latency_s": draw.uniform(0.01, 0.08),
        "radio.jitter_s": draw.choice([0.0, 0.03]),
        "radio.reorder": draw.choice([True, False]),
        "radio.loss": draw.uniform(0, 0.1),
        "radio.burst_fraction": draw.choice([0.0, 0.05]),
        "radio.duplicate": draw.choice([0.0, 0.1]),
        "radio.corruption": draw.choice([0.0, 0.05]),
        "radio.airtime_s": draw.choice([0.0, 0.002]),
        "radio.outages": [{"sender": draw.choice(sides), "start_s": 1.0, "end_s": 1.3}],
        "radio.script": [{"sender": "right", "message": 1, "effect": "delayed", "delay_s": 0.2}],
        "faults.script": [
            {"kind": "stuck", "robot": "left", "at_s": 2.0, "duration_s": 0.4, "stuck_at": "+"},
            {"kind": "intermittent", "robot": "right", "at_s": 1.0, "duration_s": 1.0,
             "probability": 0.2},
            {"kind": "clock-rate", "robot": "left", "at_s": 3.0, "duration_s": 2.0, "ppm": 9000.0},
            {"kind": "clock-jump", "robot": "right", "at_s": 4.0, "duration_s": 0.3},
            {"kind": "reboot", "robot": "right", "at_s": 5.0, "duration_s": 0.4,
             "limp_deg": draw.uniform(8, 14)},
        ],
        "faults.random_reboots": draw.choice([0, 1]),
        "bumps.script": [{"robot": "left", "at_m": 0.1, "shift_m": draw.uniform(-0.01, 0.01)}],
        "bumps.pushes": [
            {"robot": draw.choice(sides), "at_s": 0.7, "duration_s": 0.2, "speed_m_s": 0.03}
        ],
        "bumps.rate_per_m": draw.choice([0.0, 3.0]),
        "start.left_m": draw.uniform(-0.01, 0.01),
        "task.distance_m": 0.4,
        "task.slope_deg": draw.uniform(-2, 2),
        "task.direction": draw.choice(["forward", "backward"]),
        "task.inertia": draw.choice([True, False]),
    }  # fmt: skip


def test_random_scenes_with_every_key(open_page: Open) -> None:
    draw = random.Random(7)
    page = open_page("#carry?t=1")
    outcomes = set()
    for seed in range(18):
        keys = random_keys(draw)
        controller = ("distributed", "centralized", "silent", "shared-sign")[seed % 4]
        go(page, hash_of("carry", {"controller": controller, "seed": seed}, **keys))
        carried = pb.carry("paper", controller, seed=seed, overrides=keys, record=False)
        expect_hash(page, carried)
        outcomes.add(carried.outcome)
    assert "delivered" in outcomes


def test_the_command_gives_the_same_hash(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    run = runner(capsys)
    page = open_page("#carry?t=2.5&controller=resilient&seed=11")
    page.locator("#fork").click()
    page.locator("#nudge-right").click()
    page.locator("#push-left").click()
    page.locator("#switch-right").click()
    words = command_of(page)
    assert {"--fork", "--set"} < set(words)
    found = run_json(run, words)
    assert found["seed"] == 11
    expect(page.locator("#hash")).to_have_text(found["trace_hash"])
