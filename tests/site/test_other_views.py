# SPDX-License-Identifier: Apache-2.0
"""The views Compare, Mechanics, Design and Stories."""

import re
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from palmbots._util.confidence_intervals import wilson
from palmbots.mechanics.mode_words import decision_sentence, margin_sentence, mode_sentence
from site_pages import Open, command_of, hash_of, run_json


def counted(page: Page) -> list[int]:
    """The drops of both controllers, once all carries are counted."""
    rows = page.locator("#counts tbody tr")
    for k in (0, 1):
        expect(rows.nth(k)).to_have_attribute("data-carries", "1000", timeout=60_000)
    return [int(rows.nth(k).get_attribute("data-dropped") or -1) for k in (0, 1)]


def test_compare_counts_what_the_command_counts(
    open_page: Open, capsys: pytest.CaptureFixture[str]
) -> None:
    page = open_page(hash_of("compare", {"t": 1}, robot__noise_m_s=0.025, radio__loss=0.02))
    drops = counted(page)
    rows = run_json(runner(capsys), command_of(page))["rows"]
    assert [row["controller"] for row in rows] == ["centralized", "distributed"]
    assert drops == [round(1000 * row["drop_rate"]) for row in rows]
    assert min(drops) > 0
    ends = [f"{100 * end:.{2 if end < 0.1 else 1}f} %" for end in wilson(drops[0], 1000)]
    shown = page.locator("#counts tbody tr").nth(0)
    expect(shown).to_contain_text(f"{ends[0]} to {ends[1]}")
    expect(shown).to_contain_text(f"{1000 * rows[0]['rms_m']:.1f} mm")


def test_compare_runs_rows_of_ones_own(
    open_page: Open, capsys: pytest.CaptureFixture[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    page = open_page(hash_of("compare", {"t": 1}, robot__noise_m_s=0.025))
    page.locator("#controller-1").select_option("own-rows")
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
    pictures = [page.evaluate(f"document.getElementById('stage-{k}').toDataURL()") for k in (0, 1)]
    assert pictures[0] == pictures[1]
    page.locator("#controller-0").select_option("silent")
    page.locator("#scrub").fill("12")
    pictures = [page.evaluate(f"document.getElementById('stage-{k}').toDataURL()") for k in (0, 1)]
    assert pictures[0] != pictures[1]


STATES = [(5, 15, -20, 0), (15, 5, 30, -40), (15, 15, 10, 10), (25, 5, 60, 0), (0, 45, -70, 70)]


@pytest.mark.parametrize("state", STATES)
def test_mechanics_names_the_modes(
    open_page: Open, capsys: pytest.CaptureFixture[str], state: tuple[float, ...]
) -> None:
    page = open_page("#mechanics")
    for name, value in zip(("theta-left", "theta-right", "p-left", "p-right"), state, strict=True):
        page.locator(f"#{name}").fill(str(value))
    found = pb.modes(
        p_left_m=state[2] / 1000, p_right_m=state[3] / 1000, theta_left_deg=state[0],
        theta_right_deg=state[1],
    )  # fmt: skip
    for what, mode in (("together", found.closing), ("apart", found.opening)):
        heading = page.get_by_role("heading", name=f"Driven {what}")
        if mode is not None:
            expect(heading).to_contain_text("-".join(mode))
        else:
            expect(heading).to_contain_text("held" if found.margin_rad < 0 else "jammed")
        if mode is None or found.squeeze is None:
            continue
        # The binding inequality: which end of whose interval the squeeze reaches first.
        ends = {side: found.squeeze[side][what == "together"] for side in ("left", "right")}
        first, second = sorted(ends, key=lambda side: ends[side], reverse=what == "apart")
        said = page.locator("#closing-words" if what == "together" else "#opening-words")
        if ends[first] == pytest.approx(ends[second], abs=1e-9):
            wanted = [f"edges of both cones at once: H = {ends[first]:.3f}."]
        else:
            wanted = [f"edge of the {first} cone first: H = {ends[first]:.3f}",
                      f"{ends[second]:.3f} at the", f"edge of the {second} cone."]  # fmt: skip
        for words in wanted:
            expect(said).to_contain_text(words.replace("-", "−"))
    # The page's sentences are those of the package.
    held = ("ST", "ST") in found.feasible
    for name, mode in (("closing", found.closing), ("opening", found.opening)):
        decided = decision_sentence(found.squeeze, closing=name == "closing", held=held)
        said = page.locator(f"#{name}-words")
        expect(said).to_have_text(f"{mode_sentence(mode, held=held)} {decided}")
    expect(page.locator("#margin-words")).to_have_text(margin_sentence(found.margin_rad))
    happens = page.locator(".modes td.happens")
    for name, mode in (("closing", found.closing), ("opening", found.opening)):
        if mode is not None:  # in the row and the column of its codes
            row = page.locator(".modes tbody tr", has=page.get_by_role("rowheader", name=mode[0]))
            column = page.locator(".modes thead th").all_inner_texts().index(mode[1])
            expect(row.locator("th, td").nth(column)).to_contain_text(name)
    expect(happens).to_have_count(len({m for m in (found.closing, found.opening) if m}))
    balanced = page.locator(".modes td:not(.no)")
    expect(balanced).to_have_count(len(found.feasible))
    printed = run_json(runner(capsys), command_of(page))
    assert printed["closing"] == (list(found.closing) if found.closing else None)
    assert printed["p_left_m"] == state[2] / 1000


def drag_handle(page: Page, name: str, dx: float, dy: float) -> None:
    box = page.locator(f"#handle-{name}").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx / 2, y + dy / 2)
    page.mouse.move(x + dx, y + dy)
    page.mouse.up()


def drawings(page: Page) -> dict[str, str]:
    """What the canvases show, as soon as they show it."""
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => setTimeout(done)))")
    names = ("mechanics", "map-closing", "com-map")
    return {name: page.evaluate(f"document.getElementById('{name}').toDataURL()") for name in names}


def test_mechanics_can_be_dragged(open_page: Open) -> None:
    page = open_page("#mechanics?v.tl=9&v.tr=12")
    words = page.locator("#closing-words").inner_text
    seen = {words()}
    for name, dx, dy in (
        ("com", 12, 0), ("corner-2", -10, 14), ("palm-left", 0, 10), ("contact-right", 14, 4),
        ("cone", 20, 0),
    ):  # fmt: skip
        before = drawings(page)
        drag_handle(page, name, dx, dy)
        after = drawings(page)
        assert after["mechanics"] != before["mechanics"]  # Figures 3 and 4
        if name in ("palm-left", "contact-right"):
            assert after["map-closing"] != before["map-closing"]  # Figure 5
        if name not in ("palm-left", "contact-right"):  # it needs the scene's angles, all contacts
            assert after["com-map"] != before["com-map"]  # Figure 6
        if name != "corner-2":  # an upper corner does not touch a palm
            assert words() not in seen, name
        seen.add(words())
    address = page.evaluate("location.hash")
    page.wait_for_function("before => location.hash.includes('object.com_m')", arg=address)
    page.locator("#reset").click()
    expect(page.locator("#theta-left")).to_have_value("5")


def test_mechanics_handles_obey_the_keyboard(open_page: Open) -> None:
    page = open_page("#mechanics")
    before = page.locator("#closing-words").inner_text()
    page.locator("#handle-com").focus()
    page.keyboard.press("Shift+ArrowRight")
    assert page.locator("#closing-words").inner_text() != before


def test_mechanics_map_sets_the_contacts(open_page: Open) -> None:
    page = open_page("#mechanics")
    page.locator("#map-closing").click(position={"x": 140, "y": 120})
    assert page.locator("#p-left").input_value() != "-20"


def test_design_shows_the_tolerance_of_a_pair(open_page: Open, tmp_path: Path) -> None:
    page = open_page("#design")
    found = pb.analyze("paper").com_x_m
    assert found is not None
    most = 1000 * min(0.125 - found[0], found[1] - 0.125)
    expect(page.locator("#tolerance")).to_contain_text(f"±{most:.1f} mm")
    expect(page.locator("#tolerance")).to_contain_text("0.55°")
    limits = page.locator("table", has_text="what happens beyond").locator("tbody tr")
    ranges = [
        tuple(map(float, re.findall(r"([\d.]+) to ([\d.]+) mm: holds", text)[0]))
        for text in limits.all_inner_texts()
    ]
    assert len(ranges) == 4
    common = (max(low for low, _ in ranges), min(high for _, high in ranges))
    assert common == pytest.approx([1000 * end for end in found], abs=0.06)
    page.locator("#design-map").focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowRight")
    expect(page.get_by_role("heading", name="Shallow 5.5°, steep 15.5°")).to_be_visible()
    page.locator("#region").fill("40")
    assert command_of(page)[:5] == ["certify", "scene.toml", "--region-m", "-0.04", "0.04"]
    with page.expect_download() as download:
        page.get_by_role("button", name="save scene.toml").click()
    download.value.save_as(tmp_path / "scene.toml")
    scene = pb.load_scene(tmp_path / "scene.toml")
    assert (scene.palm.shallow_deg, scene.palm.steep_deg) == (5.5, 15.5)
    box = page.locator("#design-map").bounding_box()
    assert box is not None
    page.locator("#design-map").click(position={"x": 200, "y": 150})
    expect(page.get_by_role("heading", name="Shallow 5.5°, steep 15.5°")).to_have_count(0)
    for name in ("friction", "slope", "angle"):
        page.locator("#quantity").select_option(name)
        expect(page.locator("#tolerance")).not_to_be_empty()


# How each story ends before and after the one thing to do.
STORY_ENDS = {
    1: ("delivered", "delivered"),
    2: ("the right robot still waits for Ack", "delivered"),
    3: ("dropped", "delivered"),
    4: ("delivered", "delivered"),
    5: ("delivered", "delivered"),
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
    page.locator(".act").click()
    expect(page.locator(".after")).to_be_visible()
    found = run_json(runner(capsys), command_of(page))
    expect(page.locator("#hash")).to_have_text(found["trace_hash"])
    if number > 1:
        assert page.locator("#hash").inner_text() != before
    page.locator("#scrub").fill("1000")
    expect(page.locator(".ending")).to_contain_text(STORY_ENDS[number][1])
    if number == 2:
        expect(page.locator(".ending")).not_to_contain_text("waits")


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
    moved = pb.modes(
        p_left_m=0.0, p_right_m=-0.02, theta_left_deg=15, theta_right_deg=5,
        overrides={"object.com_m": [0.16, 0.04]},
    )  # fmt: skip
    assert moved.closing == ("SL", "ST")
