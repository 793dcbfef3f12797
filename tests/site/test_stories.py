# SPDX-License-Identifier: Apache-2.0
"""The view Stories: each part asks, plays and explains."""

import io
import re

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from site_pages import Open, command_of, hash_of, pictures, run_json, seconds

# How each part of each story ends, and the answer that is right, if it asks.
PARTS: list[list[tuple[str, str | None]]] = [
    [("", "The partner's, the left one."), ("delivered", None)],
    [("for an Ack that does not arrive (a message was lost)", "It waits for the Ack, to the end."),
     ("delivered", None)],
    [("dropped", "The box falls."), ("delivered", None)],
    [("210 corrections, no messages", "The box arrives."), ("140 corrections, no messages", None)],
    [("the last correction has not ended", "It continues its correction, to the end."),
     ("delivered", None)],
    [("delivered", "The box arrives."), ("dropped", "The box falls.")],
    [("delivered", "The box arrives."), ("dropped", "The box falls.")],
    [("1 correction, no messages", "The left robot tilts its own palm up and drives closer.")],
    [("delivered", "Follow, once the left heel stops the box."),
     ("delivered", "It waits for the left robot."),
     ("did not get under the object", "They try three times, and stop.")],
]  # fmt: skip
# What a part says or draws only once it has been watched.
OUTCOME = ".after, .ending strong, .right-answer"


def watch(page: Page) -> None:
    """Answer the question, and go to the end."""
    page.locator(".task input").first.check()
    page.locator("#scrub").fill("1000")


@pytest.mark.parametrize("number", range(1, len(PARTS) + 1))
def test_each_part_asks_then_plays_then_explains(
    open_page: Open, capsys: pytest.CaptureFixture[str], number: int
) -> None:
    page = open_page(hash_of("stories", {"v.story": number}))
    title = page.locator(".chapters button").nth(number - 1).inner_text()
    expect(page.locator("h1")).to_have_text(title)
    seen = []
    for k, (end, right) in enumerate(PARTS[number - 1]):
        if k > 0:
            page.locator(".act").click()
        expect(page.locator(OUTCOME)).to_have_count(0)
        expect(page.locator(".future")).to_have_count(1)
        if right is not None:
            page.locator(".task input").first.check()
            expect(page.locator(OUTCOME)).to_have_count(0)
        found = run_json(runner(capsys), command_of(page))
        expect(page.locator("#hash")).to_have_text(found["trace_hash"])
        page.locator("#scrub").fill("1000")
        expect(page.locator(".ending")).to_contain_text(end)
        expect(page.locator(".after")).not_to_be_empty()
        expect(page.locator(".future")).to_have_count(0)
        if right is not None:
            expect(page.locator(".right-answer")).to_contain_text(right)
        if number in (2, 5) and k == 1:  # now nothing is wrong
            expect(page.locator(".ending")).not_to_contain_text(re.compile("waited|not ended"))
            expect(page.locator(".ending .good")).to_be_visible()
        seen.append((page.locator("#hash").inner_text(), page.locator("#tally").inner_text()))
    if number > 1:
        assert len({trace for trace, _ in seen}) == len(seen)
    if number == 4:  # the numbers are those of the carry, and the contacts move further
        for noise, (_, shown) in zip((0.01, 0.02), seen, strict=True):
            carried = pb.carry("paper", "silent", seed=3, overrides={"robot.noise_m_s": noise})
            assert shown.endswith(
                f"{carried.correction_count} corrections, no messages, contacts up to "
                f"{1000 * max(carried.contact_peak_m.values()):.0f} mm from p = 0"
            )


def test_a_story_waits_for_the_answer_and_plays_then(open_page: Open) -> None:
    """Also the picture shows no correction before. The first story stops where it explains."""
    page = open_page(hash_of("stories", {"v.story": 1}), moves=True)
    play = page.locator("#play")
    expect(play).to_have_attribute("aria-label", "play")
    assert seconds(page) == 0.4
    page.locator(".task input").last.check()
    expect(page.locator(".after")).to_contain_text("TiltUp and Ack")
    assert seconds(page) == 0.7
    expect(play).to_have_attribute("aria-label", "play")
    page.locator(".act").click()
    expect(play).to_have_attribute("aria-label", "pause")


def test_each_story_has_its_own_speed(open_page: Open) -> None:
    page = open_page(hash_of("stories", {"v.story": 4}))
    for number, speed in ((4, "5"), (8, "1"), (3, "2")):
        page.locator(".chapters button").nth(number - 1).click()
        expect(page.locator("#speed")).to_have_value(speed)
        page.locator("#speed").select_option("50")


def test_the_story_to_predict_is_as_it_says() -> None:
    carried = pb.carry("paper", overrides={
        "robot.noise_m_s": 0.0, "task.distance_m": 0.3,
        "bumps.script": [{"robot": "left", "at_s": 0.5, "shift_m": -0.03}],
    })  # fmt: skip
    assert [(c.robot, c.case) for c in carried.corrections] == [("left", "d")]


def test_a_reboot_is_as_the_story_says() -> None:
    """With the paper's algorithm both robots correct to the end; with leases they finish."""
    overrides = {
        "robot.noise_m_s": 0.0, "task.distance_m": 0.5,
        "bumps.script": [{"robot": "left", "at_s": 0.4, "shift_m": 0.04},
                         {"robot": "right", "at_s": 0.6, "shift_m": -0.02}],
        "faults.script": [{"kind": "reboot", "robot": "right", "at_s": 0.8, "duration_s": 0.02}],
    }  # fmt: skip
    for controller, is_endless in (("distributed", True), ("resilient", False)):
        carried = pb.carry("paper", controller, overrides=overrides)
        last = max(correction.end_s for correction in carried.corrections)
        assert (last == carried.time_s) == is_endless
        assert carried.trace is not None
        is_off_centre = bool((abs(carried.trace.contact[-1]) > 0.005).any())
        assert is_off_centre == is_endless


def test_the_texts_of_the_stories_are_true() -> None:
    bias = {"robot.noise_m_s": 0.0, "robot.right.bias_m_s": 0.008}
    assert pb.carry("paper", "none", overrides=bias).outcome == "dropped"
    assert pb.carry("paper", "distributed", overrides=bias).outcome == "delivered"
    assert pb.carry("paper", overrides={"task.slope_deg": 4.0}).outcome == "delivered"
    paper = pb.analyze("paper")
    assert paper.max_slope_deg is not None and round(paper.max_slope_deg, 1) == 4.5
    assert paper.com_x_m is not None
    assert [round(1000 * end, 1) for end in paper.com_x_m] == [108.5, 141.5]
    # With the right palm shallow, the left contact should stick when the robots close in.
    moved = pb.contact_modes(
        p_left_m=0.0, p_right_m=-0.02, theta_left_deg=15, theta_right_deg=5,
        overrides={"object.com_m": [0.16, 0.04]},
    )  # fmt: skip
    assert moved.closing == ("SL", "ST")


def test_story_3_shows_the_squeezes_that_decide(open_page: Open) -> None:
    """The numbers are those of the package, for the palms and contacts that the story names."""
    page = open_page(hash_of("stories", {"v.story": 3}))
    watch(page)
    page.locator(".act").click()
    page.locator("#scrub").fill("1000")
    both_steep, left_shallow = page.locator("#squeezes li").all()
    expect(both_steep).to_contain_text("both cones at once: H = 0.309")
    expect(left_shallow).to_contain_text("of the left cone first: H = 0.200 there ≤ 0.307")
    for item, theta, p in ((both_steep, 15, 0.0), (left_shallow, 5, -0.02)):
        modes = pb.contact_modes(
            p_left_m=p, p_right_m=0.0, theta_left_deg=theta, theta_right_deg=15
        )
        closing = next(
            line for line in str(modes).splitlines() if line.startswith("The squeeze rises")
        )
        expect(item).to_contain_text(closing)


def test_the_answers_are_numbered_as_on_the_sheet(open_page: Open) -> None:
    sheet = open_page("lesson.html", script=False)
    words = [item.inner_text() for item in sheet.locator("ol li").all()]
    page = open_page(hash_of("stories", {"v.story": 8}))
    shown = [item.inner_text().split() for item in page.locator(".task label").all()]
    assert shown == [[str(k + 1), *text.split()] for k, text in enumerate(words)]


def red_in(page: Page, chart: str) -> int:
    """How many pixels of a chart are red, and not the orange of the right robot."""
    (picture,) = pictures(page, chart)
    image = Image.open(io.BytesIO(picture)).convert("RGB")
    r, g, b = np.asarray(image, int).transpose(2, 0, 1)
    return int(((r > g + 40) & (b > g + 5)).sum())


def test_a_story_shows_the_ends_of_the_palms(open_page: Open) -> None:
    """Also in parts in which no contact comes near them, and after the part was watched."""
    page = open_page(hash_of("stories", {"v.story": 3}))
    for _ in range(2):
        if page.locator(".task input").count() > 0:
            watch(page)
        page.locator("#scrub").fill("1000")
        expect(page.locator(".future")).to_have_count(0)
        assert red_in(page, "contacts-chart") > 200
        if page.locator(".act").count() > 0:
            page.locator(".act").click()


def test_space_plays_and_pauses_wherever_the_focus_is(open_page: Open) -> None:
    page = open_page(hash_of("stories", {"v.story": 4}), moves=True)
    play = page.locator("#play")
    page.locator(".task input").first.click()
    expect(play).to_have_attribute("aria-label", "pause")
    page.keyboard.press("Space")
    expect(play).to_have_attribute("aria-label", "play")
    page.locator("#scrub").fill("1000")
    page.locator(".act").click()
    for label in ("pause", "play", "pause"):
        expect(play).to_have_attribute("aria-label", label)
        page.keyboard.press("Space")
    for focus in ("#speed", ".chapters button >> nth=3", "#play", "#scrub", ".home button"):
        for label in ("play", "pause"):
            expect(play).to_have_attribute("aria-label", label)
            page.locator(focus).press("Space")
    page.locator(".chapters button").nth(3).press("Enter")  # Enter presses
    expect(page.locator(".task input").first).not_to_be_checked()


def test_space_ticks_a_box_that_the_keyboard_reached_and_no_other(open_page: Open) -> None:
    page = open_page("#carry?t=2")
    page.locator("#cones").press("Space")
    expect(page.locator("#cones")).to_be_checked()
    expect(page.locator("#play")).to_have_attribute("aria-label", "play")
    page.get_by_text("friction cones").click()
    page.keyboard.press("Space")
    expect(page.locator("#cones")).not_to_be_checked()
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.locator("#seed").press("Space")  # a field in which one types
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")


def test_space_plays_a_counterexample(open_page: Open) -> None:
    page = open_page("#proofs")
    page.locator("#run").press("Space")
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")


@pytest.mark.parametrize("height", [630, 768])
@pytest.mark.parametrize("number", range(1, len(PARTS) + 1))
def test_a_story_fits_on_one_screen(open_page: Open, number: int, height: int) -> None:
    """All that a story speaks of, at 1366 pixels of width."""
    page = open_page(hash_of("stories", {"v.story": number}), width=1366, height=height)
    for k in range(len(PARTS[number - 1])):
        if k > 0:
            page.locator(".act").click()
        if page.locator(".task input").count() > 0:
            page.locator(".task input").first.check()
        page.locator("#scrub").fill("1000")
        for place in (
            "h1", ".lead p", ".task", "#stage", ".ending", "#play", ".after", ".legend",
            "#contacts-chart", "#palms-chart", "#sequence-chart",
        ):  # fmt: skip
            expect(page.locator(place)).to_be_in_viewport(ratio=1)
