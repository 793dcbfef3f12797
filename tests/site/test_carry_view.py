# SPDX-License-Identifier: Apache-2.0
"""The view Carry: playing, scrubbing, forking, disturbing, saving, and the URL."""

import io
import math
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageChops
from playwright.sync_api import Page, expect

import palmbots as pb
from palmbots.errors import SceneError
from site_pages import (
    Open,
    assert_reproduced,
    command_of,
    go,
    hash_of,
    overrides_of,
    pictures,
    seconds,
)

FIGURE8 = {"scene": "figure8"}
BUMP: dict[str, object] = {
    "robot__noise_m_s": 0.0,
    "bumps__script": [{"robot": "left", "at_s": 1.0, "shift_m": 0.03}],
}


def frames(page: Page, count: int) -> None:
    """Let the browser draw this many frames."""
    page.evaluate(
        "n => new Promise(done => { const f = () => (n-- > 0 ? requestAnimationFrame(f) : done());"
        " f(); })",
        count,
    )


def test_it_moves_without_a_click_and_pauses_off_screen(open_page: Open) -> None:
    page = open_page(height=420, moves=True)
    page.wait_for_function("() => parseFloat(document.querySelector('.time').innerText) > 0.2")
    page.evaluate("window.scrollTo(0, document.body.scrollHeight)")
    frames(page, 12)
    before = seconds(page)
    frames(page, 12)
    assert seconds(page) == before
    page.evaluate("window.scrollTo(0, 0)")
    page.wait_for_function(
        f"() => parseFloat(document.querySelector('.time').innerText) > {before}"
    )


def test_it_stands_still_where_motion_is_unwelcome(open_page: Open) -> None:
    page = open_page()
    frames(page, 10)
    assert seconds(page) == 0
    page.locator("#play").click()
    page.wait_for_function("() => parseFloat(document.querySelector('.time').innerText) > 0.1")


def test_reset_pauses(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"controller": "silent"}), moves=True)
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.locator("#reset").click()
    expect(page.locator("#play")).to_have_attribute("aria-label", "play")
    assert seconds(page) == 0


def test_no_robot_assists_before_it_is_asked(open_page: Open) -> None:
    """A program of `resilient` begins as if it had just assisted."""
    page = open_page(hash_of("carry", {"controller": "resilient"}))
    expect(page.locator(".left-text")).to_have_text("left p = 0.0 mm")
    expect(page.locator(".right-text")).to_have_text("right p = 0.0 mm")


def test_a_case_of_a_station_is_said_to_have_begun_with_its_condition(open_page: Open) -> None:
    """The contacts may be elsewhere by then."""
    page = open_page(hash_of("carry", {"t": 1.2, "controller": "centralized"}, **BUMP))
    expect(page.locator(".left-text")).to_contain_text("(1) began with p_L\u00a0>\u00a00")


def test_the_readouts_have_room_beside_a_long_outcome(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"t": 1000}, task__slope_deg=8.0), width=1366, height=768)
    outcome = page.locator(".status strong").bounding_box()
    expect(page.locator(".status strong")).to_contain_text("dropped after")
    for side in ("left", "right"):
        box = page.locator(f".{side}-text").bounding_box()
        assert box is not None and outcome is not None
        assert box["y"] >= outcome["y"] + outcome["height"] - 1
        assert box["width"] > 250


def test_play_pause_step_scrub_and_speed(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"t": 2}))
    assert seconds(page) == 2
    page.get_by_role("button", name="one step on").click()
    assert seconds(page) == 2.01
    page.get_by_role("button", name="one step back").click()
    page.get_by_role("button", name="one step back").click()
    assert seconds(page) == 1.99
    page.locator("#scrub").fill("5")
    assert seconds(page) == 5
    page.locator("#scrub").fill("1.5")  # backwards
    assert seconds(page) == 1.5
    page.locator("#speed").select_option("50")
    page.locator("#play").click()
    expect(page.locator(".status strong")).to_contain_text("delivered")
    expect(page.locator("#play")).to_have_attribute("aria-label", "play")


def test_the_speeds_of_the_player(open_page: Open) -> None:
    """By a clock that the test turns: real frames would depend on the machine."""
    page = open_page(hash_of("carry", {"t": 1}))
    options = page.locator("#speed option")
    speeds = [float(text.removesuffix("×")) for text in options.all_inner_texts()]
    assert speeds == [0.25, 0.5, 1, 2, 5, 10, 25, 50]
    page.clock.install(time=0)
    page.clock.pause_at(1000)
    for speed in speeds:
        page.locator("#scrub").fill("1")
        page.locator("#speed").select_option(f"{speed:g}×")
        page.locator("#play").click()
        page.clock.run_for(416)  # frames of 16 ms; the first one has nothing before it
        assert seconds(page) - 1 == pytest.approx(0.4 * speed, abs=0.017 * speed + 0.01)


def test_keys(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"t": 1}))
    page.locator("h1").click()
    page.keyboard.press(".")
    assert seconds(page) == 1.01
    page.keyboard.press(",")
    assert seconds(page) == 1
    page.locator("#contacts-chart").focus()
    page.keyboard.press("Shift+ArrowRight")
    assert seconds(page) == 1.1
    page.keyboard.press("Home")
    assert seconds(page) == 0
    page.locator("h1").click()
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")


def test_a_click_on_a_chart_moves_the_cursor(open_page: Open) -> None:
    page = open_page(hash_of("carry", {**FIGURE8, "t": 0.1}))
    box = page.locator("#contacts-chart").bounding_box()
    assert box is not None
    share = (box["width"] / 2 - 46) / (box["width"] - 56)
    page.locator("#contacts-chart").click(position={"x": box["width"] / 2, "y": 40})
    assert seconds(page) == pytest.approx(share * pb.carry("figure8").time_s, abs=0.02)


def test_forks(open_page: Open, capsys: pytest.CaptureFixture[str]) -> None:
    page = open_page(hash_of("carry", {"t": 3, "seed": 4}))
    first = page.locator("#hash").inner_text()
    page.locator("#fork").click()
    assert command_of(page)[-2:] == ["--fork", "3:5"]
    second = page.locator("#hash").inner_text()
    assert first != second
    page.locator("#fork").click()  # another future from the same moment
    assert command_of(page)[-2:] == ["--fork", "3:6"]
    page.locator("#scrub").fill("6")
    page.locator("#fork").click()
    assert command_of(page)[-4:] == ["--fork", "3:6", "--fork", "6:7"]
    assert_reproduced(page, capsys)
    page.locator("#undo").click()
    expect(page.locator("#hash")).to_have_text(first)


@pytest.mark.parametrize("width", [1200, 700])
def test_one_cursor_links_the_charts(open_page: Open, width: int) -> None:
    """At the time of the player in each of them, from the first picture on."""
    page = open_page(hash_of("carry", {"t": 2.5}), width=width)
    cursor = page.locator(".cursor").bounding_box()
    assert cursor is not None
    for name in ("contacts-chart", "palms-chart", "sequence-chart"):
        box = page.locator(f"#{name}").bounding_box()
        assert box is not None
        shown_s = box["width"] / 85  # a second has 85 pixels
        expected = box["x"] + 46 + (box["width"] - 56) * 2.5 / shown_s
        assert cursor["x"] == pytest.approx(expected, abs=2)
        assert cursor["y"] <= box["y"]
        assert cursor["y"] + cursor["height"] >= box["y"] + box["height"] - 1


def drag(page: Page, x: float, y: float, by: float) -> None:
    box = page.locator("#stage").bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + x * box["width"] + by / 2, box["y"] + y * box["height"])
    page.mouse.move(box["x"] + x * box["width"] + by, box["y"] + y * box["height"])
    page.mouse.up()


def test_dragging_the_object_shifts_both_contacts(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    page = open_page(hash_of("carry", {"t": 2}))
    drag(page, 0.5, 0.2, 15)
    left, right = overrides_of(page)["bumps.script"]
    assert (left["robot"], right["robot"], left["at_s"]) == ("left", "right", 2)
    assert right["shift_m"] == -left["shift_m"] > 0
    assert_reproduced(page, capsys)


def test_dragging_a_robot_pushes_it(open_page: Open, capsys: pytest.CaptureFixture[str]) -> None:
    page = open_page(hash_of("carry", {"t": 2}))
    drag(page, 0.28, 0.75, -15)  # the left robot, outward
    (push,) = overrides_of(page)["bumps.pushes"]
    assert (push["robot"], push["at_s"]) == ("left", 2)
    assert push["speed_m_s"] > 0
    assert_reproduced(page, capsys)


def test_robots_are_switched_off_and_on(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    page = open_page(hash_of("carry", {"t": 2, "controller": "resilient"}))
    page.locator("#switch-left").click()
    expect(page.locator("#switch-left")).to_have_text("left on")
    page.locator("#scrub").fill("20")
    expect(page.locator("#switch-left")).to_have_text("left on")  # until it is switched on again
    assert_reproduced(page, capsys)
    page.locator("#scrub").fill("2.5")
    page.locator("#switch-left").click()
    (fault,) = overrides_of(page)["faults.script"]
    assert fault == {"kind": "reboot", "robot": "left", "at_s": 2, "duration_s": 0.5}
    assert_reproduced(page, capsys)


def test_a_moment_is_taken_apart(open_page: Open) -> None:
    page = open_page(hash_of("carry", {**FIGURE8, "t": 4.7}))
    page.locator("#examine").click()
    expect(page.locator("h1")).to_have_text("Which contact slides?")
    trace = pb.carry("figure8").trace
    assert trace is not None
    at = trace.sel(time=4.7, method="nearest")
    p, theta = at.contact.values, at.palm.values
    assert abs(p[1] - p[0]) > 0.005  # the moment is no trivial one
    found = pb.contact_modes(
        "figure8", p_left_m=p[0], p_right_m=p[1], theta_left_deg=math.degrees(theta[0]),
        theta_right_deg=math.degrees(theta[1]),
    )  # fmt: skip
    for what, mode in (("Closing", found.closing), ("Opening", found.opening)):
        assert mode is not None
        expect(page.get_by_role("heading", name=f"{what}:")).to_contain_text("-".join(mode))
    for side, place in (("left", 0), ("right", 1)):
        shown = page.locator(f"label:has(#p-{side}) .value").inner_text().removesuffix(" mm")
        assert float(shown.replace("−", "-")) == pytest.approx(1000 * p[place], abs=0.06)


def test_the_url_holds_the_whole_state(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"t": 2, "seed": 3}))
    page.locator("#fork").click()
    page.locator("#nudge-left").click()
    page.locator("[data-key='robot.noise_m_s']").fill("17")
    page.locator("#object").select_option("tray")
    page.locator("#speed").select_option("5")
    shown = page.locator("#hash").inner_text()
    page.wait_for_function(
        "() => location.hash.includes('tray') && location.hash.includes('speed=5')"
    )
    again = open_page(page.evaluate("location.hash"))
    expect(again.locator("#hash")).to_have_text(shown)
    assert seconds(again) == 2
    assert again.locator("#speed").input_value() == "5"
    assert command_of(again) == command_of(page)


def test_back_and_forward(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    page.get_by_role("link", name="Mechanics").click()
    expect(page.locator("h1")).to_have_text("Which contact slides?")
    page.go_back()
    expect(page.locator("#stage")).to_be_visible()


def test_friction_cones_change_the_picture(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    before = pictures(page, "stage")
    page.locator("#cones").check()
    assert pictures(page, "stage") != before


def test_a_scene_file_opens(open_page: Open, tmp_path: Path) -> None:
    scene = tmp_path / "own.toml"
    scene.write_text(
        "[object]\nvertices_m = [[0, 0], [0.3, 0], [0.3, 0.1], [0, 0.1]]\n[palm]\nfriction = 0.4\n"
        "[robot.left]\nnoise_m_s = 0.004\n"
    )
    page = open_page("#mechanics")
    page.locator("#scene-file").set_input_files(scene)
    expect(page.locator("#hash")).to_have_text(pb.carry(scene).trace_hash)
    expect(page.locator("#object")).to_have_value("")
    with page.expect_download() as found:
        page.get_by_role("button", name="save scene.toml").click()
    saved = tmp_path / "saved.toml"
    found.value.save_as(saved)
    assert pb.carry(saved).trace_hash == pb.carry(scene).trace_hash
    assert command_of(page)[:2] == ["carry", "scene.toml"]


def test_a_scene_file_is_dropped_on_the_page(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    page.evaluate(
        """() => {
          const data = new DataTransfer();
          data.items.add(new File(['[palm]\\nfriction = 0.35\\n'], 'dropped.toml'));
          document.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true }));
        }"""
    )
    expected = pb.carry(overrides={"palm.friction": 0.35}).trace_hash
    expect(page.locator("#hash")).to_have_text(expected)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[radio]\nlos = 1\n", "radio.los: 1 is the value of an unknown key"),
        ("[radio]\nloss = 3\n", "radio.loss: 3 is too large"),
        ("[radio\n", "bad.toml:"),
        ('[radio]\nloss = "much"\n', "is a string, not a number"),
        ('object = "moon"\n', "is no built-in object"),
    ],
)
def test_a_bad_scene_file_gives_one_line(
    open_page: Open, tmp_path: Path, text: str, words: str
) -> None:
    (tmp_path / "bad.toml").write_text(text)
    page = open_page("#carry?t=1")
    before = page.locator("#hash").inner_text()
    page.locator("#scene-file").set_input_files(tmp_path / "bad.toml")
    expect(page.get_by_role("alert")).to_contain_text(words)
    assert page.locator("#hash").inner_text() == before


def test_a_picture(open_page: Open, tmp_path: Path) -> None:
    page = open_page(hash_of("carry", {**FIGURE8, "t": 5.9, "speed": 2}), width=1366)
    with page.expect_download() as found:
        page.locator("#save-picture").click()
    found.value.save_as(tmp_path / "picture.png")
    picture = Image.open(io.BytesIO((tmp_path / "picture.png").read_bytes())).convert("RGB")
    assert picture.width > 600
    assert len(picture.getcolors(1 << 24) or ()) > 20


def test_a_film_of_the_rest_of_the_carry(open_page: Open, tmp_path: Path) -> None:
    """Also while the drawing is outside the window, where the carry stands still otherwise."""
    page = open_page(hash_of("carry", {**FIGURE8, "t": 5.4, "speed": 0.5}), height=420, moves=True)
    with page.expect_download() as found:
        page.locator("#save-film").click()
    assert page.evaluate("document.getElementById('stage').getBoundingClientRect().bottom") < 0
    film = tmp_path / found.value.suggested_filename
    found.value.save_as(film)
    subprocess.run(
        ["ffmpeg", "-v", "error", "-i", str(film), "-fps_mode", "passthrough",
         str(tmp_path / "frame%04d.png")],
        check=True,
    )  # fmt: skip
    frames = [Image.open(path).convert("RGB") for path in sorted(tmp_path.glob("frame*.png"))]
    assert len(frames) > 3
    # Both palms are steep at the end, and the left one is shallow at the beginning.
    changed = (
        ImageChops.difference(frames[0], frames[-1]).convert("L").point([0] * 61 + [255] * 195)
    )
    assert changed.getbbox() is not None
    assert page.locator(".time").inner_text() == "6.43 s"


def test_a_controller_that_refuses_the_scene_says_why(open_page: Open) -> None:
    """In the words of the package."""
    page = open_page("#carry?t=1")
    for key, value in (
        ("radio.latency_s", 0.5), ("radio.lease_s", 0.1), ("radio.lease_s", 3.0),
        ("radio.beacon_s", 0.005),
    ):  # fmt: skip
        with pytest.raises(SceneError) as refused:
            pb.carry("paper", "resilient", overrides={key: value})
        keys = {key.replace(".", "__"): value}
        go(page, hash_of("carry", {"controller": "resilient"}, **keys))
        said = page.locator(".refusal")
        expect(said).to_have_text(f"resilient refuses this scene: {refused.value}")


def test_the_commands_are_copied(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    page.clock.install(time=0)
    page.clock.pause_at(1000)
    page.get_by_role("button", name="copy", exact=True).click()
    expect(page.get_by_role("button", name="copied")).to_be_visible()
    copied = page.evaluate("navigator.clipboard.readText()")
    assert copied == page.locator(".command").inner_text()
    page.clock.run_for(2000)
    expect(page.get_by_role("button", name="copy", exact=True)).to_be_visible()


def drawn_heights(page: Page) -> list[int]:
    """How many pixels of the first and the last column are drawn: the floor there."""
    (data,) = pictures(page, "stage")
    alpha = np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))[..., 3]
    return [int((alpha[:, x] > 0).sum()) for x in (2, alpha.shape[1] - 3)]


@pytest.mark.parametrize("direction", ["forward", "backward"])
def test_a_slope_is_drawn(open_page: Open, direction: str) -> None:
    """The floor rises in the direction of travel, and what one drags follows the pointer."""
    page = open_page(
        hash_of("carry", {"t": 0.1}, task__slope_deg=8.0, task__direction=direction), width=1366
    )
    low, high = drawn_heights(page)[:: 1 if direction == "forward" else -1]
    width = page.locator("#stage").bounding_box()["width"]
    assert high - low == pytest.approx(math.tan(math.radians(8)) * (width - 5), abs=3)
    go(page, hash_of("mechanics", task__slope_deg=8.0, task__direction=direction))
    com = page.locator("#handle-com")
    before = com.bounding_box()
    com.press("Shift+ArrowRight")  # ten pixels
    page.wait_for_function("location.hash.includes('object.com_m')")
    after = com.bounding_box()
    assert after["x"] - before["x"] == pytest.approx(10, abs=2)
    assert after["y"] - before["y"] == pytest.approx(0, abs=2)


def test_the_table_of_what_ends_a_carry_marks_the_reason(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"controller": "none", "seed": 0}, robot__noise_m_s=0.1))
    page.locator("#ends summary").click()
    table = pb.ends()
    assert page.locator("#ends tbody th").all_inner_texts() == [
        f"{end.name}: {end.meaning}" for end in table.ends
    ]
    for k, end in enumerate(table.ends):
        row = page.locator("#ends tbody tr").nth(k)
        assert row.locator("td").all_inner_texts() == list(end.follows.values())
    carry = pb.carry("paper", "none", seed=0, overrides={"robot.noise_m_s": 0.1}, record=False)
    assert carry.reason is not None
    expect(page.locator("#ends tr[aria-current] th")).to_contain_text(f"{carry.reason}: ")
