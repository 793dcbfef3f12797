# SPDX-License-Identifier: Apache-2.0
"""The page as one file, opened without a server: the same bits, from nothing but this file."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

import palmbots as pb
from palmbots.control.registry import shipped_names
from site_pages import SITE, Open, go, hash_of

FILE = SITE / "palmbots.html"


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """The file in a browser; afterwards nothing else may have been requested or printed."""
    said: list[str] = []
    asked: list[str] = []
    with browser.new_context(viewport={"width": 1366, "height": 768}) as context:
        page = context.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: asked.append(request.url))
        page.goto(FILE.as_uri() + "#carry?t=1")
        page.wait_for_selector("html[data-ready]")
        yield page
    assert said == []
    assert [url for url in asked[1:] if not url.startswith("blob:")] == []


def test_it_is_small_and_loads_nothing() -> None:
    text = FILE.read_text("utf-8")
    assert len(text.encode()) <= 1_350_000
    assert text.count("<script") == 1
    assert "import(" not in text
    assert "import.meta" not in text


def test_it_computes_the_same_bits(page: Page) -> None:
    for seed, controller in enumerate(shipped_names()):
        go(page, hash_of("carry", {"controller": controller, "seed": seed}))
        carried = pb.carry("paper", controller, seed=seed, record=False)
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)
    expect(page.locator("#book")).to_have_count(0)  # a stick holds no documentation


def test_its_worker_counts_the_same_drops(page: Page, open_page: Open) -> None:
    place = hash_of("compare", {"v.a": "none", "v.b": "distributed", "t": 1}, robot__noise_m_s=0.04)
    go(page, place)
    served = open_page(place)
    for k in (0, 1):
        row = served.locator("#counts tbody tr").nth(k)
        expect(row).to_have_attribute("data-carries", "1000")
        dropped = row.get_attribute("data-dropped") or ""
        assert int(dropped) > 0
        same = page.locator("#counts tbody tr").nth(k)
        expect(same).to_have_attribute("data-carries", "1000")
        expect(same).to_have_attribute("data-dropped", dropped)


@pytest.mark.parametrize("view", ["mechanics", "design", "stories", "proofs"])
def test_every_view_opens(page: Page, view: str) -> None:
    go(page, f"#{view}")
    expect(page.locator("h1")).to_be_visible()
    expect(page.locator("main canvas").first).to_be_visible()


def test_the_page_that_needs_a_server_names_this_file(browser: Browser) -> None:
    with browser.new_context() as context:
        page = context.new_page()
        page.goto((SITE / "index.html").as_uri(), wait_until="commit")  # it stops before the rest
        page.get_by_role("link", name="palmbots.html").click()
        page.wait_for_selector("html[data-ready]")
