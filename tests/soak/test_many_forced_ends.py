# SPDX-License-Identifier: Apache-2.0
"""10⁵ random scripts for the quasistatic world end where the slow world ends, or in its pose."""

import pytest

from contact_scripts import Runner, scripts
from script_ends import Ends, compare

PARTS = 40
SCRIPTS = 2500  # in each part
NEVER = {"flush", "tip", "jammed"}


@pytest.mark.parametrize("part", range(PARTS))
def test_random_scripts_end_where_the_slow_world_ends(part: int, soak_seed: int) -> None:
    runner, ends = Runner(), Ends()
    for n, script in enumerate(scripts(soak_seed * PARTS + part, SCRIPTS)):
        course, end = runner.course(script), runner.end(script)
        # The slow world takes half a second for a script: it judges one in ten.
        if end is not None and end.reason in NEVER:
            assert course.is_forced(end), (n, end, script)
        elif n % 10 == 0:
            compare(f"script {n}", course, ends)
    assert ends.faults == ends.missed == []
