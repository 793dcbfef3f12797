# SPDX-License-Identifier: Apache-2.0
"""Every view names commands that reproduce what it shows, with the traces of its carries."""

import shlex
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from site_pages import ROOT, Open, hash_of, run_json


def assert_traces(page: Page, capsys: pytest.CaptureFixture[str], count: int = 1) -> None:
    """The commands that carry have the traces that stand beside them."""
    run = runner(capsys)
    lines = (shlex.split(line) for line in page.locator(".command").inner_text().splitlines())
    carries = [words[1:] for words in lines if words[:2] == ["palmbots", "carry"]]
    assert len(carries) == count
    found = [run_json(run, words)["trace_hash"] for words in carries]
    assert page.locator(".home code").all_inner_texts() == found


def save(page: Page, name: str, folder: Path) -> None:
    """Save the file that the commands read."""
    with page.expect_download() as found:
        page.get_by_role("button", name=f"save {name}").click()
    found.value.save_as(folder / name)


def test_both_carries_of_a_race(open_page: Open, capsys: pytest.CaptureFixture[str]) -> None:
    page = open_page(
        hash_of("compare", {"t": 3, "seed": 5, "v.a": "resilient", "v.b": "silent"},
                radio__loss=0.1)
    )  # fmt: skip
    expect(page.locator("#hash-1")).to_be_visible()
    assert_traces(page, capsys, 2)


def test_rows_of_ones_own(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """A station runs them, in the page as at home."""
    page = open_page(hash_of("compare", {"t": 1, "v.a": "none", "v.b": "own-rows"}))
    page.get_by_label("row +-, palm of the left robot").select_option("shallow")
    page.get_by_label("row 0+, drive of the right robot").select_option("hold")
    save(page, "rows.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    assert_traces(page, capsys, 2)


def test_an_object_of_ones_own_in_another_scene(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The file holds what the built-in scene sets, too."""
    page = open_page(hash_of("mechanics", {"scene": "figure8"}))
    before = page.locator("#hash").inner_text()
    page.locator("#handle-com").focus()
    page.keyboard.press("Shift+ArrowRight")
    expect(page.locator("#hash")).not_to_have_text(before)
    save(page, "scene.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    assert_traces(page, capsys)
    assert pb.load_scene("scene.toml").bumps.script == pb.load_scene("figure8").bumps.script


def test_a_design(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """The scene file, the carry, and the two commands that certify the pair and measure its σ*."""
    page = open_page(hash_of("design", {"controller": "shared-sign", "seed": 2}))
    page.locator("#design-map").focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowRight")
    page.locator("#region").fill("40")
    save(page, "scene.toml", tmp_path)
    monkeypatch.chdir(tmp_path)
    assert_traces(page, capsys)
    commands = page.locator(".command").inner_text().splitlines()[:2]
    certify, limit = (shlex.split(line) for line in commands)
    run = runner(capsys)
    assert (certify[1], limit[1]) == ("certify", "noise-limit")
    assert run(*certify[1:]).returncode == 0
    assert run("check", certify[-1]).returncode == 0
    measured = run_json(run, [*limit[1:], "--relative-error-percent", "5"])
    assert measured["controller"] == "shared-sign"
    assert 0 < measured["sigma_star_m_s"] < 0.1


def test_a_counterexample(
    open_page: Open, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    page = open_page(hash_of("proofs", {"v.run": "copied-ack", "v.step": 2}))
    expect(page.locator(".time")).to_contain_text("3 of")
    assert_traces(page, capsys)
