# SPDX-License-Identifier: Apache-2.0
"""The view Compare: counts, rows of one's own, races."""

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from commands import runner
from palmbots._util.confidence_intervals import rate_interval
from palmbots.control.interface import MOVES, PALMS
from site_pages import Open, command_of, hash_of, pictures, run_json


def counted(page: Page) -> list[int]:
    """The drops of both controllers, once all carries are counted."""
    rows = page.locator("#counts tbody tr")
    for k in (0, 1):
        expect(rows.nth(k)).to_have_attribute("data-carries", "1000", timeout=60_000)
    return [int(rows.nth(k).get_attribute("data-dropped") or -1) for k in (0, 1)]


# Collects what the first row of the table shows, from the last time on that nothing is counted yet.
WATCH_COUNTS = """() => {
  window.seen = [];
  new MutationObserver(() => {
    const row = document.querySelector('#counts tbody tr');
    const ends = row.querySelector('.ends');
    if (ends) seen.push([+row.dataset.carries, +row.dataset.dropped, ends.innerText]);
    else seen.length = 0;
  }).observe(document.getElementById('counts'), {
    subtree: true, childList: true, attributes: true, characterData: true });
}"""


def interval_words(dropped: int, carries: int) -> str:
    ends = rate_interval(dropped, carries)
    return " to ".join(f"{1000 * end:.{1 if end < 0.01 else 0}f}" for end in ends) + " of 1000"


def test_compare_counts_what_the_command_counts(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    """With the latency and loss of the sliders, and with an interval while it counts."""
    page = open_page(hash_of("compare", {"t": 1}, robot__noise_m_s=0.025))
    assert not any("radio.loss" in word for word in command_of(page))
    seen = page.locator("#hash-1").inner_text()
    page.evaluate(WATCH_COUNTS)
    for key, value in (("latency_s", 120), ("loss", 5)):
        page.locator(f"[data-key='radio.{key}']").fill(str(value))
        expect(page.locator("#hash-1")).not_to_have_text(seen)
        seen = page.locator("#hash-1").inner_text()
    words = command_of(page)
    assert words[words.index("--values") + 1] == "0.12"
    assert "radio.loss=0.05" in words
    drops = counted(page)
    meanwhile = page.evaluate("seen")
    assert any(0 < carries < 1000 for carries, _, _ in meanwhile)
    for carries, dropped, ends in meanwhile:
        assert ends == interval_words(dropped, carries)
    run = runner(capsys)
    rows = run_json(run, words)["rows"]
    assert run_json(run, command_of(page, 2))["trace_hash"] == seen
    assert [row["controller"] for row in rows] == ["centralized", "distributed"]
    assert drops == [round(1000 * row["drop_rate"]) for row in rows]
    assert min(drops) > 0
    shown = page.locator("#counts tbody tr").nth(0)
    expect(shown).to_contain_text(interval_words(drops[0], 1000))
    expect(shown).to_contain_text(f"{1000 * rows[0]['rms_m']:.1f} mm")


def test_no_drop_has_the_one_sided_bound_of_the_command(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    """0 of 1000: at most 3.0 of 1000, as `palmbots compare` prints (< 0.30 %)."""
    page = open_page(hash_of("compare", {"t": 1, "v.a": "distributed"}, task__distance_m=0.1))
    assert counted(page)[0] == 0
    expect(page.locator("#counts tbody tr").nth(0)).to_contain_text("0.0 to 3.0 of 1000")
    row = run_json(runner(capsys), command_of(page))["rows"][0]
    assert row["interval"][1] == pytest.approx(1 - 0.05**0.001)


def test_compare_runs_rows_of_ones_own(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    page = open_page(hash_of("compare", {"t": 1}, robot__noise_m_s=0.025))
    page.locator("#controller-1").select_option("own-rows")
    for name, words in (("palm of the left", PALMS), ("drive of the right", MOVES)):
        choice = page.get_by_label(f"row ++, {name} robot")
        assert choice.locator("option").all_inner_texts() == list(words)
    page.get_by_label("row ++, palm of the left robot").select_option("shallow")
    page.get_by_label("row +0, drive of the right robot").select_option("hold")
    drops = counted(page)
    with page.expect_download() as found:
        page.get_by_role("button", name="save rows.toml").click()
    found.value.save_as(tmp_path / "rows.toml")
    monkeypatch.chdir(tmp_path)
    rows = run_json(runner(capsys), command_of(page))["rows"]
    assert rows[1]["controller"] == "rows.toml@station"
    assert drops == [round(1000 * row["drop_rate"]) for row in rows]
    address = page.evaluate("location.hash")
    again = open_page(address)
    expect(again.get_by_label("row ++, palm of the left robot")).to_have_value("shallow")


def test_compare_races_on_the_same_noise(open_page: Open) -> None:
    page = open_page(hash_of("compare", {"t": 5, "v.a": "none", "v.b": "none"}))
    first, second = pictures(page, "stage-0", "stage-1")
    assert first == second
    page.locator("#controller-0").select_option("silent")
    page.locator("#scrub").fill("12")
    first, second = pictures(page, "stage-0", "stage-1")
    assert first != second
