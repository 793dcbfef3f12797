# SPDX-License-Identifier: Apache-2.0
"""The angle by which an outline turns to rest on its contacts, and the warning about it."""

import math

import pytest

from palmbots.scene.scene import load_scene
from palmbots.simulation.single import carry

CRATE = [[0, 0], [0.4, 0], [0.4, 0.06], [0.15, 0.06], [0.15, 0.12], [0, 0.12]]


@pytest.mark.parametrize(
    ("contacts", "angle"), [([0, 1], 0.0), ([2, 5], 8.53 - 180), ([5, 0], 90.0), ([1, 2], -90.0)]
)
def test_rest_angle(contacts, angle):
    item = load_scene({"object": {"vertices_m": CRATE, "contacts": contacts}}).object
    assert item.rest_angle_deg == pytest.approx(angle, abs=0.01)
    # The outline turned by the angle has its contacts level, with the left one on the left.
    turn = math.radians(item.rest_angle_deg)
    (lx, ly), (rx, ry) = (item.vertices_m[k] for k in item.contacts)
    assert math.sin(turn) * (rx - lx) + math.cos(turn) * (ry - ly) == pytest.approx(0, abs=1e-12)
    assert math.cos(turn) * (rx - lx) - math.sin(turn) * (ry - ly) > 0


def test_upside_down_object_is_reported_with_its_angle(capsys):
    from palmbots.cli import main as cli

    overrides = {"object.vertices_m": CRATE, "object.contacts": [2, 5], "task.distance_m": 0.05}
    upside_down = carry(overrides=overrides)
    assert upside_down.summary()["rest_angle_deg"] == pytest.approx(-171.47, abs=0.01)
    assert [w for w in upside_down.warnings if "upside down" in w] == [
        "the object rests upside down: its outline is turned by -171° (object.contacts are upper "
        "vertices of object.vertices_m)"
    ]
    upright = carry(overrides={**overrides, "object.contacts": [0, 1]})
    assert not any("upside down" in w for w in upright.warnings)
    cli.run(["carry", *(f"--set={key}={value}" for key, value in overrides.items())])
    printed = capsys.readouterr()
    assert "object: outline turned by -171.5° to rest on its contacts" in printed.out
    assert "palmbots: warning: the object rests upside down" in printed.err
