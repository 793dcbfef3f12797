# SPDX-License-Identifier: Apache-2.0
"""The page shows what a robot does: it corrects, assists, or waits for a message."""

import io

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

import palmbots as pb
from palmbots.control.registry import resolve
from site_pages import Open, go, hash_of, pictures

# The first TiltUp is lost: both robots wait for the Ack of the other, to the end.
BOTH_WAIT: dict[str, object] = {
    "radio__script": [{"sender": "right", "message": 1, "effect": "lost"}]
}
LEFT = (0x00, 0x68, 0xA4)


def solid(page: Page) -> float:
    """The share of the line of the left robot, in the chart of corrections, in its full colour."""
    (data,) = pictures(page, "sequence-chart")
    image = np.asarray(Image.open(io.BytesIO(data)).convert("RGB"), int)
    line = image[26 - 5 : 26 + 6, 60:-20]
    return float((line == LEFT).all(-1).mean())


def test_robots_that_wait_are_shown_as_waiting(open_page: Open) -> None:
    page = open_page(hash_of("carry", {"t": 5}, **BOTH_WAIT), width=1366)
    expect(page.locator(".left-text")).to_contain_text("(a) has asked its partner")
    expect(page.locator(".left-text")).to_contain_text("waits for an Ack")
    expect(page.locator(".right-text")).to_contain_text("(b) both robots have asked; waits for an")
    assert solid(page) < 0.05
    # The same robot in a correction that does not end.
    moves = {
        "robot__noise_m_s": 0.0, "task__distance_m": 0.5,
        "bumps__script": [{"robot": "left", "at_s": 0.4, "shift_m": 0.04},
                          {"robot": "right", "at_s": 0.6, "shift_m": -0.02}],
        "faults__script": [{"kind": "reboot", "robot": "right", "at_s": 0.8, "duration_s": 0.02}],
    }  # fmt: skip
    go(page, hash_of("carry", {"t": 5}, **moves))
    expect(page.locator(".left-text")).to_contain_text("(a) moves away, its partner assists")
    assert solid(page) > 0.5


@pytest.mark.parametrize("controller", ["distributed", "resilient", "silent", "shared-sign"])
def test_the_words_are_those_of_the_table(open_page: Open, controller: str) -> None:
    """At moments at which the trace of the package names a case, and only there."""
    trace = pb.carry("figure8", controller).trace
    assert trace is not None
    page = open_page(hash_of("carry", {"scene": "figure8", "controller": controller, "t": 0.5}))
    known = resolve(controller).states.values()
    seen = set()
    for time in np.arange(0.55, 6.0, 0.3):
        page.locator("#scrub").fill(f"{time:.2f}")
        cases = trace.case.sel(time=time, method="nearest").values
        for side, case in zip(("left", "right"), cases, strict=True):
            words = page.locator(f".{side}-text").inner_text()
            _, _, does = words.partition(" mm")
            if not str(case).strip():
                assert does == ""
                continue
            assert does.startswith(f", ({case}) ")
            assert does.removeprefix(f", ({case}) ") in known
            seen.add(does)
    assert len(seen) > 3
