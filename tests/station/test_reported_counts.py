# SPDX-License-Identifier: Apache-2.0
"""The counts that a robot reports modulo 65536 add up to the true ones."""

import random
from typing import Any

from palmbots.station.reported_counts import ReportedCounts
from palmbots.wire import Status


def test_totals_are_the_true_ones_beyond_the_modulus() -> None:
    chance = random.Random(1)
    true = dict.fromkeys(("sent", "accepted", "stale"), 0)
    counts = ReportedCounts()
    for _ in range(5000):
        for name in true:
            true[name] += chance.randrange(100)
        item: Any = chance.choice([*true, "progress", "battery", "overruns"])
        counts.note(Status(item=item, value=true.get(item, 77) % 65536))
    for name in true:
        counts.note(Status(item=name, value=true[name] % 65536))  # type: ignore[arg-type]
    assert true["sent"] > 3 * 65536
    assert counts.totals == true


def test_a_reboot_adds_what_was_counted_since() -> None:
    counts = ReportedCounts()
    for value in (100, 250, 3, 10):
        counts.note(Status(item="sent", value=value))
    assert counts.totals == {"sent": 260}
