# SPDX-License-Identifier: Apache-2.0
"""The URL holds the whole state: a second page at the same address shows the same."""

from collections.abc import Callable

import pytest
from playwright.sync_api import Page, expect

from site_pages import Open, command_of, hash_of, pictures

Change = Callable[[Page], None]


def again(open_page: Open, page: Page) -> Page:
    """A new page at the address that the page has once it has come to rest."""
    page.wait_for_function(
        """async () => {
          const before = location.hash;
          await new Promise(done => setTimeout(done, 300));
          return before === location.hash;
        }"""
    )
    return open_page(page.evaluate("location.hash"))


def choose_message(page: Page) -> None:
    """Select the second message."""
    page.locator("#sequence-chart").focus()
    page.keyboard.press("m")
    page.keyboard.press("m")


def show_whole(page: Page) -> None:
    """Cones on, the whole carry in the charts, the other theme."""
    page.locator("#cones").check()
    page.locator("#whole").check()
    page.locator("#theme").click()


def test_a_carry(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"scene": "figure8", "t": 0.1}))
    choose_message(page)
    show_whole(page)
    other = again(open_page, page)
    expect(other.locator(".card")).to_contain_text("Ack from the left robot")
    expect(other.locator("#cones")).to_be_checked()
    expect(other.locator("#whole")).to_be_checked()
    expect(other.locator("html")).to_have_attribute("data-theme", "dark")
    assert other.locator(".time").inner_text() == page.locator(".time").inner_text()
    for name in ("stage", "contacts-chart", "sequence-chart"):
        assert pictures(other, name) == pictures(page, name), name


@pytest.mark.parametrize("seed", [0, 1, 2, 3])
def test_the_end_of_a_carry(open_page: Open, seed: int) -> None:
    """Its time is no whole number of hundredths of a second."""
    page = open_page(hash_of("carry", {"seed": seed, "t": 1000}))
    shown = page.locator(".status strong").inner_text()
    assert "delivered" in shown
    expect(again(open_page, page).locator(".status strong")).to_have_text(shown)


def test_a_state_of_mechanics(open_page: Open) -> None:
    page = open_page("#mechanics")
    page.locator("#theta-left").fill("9.5")
    page.locator("#p-right").fill("-31")
    page.locator("#friction").fill("0.41")
    other = again(open_page, page)
    assert (
        other.locator("#closing-words").inner_text() == page.locator("#closing-words").inner_text()
    )
    assert command_of(other) == command_of(page)


def test_a_design(open_page: Open) -> None:
    page = open_page("#design")
    page.locator("#quantity").select_option("slope")
    page.locator("#region").fill("33")
    page.locator("#design-map").focus()
    page.keyboard.press("ArrowUp")
    other = again(open_page, page)
    assert other.locator("#quantity").input_value() == "slope"
    assert other.locator("#tolerance").inner_text() == page.locator("#tolerance").inner_text()
    assert command_of(other) == command_of(page)


@pytest.mark.parametrize(
    ("number", "change", "words"),
    [
        (2, lambda page: page.locator(".act").click(), "until its lease ends"),
        (8, lambda page: None, "and it slides up"),
    ],
)
def test_a_story(open_page: Open, number: int, change: Change, words: str) -> None:
    page = open_page(hash_of("stories", {"v.story": number}))
    page.get_by_role("radio").nth(1).check()
    page.locator("#scrub").fill("1000")
    change(page)
    page.locator("#scrub").fill("1000")
    expect(page.locator(".after")).to_contain_text(words)
    other = again(open_page, page)
    expect(other.locator(".after")).to_contain_text(words)
    assert command_of(other) == command_of(page)


def test_a_counterexample(open_page: Open) -> None:
    page = open_page("#proofs")
    page.locator("#run").select_option("late-ack")
    page.locator("#scrub").fill("3")
    other = again(open_page, page)
    assert other.locator("#run").input_value() == "late-ack"
    expect(other.locator(".time")).to_contain_text("4 of")
    assert other.locator("#play").get_attribute("aria-label") == "play"


def test_while_it_plays_the_address_is_current_and_the_history_short(open_page: Open) -> None:
    page = open_page("#carry?v.whole=1", moves=True)
    length = page.evaluate("history.length")
    page.wait_for_function(
        "Number(new URLSearchParams(location.hash.split('?')[1]).get('t')) > 1.5"
    )
    expect(page.locator("#play")).to_have_attribute("aria-label", "pause")
    assert page.evaluate("history.length") == length
