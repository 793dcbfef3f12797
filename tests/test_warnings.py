"""What a carry warns of at its end, from what the core says of it."""

from types import SimpleNamespace
from typing import Any

import pytest

from palmbots.result import _warnings_after
from palmbots.scene import load_scene

QUIET: dict[str, Any] = {
    "outcome": "delivered",
    "limit_cycle": (False, False),
    "correction_count": 2,
    "corrections": [0, 0],
    "touch_count": 1,
    "touches": [0],
    "links": [(5, 0, 0, 0, 0)] * 4,
    "messages_lost": 0,
    "hanging": ((1.0, 0.0, ""), (2.0, 0.0, "")),
    "rests": (False, False),
}


def told(controller: str = "distributed", latency_s: float = 0.05, **keys: Any) -> tuple[str, ...]:
    scene = load_scene("paper", {"radio.latency_s": latency_s, "radio.jitter_s": 0.1})
    return _warnings_after(SimpleNamespace(**QUIET | keys), scene, controller)


def test_nothing_to_warn_of() -> None:
    assert told() == told("resilient") == told("centralized") == ()


def test_more_than_is_listed() -> None:
    assert told(correction_count=3) == ("3 corrections; only the first are listed",)
    assert told(touch_count=2) == ("2 touches; only the first are listed",)


def test_limit_cycles_by_side() -> None:
    (one,) = told(limit_cycle=(False, True))
    assert one.startswith("limit cycle: the right robot")
    assert len(told(limit_cycle=(True, True))) == 2


@pytest.mark.parametrize(("lasts", "latency_s", "warned"), [
    (2.1, 0.05, False), (2.31, 0.05, True), (2.31, 0.1, False), (2.9, 0.4, False), (3.1, 0.4, True),
])  # fmt: skip
def test_how_long_a_robot_may_wait(lasts: float, latency_s: float, warned: bool) -> None:
    """Two seconds, and what the radio takes both ways at most, jitter included."""
    hanging: dict[str, Any] = {"hanging": ((1.0, lasts, "Ack"), (2.0, 0.0, ""))}
    found = told(latency_s=latency_s, messages_lost=1, **hanging)
    assert len(found) == warned
    for one in found:
        assert one == (
            "left has waited since 1.0 s for an Ack that does not come (a letter was lost)"
        )
    assert told(latency_s=latency_s, **hanging) == ()


def test_robots_at_rest() -> None:
    """Only of the resilient algorithm, and only where they did not get there."""
    assert told("resilient", rests=(True, False)) == ()
    (one,) = told("resilient", rests=(True, False), outcome="stalled")
    assert one.startswith("the left robot is at rest")
    assert told(rests=(True, False), outcome="stalled") == ()
