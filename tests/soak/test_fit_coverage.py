# SPDX-License-Identifier: Apache-2.0
"""How often the 95 % intervals of a fit contain hidden values; `pytest -s` prints the counts."""

from collections import Counter

import numpy as np
import pytest

from fitted_carries import HIDDEN, carries_fitted, contains
from fitted_objects import object_fitted
from stretches import TRUTH, coverage

FITS = 400


def test_intervals_away_from_0_cover_95_percent() -> None:
    """Between 90 and 98 % of 400 fits. Both parts of the noise have to be away from 0: where the
    white part may explain all of it, there may be no noise with a correlation time, and the fit
    rightly does not identify one."""
    found = coverage(FITS, 60, TRUTH * [1, 1, 1, 1.5, 1, 1.5, 1])
    print(found)
    for key, hits in found.covered.items():
        identified = FITS - found.unidentified[key]
        assert found.unidentified[key] <= 0.05 * FITS, key
        assert 0.90 <= hits / identified <= 0.98, key


@pytest.mark.parametrize(
    ("index", "key"), [(2, "robot.gain_sd"), (5, "robot.white_noise_m_per_sqrt_s")]
)
def test_a_bound_on_one_side_covers_0(index: int, key: str) -> None:
    """The lower end is 0 in at least 90 % of 400 fits."""
    hidden = np.where(np.arange(7) == index, 0.0, TRUTH)
    found = coverage(FITS, 60, hidden)
    print(found)
    assert found.covered[key] >= 0.90 * FITS


RADIO = {"radio.loss": 0.1, "radio.latency_s": 0.03, "radio.jitter_s": 0.04}
BOUNDED = ("radio.latency_s", "radio.jitter_s")
"""What logs show to a control period only."""


@pytest.mark.parametrize("controller", ["shared-sign", "silent"])
def test_intervals_of_carries_cover_95_percent(controller: str) -> None:
    """400 fits of 4 carries each; `silent` has no radio. Between 90 and 98 % contain the value, and
    at least 90 % where the interval bounds it."""
    radio = RADIO if controller == "shared-sign" else {}
    hidden = {**HIDDEN, **radio}
    covered, unidentified = Counter[str](), Counter[str]()
    for number in range(FITS):
        of = carries_fitted(controller, number, 4, radio)
        covered.update(key for key, value in hidden.items() if contains(of[key], value))
        unidentified.update(key for key in hidden if not of[key].is_identified)
    print(controller, covered, unidentified)
    for key in hidden:
        assert unidentified[key] <= 0.05 * FITS, key
        share = covered[key] / (FITS - unidentified[key])
        assert 0.90 <= share <= (1.0 if key in BOUNDED else 0.98), key


def test_bounds_of_the_object_contain_it() -> None:
    """Of 400 fits of random objects and palms."""
    missed = [
        (seed, key)
        for seed in range(FITS)
        for key, one, value in object_fitted(seed)
        if one.low is not None and one.high is not None and not one.low <= value <= one.high
    ]
    assert not missed
