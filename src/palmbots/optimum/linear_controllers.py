# SPDX-License-Identifier: Apache-2.0
"""The controllers `exact-p` and `kalman`: references with linear feedback.

`exact-p` reads both contact coordinates p. `kalman` estimates them from the signs of both palms,
by a Kalman filter (`optimum/sign_filter.hpp`), and so shows what can be made of signs alone. Both
learn everything at once, without a radio, and command any speed between the admissible ones. With
`-stopping` the robots may also stop travelling (`optimum/linear_team.hpp`).
"""

from __future__ import annotations

from palmbots.control.registry import ControllerEntry
from palmbots.optimum.opening import LinearFeedback


def _entry(name: str, description: str, *, exact: bool, may_stop: bool) -> ControllerEntry:
    speeds = "robots may stop" if may_stop else "corrections only"
    return ControllerEntry(
        name,
        f"reference with {description}, {speeds}",
        uses_radio=False,
        policy_maker=lambda spec: LinearFeedback(exact, may_stop),
    )


_READS = "linear feedback of both contact coordinates, read exactly"
_FILTERS = "linear feedback of a Kalman filter on the signs of both palms"

EXACT_P = _entry("exact-p", _READS, exact=True, may_stop=False)
EXACT_P_STOPPING = _entry("exact-p-stopping", _READS, exact=True, may_stop=True)
KALMAN = _entry("kalman", _FILTERS, exact=False, may_stop=False)
KALMAN_STOPPING = _entry("kalman-stopping", _FILTERS, exact=False, may_stop=True)
