# SPDX-License-Identifier: Apache-2.0
"""Messages in the view Carry: each can be chosen, lost, delayed and duplicated."""

import re

import pytest
from playwright.sync_api import expect

import palmbots as pb
from site_pages import Open, assert_reproduced, hash_of, overrides_of, seconds

FIGURE8 = {"scene": "figure8"}


@pytest.mark.parametrize(
    ("effect", "entry"),
    [
        ("lost", {"effect": "lost"}),
        ("delayed", {"effect": "delayed", "delay_s": 0.5}),
        ("duplicated", {"effect": "duplicated", "delay_s": 0.5}),
    ],
)
def test_messages(
    open_page: Open, capsys: pytest.CaptureFixture[str], effect: str, entry: dict[str, object]
) -> None:
    page = open_page(hash_of("carry", {**FIGURE8, "t": 0.1}))
    page.locator("#sequence-chart").focus()
    page.keyboard.press("m")  # TiltUp
    page.keyboard.press("m")  # Ack
    expect(page.locator(".card")).to_contain_text("Ack from the left robot")
    page.locator(f"[data-effect={effect}]").click()
    assert overrides_of(page)["radio.script"] == [{"sender": "left", "message": 1, **entry}]
    carried = pb.carry("figure8", overrides=overrides_of(page))
    ack = next(m for m in carried.message_log if m.kind == "Ack")
    assert (ack.received_s is None) == (effect == "lost")
    assert_reproduced(page, capsys)
    page.locator(f"[data-effect={effect}]").click()  # once more takes it back
    expect(page.locator("#hash")).to_have_text(pb.carry("figure8").trace_hash)


def test_a_beacon_is_lost(open_page: Open, capsys: pytest.CaptureFixture[str]) -> None:
    """Messages of other controllers, too: each has its number."""
    page = open_page(hash_of("carry", {"controller": "resilient", "t": 1.02}))
    page.locator("#sequence-chart").focus()
    page.keyboard.press("m")
    page.locator("[data-effect=lost]").click()
    (fault,) = overrides_of(page)["radio.script"]
    carried = pb.carry("paper", "resilient", overrides=overrides_of(page))
    mine = [m for m in carried.message_log if m.sender == fault["sender"]]
    assert [k for k, m in enumerate(mine) if m.received_s is None] == [fault["message"] - 1]
    assert mine[fault["message"] - 1].sent_s == pytest.approx(seconds(page), abs=0.006)
    assert_reproduced(page, capsys)


LINKS = {
    "left_to_station": ("report", "the left robot", {"sender": "left"}),
    "right_to_station": ("report", "the right robot", {"sender": "right"}),
    "station_to_left": ("command", "the station to the left robot",
                        {"sender": "station", "receiver": "left"}),
    "station_to_right": ("command", "the station to the right robot",
                         {"sender": "station", "receiver": "right"}),
}  # fmt: skip


@pytest.mark.parametrize("link", LINKS)
def test_packets_of_a_station_are_chosen_and_lost(
    open_page: Open, capsys: pytest.CaptureFixture[str], link: str
) -> None:
    """A click between two lines chooses the packet that was sent there, also one without news."""
    kind, words, sender = LINKS[link]
    page = open_page(hash_of("carry", {"controller": "centralized", "t": 0.5}))
    chart = page.locator("#sequence-chart")
    box = chart.bounding_box()
    assert box is not None
    seconds_shown = box["width"] / 85  # as long as the carry is longer
    x = 46 + (box["width"] - 56) * 4.2 / seconds_shown  # between two corrections
    y = {"left_to_station": 42, "station_to_left": 85, "station_to_right": 107,
         "right_to_station": 150}[link]  # fmt: skip
    chart.click(position={"x": x, "y": y})
    card = page.locator(".card")
    expect(card).to_contain_text(f"{kind} from {words} at 4.")
    sent_s = float(re.findall(r"at ([\d.]+) s", card.inner_text())[0])
    assert sent_s == pytest.approx(4.2, abs=0.02)
    page.locator("[data-effect=lost]").click()
    expect(card).to_contain_text("lost")
    (fault,) = overrides_of(page)["radio.script"]
    number = fault.pop("message")
    assert fault == {**sender, "effect": "lost"}
    # A robot sends from the first control period on, the station when it has heard both.
    first_s = 0.0 if kind == "report" else 0.05
    assert number == round((sent_s - first_s) / 0.01) + 1
    carried = pb.carry("paper", "centralized", overrides=overrides_of(page))
    lost = {name: counts.lost for name, counts in carried.links.items()}
    assert lost == {name: int(name == link) for name in lost}
    assert_reproduced(page, capsys)


@pytest.mark.parametrize("effect", ["delayed", "duplicated"])
def test_commands_are_delayed_and_duplicated(
    open_page: Open, capsys: pytest.CaptureFixture[str], effect: str
) -> None:
    page = open_page(hash_of("carry", {"controller": "centralized", "t": 1}))
    first = page.locator("#hash").inner_text()
    page.locator("#sequence-chart").focus()
    page.keyboard.press("m")
    card = page.locator(".card")
    while "from the station" not in card.inner_text():
        page.keyboard.press("m")  # what says something new
    expect(card).to_contain_text(re.compile("palm (steep|shallow), (hold|away|closer)"))
    page.locator(f"[data-effect={effect}]").click()
    expect(page.locator(f"[data-effect={effect}]")).to_have_attribute("aria-pressed", "true")
    (fault,) = overrides_of(page)["radio.script"]
    assert (fault["sender"], fault["effect"], fault["delay_s"]) == ("station", effect, 0.5)
    if effect == "delayed":
        expect(page.locator("#hash")).not_to_have_text(first)
    assert_reproduced(page, capsys)


def test_a_message_is_chosen_by_a_click(open_page: Open) -> None:
    page = open_page(hash_of("carry", {**FIGURE8, "t": 0.1}))
    box = page.locator("#sequence-chart").bounding_box()
    assert box is not None
    carried = pb.carry("figure8")
    message = carried.message_log[0]
    assert message.received_s is not None
    middle = (message.sent_s + message.received_s) / 2
    x = 46 + (box["width"] - 56) * middle / carried.time_s
    page.locator("#sequence-chart").click(position={"x": x, "y": 65})
    expect(page.locator(".card")).to_contain_text("TiltUp from the right robot")


@pytest.mark.parametrize("height", [630, 768])
def test_a_lost_message_fits_on_one_screen(open_page: Open, height: int) -> None:
    """What the lesson's task speaks of: stage, warnings, player, chart and the chosen message."""
    page = open_page("#carry?t=0", width=1366, height=height)
    page.locator("#sequence-chart").focus()
    page.keyboard.press("m")
    page.locator("[data-effect=lost]").click()
    page.locator("#scrub").fill("1000")
    expect(page.locator(".warnings li")).to_have_count(2)
    page.evaluate("scrollTo(0, 0)")
    for place in ("#controller", "#stage", ".warnings", "#play", "#sequence-chart", ".card"):
        expect(page.locator(place)).to_be_in_viewport(ratio=1)


@pytest.mark.parametrize("controller", ["distributed", "resilient"])
def test_the_page_says_from_when_on_a_loss_matters(open_page: Open, controller: str) -> None:
    """The loss of some beacons changes nothing, that of others the carry from their arrival on."""
    page = open_page(hash_of("carry", {"controller": controller, "t": 0.7}))
    page.locator("#sequence-chart").focus()
    words = page.locator("#effect")
    said = []
    for _ in range(3):
        page.keyboard.press("m")
        said.append(words.inner_text())
        message = page.locator(".card p").first.inner_text()
        received = float(re.findall(r"received at ([\d.]+) s", message)[0])
        trace = page.locator("#hash").inner_text()
        page.locator("[data-effect=lost]").click()
        if page.locator("#hash").inner_text() == trace:
            assert said[-1] == "If it is lost, nothing changes."
        else:
            (since,) = re.findall("the carry is different from ([0-9.]+) s on", said[-1])
            assert received - 1e-9 <= float(since) <= received + 0.021
        expect(words).to_have_text(said[-1].replace("If it is", "Because it is"))
        page.locator("[data-effect=lost]").click()
        page.locator("#sequence-chart").focus()
    assert any("nothing" in text for text in said) == (controller == "resilient")
