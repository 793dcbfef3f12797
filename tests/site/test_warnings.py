# SPDX-License-Identifier: Apache-2.0
"""The page shows the warnings that the command prints before and after a carry."""

import pytest
from playwright.sync_api import expect

import palmbots as pb
from palmbots.control.dead_band import warnings_before
from palmbots.errors import SceneError
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
    ("none", 0, {"mujoco__palm_torque_n_m": 600.0}),
    (
        "silent",
        1,
        {"object__contacts": [2, 3], "object__vertices_m": TURNED, "object__com_m": [0.125, 0.04]},
    ),
    # Numbers that exceed what the analysis allows.
    ("distributed", 0, {"object__mass_kg": 3.0}),
    ("distributed", 0, {"object__mass_kg": 1.5, "mujoco__body_kg": 1.0}),
    ("none", 0, {"object__mass_kg": 3.0}),
    ("distributed", 0, {"task__slope_deg": 8.0}),
    ("resilient", 0, {"task__slope_deg": -6.0, "task__direction": "backward"}),
    ("distributed", 0, {"robot__acceleration_m_s2": 0.9}),
    ("shared-sign", 0, {"palm__rate_deg_s": 700.0}),
    ("distributed", 0, {"object__com_m": [0.16, 0.04]}),
    ("silent", 0, {"palm__left__friction": 0.15, "palm__right__length_m": 0.2}),
    ("distributed", 0, {"palm__length_m": 0.36, "palm__steep_deg": 50.0}),
]


def limits_of(scene: pb.Scene, controller: str) -> tuple[str, ...]:
    """What the command adds to the warnings of a carry: the analysis is about corrections."""
    return () if controller == "none" else self_check(scene)


def test_page_and_command_warn_alike(open_page: Open) -> None:
    page = open_page("#carry?t=1", width=1366, height=768)
    found = []
    for controller, seed, keys in CASES:
        overrides = {name.replace("__", "."): value for name, value in keys.items()}
        carried = pb.carry("paper", controller, seed=seed, overrides=overrides, record=False)
        go(page, hash_of("carry", {"controller": controller, "seed": seed, "t": 10000}, **keys))
        expect(page.locator("#hash")).to_have_text(carried.trace_hash)
        early = (*warnings_before(carried.scene, controller), *limits_of(carried.scene, controller))
        late = carried.warnings[len(warnings_before(carried.scene, controller)) :]
        expect(page.locator(".warnings li")).to_have_text(
            [f"warning: {line}" for line in (*early, *late)]
        )
        is_good = carried.outcome == "delivered" and not late
        expect(page.locator(".status strong")).to_have_class("good" if is_good else "bad")
        page.evaluate("scrollTo(0, 0)")
        for place in (".warnings", "#play", ".hands"):  # below the stage
            if early or late or place != ".warnings":
                expect(page.locator(place)).to_be_in_viewport(ratio=1)
        found += [*early, *late]
    for part in (
        "for an Ack",
        "for a TiltDown",
        "stands: it hears nothing fresh",
        "corrections may not end",
        "carries like the controller silent",
        "a fault may drop the object",
        "never reads -:",
        "rests upside down",
        "that of the paper's box",
        "if that is in mN m, write 0.6",
        "the robots certainly hold only",
        "task.slope_deg is 8, but",
        "task.slope_deg is -6, but",
        "robot.acceleration_m_s2 is 0.9, but",
        "palm.rate_deg_s turns",
        "property 1 fails for contacts somewhere",
        "cannot hold on the whole palms",
    ):
        assert any(part in line for line in found)


@pytest.mark.parametrize(
    "keys",
    [
        {"object__mass_kg": 20.0},
        {"palm__length_m": 0.28},
        {"object__mass_kg": 5.0, "start__left_m": 0.05, "mujoco__palm_torque_n_m": 0.1},
        {"object__mass_kg": 5.0, "start__left_m": 0.05, "mujoco__axle_m": 0.05},
    ],
)
@pytest.mark.parametrize("controller", ["distributed", "none"])
def test_what_cannot_begin_is_refused_as_by_the_command(
    open_page: Open, keys: dict[str, object], controller: str
) -> None:
    overrides = {name.replace("__", "."): value for name, value in keys.items()}
    with pytest.raises(SceneError) as refused:
        pb.carry("paper", controller, overrides=overrides)
    page = open_page(hash_of("carry", {"controller": controller, "t": 1}, **keys))
    expect(page.locator(".refusal")).to_have_text(f"This scene cannot be carried: {refused.value}")


@pytest.mark.parametrize("side", ["left", "right"])
def test_compare_shows_them_too(open_page: Open, side: str) -> None:
    keys = lost(side, 1)
    (line, *_) = pb.carry(overrides={"radio.script": keys["radio__script"]}).warnings
    page = open_page(hash_of("compare", {"v.a": "distributed", "t": 10000}, **keys))
    expect(page.locator(".lane-warnings").first).to_contain_text(line)


def test_compare_warns_of_the_scene_from_the_start_as_carry_does(open_page: Open) -> None:
    keys: dict[str, object] = {"task__slope_deg": 8.0, "radio__latency_s": 0.15}
    shown = {}
    for controller in ("centralized", "resilient", "silent", "none"):
        page = open_page(hash_of("carry", {"controller": controller, "t": 0.1}, **keys))
        shown[controller] = page.locator(".warnings li").all_inner_texts()
    assert len({len(lines) for lines in shown.values()}) > 1
    for first, second in (("centralized", "resilient"), ("silent", "none")):
        names = {"v.a": first, "v.b": second, "t": 0.1}
        page = open_page(hash_of("compare", names, **keys), width=1366, height=768)
        for lane, name in zip(page.locator(".lane-warnings").all(), (first, second), strict=True):
            expect(lane.locator("li")).to_have_text(shown[name])
