# SPDX-License-Identifier: Apache-2.0
"""Accessibility, small screens, the page without JavaScript, and its size."""

import gzip
import re
import time

import pytest
from playwright.sync_api import Page, expect

from site_pages import ROOT, SITE, Open

VIEWS = ("carry?t=2", "compare?t=2", "mechanics", "design", "stories?v.story=2", "proofs")
AXE = ROOT / "site" / "node_modules" / "axe-core" / "axe.min.js"
LARGEST = 300_000  # bytes, gzipped, of what the front page loads


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing(open_page: Open, scheme: str) -> None:
    page = open_page("#carry?t=2", scheme=scheme)
    page.add_script_tag(path=AXE)
    for view in VIEWS:
        page.evaluate("view => { location.hash = view; }", view)
        expect(page.locator("h1")).to_be_visible()
        found = page.evaluate(
            "() => axe.run(document, { resultTypes: ['violations'] }).then(r => r.violations.map("
            "v => [v.id, v.nodes.map(n => n.html + ' ' + n.failureSummary)]))"
        )
        assert found == [], view


@pytest.mark.parametrize("view", VIEWS)
def test_a_phone_shows_every_view(open_page: Open, view: str) -> None:
    page = open_page(f"#{view}", width=390, height=844, touch=True)
    expect(page.locator("h1")).to_be_visible()
    wide = page.evaluate("document.documentElement.scrollWidth - window.innerWidth")
    assert wide <= 0
    small = page.evaluate(
        "() => [...document.querySelectorAll('button, select')].filter(e => !e.closest('.handles'))"
        ".map(e => [e.id || e.innerText, e.getBoundingClientRect().height])"
        ".filter(([, height]) => height > 0 && height < 24)"
    )
    assert small == []


def test_a_phone_plays_by_touch(open_page: Open) -> None:
    page = open_page("#carry?t=2", width=390, height=844, touch=True)
    page.locator("#play").tap()
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")


def swipe(page: Page, x: float, y: float, by: float) -> None:
    """A finger that touches the page, moves sideways, rests and leaves.

    Its times say how fast it is. After a fast one, a browser takes the next tap for the end of a
    fling.
    """
    session = page.context.new_cdp_session(page)
    now = time.time()
    for kind, share, age in (
        ("touchStart", 0.0, 0.9), ("touchMove", 0.25, 0.8), ("touchMove", 0.5, 0.7),
        ("touchMove", 0.75, 0.6), ("touchMove", 1.0, 0.5), ("touchMove", 1.0, 0.1),
        ("touchEnd", None, 0.0),
    ):  # fmt: skip
        points = [] if share is None else [{"x": x + by * share, "y": y}]
        session.send(
            "Input.dispatchTouchEvent",
            {"type": kind, "touchPoints": points, "timestamp": now - age},
        )


def centre(page: Page, name: str) -> tuple[float, float]:
    """The middle of an element, which is scrolled into view."""
    page.locator(name).scroll_into_view_if_needed()
    box = page.locator(name).bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_a_finger_drags_what_a_mouse_drags(open_page: Open) -> None:
    page = open_page("#carry?t=2", width=390, height=844, touch=True)
    before = page.locator("#hash").inner_text()
    x, y = centre(page, "#stage")
    swipe(page, x, y - 40, 30)  # the object
    expect(page.locator(".command")).to_contain_text("bumps.script")
    assert page.locator("#hash").inner_text() != before
    swipe(page, *centre(page, "#contacts-chart"), 40)
    expect(page.locator(".time")).not_to_have_text("2.00 s")
    shown = page.locator(".time").inner_text()
    page.get_by_role("button", name="one step back").tap()
    expect(page.locator(".time")).not_to_have_text(shown)
    page.evaluate("location.hash = 'mechanics'")
    swipe(page, *centre(page, "#handle-com"), 30)
    expect(page.locator(".command")).to_contain_text("scene.toml")


def test_the_theme_can_be_changed(open_page: Open) -> None:
    page = open_page("#carry?t=2")
    colour = "getComputedStyle(document.body).backgroundColor"
    assert page.evaluate(colour) == "rgb(255, 255, 255)"
    page.locator("#theme").click()
    assert page.evaluate(colour) == "rgb(22, 25, 29)"


def test_the_keyboard_reaches_everything(open_page: Open) -> None:
    page = open_page("#carry?t=2")
    seen = set()
    for _ in range(60):
        page.keyboard.press("Tab")
        seen.add(page.evaluate("document.activeElement.id || document.activeElement.innerText"))
    assert {"scene", "controller", "seed", "play", "scrub", "fork", "contacts-chart"} <= seen
    assert {"Compare", "Proofs", "theme", "scene-file"} <= seen


def test_every_slider_has_a_name_and_the_time_one_says_the_moment(open_page: Open) -> None:
    page = open_page("#carry?t=2")
    for name in ("speed noise 10 mm/s", "radio latency 50 ms", "radio loss 0 %", "time"):
        expect(page.get_by_role("slider", name=name, exact=True)).to_be_visible()
    scrub = page.locator("#scrub")
    for side in ("left", "right"):
        shown = page.locator(f".{side}-text").inner_text().split(",")[0]
        assert shown in (scrub.get_attribute("aria-valuetext") or "")
    # It changes all the time: nobody wants to hear it.
    expect(page.locator(".time")).to_have_attribute("aria-live", "off")
    page.evaluate("location.hash = 'mechanics'")
    for symbol in ("θ_L", "p_R", "friction"):
        expect(page.get_by_role("slider", name=symbol).first).to_be_visible()


@pytest.mark.parametrize(("place", "words"), [("carry", "delivered: "), ("stories", "dropped ")])
def test_the_outcome_is_announced(open_page: Open, place: str, words: str) -> None:
    query = "?v.story=3" if place == "stories" else ""
    page = open_page(f"#{place}{query}")
    if place == "stories":
        page.get_by_role("radio").last.press("Space")
    page.locator("#scrub").press("End")
    expect(page.get_by_role("status").filter(has_text=words)).to_have_count(1)


def test_a_story_by_keyboard_keeps_the_focus(open_page: Open) -> None:
    """A button that begins a part is gone then, and the part is not yet played."""
    page = open_page("#stories?v.story=2")
    page.get_by_role("radio").last.press("Space")
    page.keyboard.press("Space")  # it plays wherever the focus is
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    page.locator("#scrub").press("End")
    page.locator(".act").press("Enter")
    expect(page.locator("#play")).to_be_focused()


def test_the_page_without_javascript(open_page: Open) -> None:
    page = open_page(script=False, moves=True)
    expect(page.get_by_role("heading", name="Two robots, no gripper, one box")).to_be_visible()
    images = page.get_by_role("img")
    expect(images).to_have_count(5)
    for k in range(5):
        box = images.nth(k).bounding_box()
        assert box is not None and box["height"] > 100  # it has arrived
    assert "palmbots carry figure8" in page.content()


def test_without_javascript_nothing_moves_where_motion_is_unwelcome(open_page: Open) -> None:
    page = open_page(script=False)
    shown = [image.get_attribute("src") for image in page.get_by_role("img").all()]
    assert len(shown) == 4
    assert not any(source.endswith(".gif") for source in shown if source)


def test_the_front_page_is_small() -> None:
    """HTML, style, the script with what it imports at once, and the core."""
    html = (SITE / "index.html").read_text()
    names = set(re.findall(r"\./assets/[\w.-]+", html))
    script = next(name for name in names if name.endswith(".js"))
    code = (SITE / script).read_text()
    names |= {f"./assets/{name}" for name in re.findall(r'from"\./([\w.-]+\.js)"', code)}
    names |= {f"./assets/{path.name}" for path in (SITE / "assets").glob("core-*.wasm")}
    size = sum(len(gzip.compress((SITE / name).read_bytes(), 9)) for name in names)
    size += len(gzip.compress(html.encode(), 9))
    assert 50_000 < size <= LARGEST
