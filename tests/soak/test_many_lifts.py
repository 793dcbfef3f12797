# SPDX-License-Identifier: Apache-2.0
"""1000 random jobs on the floor whose end is certain, in both worlds: at least 99 % end alike, and
at least 60 % of the possible jobs are certain (lift_agreement). Of 1595 of them, 1584 ended alike
(docs/reference/mujoco-agreement.md has the differences)."""

from lift_agreement import NEARBY, can_start, compare

STARTS = 1000


def test_random_jobs_end_alike(soak_seed: int) -> None:
    assert NEARBY >= 6
    possible, differ, certain = 0, [], 0
    seed = 1_000_000 * soak_seed
    while certain < STARTS:
        seed += 1
        if not can_start(seed):
            continue
        possible += 1
        pair = compare(seed)
        if pair is None:
            continue
        certain += 1
        if not pair.agrees:
            differ.append(pair)
    assert certain >= 0.6 * possible
    assert len(differ) <= 0.01 * STARTS, differ
