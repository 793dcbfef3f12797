# SPDX-License-Identifier: Apache-2.0
"""A small result of `palmbots validate`; tests/mujoco/test_validation.py makes large ones."""

import pytest

import palmbots as pb
from palmbots.mujoco.validation.validation import Validation

FEW_LINES = {"palmbots.mujoco.validation.validation.LINE_PLACES": (0.0,)}
"""Half of the time goes into the search for switch lines."""


def short_validation() -> Validation:
    """Of one state, one carry, and the switch lines of one place."""
    with pytest.MonkeyPatch.context() as patch:
        for name, value in FEW_LINES.items():
            patch.setattr(name, value)
        near = pb.load_scene("paper", {"task.distance_m": 0.05})
        return pb.validate(near, states=1, carries=1)
