# SPDX-License-Identifier: Apache-2.0
"""10⁵ random scripts of 500 periods: nothing sinks in, and there are forces for every motion.

One in 100 is made in the slow world, too, and the energy of others is accounted for.
"""

import pytest

from energy_oracle import Account, account_for
from palm_scripts import Found, run
from script_ends import compare_scripts

PARTS = 400
SCRIPTS = 250  # in each part
COMPARED = 50


@pytest.mark.parametrize("part", range(PARTS))
def test_nothing_sinks_in_and_forces_balance(part: int, soak_seed: int) -> None:
    found = Found()
    for n in range(SCRIPTS):
        run((soak_seed * PARTS + part) * SCRIPTS + n, found)
    assert found.faults == []
    assert found.checked > 10 * SCRIPTS
    assert found.judged_events > 0.8 * found.events
    assert found.ends["gave up"] <= 1


@pytest.mark.parametrize("part", range(20))
def test_scripts_end_as_in_the_slow_world(part: int, soak_seed: int) -> None:
    first = (soak_seed * PARTS + part) * SCRIPTS
    ends = compare_scripts(range(first, first + COMPARED))
    assert ends.clear_share >= 0.7
    # 99 in 100 agreed (docs/theory/contacts.md).
    assert len(ends.faults + ends.missed) <= 0.04 * ends.agreed, ends


@pytest.mark.parametrize("part", range(40))
def test_work_lifts_the_object_or_becomes_heat(part: int, soak_seed: int) -> None:
    total = Account()
    first = (soak_seed * PARTS + part) * SCRIPTS
    for seed in range(first, first + COMPARED):
        account_for(seed, total)
    assert total.faults == []
    assert total.work == pytest.approx(total.gained + total.heat, rel=1e-4)
