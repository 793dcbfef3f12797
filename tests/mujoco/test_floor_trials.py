# SPDX-License-Identifier: Apache-2.0
"""Contacts of rounded corners with noses, palms, heels and the floor move in MuJoCo as one of the
consistent contact modes."""

import math
from collections import Counter
from dataclasses import replace

import pytest

from palmbots.mechanics.consistent_modes import consistent_modes
from palmbots.mujoco.validation.floor_trials import FloorTrial, floor_trial
from palmbots.scene.scene import load_scene


@pytest.fixture(scope="module")
def found() -> list[FloorTrial]:
    scene = load_scene("paper")
    tried = (floor_trial(scene, seed, math.radians(1)) for seed in range(250))
    return [one for one in tried if one is not None and one.decisive]


def test_nearly_all_decisive_states_agree(found: list[FloorTrial]) -> None:
    assert len(found) > 40
    assert sum(one.agrees for one in found) >= 0.97 * len(found)


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
