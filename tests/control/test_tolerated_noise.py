# SPDX-License-Identifier: Apache-2.0
"""The σ* that are shipped, measured again, and the recommended controller."""

import re

import pytest

import palmbots as pb
from palmbots.control.registry import describe, shipped_names
from palmbots.control.tolerated_noise import RECOMMENDED, tolerated_noise
from palmbots.scene.overrides import parse_overrides


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_names())
def test_shipped_number_is_that_of_the_code(name: str) -> None:
    """On other seeds, within four standard errors of the new measurement, with the keys that its
    command sets."""
    shipped = tolerated_noise(name)
    assert shipped is not None
    low, high = shipped.interval
    assert low < shipped.sigma_star_m_s < high < 1.01 * low
    changes = re.findall(r"--set (\S+)", shipped.command)
    again = pb.noise_limit(
        "paper", name, seed=10**6, relative_half_width=0.02, overrides=parse_overrides(changes)
    )
    assert again.sigma_star_m_s == pytest.approx(shipped.sigma_star_m_s, rel=0.04)


def test_recommended_controller_tolerates_most() -> None:
    assert describe(RECOMMENDED).is_compiled
    found = {name: tolerated_noise(name) for name in shipped_names()}
    best = found.pop(RECOMMENDED)
    assert best is not None
    assert all(one is not None and one.interval[1] < best.interval[0] for one in found.values())


def test_controller_that_was_not_measured_has_no_number() -> None:
    assert tolerated_noise("mine") is None
