# SPDX-License-Identifier: Apache-2.0
"""Contacts of rounded corners with noses, palms, heels and the floor move in MuJoCo as one of the
consistent contact modes."""

import math
from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from palmbots.mechanics.consistent_modes import consistent_modes
from palmbots.mujoco.engine import mujoco
from palmbots.mujoco.engine_settings import Contact
from palmbots.mujoco.validation.floor_trials import BOTH_PALMS, FloorTrial, floor_trial
from palmbots.scene.scene import load_scene

MODULE = "palmbots.mujoco.validation.floor_trials"


def decisive(seed: int) -> FloorTrial | None:
    one = floor_trial(load_scene("paper"), seed, math.radians(1))
    return one if one is not None and one.decisive else None


@pytest.fixture(scope="module")
def by_seed() -> dict[int, FloorTrial]:
    return {seed: one for seed in range(250) if (one := decisive(seed)) is not None}


@pytest.fixture
def found(by_seed: dict[int, FloorTrial]) -> list[FloorTrial]:
    return list(by_seed.values())


def test_decisive_states_agree(found: list[FloorTrial]) -> None:
    assert len(found) > 40
    assert sum(one.agrees for one in found) >= 0.99 * len(found)


def test_with_stiff_contacts_and_fast_palms_both_noses_hop(
    by_seed: dict[int, FloorTrial], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Friction that is a hundred times stiffer changes nothing: the contacts do not creep."""
    seeds = [seed for seed, one in by_seed.items() if one.contacts == BOTH_PALMS]
    for name, value in (
        ("SPEED", 1e-3), ("_STEP_S", 1e-4), ("_RAMP_S", 0.1), ("_SEEN_S", 0.05),
        ("_CONTACT", Contact((0.0005, 1.0), (0.98, 0.98, 0.001))),
    ):  # fmt: skip
        monkeypatch.setattr(f"{MODULE}.{name}", value)
    agreement = []
    for impratio in (1e3, 1e5):
        monkeypatch.setattr(f"{MODULE}._IMPRATIO", impratio)
        tried = [one for seed in seeds if (one := decisive(seed)) is not None]
        agreement.append([one.agrees for one in tried])
    assert len(agreement[0]) > 15 and sum(agreement[0]) < 0.9 * len(agreement[0])
    assert agreement[1] == agreement[0]


@pytest.mark.parametrize(
    ("time", "impedance", "friction"), [(0.002, 0.9, 0.4), (0.0005, 0.98, 0.4), (0.02, 0.8, 0.3)]
)
def test_a_sliding_contact_rises_in_proportion_to_its_speed(
    time: float, impedance: float, friction: float
) -> None:
    """Its depth is (1 - v / v₀) times that at rest, with v₀ = (1 - d) T N / (2 μ m)."""
    gravity = 9.81
    fastest = (1 - impedance) * time * gravity / (2 * friction)

    def depth(speed: float) -> float:
        # The large inertia against sliding is that of two palms that nothing stops.
        mj = mujoco()
        model: Any = mj.MjModel.from_xml_string(f"""
            <mujoco>
              <option timestep="{time / 20}" gravity="0 0 {-gravity}" cone="elliptic"
                impratio="1000" tolerance="1e-12" iterations="200"/>
              <default><geom contype="0" conaffinity="0"/></default>
              <worldbody>
                <geom name="floor" type="plane" size="0 0 1"/>
                <body pos="0 0 0.01">
                  <joint type="slide" axis="1 0 0" armature="1e6"/>
                  <joint type="slide" axis="0 0 1"/>
                  <geom name="ball" type="sphere" size="0.01" mass="1"/>
                </body>
              </worldbody>
              <contact>
                <pair geom1="floor" geom2="ball" condim="3" solref="{time} 1"
                  solimp="{impedance} {impedance} 0.001"
                  friction="{friction} {friction} 0.005 0.0001 0.0001"/>
              </contact>
            </mujoco>
        """)
        data: Any = mj.MjData(model)
        ramp = 2000
        for k in range(2 * ramp):
            data.qvel[0] = speed * min(1.0, k / ramp)
            mj.mj_step(model, data)
        return -float(data.qpos[1])

    at_rest = depth(0.0)
    for share in (0.25, 0.5, 0.9):
        assert depth(share * fastest) == pytest.approx((1 - share) * at_rest, abs=0.01 * at_rest)
    assert depth(3 * fastest) < 0.2 * at_rest  # it hops


def test_states_have_contacts_of_all_kinds(found: list[FloorTrial]) -> None:
    surfaces = Counter(c.surface for one in found for c in one.modes.contacts)
    assert min(surfaces[name] for name in ("left palm", "right palm", "floor")) > 10
    motions = {motion for one in found for mode in one.modes.modes for motion in mode.motions}
    assert motions == {"ST", "SL", "SR", "BR"}


def test_the_comparison_notices_modes_of_other_frictions(found: list[FloorTrial]) -> None:
    """The same motions in MuJoCo, judged with a tenth of the friction and with ten times it."""
    for factor in (0.1, 10.0):
        others = [
            replace(one, modes=consistent_modes(
                [replace(c, friction=factor * c.friction) for c in one.modes.contacts]
            ))
            for one in found
        ]  # fmt: skip
        assert sum(one.agrees for one in others) < 0.9 * len(found)
