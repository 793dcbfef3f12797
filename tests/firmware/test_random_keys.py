# SPDX-License-Identifier: Apache-2.0
"""Every key of a scene that reaches the settings of a board is carried there with random values.

Which keys these are follows from the core's table of keys: those that change the settings.
"""

import random
from typing import Any

import pytest

import palmbots as pb
from emulator.__main__ import CONTROLLERS, carried, dongle_image
from emulator.board import Image
from emulator.lockstep import lockstep_settings
from palmbots.control.registry import resolve
from palmbots.errors import SceneError
from palmbots.scene.core_keys import ROWS
from palmbots.simulation.prepare import prepare
from random_keys import holders_of, value_of

EXPECTED = {"control.period_s", "control.watchdog_s", "task.direction"}
"""Some keys that certainly reach the board."""


def settings(controller: str, keys: dict[str, Any]) -> list[bytes]:
    scene = pb.load_scene("paper", keys)
    if prepare(scene, controller).spec.uses_floor:
        raise SceneError("a job on the floor: test_lockstep.py")
    entry = resolve(controller)
    return [lockstep_settings(scene, entry, side).packed() for side in (0, 1)]


def reaching(controller: str, draw: random.Random) -> dict[str, Any]:
    """Random values of all keys that change the settings of a board, which go together."""
    usual = settings(controller, {})
    keys: dict[str, Any] = {}
    for name in (name for name in ROWS if "[" not in name):
        for given in holders_of(name):
            for _ in range(20):
                value = value_of(ROWS[name], draw)
                value = round(value, 4) if isinstance(value, float) else value  # whole µs
                if value == ROWS[name]["default"]:
                    continue
                try:
                    if settings(controller, {given: value}) != usual:
                        settings(controller, keys | {given: value})
                        keys[given] = value
                    break
                except SceneError:  # the value does not agree with others
                    continue
    return keys


@pytest.mark.parametrize("controller", CONTROLLERS)
def test_random_values_of_all_keys_that_reach_a_board(image: Image, controller: str) -> None:
    draw = random.Random(controller)
    keys = reaching(controller, draw)
    assert keys.keys() >= EXPECTED
    overrides = keys | {"task.distance_m": 0.2}
    row, result, host = carried(image, controller, 5, overrides, dongle_image())
    assert row["trace_hash"] == row["host_trace_hash"], keys
    assert result.message_log == host.message_log
