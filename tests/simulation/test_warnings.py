# SPDX-License-Identifier: Apache-2.0
"""Warnings at the end of a carry, from what the core measured."""

from types import SimpleNamespace
from typing import Any

import pytest

from palmbots.control.registry import resolve
from palmbots.scene.scene import load_scene
from palmbots.simulation.warnings import warnings_after

QUIET: dict[str, Any] = {
    "outcome": "delivered",
    "limit_cycle": (False, False),
    "correction_count": 2,
    "corrections": [0, 0],
    "contact_event_count": 1,
    "contact_events": [0],
    "links": [(5, 0, 0, 0, 0)] * 4,
    "messages_lost": 0,
    "hanging": ((1.0, 0.0, ""), (2.0, 0.0, "")),
    "stopped": (False, False),
}


def warnings_of(
    controller: str = "distributed", latency_s: float = 0.05, **keys: Any
) -> tuple[str, ...]:
    scene = load_scene("paper", {"radio.latency_s": latency_s, "radio.jitter_s": 0.1})
    return warnings_after(SimpleNamespace(**QUIET | keys), scene, resolve(controller))


def test_no_warning_without_cause() -> None:
    assert warnings_of() == warnings_of("resilient") == warnings_of("centralized") == ()


def test_truncated_lists_give_a_warning() -> None:
    assert warnings_of(correction_count=3) == ("3 corrections; only the first are listed",)
    assert warnings_of(contact_event_count=2) == ("2 contact events; only the first are listed",)


def test_limit_cycle_names_the_side() -> None:
    (one,) = warnings_of(limit_cycle=(False, True))
    assert one.startswith("limit cycle: the right robot")
    assert len(warnings_of(limit_cycle=(True, True))) == 2


@pytest.mark.parametrize(("lasts", "latency_s", "warned"), [
    (2.1, 0.05, False), (2.31, 0.05, True), (2.31, 0.1, False), (2.9, 0.4, False), (3.1, 0.4, True),
])  # fmt: skip
def test_waiting_warns_after_two_seconds_and_the_radio_delay(
    lasts: float, latency_s: float, warned: bool
) -> None:
    """Two seconds, and the longest radio delay in both directions, jitter included."""
    hanging: dict[str, Any] = {"hanging": ((1.0, lasts, "Ack"), (2.0, 0.0, ""))}
    result = warnings_of(latency_s=latency_s, messages_lost=1, **hanging)
    assert len(result) == warned
    for one in result:
        assert one == (
            "the left robot has waited since 1.0 s for an Ack that does not arrive "
            "(a message was lost)"
        )
    assert warnings_of(latency_s=latency_s, **hanging) == ()


def test_standing_robots_of_resilient_give_a_warning() -> None:
    """Only with the resilient algorithm, and only if the carry timed out."""
    assert warnings_of("resilient", stopped=(True, False)) == ()
    (one,) = warnings_of("resilient", stopped=(True, False), outcome="stalled")
    assert one.startswith("the left robot stands")
    assert warnings_of(stopped=(True, False), outcome="stalled") == ()
