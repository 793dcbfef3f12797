# SPDX-License-Identifier: Apache-2.0
"""Probes in MuJoCo: the truth stays in the set, and each departure from the quasistatic world stays
within the bound that `give_of("mujoco")` states for it."""

import math
import statistics
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

import palmbots as pb
from palmbots._types import SIDES
from palmbots.mujoco.world import MujocoWorld
from palmbots.probing import probe as probe_command
from palmbots.probing.contact_tracking import Pair
from palmbots.probing.object_set import ObjectSet, Observation
from palmbots.probing.probe_run import ProbeRun
from palmbots.probing.simulated_hands import give_of
from probed import hidden
from sampled import amounts

_OUTSIDE_M = 0.0002
"""By so much a contact may be outside of its bounds: the object then turns by less than 0.05°."""


@dataclass
class Departures:
    """The largest ones of some runs."""

    truth: np.ndarray = field(default_factory=lambda: np.zeros((1, 3, 2)))
    contact: float = -math.inf
    """Of a contact beyond its bounds [m]."""
    angle: float = 0.0
    """Of a palm from its encoder, beyond the error that was drawn [rad]."""
    yields: list[float] = field(default_factory=list)
    """The separation less what the wheels have rolled [m]."""
    false: list[Observation] = field(default_factory=list)

    def observe(self, run: ProbeRun, is_stroke: bool) -> None:
        """Compare what the robots believe with the world. Palms that turn depart further."""
        hands: Any = run.hands
        world: MujocoWorld = hands.stage.world
        for p, (low, high) in zip(world.contacts, run.bounds.contacts, strict=True):
            self.contact = max(self.contact, low - p, p - high)
        changes, angles = hands.read()
        for palm, angle, error in zip(world._palms(), angles, hands.stage.errors, strict=True):
            if is_stroke:
                self.angle = max(self.angle, abs(palm - angle - error))
        left, right = world._distances()
        self.yields.append(right - left - sum(changes))


@pytest.fixture
def departures(monkeypatch: pytest.MonkeyPatch) -> Departures:
    """What the runs of a test show."""
    seen = Departures()

    class Watched(ProbeRun):
        def _step(
            self, changes: Pair, angles: Pair, way: int, free: tuple[bool, bool] = (True, True)
        ) -> list[int]:
            changed = super()._step(changes, angles, way, free)
            if not self.stop:
                seen.observe(self, way != 0)
            return changed

    def add(found: ObjectSet, one: Observation) -> bool:
        if not found.may_slide(seen.truth, one.pose, one.way)[one.side][0]:
            seen.false.append(one)
        return plain_add(found, one)

    plain_add = ObjectSet.add
    monkeypatch.setattr(probe_command, "ProbeRun", Watched)
    monkeypatch.setattr(ObjectSet, "add", add)
    return seen


@pytest.mark.slow
@pytest.mark.parametrize("count", amounts(2, 100))
def test_the_truth_stays_in_the_set_in_mujoco(count: int, departures: Departures) -> None:
    half_mm: list[float] = []
    spread = 0.0
    for seed in range(count):
        keys = hidden(seed)
        x, cones = keys["object.com_m"][0], [keys[f"palm.{side}.friction"] for side in SIDES]
        departures.truth = np.array([[[v, v] for v in (x, *map(math.atan, cones))]])
        departures.yields.clear()
        found = pb.probe("paper", world="mujoco", overrides=keys, seed=seed)
        assert found.contains_truth, seed
        assert found.is_consistent
        assert not departures.false, seed
        assert found.observations <= 20
        assert found.time_s <= 60
        assert found.contact_m is not None
        assert found.contact_m <= 0.010
        half_mm.append(500 * (found.com_x_m[1] - found.com_x_m[0]))
        spread = max(spread, max(departures.yields) - min(departures.yields))
    give = give_of("mujoco")
    print(
        f"COM to ±{statistics.median(half_mm):.1f} mm in the median, to ±{max(half_mm):.1f} mm at "
        f"worst; palms depart from their encoders by {math.degrees(departures.angle):.2f}°, the "
        f"separation by ±{500 * spread:.2f} mm from what the wheels have rolled"
    )
    assert departures.contact <= _OUTSIDE_M
    assert departures.angle <= give.angle
    assert spread <= 2 * give.loop
