# SPDX-License-Identifier: Apache-2.0
"""Events after which mechanics permit several motions: a rule, or a draw, decides."""

from collections import Counter
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots.scene.spec import to_spec
from palmbots.simulation import Carry, FloorWorld, run_seeds

# Left and right are alike, and the robots drive apart: one contact of the pipe rolls, or neither.
LEVEL: dict[str, Any] = {
    "robot.noise_m_s": 0.0, "task.inertia": False, "robot.right.bias_m_s": 0.002,
    "task.distance_m": 0.1, "world.ambiguity": "drawn",
}  # fmt: skip


def first_motion(seed: int, keys: dict[str, Any]) -> tuple[Carry, tuple[int, ...]]:
    carry = pb.carry("pipe", "none", seed=seed, overrides=keys)
    assert carry.trace is not None
    moves = carry.trace["motion"].to_numpy()
    return carry, tuple(moves[np.flatnonzero(moves.any(axis=1))[0]].tolist())


def test_each_of_the_possible_motions_is_drawn_as_often_as_the_others() -> None:
    counts: Counter[tuple[int, ...]] = Counter()
    for seed in range(150):
        carry, motion = first_motion(seed, LEVEL)
        assert carry.ambiguous_events == 1  # the motion persists
        (choice,) = carry.ambiguous_choices
        assert choice.time_s == 0.0
        # Inward is to the right on the left palm, and to the left on the right one.
        expected = [("left", "SR" if motion[0] else "ST"), ("right", "SL" if motion[1] else "ST")]
        assert sorted((one.surface, one.motion) for one in choice.contacts) == expected
        counts[motion] += 1
    assert set(counts) == {(-1, -1), (-1, 0), (0, -1)}
    assert min(counts.values()) > 30  # of 50; 4 standard deviations are 23


def test_the_rule_takes_the_motion_in_which_both_slide() -> None:
    for seed in range(3):
        carry, motion = first_motion(seed, LEVEL | {"world.ambiguity": "rule"})
        assert (motion, carry.ambiguous_events) == ((-1, -1), 1)


def test_the_rule_keeps_as_many_contacts_as_possible() -> None:
    """A palm with much friction retreats from an object on a slippery floor: it leaves the object,
    or takes it along."""
    keys = {"object.edge_radius_m": 0.003, "palm.friction": 0.8, "floor.friction": 0.1}
    world = FloorWorld("plate", palms_deg=(8, 8), overrides=keys)
    for _ in range(10):
        state = world.move(0.0012, 0.0)
    modes = [mode.motions for mode in world.contact_modes(-0.01, 0.0).modes]
    assert sorted(modes) == [("BR", "ST", "ST"), ("ST", "SL", "SL")]
    assert world.move(-0.001, 0.0).com_m[0] == pytest.approx(state.com_m[0] - 0.001, abs=1e-12)


def test_a_carry_draws_alike_alone_and_side_by_side() -> None:
    """A plank lies flush on palms that dip inward while they are shallow."""
    keys = {"object": "plank", "palm.shallow_deg": -2, "robot.noise_m_s": 0.02}
    drawn, ruled = (
        pb.load_scene("paper", keys | {"world.ambiguity": how}) for how in ("drawn", "rule")
    )
    lanes = run_seeds(to_spec(drawn), "shared-sign", 0, 16, threads=1)
    differ = 0
    for seed in range(16):
        alone, other = (
            pb.carry(scene, "shared-sign", seed=seed, record=False) for scene in (drawn, ruled)
        )
        assert alone.time_s == lanes["time_s"][seed]
        assert alone.contact_rms_m.left == lanes["contact_rms_m"][seed][0]
        differ += alone.trace_hash != other.trace_hash
        assert alone.ambiguous_events > 0 or alone.trace_hash == other.trace_hash
        times = [choice.time_s for choice in alone.ambiguous_choices]
        assert len(times) == alone.ambiguous_events and times == sorted(times)
        assert all(choice.contacts for choice in alone.ambiguous_choices)
    assert differ > 8


@pytest.mark.parametrize("scene", ["paper", "plate"])
def test_two_vertices_are_never_ambiguous(scene: str) -> None:
    one, two = (
        pb.carry(scene, overrides={"world.ambiguity": how, "task.distance_m": 0.3})
        for how in ("rule", "drawn")
    )
    assert one.trace_hash == two.trace_hash
    assert one.ambiguous_events == two.ambiguous_events == 0
