# SPDX-License-Identifier: Apache-2.0
"""Small screens of classrooms: what must be in sight, and what must not move or be skipped."""

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from site_pages import Open, go, hash_of, pictures, seconds

SCREENS = [(1024, 640), (1366, 630), (1366, 768)]
PARTS = (1, 2, 3, 4, 5, 6, 7, 8, 9)


def tops(page: Page, *places: str) -> list[float]:
    """Where these elements begin on the page."""
    return page.evaluate(
        "names => names.map(n => document.querySelector(n).getBoundingClientRect().top + scrollY)",
        places,
    )


@pytest.mark.parametrize(("width", "height"), SCREENS)
def test_play_is_in_sight_and_stands_still(open_page: Open, width: int, height: int) -> None:
    lost = {"radio__script": [{"sender": "right", "message": 1, "effect": "lost"}]}
    page = open_page(hash_of("carry", {"t": 0.1}, **lost), width=width, height=height)
    buttons = ("#play", "#scrub", "#fork", "#examine")
    before = tops(page, *buttons)
    for place in ("#stage", "#contacts-chart", *buttons):
        expect(page.locator(place)).to_be_in_viewport(ratio=1)
    for time in (0.8, 1.0, 1.6, 2.4, 5, 1000):  # at the end there are warnings
        page.locator("#scrub").fill(str(time))
        assert tops(page, *buttons) == before
    expect(page.locator(".warnings li")).to_have_count(2)
    go(page, hash_of("compare", {"t": 0.1}, **lost))
    expect(page.locator("#stage-0")).to_be_visible()
    pictures(page, "stage-0")  # the canvases have their heights
    before = tops(page, "#play")
    expect(page.locator("#play")).to_be_in_viewport(ratio=1)
    page.locator("#scrub").fill("1000")
    assert tops(page, "#play") == before


def test_drawings_follow_the_height_of_the_window(open_page: Open) -> None:
    page = open_page("#carry?t=1", width=1366, height=900)
    high = page.locator("#stage").bounding_box()["height"]
    page.set_viewport_size({"width": 1366, "height": 768})
    expect(page.locator("#play")).to_be_in_viewport(ratio=1)
    pictures(page, "stage")
    assert page.locator("#stage").bounding_box()["height"] < high


@pytest.mark.parametrize(("width", "height"), SCREENS)
@pytest.mark.parametrize("number", PARTS)
def test_play_stands_still_in_a_story(
    open_page: Open, number: int, width: int, height: int
) -> None:
    page = open_page(hash_of("stories", {"v.story": number}), width=width, height=height)
    before = tops(page, "#play")
    expect(page.locator("#play")).to_be_in_viewport(ratio=1)
    page.locator(".task input").first.check()
    assert tops(page, "#play") == before
    page.locator("#scrub").fill("1000")
    expect(page.locator(".after")).to_be_visible()
    assert tops(page, "#play") == before


def test_a_view_opens_at_its_top(open_page: Open) -> None:
    """No element has the name of a view: the browser would scroll to it."""
    page = open_page("#mechanics", width=1024, height=640)
    assert page.evaluate("scrollY") == 0
    for view in ("mechanics", "compare", "design", "stories", "proofs", "carry"):
        go(page, f"#{view}")
        expect(page.locator(f"nav a[aria-current][href^='#{view}']")).to_have_count(1)
        expect(page.locator("canvas").first).to_be_visible()
        expect(page.locator(f"#{view}")).to_have_count(0)
    go(page, "#carry?t=2")
    expect(page.locator("#examine")).to_be_visible()
    page.evaluate("scrollTo(0, document.body.scrollHeight)")
    assert page.evaluate("scrollY") > 0
    page.locator("#examine").evaluate("button => button.click()")
    expect(page.locator("h1")).to_have_text("Which contact slides?")
    assert page.evaluate("scrollY") == 0


def test_a_question_is_answered_before_its_carry_plays(open_page: Open) -> None:
    page = open_page(hash_of("stories", {"v.story": 3}), width=1366, height=768, moves=True)
    expect(page.locator("#play")).to_be_disabled()
    expect(page.locator("#scrub")).to_be_disabled()
    expect(page.locator(".ending")).to_have_text("Answer first; then it plays.")
    page.locator("h1").click()
    page.keyboard.press("Space")
    expect(page.locator("#play")).to_have_attribute("aria-label", "play")
    for _ in range(2):
        page.keyboard.press(".")
    chart = page.locator("#contacts-chart").bounding_box()
    page.mouse.click(chart["x"] + 300, chart["y"] + 40)
    page.locator("#contacts-chart").press("End")
    assert seconds(page) == 0
    expect(page.locator(".after")).to_have_count(0)
    page.locator(".task input").first.check()
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.get_by_role("link", name="Carry", exact=True).click()
    page.locator("#scrub").fill("3")
    assert seconds(page) == 3


def test_the_sliders_set_the_keys_that_they_name(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    shown = page.locator("#hash")
    for key, position, value in (
        ("palm.left.friction", "0.2", 0.2), ("palm.right.friction", "0.9", 0.9),
        ("radio.loss", "100", 1.0), ("radio.latency_s", "120", 0.12),
        ("robot.noise_m_s", "5", 0.005),
    ):  # fmt: skip
        go(page, "#carry?t=1")
        slider = page.locator(f"[data-key='{key}']")
        usual = slider.input_value()
        slider.fill(position)
        expect(shown).to_have_text(pb.carry("paper", overrides={key: value}).trace_hash)
        slider.fill(usual)
        expect(shown).to_have_text(pb.carry("paper").trace_hash)
        expect(page.locator(".command")).not_to_contain_text("--set")
    mass = page.locator("[data-key='object.mass_kg']")
    mass.fill("2")
    expect(page.locator(".command")).to_contain_text("object.mass_kg=2")
    expect(shown).to_have_text(pb.carry("paper").trace_hash)  # the motion is the same
    mass.fill("10")
    expect(page.locator(".refusal")).to_contain_text("tips over")


def test_the_picture_has_a_key(open_page: Open) -> None:
    page = open_page("#carry?t=1", width=1366, height=768)
    expect(page.locator(".picture-key")).to_contain_text("slides along the arrow")
    page.locator("#cones").check()
    expect(page.locator(".picture-key")).to_contain_text("friction cone")
    go(page, "#compare?t=1")
    expect(page.locator(".picture-key")).to_be_in_viewport(ratio=1)
