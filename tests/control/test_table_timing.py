# SPDX-License-Identifier: Apache-2.0
"""The lease of `shared-sign`: the warning for a short one agrees with what the carries do.

The oracle is the carry itself. Where the lease is long enough, its length changes nothing as long
as no message is lost. Where no beacon can be answered within it, the robots carry as `silent` does.
"""

from typing import Any

import pytest

import palmbots as pb
from palmbots.control.dead_band import warnings_before
from palmbots.control.registry import shipped_names

TICK_S = 0.01
RADIOS: list[dict[str, float]] = [
    {},
    {"radio.latency_s": 0.1},
    {"radio.latency_s": 0.03, "radio.beacon_s": 0.08},
    {"radio.jitter_s": 0.03},
    {"radio.latency_s": 0.0},
]
WORDS = "is shorter than the round trip of two beacons"


def contacts(controller: str, keys: dict[str, float], lease_s: float | None = None) -> Any:
    """What the contacts do in a noisy carry."""
    lease = {} if lease_s is None else {"radio.lease_s": lease_s}
    scene = pb.load_scene("paper", {"robot.noise_m_s": 0.02} | keys | lease)
    return pb.carry(scene, controller, record=False).contact_rms_m


def is_warned_of(keys: dict[str, float], lease_s: float) -> bool:
    scene = pb.load_scene("paper", keys | {"radio.lease_s": lease_s})
    lines = [line for line in warnings_before(scene, "shared-sign") if WORDS in line]
    return len(lines) == 1


@pytest.mark.parametrize("keys", RADIOS, ids=str)
def test_warning_is_given_below_the_round_trip_of_two_beacons(keys: dict[str, float]) -> None:
    """There and back, a sign travels, waits for the next beacon, and for the next period."""
    radio = pb.load_scene("paper", keys).radio
    travel_s = max(TICK_S, radio.latency_s + radio.jitter_s)
    round_trip_s = 2 * (travel_s + radio.beacon_s + TICK_S)
    assert is_warned_of(keys, round_trip_s - TICK_S)
    assert not is_warned_of(keys, round_trip_s)
    assert contacts("shared-sign", keys, round_trip_s) == contacts("shared-sign", keys)
    assert contacts("shared-sign", keys, 2 * round_trip_s) == contacts("shared-sign", keys)


@pytest.mark.parametrize("keys", RADIOS, ids=str)
def test_robots_carry_as_silent_does_below_the_round_trip_of_the_radio(
    keys: dict[str, float],
) -> None:
    radio = pb.load_scene("paper", keys).radio
    lease_s = max(TICK_S, 2 * radio.latency_s - TICK_S)  # jitter may be 0
    assert is_warned_of(keys, lease_s)
    assert contacts("shared-sign", keys, lease_s) == contacts("silent", keys)
    assert contacts("shared-sign", keys) != contacts("silent", keys)


def test_between_the_two_the_lease_changes_the_carry() -> None:
    """So the warning is due, and it must not claim that the robots never hear each other."""
    assert is_warned_of({}, 0.15)
    carries = [contacts("shared-sign", {}, 0.15), contacts("shared-sign", {})]
    assert carries[0] not in (carries[1], contacts("silent", {}))


def test_warning_names_key_values_and_remedy() -> None:
    scene = pb.load_scene("paper", {"radio.lease_s": 0.05})
    (line,) = warnings_before(scene, "shared-sign")
    assert line.startswith(f"radio.lease_s: 0.05 s {WORDS}, 0.22 s: ")
    assert line.endswith("shared-sign works like silent meanwhile (raise it, or lower "
                         "radio.latency_s or radio.beacon_s)")  # fmt: skip
    assert "\n" not in line


def test_only_a_controller_whose_sign_has_a_lease_is_warned_of() -> None:
    scene = pb.load_scene("paper", {"radio.lease_s": 0.05})
    warned = {name for name in shipped_names() if warnings_before(scene, name)}
    assert warned == {"shared-sign"}  # resilient refuses such a scene
