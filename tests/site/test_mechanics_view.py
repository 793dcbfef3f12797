# SPDX-License-Identifier: Apache-2.0
"""The view Mechanics: modes, drags, maps."""

import io
import math
import re
from typing import Any

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

import palmbots as pb
from commands import runner
from palmbots.mechanics.contact_mode_words import decision_sentence, margin_sentence, mode_sentence
from palmbots.mechanics.contact_modes import contact_modes_batch
from site_pages import Open, command_of, hash_of, mode_name, pictures, run_json


def assert_sentences(page: Page, found: pb.mechanics.ContactModes) -> None:
    """The page states both directions in the package's sentences."""
    held = ("ST", "ST") in found.feasible
    for name, mode in (("closing", found.closing), ("opening", found.opening)):
        decided = decision_sentence(found.squeeze, closing=name == "closing", held=held)
        said = page.locator(f"#{name}-words")
        expect(said).to_have_text(f"{mode_sentence(mode, held=held)} {decided}")


STATES = [(5, 15, -20, 0), (15, 5, 30, -40), (15, 15, 10, 10), (25, 5, 60, 0), (0, 45, -70, 70)]


@pytest.mark.parametrize("state", STATES)
def test_mechanics_names_the_modes(
    open_page: Open, capsys: pytest.CaptureFixture[str], state: tuple[float, ...]
) -> None:
    page = open_page("#mechanics")
    for name, value in zip(("theta-left", "theta-right", "p-left", "p-right"), state, strict=True):
        page.locator(f"#{name}").fill(str(value))
    found = pb.contact_modes(
        p_left_m=state[2] / 1000, p_right_m=state[3] / 1000, theta_left_deg=state[0],
        theta_right_deg=state[1],
    )  # fmt: skip
    for what, mode in (("Closing", found.closing), ("Opening", found.opening)):
        heading = page.get_by_role("heading", name=f"{what}:")
        if mode is not None:
            expect(heading).to_contain_text("-".join(mode))
        else:
            expect(heading).to_contain_text("held" if found.margin_rad < 0 else "jammed")
        if mode is None or found.squeeze is None:
            continue
        # The binding inequality: which end of whose interval the squeeze reaches first.
        ends = {side: found.squeeze[side][what == "Closing"] for side in ("left", "right")}
        first, second = sorted(ends, key=lambda side: ends[side], reverse=what == "Opening")
        said = page.locator("#closing-words" if what == "Closing" else "#opening-words")
        if ends[first] == pytest.approx(ends[second], abs=1e-9):
            wanted = [f"edges of both cones at once: H = {ends[first]:.3f}."]
        else:
            wanted = [f"edge of the {first} cone first: H = {ends[first]:.3f}",
                      f"{ends[second]:.3f} at the", f"edge of the {second} cone."]  # fmt: skip
        for words in wanted:
            expect(said).to_contain_text(words.replace("-", "−"))
    # The page's sentences are those of the package.
    assert_sentences(page, found)
    expect(page.locator("#margin-words")).to_have_text(margin_sentence(found.margin_rad))
    happens = page.locator(".contact-modes td.happens")
    for name, mode in (("closing", found.closing), ("opening", found.opening)):
        if mode is not None:  # in the row and the column of its codes
            head = page.get_by_role("rowheader", name=mode[0])
            row = page.locator(".contact-modes tbody tr", has=head)
            column = page.locator(".contact-modes thead th").all_inner_texts().index(mode[1])
            expect(row.locator("th, td").nth(column)).to_contain_text(name)
    expect(happens).to_have_count(len({m for m in (found.closing, found.opening) if m}))
    balanced = page.locator(".contact-modes td:not(.no)")
    expect(balanced).to_have_count(len(found.feasible))
    printed = run_json(runner(capsys), command_of(page))
    assert printed["closing"] == (list(found.closing) if found.closing else None)
    assert printed["p_left_m"] == state[2] / 1000


def test_rounded_contact_vertices_act_where_they_touch(open_page: Open) -> None:
    radii = [0.03, 0.01, 0, 0]
    page = open_page(hash_of("mechanics", object__edge_radius_m=radii))
    state: dict[str, Any] = {
        "p_left_m": -0.02,
        "p_right_m": 0.05,
        "theta_left_deg": 9,
        "theta_right_deg": 17,
    }
    for name, value in zip(("p-left", "p-right", "theta-left", "theta-right"), state, strict=True):
        page.locator(f"#{name}").fill(f"{state[value] * (1000 if value[0] == 'p' else 1):g}")
    found = pb.contact_modes(**state, overrides={"object.edge_radius_m": radii})
    assert_sentences(page, found)
    expect(page.locator("#margin-words")).to_have_text(margin_sentence(found.margin_rad))
    sharp = pb.contact_modes(**state)
    assert sharp.squeeze.left != pytest.approx(found.squeeze.left, rel=0.01)


def drag_handle(page: Page, name: str, dx: float, dy: float) -> None:
    box = page.locator(f"#handle-{name}").bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx / 2, y + dy / 2)
    page.mouse.move(x + dx, y + dy)
    page.mouse.up()


def drawings(page: Page) -> dict[str, bytes]:
    names = ("state-picture", "map-closing", "com-map")
    return dict(zip(names, pictures(page, *names), strict=True))


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
        assert after["state-picture"] != before["state-picture"]  # Figures 3 and 4
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
    (data,) = pictures(page, "com-map")
    picture = Image.open(io.BytesIO(data))
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
    found = pb.contact_modes(
        p_left_m=p_left / 1000, p_right_m=p_right / 1000, theta_left_deg=5, theta_right_deg=15
    )
    assert_sentences(page, found)
    expect(page.locator(".contact-modes td:not(.no)")).to_have_count(len(found.feasible))


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
    mode = contact_modes_batch(
        width=0.25, com_x=0.125, com_y=0.04, theta_left=math.radians(5),
        theta_right=math.radians(15), p_left=np.array([left]), p_right=np.array([right]),
        friction_left=0.3, friction_right=0.3,
    ).closing[0]  # fmt: skip
    heading = page.get_by_role("heading", name="Closing:")
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
