# SPDX-License-Identifier: Apache-2.0
"""10⁵ random scripts for the quasistatic world: none ends that the slow world carries on."""

import pytest

from contact_scripts import Runner, scripts

PARTS = 40
SCRIPTS = 2500  # in each part
NEVER = {"flush", "tip", "jammed"}


@pytest.mark.parametrize("part", range(PARTS))
def test_random_scripts_end_only_where_the_slow_world_ends(part: int, soak_seed: int) -> None:
    runner = Runner()
    for n, script in enumerate(scripts(soak_seed * PARTS + part, SCRIPTS)):
        end = runner.end(script)
        if end is None or end.reason == "off-palm":
            continue
        # The slow world takes a second for a script: of the usual ends it judges one in ten.
        if end.reason in NEVER or n % 10 == 0:
            assert runner.is_forced(script, end), (n, end, script)
