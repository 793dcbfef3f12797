# SPDX-License-Identifier: Apache-2.0
"""The lesson as its sheet says: every answer of the teacher's file is what the page shows."""

import re

import pytest
from playwright.sync_api import Page, expect

from site_pages import SITE, Open


def to_end(page: Page) -> None:
    page.locator("#scrub").fill("1000")


def story(page: Page, number: int) -> None:
    page.get_by_role("link", name="Stories", exact=True).click()
    page.locator(".chapters button").nth(number - 1).click()


def lose(page: Page, what: str, times: int) -> None:
    """Choose the message that M reaches first, second, ..., and lose it."""
    page.locator("#sequence-chart").focus()
    for _ in range(times):
        page.keyboard.press("m")
    expect(page.locator(".card")).to_contain_text(what)
    page.get_by_role("button", name="lose it").click()


def test_every_answer_of_the_teacher(open_page: Open) -> None:
    sheet = open_page("lesson-answers.html", script=False)
    answers = {
        item.get_attribute("data-answer"): " ".join(item.inner_text().split())
        for item in sheet.locator("[data-answer]").all()
    }
    page = open_page(width=1366, height=768)

    def shows(place: str, *names: str) -> None:
        for name in names:
            expect(page.locator(place)).to_contain_text(answers.pop(name))

    story(page, 3)
    page.get_by_text("The box falls.").click()
    to_end(page)
    shows(".ending", "tilt-none")
    page.get_by_role("button", name="distributed").click()
    to_end(page)
    shows(".ending", "tilt-distributed")
    shows("#squeezes", "squeeze-near", "squeeze-far", "squeeze-tie")

    story(page, 8)
    page.get_by_text("tilts its own palm up and drives closer").click()
    to_end(page)
    shows(".ending", "predict")

    page.get_by_role("link", name="Carry", exact=True).click()
    page.get_by_role("button", name="reset").click()
    lose(page, "Ack from the left robot", 2)
    to_end(page)
    shows(".status", "lost-ack")
    page.get_by_role("button", name="reset").click()
    lose(page, "TiltUp from the right robot", 1)
    to_end(page)
    shows(".warnings", "lost-left", "lost-right")
    shows(".status", "lost-outcome", "lost-contact")
    page.get_by_role("button", name="reset").click()
    page.locator("#controller").select_option("resilient")
    page.locator("#scrub").fill("0.7")
    lose(page, "TiltUp from the right robot", 1)
    shows("#effect", "resilient-effect")
    to_end(page)
    shows(".status", "resilient-outcome")
    expect(page.locator(".warnings")).to_have_count(0)

    page.get_by_role("link", name="Compare", exact=True).click()
    page.get_by_role("button", name="reset").click()
    page.locator("#controller-0").select_option("distributed")
    page.locator("#controller-1").select_option("resilient")
    page.locator("[data-key='radio.loss']").fill("10")
    for k, name in enumerate(("distributed", "resilient")):
        row = page.locator("#counts tbody tr").nth(k)
        expect(row).to_have_attribute("data-carries", "1000")
        expect(row).to_contain_text(answers.pop(f"count-{name}"))
        expect(row.locator("td").last).to_have_text(answers.pop(f"messages-{name}"))
    shows("#counts", "interval-resilient")
    page.locator("#controller-0").select_option("silent")
    row = page.locator("#counts tbody tr").first
    expect(row).to_have_attribute("data-carries", "1000")
    expect(row).to_contain_text(answers.pop("count-silent"))
    expect(row.locator("td").last).to_have_text(answers.pop("messages-silent"))

    page.get_by_role("button", name="reset").click()
    page.locator("#controller-0").select_option("distributed")
    page.locator("#controller-1").select_option("resilient")
    rows = page.locator("#counts tbody tr")
    for case, key, position in (
        ("jammed", "radio.loss", "100"), ("slippery", "palm.left.friction", "0.1"),
        ("heavy", "object.mass_kg", "5"),
    ):  # fmt: skip
        page.get_by_role("button", name="reset").click()
        page.locator(f"[data-key='{key}']").fill(position)
        expect(page.locator(".command")).to_contain_text(key)
        for k, name in enumerate(("distributed", "resilient")):
            expect(rows.nth(k)).to_have_attribute("data-carries", "1000")
            if f"{case}-{name}" in answers:
                expect(rows.nth(k)).to_contain_text(answers.pop(f"{case}-{name}"))
        if case == "jammed":
            expect(rows.nth(1).locator("td").nth(3)).to_have_text(answers.pop("jammed-stalled"))

    for number, button, name in ((6, "8°", "slope"), (7, "160 mm", "com")):
        story(page, number)
        page.get_by_text("The box falls.").click()
        to_end(page)
        expect(page.locator(".ending")).to_contain_text("delivered")
        page.get_by_role("button", name=button).click()
        page.get_by_text("The box arrives.").click()
        to_end(page)
        shows(".ending", name)
    assert answers == {}


@pytest.mark.parametrize("task", range(1, 5))
def test_the_prediction_comes_before_the_page_is_touched(open_page: Open, task: int) -> None:
    """What the page shows at once would answer it."""
    sheet = open_page("lesson.html", script=False)
    text = sheet.locator("body").inner_text()
    part = text.split(f"\n{task} ")[1].split(f"\n{task + 1} ")[0]
    asked, touched = part.index("We expect"), re.search("[Cc]lick |[Cc]hoose ", part)
    assert touched is not None and asked < touched.start()


def test_the_sheet_and_the_answers_are_a_page_each(open_page: Open) -> None:
    """The learners' file contains no answer and no link to them."""
    for name in ("lesson.html", "lesson-answers.html"):
        sheet = open_page(name, script=False)
        assert b"/Count 1\n" in sheet.pdf(prefer_css_page_size=True)
    text = (SITE / "lesson.html").read_text("utf-8")
    assert "data-answer" not in text
    assert 'href="lesson-answers' not in text
