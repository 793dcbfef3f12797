# SPDX-License-Identifier: Apache-2.0
"""The view Mechanics with any contacts: every handle and field, against the package for the same
scene."""

import math
import re
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

import palmbots as pb
from palmbots._types import SIDES
from palmbots.mechanics import SurfaceContact
from palmbots.mechanics.contact_mode_words import SENTENCES
from palmbots.mechanics.contact_points import touching
from palmbots.mechanics.mode_forces import ConsistentMode
from palmbots.mechanics.state import palm_state
from palmbots.scene.overrides import parse_overrides
from palmbots.simulation import FloorWorld
from site_pages import Open, hash_of, pictures

DEGREE_S = 1.0
FLOOR_MOTIONS: dict[str, dict[str, Any]] = {
    "closing": {"left_m_s": 0.01, "right_m_s": -0.01},
    "opening": {"left_m_s": -0.01, "right_m_s": 0.01},
    "left-in": {"left_m_s": 0.01},
    "right-in": {"right_m_s": -0.01},
    "rising": {"up_m_s": (0.01, 0.01)},
    "left-steeper": {"turn_deg_s": (DEGREE_S, 0.0)},
    "left-shallower": {"turn_deg_s": (-DEGREE_S, 0.0)},
    "right-steeper": {"turn_deg_s": (0.0, DEGREE_S)},
    "right-shallower": {"turn_deg_s": (0.0, -DEGREE_S)},
}
LIFT_OFF = {"v.floor": 1, "v.tl": 15, "v.tr": 45, "v.dl": 14, "v.dr": 10}
"""The left nose is under the edge, the right palm leans against the object."""


def number(value: float) -> str:
    if not math.isfinite(value):
        return "∞" if value > 0 else "−∞"
    return f"{round(value, 3) + 0.0:.3f}".replace("-", "−")


def span(ends: tuple[float, float]) -> str:
    low, high = map(number, ends)
    return low if low == high else f"{low} … {high}"


def home(page: Page) -> str:
    return page.locator(".command").inner_text()


def floor_world(page: Page) -> FloorWorld:
    """The world of the program that the page prints."""
    words = shlex.split(home(page).split("\npalmbots")[0])
    assert words[:2] == ["python", "-c"]
    names: dict[str, Any] = {"print": lambda *_: None}
    exec(words[2], names)
    return names["world"]


def state_of(page: Page) -> dict[str, Any]:
    """The arguments of `pb.contact_modes` in the command that the page prints."""
    words = shlex.split(home(page).splitlines()[0])
    assert words[:2] == ["palmbots", "contact-modes"]
    found: dict[str, Any] = {"scene": words[2]}
    found["overrides"] = dict(
        parse_overrides([words[k + 1] for k, w in enumerate(words) if w == "--set"])
    )
    for name in ("theta_left_deg", "theta_right_deg", "p_left_m", "p_right_m"):
        found[name] = float(words[words.index("--" + name.replace("_", "-")) + 1])
    return found


def assert_modes(page: Page, motion: str, modes: Sequence[ConsistentMode]) -> None:
    """The page lists these contact modes of a motion, with their forces, margins and limits."""
    page.locator(f"#motion-{motion}").click()
    expect(page.locator(f"#motion-{motion} .count")).to_have_text(str(len(modes)))
    if not modes:
        expect(page.locator("#mode-margin")).to_have_text(SENTENCES["no_mode"])
    for k, mode in enumerate(modes):
        if len(modes) > 1:
            page.locator(f"#mode-{k}").click()
        rows = page.locator(".forces tbody tr")
        cells = [row.locator("td").all_inner_texts() for row in rows.all()]
        assert cells == [
            [motion, span(force.normal), span(force.friction)]
            for motion, force in zip(mode.motions, mode.forces, strict=True)
        ]
        margin = SENTENCES["mode_margin" if mode.at_limit else "endless_margin"]
        expect(page.locator("#mode-margin")).to_have_text(
            margin.format(angle=f"{mode.margin_deg:.2f}°")
        )
        limits = [
            SENTENCES["carries_nothing" if limit == "BR" else "at_cone"].format(motion=limit)
            for motion, limit in zip(mode.motions, mode.at_limit or mode.motions, strict=True)
            if motion != limit
        ]
        assert page.locator(".limit").all_inner_texts() == limits


def assert_report(page: Page) -> list[str]:
    """The report is that of the package for the program or the command that the page prints.
    Returns what touches."""
    kinds = page.locator(".forces tbody .count").all_inner_texts()
    if page.locator("#floor").is_checked():
        world = floor_world(page)
        first = world.contact_modes(0.01, -0.01)
        held, count = first.held, len(first.contacts)
        is_alone = page.locator("#theta-right").count() == 0
        for motion, given in FLOOR_MOTIONS.items():
            if is_alone and motion.startswith("right"):
                expect(page.locator(f"#motion-{motion}")).to_have_count(0)
            else:
                assert_modes(page, motion, world.contact_modes(**given).modes)
    else:
        given = state_of(page)
        found = pb.contact_modes(**given)
        assert found.modes_closing is not None and found.modes_opening is not None
        held, count = bool(found.held), len(found.contacts)
        assert kinds == [one.kind for one in found.contacts]
        assert_modes(page, "closing", found.modes_closing)
        assert_modes(page, "opening", found.modes_opening)
        touched = touching(palm_state(**given))
        for side in SIDES:
            for name, up in (("steeper", False), ("shallower", True)):
                page.locator(f"#motion-{side}-{name}").click()
                seen = page.locator(".forces tbody tr td:nth-of-type(1)").all_inner_texts()
                ways = touched.turning(side, up)
                expect(page.locator(f"#motion-{side}-{name} .count")).to_have_text(str(len(ways)))
                assert tuple(seen) == (ways[0] if ways else ("",) * count)
    sentence = SENTENCES["all_hold" if held else "all_slip"].format(count=count)
    expect(page.locator("#held")).to_have_text(sentence)
    return kinds


def drag(page: Page, name: str, dx: float, dy: float) -> None:
    box = page.locator(f"#handle-{name}").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx / 2, y + dy / 2)
    page.mouse.move(x + dx, y + dy)
    page.mouse.up()


def report(page: Page) -> str:
    return page.locator(".state").inner_text()


FIELDS = {
    "edge-radius": ("object.edge_radius_m", (-6, 6)),
    "thickness": ("palm.thickness_m", (2, 9)),
    "nose": ("palm.nose_m", (0, 3)),
    "bevel": ("palm.bevel_m", (-4, 1)),
    "heel": ("palm.heel_m", (-2, -9)),
}


@pytest.mark.parametrize("name", FIELDS)
def test_a_handle_shapes_what_touches(open_page: Open, name: str) -> None:
    """Each handle changes its key, picture and report follow, and the report is the package's."""
    key, (dx, dy) = FIELDS[name]
    place = hash_of("mechanics", {"scene": "plate", **LIFT_OFF}, object__edge_radius_m=0.003)
    page = open_page(place)
    field = page.locator(f"#{name}")
    before = float(field.input_value())
    assert_report(page)
    (drawn,) = pictures(page, "state-picture")
    drag(page, name, dx, dy)
    after = float(field.input_value())
    assert abs(after - before) > 0.05
    assert pictures(page, "state-picture") != [drawn]
    assert f'"{key}": {after / 1000:g}' in home(page)
    address = page.evaluate("location.hash")
    page.wait_for_function("key => location.hash.includes(key)", arg=f"{key}%3D{after / 1000:g}")
    assert key in page.evaluate("location.hash") or address
    assert_report(page)
    # The keyboard and the field do the same.
    page.locator(f"#handle-{name}").focus()
    page.keyboard.press("ArrowUp" if name == "heel" else "ArrowDown")
    page.keyboard.press("ArrowLeft" if name != "bevel" else "ArrowRight")
    assert float(field.input_value()) != after
    field.fill(f"{before:g}")
    field.press("Enter")
    (again,) = pictures(page, "state-picture")
    assert again == drawn


def test_the_radius_decides_where_the_object_rests(open_page: Open) -> None:
    """A larger radius lets the nose lift the edge later: the reports differ."""
    place = hash_of("mechanics", {"scene": "plate", **LIFT_OFF}, object__edge_radius_m=0.003)
    page = open_page(place)
    before = report(page)
    page.locator("#edge-radius").fill("12")
    page.locator("#edge-radius").press("Enter")
    assert_report(page)
    page.locator("#motion-closing").click()
    assert report(page) != before


def test_examples_show_further_contacts(open_page: Open) -> None:
    page = open_page("#mechanics")
    page.locator("#from-the-floor").click()
    assert assert_report(page) == ["vertex", "vertex", "floor"]
    page.locator("#motion-closing").click()
    assert page.locator(".forces td:nth-of-type(1)").all_inner_texts() == ["SL", "ST", "BR"]
    page.locator("#rounded-edge").click()
    assert "flush" in assert_report(page)
    page.locator("#reset").click()
    expect(page.locator("#closing-words")).to_contain_text("The left contact slides up")
    assert page.locator(".forces").count() == 0


@pytest.mark.parametrize("theta", [(0, 15, 0, 0), (0, 0, -10, 20)])
def test_flush_contacts_of_sharp_vertices_are_reported(
    open_page: Open, theta: tuple[float, ...]
) -> None:
    names = ("theta-left", "theta-right", "p-left", "p-right")
    page = open_page("#mechanics")
    for name, value in zip(names, theta, strict=True):
        page.locator(f"#{name}").fill(str(value))
    assert "flush" in assert_report(page)


def test_palms_drive_and_rise_on_the_floor(open_page: Open) -> None:
    page = open_page(
        hash_of("mechanics", {"scene": "plate", "v.tl": 15}, object__edge_radius_m=0.003)
    )
    page.locator("#floor").check()
    assert assert_report(page) == ["floor", "floor"]
    for handle, field, by in (
        ("drive-left", "driven-left", (18, 0)), ("drive-right", "driven-right", (-40, 0)),
        ("raise", "raised", (0, -25)),
    ):  # fmt: skip
        before = pictures(page, "state-picture")
        drag(page, handle, *by)
        assert float(page.locator(f"#{field}").input_value()) > 5
        assert pictures(page, "state-picture") != before, handle
        assert_report(page)
        page.locator("#motion-closing").click()
    assert page.locator(".forces tbody .count").all_inner_texts() == ["vertex", "vertex"]
    # The floor does not matter in the air; on it, its friction does.
    drag(page, "raise", 0, 60)
    page.locator("#driven-left").fill("12")
    page.locator("#driven-right").fill("0")
    before = report(page)
    page.locator("#floor-friction").fill("0.6")
    assert report(page) != before
    assert_report(page)


def test_a_wall_in_place_of_the_right_palm(open_page: Open) -> None:
    """It is drawn, dragged and reported, and neither the object nor the palm may be in it."""
    page = open_page("#mechanics")
    page.locator("#one-palm-and-a-wall").click()
    assert assert_report(page) == ["vertex", "wall", "wall"]
    before = pictures(page, "state-picture")
    drag(page, "wall", 30, 20)
    assert pictures(page, "state-picture") != before
    expect(page.locator(".command")).not_to_contain_text('"at_m": 0.065')
    assert_report(page)
    page.locator("#driven-left").fill("300")
    expect(page.locator(".over .refusal")).to_have_text(
        "floor.walls[0]: on the way, the left palm would be in the wall; allowed: places outside it"
    )
    page.locator("#driven-left").fill("0")
    held = page.locator(".command").inner_text()
    drag(page, "wall", -150, 0)
    expect(page.locator(".over .refusal")).to_contain_text("would be in a wall or in a stand")
    assert page.locator(".command").inner_text() == held


def test_an_object_on_a_stand(open_page: Open) -> None:
    page = open_page(hash_of("mechanics", {"scene": "plate", "v.floor": 1}))
    page.locator("#surroundings").select_option("on a stand")
    assert assert_report(page) == ["stand", "stand"]
    drag(page, "stand-right", 40, -20)
    assert_report(page)
    page.locator("#driven-left").fill("40")
    assert_report(page)
    page.locator("#surroundings").select_option("alone")
    assert "floor.stands" not in page.locator(".command").inner_text()


def test_palms_that_cannot_go_on_say_why(open_page: Open) -> None:
    page = open_page(hash_of("mechanics", {"scene": "plate", **LIFT_OFF, "v.dl": 30, "v.dr": 30}))
    end = floor_world(page).state.end
    assert end  # a nose gets under no sharp edge
    expect(page.locator(".over .refusal")).to_contain_text(f"the palms stop here: {end}")
    assert assert_report(page) == ["tip", "tip", "floor", "floor"]


def test_a_floor_may_slope(open_page: Open) -> None:
    place = hash_of("mechanics", {"scene": "plate", **LIFT_OFF}, task__slope_deg=6)
    page = open_page(place)
    assert_report(page)
    page.locator("#edge-radius").fill("3")
    page.locator("#edge-radius").press("Enter")
    assert len(assert_report(page)) == 3


@pytest.mark.parametrize(
    ("name", "key", "value", "most"),
    [
        ("edge-radius", "object.edge_radius_m", 200, 80),
        ("heel", "palm.heel_m", 1500, 1000),
        ("thickness", "palm.thickness_m", 0.2, 0.3),
        ("nose", "palm.nose_m", 4, 1.5),
        ("bevel", "palm.bevel_m", 400, 150),
    ],
)
def test_the_core_refuses_what_no_scene_may_have(
    open_page: Open, name: str, key: str, value: float, most: float
) -> None:
    """In the words of the package; the value goes as far as the core permits."""
    page = open_page(hash_of("mechanics", {"scene": "plate"}))
    field = page.locator(f"#{name}")
    field.fill(str(value))
    field.press("Enter")
    with pytest.raises(pb.SceneError) as refused:
        pb.contact_modes("plate", overrides={key: value / 1000})
    said = page.locator(".over .refusal")
    assert f"overrides: {said.inner_text()}" == str(refused.value)
    expect(field).to_have_value(f"{most:g}")
    assert pb.contact_modes("plate", overrides={key: most / 1000, "palm.friction": 0.2})


def test_a_palm_in_the_object_is_refused_in_the_words_of_the_package(open_page: Open) -> None:
    page = open_page(hash_of("mechanics", {"v.tl": -5}, object__edge_radius_m=0.02))
    with pytest.raises(pb.PalmbotsError) as refused:
        pb.contact_modes(**state_of(page))
    expect(page.locator(".over .refusal")).to_have_text(str(refused.value))


def test_objects_on_a_floor_stay_scenes(
    open_page: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A dragged corner is in the file beside the program; one across the object is refused."""
    place = hash_of("mechanics", {"scene": "plate", **LIFT_OFF}, object__edge_radius_m=0.003)
    page = open_page(place)
    drag(page, "corner-3", 20, 10)
    with page.expect_download() as download:
        page.get_by_role("button", name="save scene.toml").click()
    download.value.save_as(tmp_path / "scene.toml")
    monkeypatch.chdir(tmp_path)
    assert len(assert_report(page)) == 3
    before = home(page)
    drag(page, "corner-3", 40, 200)
    expect(page.locator(".over .refusal")).to_contain_text("object.")
    assert home(page) == before
    page = open_page(hash_of("mechanics", LIFT_OFF, object__com_m=[0.5, 0.04]))
    with pytest.raises(pb.SceneError) as refused:
        FloorWorld(overrides={"object.com_m": [0.5, 0.04]})
    said = page.locator(".over .refusal").inner_text()
    assert f"overrides: {said}" == str(refused.value)


def test_a_dragged_corner_keeps_the_radius(open_page: Open) -> None:
    page = open_page(hash_of("mechanics", object__edge_radius_m=0.02))
    drag(page, "corner-2", -10, 14)
    expect(page.locator("#edge-radius")).to_have_value("20")
    assert re.search(r"edge_radius_m%3D0\.02", page.evaluate("location.hash")) is not None


@pytest.mark.parametrize(
    ("theta_deg", "p_mm", "slope_deg"), [((45, 50), 4, 0), ((50, 50), 0, 2), ((30, 55), -10, 0)]
)
def test_a_pipe_has_two_contacts_that_move_together(
    open_page: Open, theta_deg: tuple[float, float], p_mm: float, slope_deg: float
) -> None:
    """Both are at one distance from the point where the palms meet, and the pivots at one height:
    p_R sin θ_R = p_L sin θ_L + R (cos θ_L − cos θ_R)."""
    place = {"scene": "pipe", "v.tl": theta_deg[0], "v.tr": theta_deg[1], "v.pl": p_mm}
    page = open_page(hash_of("mechanics", place, task__slope_deg=slope_deg))
    kinds = page.locator(".forces tbody .count").all_inner_texts()
    assert kinds == ["vertex", "vertex"] and page.locator("#p-right").count() == 0
    lists: list[Sequence[SurfaceContact]] = []
    found = []
    words = shlex.split(home(page).split("\npalmbots")[0])
    assert words[:2] == ["python", "-c"]
    exec(words[2], {"print": found.append})
    names: dict[str, Any] = {"print": lambda *_: lists.append(names["contacts"])}
    exec(words[2], names)
    theta = [math.radians(angle) for angle in theta_deg]
    radius = 0.08
    for k, contact in enumerate(lists[0]):
        out = (-1, 1)[k]
        normal = (-out * math.sin(theta[k]), math.cos(theta[k]))
        assert contact.normal == pytest.approx(normal, abs=1e-12)
        # From its centre, which is the COM.
        assert contact.point_m == pytest.approx([-radius * n for n in normal], abs=1e-12)
    for motion, one in zip(("closing", "opening"), found, strict=True):
        assert_modes(page, motion, one.modes)
        assert one.modes
    before = pictures(page, "state-picture")
    drag(page, "contact-left", -12, 0)
    assert float(page.locator("#p-left").input_value()) > p_mm
    assert pictures(page, "state-picture") != before


def test_a_pipe_on_a_floor_is_refused_in_the_words_of_the_package(open_page: Open) -> None:
    """It rolls away; the view opens all the same, and its controls work."""
    page = open_page(hash_of("mechanics", {"scene": "pipe", "v.floor": 1}))
    with pytest.raises(pb.SceneError) as refused:
        FloorWorld("pipe")
    expect(page.locator(".over .refusal")).to_have_text(str(refused.value))
    page.locator("#edge-radius").fill("10")
    page.locator("#edge-radius").press("Enter")
    expect(page.locator(".over .refusal")).to_have_count(0)


def test_a_palm_on_a_floor_is_never_below_the_horizontal(open_page: Open) -> None:
    page = open_page(hash_of("mechanics", {"v.tl": -5}))
    page.locator("#floor").check()
    assert floor_world(page).state.palms_deg.left == 0
    assert_report(page)
