# SPDX-License-Identifier: Apache-2.0
"""Switches close where pressed, and open once nothing has pressed for their debounce time."""

import pytest

from palmbots.mujoco.curved_world import world_of
from palmbots.mujoco.engine_settings import DEFAULT
from palmbots.mujoco.switches import Switches
from palmbots.scene.scene import load_scene

STEEP = (0.2617993877991494, 0.2617993877991494)


def switches(**changes: float) -> Switches:
    keys = {f"mujoco.{key}": value for key, value in changes.items()}
    return Switches(load_scene("paper", keys).mujoco)


def test_switch_closes_under_force_and_stays_closed_during_a_hop() -> None:
    palm = switches(switch_debounce_s=0.05)
    assert not palm.closed
    palm.update(0.10, [(0.0, 0.0), (2.0, 0.02)])
    assert palm.closed and palm.place == pytest.approx(0.01)
    palm.update(0.15, [(0.0, 0.0), (0.0, 0.0)])
    assert palm.closed and palm.place == pytest.approx(0.01)
    palm.update(0.16, [(0.0, 0.0), (0.0, 0.0)])
    assert not palm.closed


def test_switch_without_debounce_opens_at_a_hop() -> None:
    palm = switches(switch_debounce_s=0.0)
    palm.update(0.10, [(2.0, 0.02)])
    assert palm.closed
    palm.update(0.11, [(0.0, 0.0)])
    assert not palm.closed


def test_force_below_the_threshold_closes_no_switch() -> None:
    palm = switches(switch_force_n=1.0)
    palm.update(0.0, [(0.99, 0.5)])
    assert not palm.closed
    palm.update(0.0, [(1.0, 0.5)])
    assert palm.closed and palm.place == 0.5


def test_the_last_load_that_presses_counts() -> None:
    palm = switches(switch_force_n=1.0)
    palm.update(0.0, [(2.0, -0.2), (3.0, 0.3)])
    assert palm.place == pytest.approx(0.1)
    palm.update(0.01, [(2.0, -0.2), (0.5, 0.3)])
    assert palm.place == pytest.approx(-0.1)


def opened(switch_debounce_s: float, speed: float) -> tuple[int, int]:
    """Of 200 ticks with the palms driven together and apart at a speed [m/s]: how often nothing
    presses on some palm, how often some switch reads as open."""
    scene = load_scene("paper", {"mujoco.switch_debounce_s": switch_debounce_s})
    world = world_of(scene, DEFAULT)
    hops = open_ticks = 0
    for tick in range(200):
        way = 0.5 * speed * (1.0 if tick % 100 < 50 else -1.0)
        world.move((way, -way), STEEP)
        world.sight()
        hops += min(world.measured.force) <= 0
        open_ticks += not all(palm.closed for palm in world._switches)
    return hops, open_ticks


def test_switches_ignore_the_hops_of_fast_sliding() -> None:
    hops, open_ticks = opened(0.0, 0.08)
    assert 10 <= hops <= 20 and open_ticks == hops
    hops, open_ticks = opened(0.05, 0.08)
    assert hops > 5 and open_ticks == 0


def test_contacts_that_slide_slowly_do_not_hop() -> None:
    assert opened(0.0, 0.02) == (0, 0)
