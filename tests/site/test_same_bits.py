# SPDX-License-Identifier: Apache-2.0
"""The page computes the same bits as the native core, and its commands reproduce what it shows."""

import random

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from palmbots.control.registry import shipped_names
from palmbots.errors import SceneError
from palmbots.scene.files import built_in_scenes
from random_keys import CARRIED_ROWS, names_in, random_keys
from site_pages import Open, command_of, go, hash_of, run_json


def expect_hash(page: Page, carried: pb.simulation.Carry) -> None:
    expect(page.locator("#hash")).to_have_text(carried.trace_hash)


def on_the_page() -> list[str]:
    """The built-in scenes that the page has: no stands with a gap, no routes, no single palms."""
    tasks = {name: pb.load_scene(name).task for name in built_in_scenes()}
    return [
        name
        for name, task in tasks.items()
        if "stand" not in task.ends
        and not task.route.is_set
        and task.dock not in ("alone", "hand-over")
    ]


def test_every_controller_and_scene(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    for controller in shipped_names():
        for seed, scene in enumerate(on_the_page()):
            try:
                carried = pb.carry(scene, controller, seed=seed, record=False)
            except SceneError:  # a controller that cannot keep its time bounds
                assert (scene, controller) == ("pipe", "resilient")
                continue
            go(page, hash_of("carry", {"scene": scene, "controller": controller, "seed": seed}))
            expect_hash(page, carried)


def test_every_object(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    for seed, name in enumerate(pb.object_names()):
        go(page, hash_of("carry", {"seed": seed}, object=name))
        expect_hash(page, pb.carry(seed=seed, overrides={"object": name}, record=False))


def test_random_scenes_with_every_key(open_page: Open) -> None:
    """The keys are those of the core's table: one that the page forgets changes a hash."""
    draw = random.Random(7)
    page = open_page("#carry?t=1")
    outcomes, given, seed = set(), set(), 0
    while seed < 24 or not given >= CARRIED_ROWS:
        seed += 1
        keys = random_keys(draw)
        controller = shipped_names()[seed % len(shipped_names())]
        try:
            carried = pb.carry("paper", controller, seed=seed, overrides=keys, record=False)
        except SceneError:  # a controller that cannot keep its time bounds
            continue
        go(page, hash_of("carry", {"controller": controller, "seed": seed}, **keys))
        expect_hash(page, carried)
        outcomes.add(carried.outcome)
        given |= set(names_in(keys))
    assert seed < 100
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
