# SPDX-License-Identifier: Apache-2.0
"""The view Stories: one thing to do in each."""

import re

import pytest
from playwright.sync_api import expect

import palmbots as pb
from commands import runner
from site_pages import Open, command_of, hash_of, run_json, seconds

# How each story ends before and after the one thing to do.
STORY_ENDS = {
    1: ("delivered", "delivered"),
    2: ("for an Ack that does not arrive (a message was lost)", "delivered"),
    3: ("dropped", "delivered"),
    4: ("210 corrections, no messages", "140 corrections, no messages"),
    5: ("the last correction has not ended", "delivered"),
    6: ("delivered", "dropped"),
    7: ("delivered", "dropped"),
}


@pytest.mark.parametrize("number", range(1, 9))
def test_every_story_has_one_thing_to_do(
    open_page: Open, capsys: pytest.CaptureFixture[str], number: int
) -> None:
    page = open_page(hash_of("stories", {"v.story": number}))
    title = page.locator(".chapters button").nth(number - 1).inner_text()
    expect(page.locator("h1")).to_have_text(title)
    if number == 8:
        page.get_by_text("tilts its own palm up and drives closer").click()
        expect(page.locator(".after")).to_contain_text("Yes.")
        carried = pb.carry("paper", overrides={
            "robot.noise_m_s": 0.0, "task.distance_m": 0.3,
            "bumps.script": [{"robot": "left", "at_s": 0.5, "shift_m": -0.03}],
        })  # fmt: skip
        assert [(c.robot, c.case) for c in carried.corrections] == [("left", "d")]
        return
    page.locator("#scrub").fill("1000")
    expect(page.locator(".ending")).to_contain_text(STORY_ENDS[number][0])
    before = page.locator("#hash").inner_text()
    furthest = page.locator("#tally").inner_text()
    page.locator(".act").click()
    expect(page.locator(".after")).to_be_visible()
    if number == 1:
        assert seconds(page) == 0.7
    found = run_json(runner(capsys), command_of(page))
    expect(page.locator("#hash")).to_have_text(found["trace_hash"])
    if number > 1:
        assert page.locator("#hash").inner_text() != before
    page.locator("#scrub").fill("1000")
    expect(page.locator(".ending")).to_contain_text(STORY_ENDS[number][1])
    if number in (2, 5):  # now nothing is wrong
        expect(page.locator(".ending")).not_to_contain_text(re.compile("waited|not ended"))
        expect(page.locator(".ending .good")).to_be_visible()
    if number == 4:  # the numbers are those of the carry, and the contacts move further
        for noise, shown in ((0.01, furthest), (0.02, page.locator("#tally").inner_text())):
            carried = pb.carry("paper", "silent", seed=3, overrides={"robot.noise_m_s": noise})
            assert shown.endswith(
                f"{carried.correction_count} corrections, no messages, contacts up to "
                f"{1000 * max(carried.contact_peak_m.values()):.0f} mm from p = 0"
            )


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
    page = open_page(hash_of("stories", {"v.story": 3}), motion="reduce")
    page.locator(".act").click()
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


def test_space_pauses_after_a_click_on_a_button(open_page: Open) -> None:
    page = open_page(hash_of("stories", {"v.story": 4}))
    page.locator(".act").click()
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_attribute("aria-label", "play")
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.keyboard.press("Space")
    page.locator(".act").press("Space")  # who chose a button with the keyboard presses it
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")


@pytest.mark.parametrize("number", range(1, 9))
def test_a_story_fits_on_one_screen(open_page: Open, number: int) -> None:
    """Stage, player, what the action shows and the chart of messages, at 1366 × 768."""
    page = open_page(
        hash_of("stories", {"v.story": number}), motion="reduce", width=1366, height=768
    )
    page.locator(".task button, .task input").first.click()
    for place in ("#stage", "#play", ".after", "#sequence-chart"):
        expect(page.locator(place)).to_be_in_viewport(ratio=1)
