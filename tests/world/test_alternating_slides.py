# SPDX-License-Identifier: Apache-2.0
"""Contacts that slide alternately, against a closed form.

A level object rests on the inner tips of two palms that slope down outward. Closing moves both tips
towards the COM. All normal forces are vertical and the two friction forces are equal, so the tip
with the smaller μN slides. As it approaches the COM its N grows, until μN is equal on both tips.
From there on both slide and keep it equal: with the lever rule N_left / N_right = d_right / d_left,
the distances from the COM stay in the ratio d_left : d_right = μ_left : μ_right.
"""

import math

import pytest

import palmbots._core as _core
from contact_scripts import Runner, Script
from palmbots.scene.scene import load_scene
from palmbots.scene.spec import to_spec

DOWN = math.radians(-5.0)
FRICTION = (0.15, 0.45)
OFFSET = 0.01
CLOSING = 0.017  # [m]
KEYS = {
    "palm.friction": FRICTION[0],
    "palm.right": {"friction": FRICTION[1]},
    "palm.pivot_offset_m": OFFSET,
    "start.left_m": 0.037,
    "start.right_m": 0.034,
}


def distances(world: _core.World, spec: _core.Spec) -> tuple[float, float]:
    """How far each inner tip is from the vertical through the COM [m]."""
    half = spec.palms[0].length / 2
    tip = OFFSET * math.sin(DOWN) + half * math.cos(DOWN)  # inward of its pivot
    vertex = (  # the left contact vertex, from the left pivot
        (OFFSET + world.lift[0]) * math.sin(DOWN) - world.contacts[0] * math.cos(DOWN)
    )
    com = vertex + spec.com_left
    return com - tip, world.separation - tip - com


@pytest.mark.parametrize("steps", [1, 7, 100])
def test_both_tips_slide_in_the_ratio_of_their_frictions(steps: int) -> None:
    spec = to_spec(load_scene({"object": "trapezoid"}, KEYS))
    world = _core.World(spec)
    assert world.advance(0.0, (DOWN, DOWN))[0] == ""
    left, right = distances(world, spec)
    assert left / right > 1.5 * FRICTION[0] / FRICTION[1]  # at first the left tip slides alone
    for _ in range(steps):
        assert world.advance(-CLOSING / steps, (DOWN, DOWN))[0] == ""
    total = sum(distances(world, spec))
    expected = total * FRICTION[0] / sum(FRICTION)
    assert distances(world, spec)[0] == pytest.approx(expected, abs=5e-5)
    # Had the left tip slid alone, it would be much nearer to the COM.
    assert left - CLOSING < expected - 1e-3


def test_a_tilt_after_it_ends_where_the_slow_world_ends() -> None:
    moves = [(0.0, 0.0, 1.0), (0.0, -5.0, -5.0), (-0.014393, -5.0, -5.0), (0.0, 0.0, -5.0)]
    start = {"start.left_m": 0.037228, "start.right_m": 0.0343346}
    script, runner = Script({"object": "trapezoid"}, KEYS | start, moves), Runner()
    end = runner.end(script)
    assert end is not None and end.at == pytest.approx(3.115, abs=0.01)
    assert runner.course(script).is_forced(end)
