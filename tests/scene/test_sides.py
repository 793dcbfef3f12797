# SPDX-License-Identifier: Apache-2.0
"""Keys that a side may override: what changes them everywhere, and what would change nothing."""

from typing import Any

import pytest

import palmbots as pb
from palmbots.scene.core_keys import ROWS
from palmbots.scene.sides import multiplied, on_every_side, value_of
from palmbots.scene.spec import to_spec

LIKE: dict[str, Any] = {
    "palm.usable_m": 0.1, "robot.period_s": 0.02, "robot.motor_force_n": 4.0,
    "robot.traction_n": 3.0,
    "robot.max_speed_m_s": 0.18, "palm.steep_deg": 14.0,
}  # fmt: skip
"""Values for keys without a default, or with close relations to others."""
NEEDED = {"palm.nose_m": {"palm.thickness_m": 0.1, "palm.bevel_m": 0.1}}
KEYS = [
    name
    for name in ROWS
    if (
        name.startswith(("palm.", "robot.", "arm."))
        and name != "palm.friction_angle_deg"
        and ROWS[name]["kind"] != "choice"
    )
    or name in ("radio.latency_s", "radio.jitter_s", "radio.loss")
]


def _value(key: str, times: float) -> float:
    if key in LIKE:
        return LIKE[key] if key == "robot.period_s" else LIKE[key] * times
    return (ROWS[key]["default"] or 0.004) * times


@pytest.mark.parametrize("key", KEYS)
def test_value_holds_on_both_sides(key: str) -> None:
    section, name = key.split(".")
    sides = [f"{section}.{side}.{name}" for side in ("left", "right")]
    new, old = _value(key, 1.04), _value(key, 0.98)
    for given in ([], sides[:1], sides):
        base = pb.load_scene("paper", dict.fromkeys(given, old) | NEEDED.get(key, {}))
        keys = on_every_side(base, {key: new})
        changed = pb.load_scene(base, keys)
        assert [value_of(changed, side) for side in sides] == [new, new]
        assert set(keys) == {*given, *([] if len(given) == 2 else [key])}
    # The key alone reaches no robot, and is refused.
    base = pb.load_scene("paper", dict.fromkeys(sides, old) | NEEDED.get(key, {}))
    with pytest.raises(pb.SceneError, match=rf"^overrides: {key}: both sides override it; allowed"):
        pb.load_scene(base, {key: new})
    everything = dict.fromkeys([key, *sides], new) | NEEDED.get(key, {})
    assert pb.load_scene(base, everything) == pb.load_scene("paper", everything)


def test_friction_and_its_angle_override_each_other() -> None:
    both = {f"palm.{side}.friction_angle_deg": 15.0 for side in ("left", "right")}
    base = pb.load_scene("paper", both)
    with pytest.raises(pb.SceneError, match=r"palm\.friction: both sides override it"):
        pb.load_scene(base, {"palm.friction": 0.4})
    for given in (both, {"palm.friction_angle_deg": 15.0}, {"palm.left.friction_angle_deg": 15.0}):
        base = pb.load_scene("paper", given)
        changed = pb.load_scene(base, on_every_side(base, {"palm.friction": 0.4}))
        assert [palm.friction for palm in to_spec(changed).palms] == [0.4, 0.4]
        twice = pb.load_scene(base, multiplied(base, "palm.friction", 1.5))
        before, after = ([palm.friction for palm in to_spec(s).palms] for s in (base, twice))
        assert after == pytest.approx([1.5 * mu for mu in before])


def test_multiplied_keeps_the_difference_of_the_sides() -> None:
    base = pb.load_scene("paper", {"robot.left.noise_m_s": 0.01, "robot.right.noise_m_s": 0.03})
    assert multiplied(base, "robot.noise_m_s", 2.0) == {
        "robot.left.noise_m_s": 0.02, "robot.right.noise_m_s": 0.06,
    }  # fmt: skip
    assert multiplied(base, "palm.usable_m", 2.0) == {}


def test_losses_of_robots_with_their_own() -> None:
    own = {"radio.left.loss": 0.1, "radio.right.loss": 0.2}
    base = pb.load_scene("paper", own)
    assert on_every_side(base, {"radio.loss": 0.3}) == dict.fromkeys(own, 0.3)
    with pytest.raises(pb.SceneError, match="both sides override it"):
        pb.load_scene(base, {"radio.loss": 0.3})  # the station alone has a key of its own
    assert pb.load_scene(base, {"radio.station.loss": 0.3}).radio.station.loss == 0.3
