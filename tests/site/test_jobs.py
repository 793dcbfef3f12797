# SPDX-License-Identifier: Apache-2.0
"""Jobs on the floor: the page carries them as at home, or refuses them as at home."""

import sys
from pathlib import Path

import pytest
from playwright.sync_api import expect

import palmbots as pb
from palmbots.control.registry import shipped_names
from palmbots.errors import SceneError
from palmbots.mechanics.lifting import lifting
from palmbots.simulation.floor_job import MEANINGS, STAGES
from site_pages import ROOT, Open, assert_reproduced, go, hash_of

sys.path.insert(0, str(ROOT / "scripts"))
from site_tables import FREE_IN_JOBS, HEELS_M

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


def test_the_analysis_does_not_depend_on_what_is_free() -> None:
    usual = lifting(pb.load_scene("lift"))
    assert usual is not None
    assert set(FREE_IN_JOBS) == set(FREE)
    for key, value in FREE.items():
        found = lifting(pb.load_scene("lift", {key: value}))
        assert found is not None
        assert (found.refusals, found.warnings) == (usual.refusals, usual.warnings), key


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
