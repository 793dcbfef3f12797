# SPDX-License-Identifier: Apache-2.0
"""Scene files on the page: what the package refuses, the page refuses, and in one line."""

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from palmbots.errors import PalmbotsError
from scene_lists import of_scenes
from site_pages import ROOT, Open, assert_reproduced, command_of, hash_of

REFUSALS = ROOT / "tests" / "laws" / "refusals" / "scenes.toml"
BAD = [
    (text, re.sub(r"\{(\w+)\}", lambda found: of_scenes().get(found[1], found[0]), line))
    for text, line in tomllib.loads(REFUSALS.read_text("utf-8"))["scenes"]["rows"]
]
ON_FLOOR = ('[task]\nfrom = "floor"', '[task]\nto = "floor"')  # for the page only
RECORDED = ('[robot.left]\nerror_trace = "e.csv"', '[radio]\ntrace = "t.csv"')
MORE_BAD = (
    *ON_FLOOR, *RECORDED,
    "[palm]\nlength_m = 150", '[palm]\nlength_m = "15 cm"', "[palm]\nfriction = true",
    "[radio]\nloss = nan", "[robot.left]\nspeed_m_s = -inf", "[palm.right]\nlength_m = -0.15",
    "[palm]\nsteep_deg = 80", '[task]\ndirection = "left"', "[task]\ninertia = 1",
    '[task.path]\nkind = "s"', "[task.path]\nradius_m = 3", '[control]\nstart = "never"',
    '[faults]\nscript = [{kind = "bogus", robot = "left", at_s = 1, duration_s = 1}]',
    '[faults]\nscript = [{kind = "stuck", robot = "left", at_s = 1, duration_s = 1}]',
    '[faults]\nscript = [{kind = "freeze", robot = "left", at_s = 1, duration_s = 1, ppm = 5}]',
    '[faults]\nscript = [{kind = "station-down", robot = "left", at_s = 1, duration_s = 1}]',
    '[faults]\nscript = [{kind = "freeze", robot = "left", duration_s = 1}]',
    "[faults]\nrandom_reboots = 9", "[object]\ncom_m = [9, 0.04]",
    "[palm]\nfriction = 0.3\nfriction_angle_deg = 20",
    "[palm.left]\nfriction = 0.3\nfriction_angle_deg = 20", "[palm]\nfriction_angle_deg = 80",
    '[radio]\nscript = [{sender = "station", message = 1, effect = "lost"}]',
    '[radio]\nscript = [{sender = "left", message = 1, effect = "delayed"}]',
    '[radio]\noutages = [{sender = "left", start_s = 2, end_s = 1}]',
    "[mujoco]\nridges = [{at_m = 1, height_m = 0.02, length_m = 0.03}]",
    "[floor]\nwalls = [{at_m = 1}]", "[floor]\nstands = [{from_m = 1, to_m = 2, height_m = 0.1}]",
    "[object]\nvertices_m = [[0, 0], [9, 0], [9, 9], [0, 9]]",
    "[object]\nvertices_m = [[0, 0.1], [0.1, 0], [0.2, 0.3]]",
    'object = "moon"', "[task]\ndistance_m = 50", "[task]\ntimeout_s = 1300",
)  # fmt: skip
TOO_LONG = ("[task]\ndistance_m = 50", "[task]\ntimeout_s = 1300")  # for the page only
CURVED = '[task.path]\nkind = "s"'


def give(page: Page, folder: Path, text: str) -> None:
    scene = folder / "own.toml"
    scene.write_text(text + "\n", "utf-8")
    page.locator("#scene-file").set_input_files(scene)


def test_every_bad_scene_is_refused_in_one_line(open_page: Open, tmp_path: Path) -> None:
    page = open_page("#carry?t=1")
    before = page.locator("#hash").inner_text()
    for text in (*(scene for scene, _ in BAD), *MORE_BAD):
        give(page, tmp_path, text)
        line = page.locator(".failure").inner_text()
        assert line.startswith("own.toml: "), text
        assert "\n" not in line.removesuffix("\n×").removesuffix("×").strip(), text
        assert "allowed:" in line or "this table requires" in line, (text, line)
        page.get_by_role("button", name="close").click()
        expect(page.locator(".failure")).to_have_count(0)
        assert page.locator("#hash").inner_text() == before
        if text not in (
            *TOO_LONG,
            *ON_FLOOR,
            CURVED,
        ):  # the list is one of scenes that the package refuses
            with pytest.raises(PalmbotsError):
                pb.carry(tomllib.loads(text))


MORE_LINES = (
    "[radio]\nloss = 1979-05-27", "[radio]\nloss = 07:32:00",
    "[radio]\nloss = 1979-05-27T07:32:00Z",
    '[radio]\nscript = [{sender = "station", message = 1, effect = "lost"}]',
    "[object]\nbox_m = [0.4, 0.2]\nvertices_m = [[0, 0], [1, 0], [1, 1]]",
    "[object]\nbox_m = [0.4]", "[object]\nbox_m = [0.4, 20]", "[object]\nbox_m = 3",
    "[mujoco]\nridges = [{at_m = 1, height_m = 0.03, length_m = 0.05}]",
    "[mujoco]\nridges = [{at_m = 1, height_m = 0.012345678, length_m = 0.02}]",
    "[mujoco]\nridges = [{at_m = 1, height_m = 0.03}]",
    "[mujoco]\nridges = 3",
    "[floor]\nwalls = [{at_m = 0}]", "[floor]\nwalls = [{at_m = 1}, {at_m = 2, height_m = 1}]",
    "[floor]\nstands = [{from_m = 2, to_m = 1, height_m = 0.1}]",
)  # fmt: skip


def spelt(line: str) -> str:
    """The line with numbers as JavaScript spells them, without what may be cut off at its value."""
    line = re.sub(r"(\d)\.0\b", r"\1", line)
    return re.sub(r"e-0(\d)", r"e-\1", re.sub(r": .*…", ": …", line))


def test_the_line_is_that_of_the_package(open_page: Open, tmp_path: Path) -> None:
    """Where, what and what is allowed. Only for an unknown key the page suggests none."""
    page = open_page("#carry?t=1")
    lines = dict(BAD)
    for text in MORE_LINES:
        with pytest.raises(PalmbotsError) as error:
            pb.load_scene(tomllib.loads(text))
        lines[text] = str(error.value).removeprefix("scene: ")
    for scene, line in lines.items():
        give(page, tmp_path, scene)
        shown = page.locator(".failure").inner_text().removeprefix("own.toml: ").split("\n")[0]
        if "unknown key" in line:
            shown, line = shown.split(";")[0], line.split(";")[0]
        assert spelt(shown) == spelt(line)
        page.get_by_role("button", name="close").click()
        expect(page.locator(".failure")).to_have_count(0)


def test_a_box_in_an_address_is_carried(open_page: Open) -> None:
    """It replaces the outline of the built-in scene and decides contacts and centre of mass."""
    page = open_page(hash_of("mechanics", {}, object__box_m=[0.3, 0.2]))
    expected = pb.carry(overrides={"object.box_m": [0.3, 0.2]}).trace_hash
    expect(page.locator("#hash")).to_have_text(expected)
    page.locator("#handle-com").focus()
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#hash")).not_to_have_text(expected)


def test_a_curved_path_names_the_command_that_can(open_page: Open, tmp_path: Path) -> None:
    page = open_page("#carry?t=1")
    give(page, tmp_path, CURVED)
    expect(page.locator(".failure")).to_contain_text("palmbots carry scene.toml --world mujoco")


@pytest.mark.parametrize(
    "text",
    [
        "[palm]\nfriction_angle_deg = 20.3",
        "[palm.left]\nfriction_angle_deg = 24.7",
        "[palm]\nfriction_angle_deg = 18\n[palm.right]\nfriction = 0.41",
        "[palm]\nfriction = 0.28\n[palm.right]\nfriction_angle_deg = 25",
    ],
)
def test_a_friction_angle_is_carried(
    open_page: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    page = open_page("#carry?t=1")
    give(page, tmp_path, text)
    expected = pb.carry(tomllib.loads(text)).trace_hash
    assert expected != pb.carry().trace_hash
    expect(page.locator("#hash")).to_have_text(expected)
    assert_reproduced(page, capsys)


def test_a_long_carry_is_the_same_or_refused(open_page: Open, tmp_path: Path) -> None:
    page = open_page("#carry?t=1")
    give(page, tmp_path, "[task]\ndistance_m = 35")
    carried = pb.carry(overrides={"task.distance_m": 35.0}, record=False)
    expect(page.locator("#hash")).to_have_text(carried.trace_hash)
    give(page, tmp_path, "[task]\ndistance_m = 50")
    expect(page.locator(".failure")).to_contain_text(
        "task.distance_m: 50 leads to a time limit of 1666.67 s, but the page carries for at most "
        "1200 s; allowed: about 36 m here"
    )


BAD_KEYS: list[dict[str, Any]] = [
    {"task.distance_m": 50}, {"task.path.kind": "s"}, {"object.com_m": [9, 0.04]},
    {"palm.steep_deg": "steep"}, {"palm": 3}, {"faults.script": [{"kind": "bogus"}]},
    {"palm.friction": 0.3, "palm.friction_angle_deg": 20},
]  # fmt: skip


@pytest.mark.parametrize("keys", BAD_KEYS)
@pytest.mark.parametrize("view", ["carry", "compare"])
def test_a_bad_address_shows_no_hash(open_page: Open, view: str, keys: dict[str, Any]) -> None:
    page = open_page(hash_of(view, {}, **keys))
    expect(page.locator("main")).to_contain_text("This scene cannot be carried: ")
    expect(page.locator("#hash")).to_have_count(0)


ONE_SIDED = "[palm.left]\nfriction = 0.45\n[robot.left]\nnoise_m_s = 0.004\n"


def test_controls_of_a_one_sided_scene(
    open_page: Open, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """They show what both sides have, and what they set is carried on both."""
    page = open_page("#carry?t=1")
    give(page, tmp_path, ONE_SIDED)
    hash_before = pb.carry(tomllib.loads(ONE_SIDED)).trace_hash
    expect(page.locator("#hash")).to_have_text(hash_before)
    noise = page.locator("[data-key='robot.noise_m_s']")
    expect(page.locator("label.slider", has=noise).locator(".value")).to_have_text("4 / 10 mm/s")
    noise.fill("7")
    expect(page.locator("label.slider", has=noise).locator(".value")).to_have_text("7 mm/s")
    keys = {"palm.left.friction": 0.45, "robot.noise_m_s": 0.007}
    expect(page.locator("#hash")).to_have_text(pb.carry(overrides=keys).trace_hash)
    assert_reproduced(page, capsys)
    page.get_by_role("link", name="Mechanics").click()
    output = page.locator("label.slider", has=page.locator("#friction")).locator(".value")
    expect(output).to_have_text("0.45 / 0.30")
    page.locator("#friction").fill("0.37")
    expect(output).to_have_text("0.37")
    keys = {"palm.friction": 0.37, "robot.noise_m_s": 0.007}
    expect(page.locator("#hash")).to_have_text(pb.carry(overrides=keys).trace_hash)


@pytest.mark.parametrize(("handle", "key"), [("cone", "ArrowLeft"), ("cone-right", "ArrowRight")])
def test_both_friction_cones_have_a_handle(open_page: Open, handle: str, key: str) -> None:
    page = open_page(hash_of("mechanics", {}, palm__left__friction=0.2, palm__right__friction=0.5))
    output = page.locator("label.slider", has=page.locator("#friction")).locator(".value")
    expect(output).to_have_text("0.20 / 0.50")
    before = {"cone": 0.2, "cone-right": 0.5}[handle]
    page.locator(f"#handle-{handle}").focus()
    page.keyboard.press(key)
    expect(output).not_to_contain_text("/")
    shown = float(output.inner_text())
    assert shown != before
    assert abs(shown - before) < 0.1
    keys = [w for w in command_of(page) if "friction" in w]
    assert len(keys) == 1
    assert keys[0].startswith("palm.friction=")
