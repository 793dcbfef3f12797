# SPDX-License-Identifier: Apache-2.0
"""The views Compare, Mechanics, Design and Stories."""

import base64
import io
import math
import re
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from palmbots._util.confidence_intervals import wilson
from palmbots.control.interface import MOVES, PALMS
from palmbots.mechanics.mode_analysis import CONTACT_MODES, modes_batch
from palmbots.mechanics.mode_words import decision_sentence, margin_sentence, mode_sentence
from site_pages import Open, command_of, go, hash_of, run_json, seconds


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
    ends = wilson(dropped, carries)
    return " to ".join(f"{100 * end:.{2 if end < 0.1 else 1}f} %" for end in ends)


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
        # Figure 6, which is for all contacts.
        assert (after["com-map"] != before["com-map"]) == (name != "contact-right"), name
        if name != "corner-2":  # an upper corner does not touch a palm
            assert words() not in seen, name
        seen.add(words())
    address = page.evaluate("location.hash")
    page.wait_for_function("before => location.hash.includes('object.com_m')", arg=address)
    page.locator("#reset").click()
    expect(page.locator("#theta-left")).to_have_value("5")


def row_of_com_map(page: Page, height: float) -> list[object]:
    """The colours of the map of COMs along the paper's box, at a height [m]."""
    data = drawings(page)["com-map"].split(",")[1]
    picture = Image.open(io.BytesIO(base64.b64decode(data)))
    scale = min((picture.width - 20) / 0.25, (picture.height - 20) / 0.16)
    y = round((picture.height + scale * 0.16) / 2 - scale * height)
    start = round((picture.width - scale * 0.25) / 2)
    return [picture.getpixel((x, y)) for x in range(start + 2, start + int(scale * 0.25) - 2)]


def test_the_map_of_coms_is_that_of_the_angles_shown(open_page: Open) -> None:
    """The smaller one is the shallow one: as `analyze` finds it in a scene with these angles."""
    page = open_page("#mechanics?v.tl=3&v.tr=20")
    height = 0.08  # away from the dot
    for left, right in ((3, 20), (14, 6)):
        for name, angle in (("left", left), ("right", right)):
            page.locator(f"#theta-{name}").fill(str(angle))
        shallow, steep = sorted((left, right))
        expect(page.locator("#com-angles")).to_contain_text(
            f"The shallow angle is {shallow}.0°, the steep one {steep}.0°."
        )
        row = row_of_com_map(page, height)
        inside = [k for k, colour in enumerate(row) if colour == row[len(row) // 2]]
        assert len(inside) == inside[-1] - inside[0] + 1 < len(row)
        found = pb.analyze("paper", overrides={
            "palm.shallow_deg": shallow, "palm.steep_deg": steep, "object.com_m": [0.125, height],
        }).com_x_m  # fmt: skip
        assert found is not None
        command = command_of(page, 1)
        assert command[:2] == ["analyze", "paper"]
        assert command[2:6] == [
            "--set",
            f"palm.shallow_deg={shallow}",
            "--set",
            f"palm.steep_deg={steep}",
        ]
        seen = [0.25 * (k + 2) / (len(row) + 4) for k in (inside[0], inside[-1] + 1)]
        assert seen == pytest.approx(found, abs=0.002)


def test_mechanics_handles_obey_the_keyboard(open_page: Open) -> None:
    page = open_page("#mechanics")
    before = page.locator("#closing-words").inner_text()
    page.locator("#handle-com").focus()
    page.keyboard.press("Shift+ArrowRight")
    assert page.locator("#closing-words").inner_text() != before


def contacts_shown(page: Page) -> tuple[float, float]:
    """The contacts [mm] of the state that the view shows."""
    text = page.locator("#shown-state").inner_text().replace("−", "-")
    left, right = re.findall(r"= (-?[\d.]+) mm", text)
    return float(left), float(right)


def assert_words_of(page: Page, p_left: float, p_right: float) -> None:
    """The words and the table of the modes are those of a state [mm] at the paper's angles."""
    found = pb.modes(
        p_left_m=p_left / 1000, p_right_m=p_right / 1000, theta_left_deg=5, theta_right_deg=15
    )
    held = ("ST", "ST") in found.feasible
    for name, mode in (("closing", found.closing), ("opening", found.opening)):
        decided = decision_sentence(found.squeeze, closing=name == "closing", held=held)
        said = page.locator(f"#{name}-words")
        expect(said).to_have_text(f"{mode_sentence(mode, held=held)} {decided}")
    expect(page.locator(".modes td:not(.no)")).to_have_count(len(found.feasible))


def test_mechanics_map_shows_the_state_under_the_pointer_and_sets_the_contacts(
    open_page: Open,
) -> None:
    page = open_page(hash_of("mechanics", object__com_m=[0.16, 0.04]))
    page.locator("#reset").click()
    canvas = page.locator("#map-closing")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    assert box is not None
    size = box["height"] - 34
    first = command_of(page)

    def move(left: float, right: float) -> None:
        """To a place in the map [mm], which reaches 2.6 times as far as the palms."""
        x = 34 + (left / 195 + 1) / 2 * size
        y = 6 + (1 - right / 195) / 2 * size
        page.mouse.move(box["x"] + x, box["y"] + y)

    move(40, -50)  # only held there
    expect(page.locator("#shown-state")).to_contain_text("under the pointer")
    assert contacts_shown(page) == pytest.approx((40, -50), abs=1)
    assert_words_of(page, *contacts_shown(page))
    move(-180, 180)  # beyond the palms
    expect(page.locator("#shown-state")).not_to_contain_text("= 40")
    left, right = (mm / 1000 for mm in contacts_shown(page))
    assert (left, right) == pytest.approx((-0.18, 0.18), abs=0.001)
    mode = modes_batch(
        width=0.25, com_x=0.125, com_y=0.04, theta_left=math.radians(5),
        theta_right=math.radians(15), p_left=np.array([left]), p_right=np.array([right]),
        friction_left=0.3, friction_right=0.3,
    ).closing[0]  # fmt: skip
    heading = page.get_by_role("heading", name="Driven together")
    expect(heading).to_contain_text(mode_name(mode))
    assert canvas.bounding_box() == box  # the map stays under the pointer
    assert command_of(page) == first
    page.mouse.move(0, 0)
    expect(page.locator("#shown-state")).not_to_contain_text("under the pointer")
    assert_words_of(page, -20, 0)
    move(40, -50)
    page.mouse.down()
    page.mouse.up()
    page.mouse.move(0, 0)
    chosen = [float(page.locator(f"#p-{side}").input_value()) for side in ("left", "right")]
    assert chosen == pytest.approx([40, -50], abs=1)
    assert contacts_shown(page) == tuple(chosen)
    assert_words_of(page, *chosen)


def mode_name(mode: int) -> str:
    return {-1: "not held", -2: "jammed"}.get(mode) or "-".join(CONTACT_MODES[mode])


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


def test_design_shows_the_region_of_the_pair_and_what_limits_it(open_page: Open) -> None:
    page = open_page(hash_of("design", palm__steep_deg=29.0))
    places = 0.075 * 2.6 * ((np.arange(64) + 0.5) / 32 - 1)
    left, right = np.meshgrid(places, places)
    pictures = []
    for steep in (29, 33):
        for _ in range(0 if steep == 29 else 8):
            page.locator("#design-map").press("ArrowUp")
        expect(page.get_by_role("heading", name=f"Shallow 5°, steep {steep}°")).to_be_visible()
        found = modes_batch(
            width=0.25, com_x=0.125, com_y=0.04, theta_left=math.radians(5),
            theta_right=math.radians(steep), p_left=left, p_right=right,
            friction_left=0.3, friction_right=0.3,
        )  # fmt: skip
        at_rest = pb.modes(p_left_m=0, p_right_m=0, theta_left_deg=5, theta_right_deg=steep)
        for k, (modes, mode) in enumerate(
            ((found.closing, at_rest.closing), (found.opening, at_rest.opening))
        ):
            figure = page.locator("figure.map").nth(k)
            names = {name.strip() for name in figure.locator(".key li").all_inner_texts()}
            assert names == {mode_name(m) for m in np.unique(modes)}
            assert mode is not None
            expect(figure.locator("figcaption")).to_contain_text(f"requires {'-'.join(mode)} in")
        pictures.append([
            page.evaluate(f"document.getElementById('region-{k}').toDataURL()") for k in (0, 1)
        ])  # fmt: skip
    assert all(before != after for before, after in zip(*pictures, strict=True))
    go(page, hash_of("design", palm__steep_deg=19.0))
    page.locator("[data-key='palm.friction']").fill("0.4")
    keys = {"palm.steep_deg": 19.0, "palm.friction": 0.4}
    found = pb.analyze("paper", overrides=keys).com_x_m
    assert found is not None
    most = 1000 * min(0.125 - found[0], found[1] - 0.125)
    expect(page.locator("#tolerance")).to_contain_text(f"±{most:.1f} mm")
    rows = page.locator("table", has_text="what happens beyond").locator("tbody tr")
    seen = rows.evaluate_all("all => all.map(row => [...row.cells].map(cell => cell.innerText))")
    assert len(seen) == 4
    for number, side, permitted, beyond in seen:
        key = (int(number[0]), side)
        ends = [float(end) / 1000 for end in re.findall(r"[\d.]+", permitted)]
        said = []  # what happens half a millimetre beyond either end
        for com in (ends[0] - 0.0005, ends[1] + 0.0005):
            one = pb.analyze("paper", overrides={**keys, "object.com_m": [com, 0.04]})
            assert not one.properties[key].holds
            said.append(one.properties[key].binding)
        assert beyond == "; ".join(dict.fromkeys(said))


# How each story ends before and after the one thing to do.
STORY_ENDS = {
    1: ("delivered", "delivered"),
    2: ("the right robot still waits for Ack", "delivered"),
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
        expect(page.locator(".ending")).not_to_contain_text(re.compile("waits|not ended"))
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
    moved = pb.modes(
        p_left_m=0.0, p_right_m=-0.02, theta_left_deg=15, theta_right_deg=5,
        overrides={"object.com_m": [0.16, 0.04]},
    )  # fmt: skip
    assert moved.closing == ("SL", "ST")
