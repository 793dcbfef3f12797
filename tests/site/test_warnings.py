# SPDX-License-Identifier: Apache-2.0
"""The page shows the warnings that the command prints before and after a carry."""

import pytest
from playwright.sync_api import expect

import palmbots as pb
from palmbots.control.dead_band import warnings_before
from palmbots.stability import self_check
from site_pages import Open, go, hash_of


def lost(sender: str, message: int) -> dict[str, object]:
    """A script of the radio that loses one message."""
    return {"radio__script": [{"sender": sender, "message": message, "effect": "lost"}]}


TURNED = [[0, 0], [0.25, 0], [0.25, 0.15], [0, 0.15]]
CASES = [
    *[("distributed", seed, lost(side, 1)) for seed in (0, 1, 2) for side in ("left", "right")],
    ("distributed", 5, {"radio__loss": 0.3}),
    ("distributed", 5, {"radio__corruption": 0.3}),
    ("resilient", 0, {"radio__outages": [{"sender": "left", "start_s": 1.0, "end_s": 1000.0}]}),
    ("shared-sign", 0, lost("right", 1)),
    ("centralized", 1, {"radio__loss": 0.1}),
    ("distributed", 0, {}),
    ("centralized", 0, {"radio__latency_s": 0.15, "tactile__zero_half_width_m": 0.0025}),
    ("shared-sign", 0, {"radio__lease_s": 0.05}),
    ("resilient", 0, {"robot__noise_m_s": 0.05}),
    ("silent", 0, {"tactile__zones": [{"sign": "+", "from_m": 0.01, "to_m": 0.08}]}),
    ("none", 0, {"palm__length_m": 0.28}),
    (
        "silent",
        1,
        {"object__contacts": [2, 3], "object__vertices_m": TURNED, "object__com_m": [0.125, 0.04]},
    ),
]


def test_page_and_command_warn_alike(open_page: Open) -> None:
    page = open_page("#carry?t=1")
    found = []
    for controller, seed, keys in CASES:
        overrides = {name.replace("__", "."): value for name, value in keys.items()}
        carried = pb.carry("paper", controller, seed=seed, overrides=overrides, record=False)
        go(page, hash_of("carry", {"controller": controller, "seed": seed, "t": 10000}, **keys))
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)
        expect(page.locator(".warnings li")).to_have_text(
            [f"warning: {line}" for line in carried.warnings]
        )
        early = warnings_before(carried.scene, controller)
        assert carried.warnings[: len(early)] == early
        is_good = carried.outcome == "delivered" and carried.warnings == early
        expect(page.locator(".status strong")).to_have_class("good" if is_good else "bad")
        found += carried.warnings
    for part in (
        "for an Ack",
        "for a TiltDown",
        "stands: it hears nothing fresh",
        "corrections may not end",
        "works like silent",
        "a fault may drop the object",
        "never reads -:",
        "rests upside down",
        "that of the paper's box",
        "the palms overlap",
    ):
        assert any(part in line for line in found)


@pytest.mark.parametrize(
    ("keys", "controller"),
    [
        ({}, "distributed"),
        ({"object__com_m": [0.16, 0.04]}, "distributed"),
        ({"object__com_m": [0.16, 0.04]}, "none"),
        ({"palm__left__friction": 0.15, "palm__right__length_m": 0.2}, "silent"),
    ],
)
def test_the_page_warns_of_properties_that_fail(
    open_page: Open, keys: dict[str, object], controller: str
) -> None:
    scene = {name.replace("__", "."): value for name, value in keys.items()}
    page = open_page(hash_of("carry", {"controller": controller, "t": 1}, **keys))
    warned = self_check("paper", overrides=scene) if controller != "none" else ()
    assert len(warned) == int(bool(keys) and controller != "none")
    expect(page.locator("#failing")).to_have_count(len(warned))
    for text in warned:
        expect(page.locator("#failing")).to_contain_text(f"warning: {text.split(';')[0]};")


@pytest.mark.parametrize("side", ["left", "right"])
def test_compare_shows_them_too(open_page: Open, side: str) -> None:
    keys = lost(side, 1)
    (line, *_) = pb.carry(overrides={"radio.script": keys["radio__script"]}).warnings
    page = open_page(hash_of("compare", {"v.a": "distributed", "t": 10000}, **keys))
    expect(page.locator(".lane-title").first).to_contain_text(line)
