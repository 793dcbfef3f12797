# SPDX-License-Identifier: Apache-2.0
"""Lost messages, tried by carries."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from palmbots._types import SIDES
from palmbots.assessment.answer import best_of, suffices
from palmbots.control.registry import describe
from palmbots.scene.scene import Scene
from palmbots.scene.sides import on_every_side, value_of
from palmbots.simulation.outcome_counts import OutcomeCounts, count_outcomes

LOSSES = (0.0, 0.05, 0.2, 0.5)
"""Shares of lost messages that are tried."""


@dataclass(frozen=True)
class RadioTrial:
    """How carries end if the share `loss` of messages is lost."""

    loss: float
    counts: tuple[OutcomeCounts, ...]


def try_losses(
    scene: Scene, counts: tuple[OutcomeCounts, ...], report: Callable[[float], None]
) -> Iterator[RadioTrial]:
    """Carry with more and more losses, with the controllers that suffice and use a radio."""
    best = best_of(counts)
    tried = [one for one in counts if suffices(one)] or ([best] if best else [])
    names = [one.controller for one in tried if describe(one.controller).uses_radio]
    own = {value_of(scene, f"radio.{side}.loss") for side in SIDES}
    losses = sorted({*LOSSES, *own}) if names else []
    for k, loss in enumerate(losses):
        report(k / len(losses))
        lossy = on_every_side(scene, {"radio.loss": loss})
        carries = counts[0].carries
        found = [count_outcomes(scene, name, seeds=carries, overrides=lossy) for name in names]
        yield RadioTrial(loss, tuple(found))
