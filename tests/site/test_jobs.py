# SPDX-License-Identifier: Apache-2.0
"""Jobs on the floor: the page carries them as at home, or refuses them as at home."""

import re
import sys
from pathlib import Path

import pytest
from playwright.sync_api import expect

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.errors import SceneError
from palmbots.mechanics.lifting import check_lift
from palmbots.simulation.floor_job import MEANINGS, STAGES
from site_pages import ROOT, Open, assert_reproduced, go, hash_of

sys.path.insert(0, str(ROOT / "scripts"))
from site_tables import FREE_IN_JOBS, HEELS_M, free_in_job

JOBS = ("lift", "stand", "lone", "handover")

# A value of each key on which the analysis does not depend.
FREE: dict[str, object] = {
    "robot.noise_m_s": 0.03,
    "radio.loss": 0.3,
    "radio.outages": [{"sender": "left", "start_s": 8, "end_s": 9}],
    "faults.script": [{"kind": "reboot", "robot": "left", "at_s": 9.5, "duration_s": 2}],
    "bumps.pushes": [{"robot": "right", "at_s": 5, "duration_s": 0.3, "speed_m_s": 0.04}],
    "task.dock": "one-first",
    "task.distance_m": 0.4,
}


def test_same_bits(open_page: Open) -> None:
    """Each key that the page may change, with another controller and seed."""
    page = open_page("#carry?t=1")
    alone: list[dict[str, object]] = [{key: value} for key, value in FREE.items()]
    for k, changes in enumerate([{}, {"object": "carton", "palm.heel_m": 0.002}, *alone]):
        controller = shipped_names()[k % len(shipped_names())]
        carried = pb.carry("lift", controller, seed=k, overrides=changes, record=False)
        place = hash_of("carry", {"scene": "lift", "controller": controller, "seed": k}, **changes)
        go(page, place)
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)


def test_rows_of_ones_own(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    page = open_page(hash_of("carry", {"scene": "lift", "controller": "own-rows", "t": 1}))
    with page.expect_download() as found:
        page.get_by_role("button", name="save rows.toml").click()
    found.value.save_as(tmp_path / "rows.toml")
    monkeypatch.chdir(tmp_path)
    assert_reproduced(page, capsys)


@pytest.mark.parametrize("scene", JOBS)
def test_the_analysis_does_not_depend_on_what_is_free(scene: str) -> None:
    usual = pb.load_scene(scene)
    assert set(FREE_IN_JOBS) == set(FREE)
    for key in free_in_job(usual):
        assert check_lift(pb.load_scene(scene, {key: FREE[key]})) == check_lift(usual), key


@pytest.mark.parametrize("scene", JOBS[1:])
def test_jobs_on_stands_and_on_one_palm(open_page: Open, scene: str) -> None:
    """The same bits; the status names the phases of both robots, or that one stands aside."""
    for k, changes in enumerate(({}, {"robot.noise_m_s": 0.03}, {"palm.heel_m": 0.002})):
        carried = pb.carry(scene, "shared-sign", seed=k, overrides=changes)
        place = hash_of(
            "carry", {"scene": scene, "controller": "shared-sign", "seed": k}, **changes
        )
        page = open_page(place)
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)
        assert carried.floor_job is not None
        page.locator("#scrub").fill("10")
        for side in ("left", "right"):
            at = [p for p in carried.floor_job.phases if p.robot == side and p.start_s <= 10]
            words = MEANINGS[at[-1].phase] if at else "stands aside"
            expect(page.locator(f".status .{side}-text")).to_contain_text(words)
            expect(page.locator(f"#push-{side}")).to_have_count(1 if at else 0)


@pytest.mark.parametrize("scene", JOBS)
def test_the_page_offers_what_it_can_check(open_page: Open, scene: str) -> None:
    page = open_page(hash_of("carry", {"scene": scene}))
    expect(page.locator("#hash")).to_be_visible()
    for key in FREE_IN_JOBS:
        shown = page.locator(f"[data-key='{key}']").count()
        assert shown == 0 or key in free_in_job(pb.load_scene(scene))
    assert page.locator("[data-key='robot.noise_m_s']").count() == 1


def test_stages_of_a_job_in_their_order(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"scene": "handover", "t": 5}))
    stages = ["dock", "raise", "carry", "lower", "leave"]
    expect(page.locator(".stages li button")).to_have_text(
        [re.compile(f"^{one}") for one in stages]
    )


def test_refused_as_at_home(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"scene": "lift"}))
    heels = page.locator("[data-key='palm.heel_m']")
    for k, heel in enumerate(HEELS_M):
        heels.select_option(str(k))
        try:
            carried = pb.carry("lift", overrides={"palm.heel_m": heel}, record=False)
        except SceneError as error:
            expect(page.locator(".refusal")).to_contain_text(str(error))
        else:
            expect(page.locator("#hash")).to_have_text(carried.trace_hash)
            expect(page.locator(".warnings li")).to_have_text(
                [f"warning: {line}" for line in carried.warnings]
            )


@pytest.mark.parametrize(
    ("scene", "keys", "line"),
    [
        ("lift", {"object__mass_kg": 20}, "object.mass_kg: 20 may make the job"),
        ("paper", {"task__from": "floor"}, 'task.from: "floor" may make the job'),
        ("lone", {"task__dock": "together"}, 'task.dock: "together" may make the job'),
        ("stand", {"task__distance_m": 1}, "task.distance_m: 1 may make the job"),
    ],
)
def test_what_the_page_cannot_check(
    open_page: Open, scene: str, keys: dict[str, object], line: str
) -> None:
    page = open_page(hash_of("carry", {"scene": scene}, **keys))
    expect(page.locator(".refusal")).to_contain_text(line)
    expect(page.locator(".refusal")).to_contain_text("on your computer")


def test_stages_and_phases_as_they_happen(open_page: Open) -> None:
    """Below the picture, in the status, and in what the player says."""
    job = pb.carry("lift").floor_job
    assert job is not None
    page = open_page(hash_of("carry", {"scene": "lift"}))
    for time in (0.5, 4.0, 10.0, 20.0, 39.0, 43.0):
        page.locator("#scrub").fill(str(time))
        for side in ("left", "right"):
            phase = next(p for p in job.phases if p.robot == side and p.end_s > time)
            stage = page.locator(f".stages li:has([title='{side} robot'])")
            expect(stage).to_contain_text(STAGES[phase.phase])
            expect(stage).to_have_attribute("aria-current", "step")
            expect(page.locator(f".status .{side}-text")).to_contain_text(MEANINGS[phase.phase])
            said = page.locator("#scrub").get_attribute("aria-valuetext")
            assert f"{side}: {phase.phase.replace('_', ' ')}" in said
