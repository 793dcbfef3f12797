# SPDX-License-Identifier: Apache-2.0
"""The view Design: tolerance, region, what limits it."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import expect

import palmbots as pb
from palmbots.mechanics.contact_modes import contact_modes_batch
from site_pages import Open, command_of, go, hash_of, mode_name, pictures


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
    assert command_of(page)[:4] == ["certify", "scene.toml", "--region", "-0.04,0.04"]
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
    regions = []
    for steep in (29, 33):
        for _ in range(0 if steep == 29 else 8):
            page.locator("#design-map").press("ArrowUp")
        expect(page.get_by_role("heading", name=f"Shallow 5°, steep {steep}°")).to_be_visible()
        found = contact_modes_batch(
            width=0.25, com_x=0.125, com_y=0.04, theta_left=math.radians(5),
            theta_right=math.radians(steep), p_left=left, p_right=right,
            friction_left=0.3, friction_right=0.3,
        )  # fmt: skip
        at_rest = pb.contact_modes(p_left_m=0, p_right_m=0, theta_left_deg=5, theta_right_deg=steep)
        for k, (modes, mode) in enumerate(
            ((found.closing, at_rest.closing), (found.opening, at_rest.opening))
        ):
            figure = page.locator("figure.map").nth(k)
            names = {name.strip() for name in figure.locator(".key li").all_inner_texts()}
            assert names == {mode_name(m) for m in np.unique(modes)}
            assert mode is not None
            expect(figure.locator("figcaption")).to_contain_text(f"requires {'-'.join(mode)} in")
        regions.append(pictures(page, "region-0", "region-1"))
    assert all(before != after for before, after in zip(*regions, strict=True))
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
