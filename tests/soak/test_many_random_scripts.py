# SPDX-License-Identifier: Apache-2.0
"""10⁵ random scripts of 500 periods: nothing sinks in, and there are forces for every motion."""

import pytest

from palm_scripts import Found, run

PARTS = 400
SCRIPTS = 250  # in each part


@pytest.mark.parametrize("part", range(PARTS))
def test_nothing_sinks_in_and_forces_balance(part: int, soak_seed: int) -> None:
    found = Found()
    for n in range(SCRIPTS):
        run((soak_seed * PARTS + part) * SCRIPTS + n, found)
    assert found.faults == []
    assert found.checked > 2 * SCRIPTS
    assert found.ends["gave up"] <= 1
